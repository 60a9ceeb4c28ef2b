/// Judges a history by happens-before alone, whatever the clock says.
///
/// Which operations are ordered is taken only from what any program may rely on: each worker's own
/// order, from the push of an element to the pop that returned it, and barriers (`Kind::meet`) of
/// all workers. The drain comes after everything. Vector clocks hold the closure of these edges.
///
/// What may be accused:
///  - *order*: push a -> push b and pop b -> pop a. No FIFO order of all operations can hold.
///  - *empty*: push a -> empty -> pop a. The element was inside, and this worker had every right
///    to know: it, or somebody whose element it took, had pushed it.
///  - *full*: by the most elements that can have been inside.
/// Whether what was in flight meanwhile excuses the last two, the specification says.
///
/// Every accusation also holds in real time, so queues that claim more are judged by it too. What
/// it cannot see: an *empty* that is wrong only by the clock (a release store still in a store
/// buffer), and one that only several elements together refute.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "stress/history/matching.hpp"
#include "stress/history/specification.hpp"

namespace irt::stress {

/// The happens-before relation of one history. Memory: 8 bytes per operation and worker.
class HappensBefore {
 public:
  /// The matching must outlive it.
  explicit HappensBefore(const Matching& matching);

  /// An element popped before its push by the order of the logs themselves (a cycle).
  [[nodiscard]] const std::optional<Violation>& cycle() const { return cycle_; }

  /// Whether elements leave in the order they were pushed; only compares elements of one producer
  /// when `same_producer`.
  [[nodiscard]] std::optional<Violation> judge_order(bool same_producer) const;

  struct Empties {
    std::uint64_t all = 0;
    std::uint64_t refuted = 0;       ///< an element was inside all the while
    std::optional<Violation> first;  ///< of the refuted that the specification does not allow
  };
  [[nodiscard]] Empties judge_empties(const Specification& specification) const;

  /// A *full* that the specification does not allow even with the most elements that can have been
  /// inside.
  [[nodiscard]] std::optional<Violation> judge_full(const Specification& specification) const;

 private:
  using Tick = std::uint32_t;
  static constexpr Tick no_push = ~Tick{0};

  struct Position {
    std::size_t row;
    std::size_t index;
  };
  /// Operations of a log before a position, by kind.
  struct Count {
    std::int64_t pushes = 0;
    std::int64_t refused = 0;
    std::int64_t pops = 0;
    std::int64_t empties = 0;
  };

  /// A log with, per operation, its vector clock and the earliest push, by producer, among the pops
  /// from there on; row i belongs to operation i.
  struct Row {
    const std::vector<Operation>* log;
    std::vector<Tick> clocks;
    std::vector<Tick> earliest_push;
    std::vector<Count> counts;
  };

  void run();
  void note_earliest();
  [[nodiscard]] const Tick* clock(std::size_t row, std::size_t index) const {
    return &rows_[row].clocks[index * rows_.size()];
  }
  /// The first operation of `row` that happens after operation `index` of `of`.
  [[nodiscard]] std::size_t first_after(std::size_t row, std::size_t of, std::size_t index) const;
  /// A pop that happens after the operation at `at` of an element whose push is within `past`, if
  /// there is one; of one producer's elements, in one row, if so wished.
  [[nodiscard]] std::optional<Position> later_pop(const Tick* past, Position at,
                                                  std::optional<std::size_t> producer,
                                                  std::optional<std::size_t> only_row) const;
  /// What was in flight during the operation at `at`.
  [[nodiscard]] InFlight around(Position at) const;
  /// Whether a pop in flight during the one at `at` answered *empty* and did not run, as that did,
  /// all the while that the element of `pop` was inside.
  [[nodiscard]] bool has_doubtful_empty(Position at, Position pop) const;
  /// Whether `pop` is the same worker's as `at`, and nobody else did anything in between.
  [[nodiscard]] bool found_again(Position at, Position pop) const;
  [[nodiscard]] const Operation& operation(Position at) const {
    return (*rows_[at.row].log)[at.index];
  }
  /// The operations of `row` that neither happen before the one at `at` nor after it: [from, to).
  struct Range {
    std::size_t from;
    std::size_t to;
  };
  [[nodiscard]] Range concurrent(std::size_t row, Position at) const;

  const Matching* matching_;
  std::vector<Row> rows_;  ///< the workers, then the drain
  std::optional<Violation> cycle_;
};

}  // namespace irt::stress
