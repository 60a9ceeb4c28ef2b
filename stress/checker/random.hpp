/// Random search: the three ways to draw a schedule.
///
/// Every execution has its own generator, seeded with the search's seed and the execution's number,
/// so that a run of a search can be repeated alone. Reads are stale with one in four, as far back
/// as the model allows; stores come before others with one in sixteen.
#pragma once

#include <cstdint>
#include <vector>

#include "queues/split_mix.hpp"
#include "stress/checker/strategy.hpp"

namespace irt::checker {

/// The numbers of one execution.
class Generator : public SplitMix {
 public:
  using SplitMix::SplitMix;
  /// Below `limit`, which is at least 1.
  std::uint32_t below(std::uint32_t limit) {
    return static_cast<std::uint32_t>(SplitMix::below(limit));
  }
};

/// What the random strategies share: executions without end, choices other than threads. An
/// execution depends on the seed and on its number; the `shard`-th of `shards` parts makes every
/// `shards`-th.
class RandomBase : public Strategy {
 public:
  explicit RandomBase(std::uint64_t seed, unsigned shard = 0, unsigned shards = 1)
      : generator_(seed), next_(seed + shard), shards_(shards) {}

  bool begin() override;
  [[nodiscard]] bool wants_verified() const override { return false; }

 protected:
  std::uint32_t choose(ChoiceKind kind, std::uint32_t count) override;

  Generator generator_;

 private:
  std::uint64_t next_;
  unsigned shards_;
};

/// A fair coin at every step. Good at nothing in particular, bad at nothing.
class RandomWalk final : public RandomBase {
 public:
  using RandomBase::RandomBase;
};

/// Probabilistic concurrency testing (Burckhardt, Kothari, Musuvathi and Nagarakatte 2010): random
/// priorities, of which `depth` - 1 drop at random steps. Finds a bug of that depth among n threads
/// and k steps with probability 1 / (n k^(depth-1)) or better. k is the longest execution so far.
class PriorityChanges final : public RandomBase {
 public:
  PriorityChanges(std::uint64_t seed, unsigned shard, unsigned shards, unsigned depth)
      : RandomBase(seed, shard, shards), depth_(depth) {}

  bool begin() override;
  unsigned choose_thread(ExecutionState& state, std::uint32_t runnable, unsigned current) override;

 private:
  unsigned depth_;
  std::uint32_t longest_ = 16;
  std::uint32_t step_ = 0;
  std::vector<std::uint32_t> changes_;
  std::vector<std::uint64_t> priority_;
};

/// Partial order sampling (Yuan, Yang and Gu 2018): each thread's next step has a random priority,
/// the highest runs, and those it conflicts with draw anew. Spreads over orders that differ.
class OrderSampling final : public RandomBase {
 public:
  using RandomBase::RandomBase;

  bool begin() override;
  unsigned choose_thread(ExecutionState& state, std::uint32_t runnable, unsigned current) override;

 private:
  std::vector<std::uint64_t> priority_;
};

}  // namespace irt::checker
