/// The top of the wide hierarchy: ranges so large that all threads split them together. Included
/// once per instruction set.
#if defined(IRT_WIDE_TOP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IRT_WIDE_TOP_INL
#undef IRT_WIDE_TOP_INL
#else
#define IRT_WIDE_TOP_INL
#endif

#include <algorithm>
#include <array>
#include <cstdint>
#include <hwy/highway.h>
#include <memory>
#include <vector>

#include "renderer/bvh/executor.hpp"
#include "renderer/bvh/wide/split-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

/// A range of the top. Pieces are a binary tree: the wide nodes are gathered from it.
struct Piece {
  Range range;
  std::uint32_t left = 0;  ///< index of the left half, which the right one follows; 0: not split
};

/// A piece to be split, by cost or, where the tree is too deep for that, in the middle.
struct PieceToSplit {
  std::uint32_t piece;
  bool by_cost;
};

/// Splits many pieces at once, and each in chunks, so that one large range keeps as many threads
/// busy as many small ones. Chunks leave no trace in what comes out: bins and bounds are exact, and
/// references keep their order.
class TopSplitter {
 public:
  TopSplitter(const Buffers& buffers, const Measure& measure, std::uint32_t chunk,
              Executor& executor)
      : buffers_(buffers), measure_(measure), chunk_(chunk), executor_(executor) {}

  /// Adds the halves of those `wanted` to `pieces`.
  void split(const std::vector<PieceToSplit>& wanted, std::vector<Piece>& pieces) {
    plan(wanted, pieces);
    executor_.for_each(chunks_.size(), [&](std::size_t i) { bin(chunks_[i], bins_[i]); });
    executor_.for_each(plans_.size(), [&](std::size_t i) { choose(plans_[i]); });
    executor_.for_each(chunks_.size(), [&](std::size_t i) { move(chunks_[i]); });
    for (std::size_t i = 0; i < plans_.size(); ++i) {
      Plan& plan = plans_[i];
      if (plan.split.found()) join(plan);
      pieces[wanted[i].piece].left = static_cast<std::uint32_t>(pieces.size());
      pieces.push_back({plan.halves[0]});
      pieces.push_back({plan.halves[1]});
    }
  }

 private:
  /// A piece on its way, and its chunks.
  struct Plan {
    Range range;
    bool by_cost;
    std::size_t first, last;
    Binning binning;
    Split split;
    Range halves[2];
  };
  struct Chunk {
    std::uint32_t plan;
    Range range;
    std::uint32_t lefts_before;  ///< references of the piece that go left and are in chunks before
    std::array<CenterBounds, 2> centers;
  };

  void plan(const std::vector<PieceToSplit>& wanted, const std::vector<Piece>& pieces) {
    plans_.clear();
    chunks_.clear();
    for (const PieceToSplit& one : wanted) {
      const Range& range = pieces[one.piece].range;
      const std::uint64_t count = range.count(), chunks = (count + chunk_ - 1) / chunk_;
      Plan& plan = plans_.emplace_back();
      plan.range = range;
      plan.by_cost = one.by_cost;
      plan.binning = Binning(range.centers, range.count());
      plan.first = chunks_.size();
      plan.last = plan.first + chunks;
      for (std::uint64_t i = 0; i < chunks; ++i) {
        Chunk& chunk = chunks_.emplace_back();
        chunk.plan = static_cast<std::uint32_t>(plans_.size() - 1);
        chunk.range = range;
        chunk.range.begin = range.begin + static_cast<std::uint32_t>(count * i / chunks);
        chunk.range.end = range.begin + static_cast<std::uint32_t>(count * (i + 1) / chunks);
      }
    }
    if (chunks_.size() > room_) {
      room_ = 2 * chunks_.size();
      bins_ = std::make_unique_for_overwrite<Bins[]>(room_);
    }
  }

  void bin(const Chunk& chunk, Bins& bins) const {
    const Plan& plan = plans_[chunk.plan];
    if (plan.by_cost) bins.fill(buffers_.of(chunk.range), chunk.range.count(), plan.binning);
  }

  void choose(Plan& plan) {
    if (plan.by_cost) {
      Bins all = bins_[plan.first];
      for (std::size_t i = plan.first + 1; i < plan.last; ++i) all.add(bins_[i], plan.binning.bins);
      plan.split = all.best(plan.binning, measure_);
    }
    if (!plan.split.found()) {
      halve(buffers_, measure_, plan.range, plan.halves[0], plan.halves[1]);
      return;
    }
    std::uint32_t lefts = 0;
    for (std::size_t i = plan.first; i < plan.last; ++i) {
      chunks_[i].lefts_before = lefts;
      lefts += bins_[i].left_of(plan.split);
    }
  }

  void move(Chunk& chunk) const {
    const Plan& plan = plans_[chunk.plan];
    if (!plan.split.found()) return;
    Reference* const to = buffers_.other(plan.range);
    const std::uint32_t rights_before = chunk.range.begin - plan.range.begin - chunk.lefts_before;
    chunk.centers = partition(buffers_.of(chunk.range), chunk.range.count(), plan.split,
                              to + chunk.lefts_before, to + plan.split.left_count + rights_before);
  }

  void join(Plan& plan) const {
    std::array<CenterBounds, 2> centers;
    for (std::size_t i = plan.first; i < plan.last; ++i) {
      for (std::size_t side = 0; side < 2; ++side) centers[side].add(chunks_[i].centers[side]);
    }
    part_by(plan.split, centers, plan.range, plan.halves[0], plan.halves[1]);
  }

  const Buffers& buffers_;
  const Measure& measure_;
  std::uint32_t chunk_;  ///< references at most in a chunk
  Executor& executor_;
  std::vector<Plan> plans_;
  std::vector<Chunk> chunks_;
  std::unique_ptr<Bins[]> bins_;  ///< of each chunk
  std::size_t room_ = 0;
};

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
