/// What DPOR has yet to explore: graphs to be built again and gone on from, each as a plan.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "stress/checker/graph.hpp"

namespace irt::checker {

/// An event to be made again.
struct Planned {
  const void* choice = nullptr;  ///< where it is, if it is one
  Ref from = initial_ref;        ///< what it reads or, for a store, what it comes after
  std::uint32_t option = 0;
  std::uint32_t read_stamp = 0;
  std::uint32_t write_stamp = 0;  ///< 0: to be given when it is made
  std::uint8_t thread = 0;
  bool fresh = false;  ///< its store has not yet been offered to earlier reads
};

struct Work {
  std::vector<Planned> plan;
  bool verify = false;  ///< the model has not yet been asked about the whole
  double weight = 1;    ///< part of all executions that it is taken to lead to
};

/// All of the work, or the `shard`-th of `shards` parts of it. The parts share the first few
/// pieces.
class Frontier {
 public:
  Frontier(unsigned shard, unsigned shards)
      : work_(1), shard_(shard), shards_(shards), shared_(shards > 1) {}

  /// The next piece, which led to nothing yet; none if all is done.
  std::optional<Work> next();
  /// The piece in progress leads to this one.
  void add(Work work);

  /// Whether there was too much to keep in mind.
  [[nodiscard]] bool left_out() const { return left_out_; }
  /// Estimated part of the whole that is done, from 0 to 1.
  [[nodiscard]] double explored() const { return explored_ / (explored_ + open_); }
  /// Whether the piece in progress is shared, and counted by the first part.
  [[nodiscard]] bool elsewhere() const { return shared_ && shard_ != 0; }

 private:
  void weigh();
  void divide();

  std::deque<Work> work_;
  unsigned shard_;
  unsigned shards_;
  bool shared_;              ///< the work has not been divided yet
  std::size_t planned_ = 0;  ///< events in all plans, which bounds memory
  bool left_out_ = false;
  std::optional<double> weight_;  ///< of the piece in progress
  std::size_t offspring_ = 0;     ///< pieces that it has led to
  double explored_ = 0;           ///< weight of what is done ...
  double open_ = 1;               ///< ... and of what is not
};

}  // namespace irt::checker
