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

  /// The empties that happens-before refutes, and the first of them.
  struct Empties {
    std::uint64_t all = 0;
    std::uint64_t refuted = 0;
    std::optional<Violation> first;
  };
  [[nodiscard]] Empties judge_empties() const;

  /// A *full* although fewer than `capacity` elements can have been inside. If not `exact`, only
  /// where no pop runs concurrently: a ring may have to wait for the place of one under way, and
  /// its other places are of no use meanwhile.
  [[nodiscard]] std::optional<Violation> judge_full(std::size_t capacity, bool exact) const;

 private:
  using Tick = std::uint32_t;
  static constexpr Tick no_push = ~Tick{0};

  /// A log with, per operation, its vector clock and the earliest push, by producer, among the pops
  /// from there on; row i belongs to operation i.
  struct Row {
    const std::vector<Operation>* log;
    std::vector<Tick> clocks;
    std::vector<Tick> earliest_push;
  };

  void run();
  void note_earliest();
  [[nodiscard]] const Tick* clock(std::size_t row, std::size_t index) const {
    return &rows_[row].clocks[index * rows_.size()];
  }
  /// The first operation of `row` that happens after operation `index` of `of`.
  [[nodiscard]] std::size_t first_after(std::size_t row, std::size_t of, std::size_t index) const;
  /// A pop that happens after operation (`row`, `index`) of an element whose push is within `past`;
  /// null if there is none. `only` restricts it to one producer.
  [[nodiscard]] const Operation* later_pop(const Tick* past, std::size_t row, std::size_t index,
                                           std::optional<std::size_t> only) const;

  const Matching* matching_;
  std::vector<Row> rows_;  ///< the workers, then the drain
  std::optional<Violation> cycle_;
};

}  // namespace irt::stress
