/// Joins every push with the pop of its element: the table that all oracles read.
#pragma once

#include <vector>

#include "stress/history/operation.hpp"
#include "stress/history/violation.hpp"

namespace irt::stress {

/// An element's push and its pop; either is null when it did not happen.
struct Life {
  const Operation* push = nullptr;
  const Operation* pop = nullptr;

  /// When the pop began; `never` for an element that stayed.
  [[nodiscard]] Stamp pop_invoked() const { return pop != nullptr ? pop->invoked : never; }
  [[nodiscard]] Stamp pop_returned() const { return pop != nullptr ? pop->returned : never; }
};

/// The elements of one history. Points into the history, which must outlive it.
///
/// An element's producer is the index of the log that pushes it, and a producer's sequence numbers
/// rise from 0 in the order in which it pushed; numbers that were refused (`full`) and never pushed
/// leave gaps without harm.
class Matching {
 public:
  explicit Matching(const History& history);

  /// By producer, in the order it pushed.
  [[nodiscard]] const std::vector<std::vector<Life>>& lives() const { return lives_; }

  /// The life of `e`; null when nobody pushed it.
  [[nodiscard]] const Life* find(Element e) const;

  /// Broken *exactly once*: invented, repeated and lost elements; at most one of each pattern.
  [[nodiscard]] const std::vector<Violation>& violations() const { return violations_; }

  /// Who made `operation`, which must belong to the history.
  [[nodiscard]] Culprit culprit(const Operation& operation) const;

  [[nodiscard]] const History& history() const { return *history_; }

 private:
  void note_pop(const Operation& pop);
  void report_lost();

  const History* history_;
  std::vector<std::vector<Life>> lives_;
  std::vector<Violation> violations_;
  bool invented_ = false;
  bool repeated_ = false;
};

/// The pushes of a matching as one sequence, ordered by the stamp that `Key` reads. The producers'
/// lists are sorted already, so this is a merge, not a sort.
template <Stamp Operation::*key>
class PushesInOrder {
 public:
  explicit PushesInOrder(const Matching& matching) {
    for (const auto& lives : matching.lives()) {
      cursors_.push_back({lives.data(), lives.data() + lives.size(), 0});
      skip_gaps(cursors_.back());
    }
    select();
  }
  PushesInOrder(const PushesInOrder&) = delete;
  PushesInOrder& operator=(const PushesInOrder&) = delete;

  /// The stamp of the next push; `never` at the end.
  [[nodiscard]] Stamp stamp() const { return best_ != nullptr ? best_->stamp : never; }
  [[nodiscard]] bool done() const { return best_ == nullptr; }

  const Life& next() {
    const Life& life = *best_->at++;
    skip_gaps(*best_);
    select();
    return life;
  }

 private:
  struct Cursor {
    const Life* at;
    const Life* end;
    Stamp stamp;
  };

  static void skip_gaps(Cursor& cursor) {
    while (cursor.at != cursor.end && cursor.at->push == nullptr) ++cursor.at;
    cursor.stamp = cursor.at != cursor.end ? cursor.at->push->*key : never;
  }

  void select() {
    best_ = nullptr;
    Stamp lowest = never;
    for (Cursor& cursor : cursors_) {
      if (cursor.at != cursor.end && (best_ == nullptr || cursor.stamp < lowest)) {
        best_ = &cursor;
        lowest = cursor.stamp;
      }
    }
  }

  std::vector<Cursor> cursors_;
  Cursor* best_ = nullptr;
};

}  // namespace irt::stress
