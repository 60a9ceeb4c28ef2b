/// k-FIFO: a linked list of segments of k slots each; an element goes into any slot of the last
/// segment and leaves from any slot of the first (Kirsch, Lippautz and Payer 2013, "Fast and
/// Scalable, Lock-free k-FIFO Queues", PaCT).
///
/// When to use: many cores push and pop at once, the order matters up to a bound that is known
/// beforehand, and *empty* must be true. When not: the queue is nearly empty most of the time, for
/// then each element gets a segment of its own; the order of a real FIFO is needed.
///
/// Ordering: k-relaxed FIFO with a hard bound: an element leaves before at most k - 1 older ones,
/// those of its segment; where segments are full, a quarter of that on average. *Empty* is exact.
/// Progress: lock-free, apart from the allocator; a pop may need memory. Memory: a segment for k
/// pushes, or for one element where the queue is nearly empty; segments that have left wait for
/// hazard pointers, see there for the bound. Unbounded.
///
/// How it works: a push puts its element into a free slot of the last segment, from a random one
/// on, and links a new segment where there is none free. A pop takes an element from the first
/// segment, from a random slot on, and goes on to the next segment where it finds none. Before
/// anything is taken from a segment, another one is linked behind it: so a segment without a
/// successor has lost nothing, and who finds none of its slots filled has found the queue empty as
/// it was when the search began.
///
/// A segment may be left with free slots, and a push may be about to fill one. So each segment has
/// a gate. A pop closes it before it leaves, unless the gate has moved since before its search; a
/// push that has filled a slot of the first segment moves the gate, and takes its element back
/// where that is closed. Where the segment is not the first yet, its pops have still to search.
///
/// What differs from the paper, and why:
/// - A slot is used once, so that it needs no version number beside the element. A segment is left
///   sooner or later anyway, and then given back to the allocator.
/// - The gate is a word of the segment. In the paper it is a version number beside the pointer to
/// the
///   first segment, which takes bits of the pointer or a compare-and-swap of two words.
/// - Who links a segment moves the gate of the one before, so that no pop leaves that one without
///   having seen what was seen there. In the paper two pops can take turns for ever, one linking a
///   segment for the sake of an element, the other, that has missed it, leaving it there to be
///   taken back by its push.
/// - *Empty* is seen by the missing successor, where the paper compares head and tail.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/reclamation/hazard_pointers.hpp"
#include "queues/split_mix.hpp"
#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// The algorithm, with `k` slots in a segment.
template <class T, std::size_t k>
class KFifoList {
 public:
  static constexpr Claims claims{.ordering = Ordering::k_relaxed_fifo,
                                 .relaxation = k - 1,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .empty = Answer::exact,
                                 .reclamation = Reclamation::hazard_pointers,
                                 .all_ones_reserved = true,
                                 .reserved = {0}};

  KFifoList(unsigned workers, std::size_t /*capacity*/)
      : hazards_(workers, workers),
        random_(workers),
        head_(new Segment),
        // relaxed: construction is single-threaded
        tail_(head_.load(std::memory_order_relaxed)) {
    for (unsigned worker = 0; worker < workers; ++worker) random_[worker].from = SplitMix(worker);
  }
  KFifoList(const KFifoList&) = delete;
  KFifoList& operator=(const KFifoList&) = delete;

  ~KFifoList() {
    // relaxed, twice: destruction is single-threaded
    Segment* segment = head_.load(std::memory_order_relaxed);
    while (segment != nullptr) {
      Segment* next = segment->next.load(std::memory_order_relaxed);
      delete segment;
      segment = next;
    }
  }

  /// Adds `task` to the last segment. Lock-free. Always true.
  bool push(unsigned worker, T task) {
    const std::uint64_t word = word_of(task);
    for (;;) {
      Segment* segment = hazards_.guard(worker).template protect<0>(tail_);
      const Found free = find(worker, *segment, [](std::uint64_t seen) { return seen == nothing; });
      if (free.slot == nullptr) {
        extend(segment);
        continue;
      }
      std::uint64_t expected = nothing;
      // (1) seq_cst: pairs with (5) to hand on the task, and with (6) as (5) has it. relaxed on
      // failure: nothing was read but a change
      if (free.slot->compare_exchange_strong(expected, word, std::memory_order_seq_cst,
                                             std::memory_order_relaxed) &&
          stays(*segment, *free.slot, word))
        return true;
    }
  }

  /// Takes one of the k oldest tasks; false if there is none. Lock-free. Where it finds no memory
  /// for a segment it throws, and has taken nothing.
  bool pop(unsigned worker, T& task) {
    for (;;) {
      Segment* segment = hazards_.guard(worker).template protect<0>(head_);
      // (2) acquire: pairs with (7) and (9), so that the search sees what moved the gate
      const std::uint64_t gate = segment->gate.load(std::memory_order_acquire);
      Found found = find(worker, *segment,
                         [](std::uint64_t seen) { return seen != nothing && seen != taken; });
      if (found.slot != nullptr) {
        // relaxed: (3) hands it on
        if (segment->next.load(std::memory_order_relaxed) == nullptr) extend(segment);
        // (3) release: pairs with (5), so that who sees the slot taken sees a next segment. relaxed
        // on failure: nothing was read but a change
        if (found.slot->compare_exchange_strong(found.word, taken, std::memory_order_release,
                                                std::memory_order_relaxed)) {
          task = element_of<T>(found.word);
          return true;
        }
        continue;
      }
      // (4) acquire: pairs with (10), so that the gate is closed after that has moved it
      Segment* next = segment->next.load(std::memory_order_acquire);
      if (next == nullptr) return false;
      std::uint64_t expected = gate;
      // relaxed: who moves the gate sees whether it is closed, and (12) hands it on to the others
      if ((gate & closed) == 0 && !segment->gate.compare_exchange_strong(expected, gate | closed,
                                                                         std::memory_order_relaxed))
        continue;
      // `tail_` must have left `segment` before `head_` does, or a push would find it freed
      move(tail_, segment, next);
      if (move(head_, segment, next)) hazards_.guard(worker).retire(segment);
    }
  }

 private:
  // What a slot says that has no element: not yet, and not any more.
  static constexpr std::uint64_t nothing = 0;
  static constexpr std::uint64_t taken = ~std::uint64_t{0};

  static constexpr std::uint64_t closed = std::uint64_t{1} << 63U;  // of a gate

  using Slot = std::atomic<std::uint64_t>;

  struct Segment {
    std::atomic<Segment*> next{nullptr};
    std::atomic<std::uint64_t> gate{0};
    alignas(cache_line_pair) std::array<Slot, k> slots{};
  };

  struct Found {
    Slot* slot = nullptr;
    std::uint64_t word = 0;
  };

  struct alignas(cache_line_pair) Random {
    SplitMix from{0};
  };

  // The first slot with what is `wanted`, from a random one on.
  template <class Wanted>
  Found find(unsigned worker, Segment& segment, Wanted wanted) {
    const std::size_t first = random_[worker].from.below(k);
    for (std::size_t i = 0; i < k; ++i) {
      Slot& slot = segment.slots[(first + i) % k];
      // (5) seq_cst: pairs with (3), and with (1) and (6). A push fills a slot and reads `head_`, a
      // pop has read `segment` in `head_` and reads the slot: one of them sees the other
      const std::uint64_t word = slot.load(std::memory_order_seq_cst);
      if (wanted(word)) return {&slot, word};
    }
    return {};
  }

  // Whether `word`, which its push has put into `slot`, is in the queue or was taken from there. If
  // not, it is in no slot any more. The paper's `committed`.
  bool stays(Segment& segment, Slot& slot, std::uint64_t word) {
    // (6) seq_cst: pairs with (1) and (5) as is said there, where the pop has read `head_` by the
    // load in try_protect() of hazard_pointers.hpp; and with (12), so that the gate of a segment
    // that was left is seen closed
    const bool first = head_.load(std::memory_order_seq_cst) == &segment;
    // (7) release: pairs with (2). relaxed, of the load: the one before says what must be seen
    const std::uint64_t gate = first ? segment.gate.fetch_add(1, std::memory_order_release)
                                     : segment.gate.load(std::memory_order_relaxed);
    if ((gate & closed) == 0) return true;
    // relaxed: the task stays with this push, or it is with a pop already
    return !slot.compare_exchange_strong(word, taken, std::memory_order_relaxed);
  }

  // Sees to it that there is a segment behind this one, and that pushes go there.
  void extend(Segment* segment) {
    // (8) acquire: pairs with (10), so that the segment we move `tail_` to is whole for who reads
    // it there
    Segment* next = segment->next.load(std::memory_order_acquire);
    if (next == nullptr) {
      auto fresh = std::make_unique<Segment>();
      // (9) release: pairs with (2). What is answered does not rest on that, progress does
      segment->gate.fetch_add(1, std::memory_order_release);
      // (10) release: pairs with (4), (8) and (11)
      // (11) acquire: on failure; pairs with (10) for the same
      if (segment->next.compare_exchange_strong(next, fresh.get(), std::memory_order_release,
                                                std::memory_order_acquire))
        next = fresh.release();
    }
    move(tail_, segment, next);
  }

  static bool move(std::atomic<Segment*>& source, Segment* from, Segment* to) {
    // (12) release: pairs with (6), and with the load in protect() of hazard_pointers.hpp, so that
    // `to` is whole for who reads it there; and with the fence there, which is what retire() asks
    // for. relaxed on failure: another thread has done it
    return source.compare_exchange_strong(from, to, std::memory_order_release,
                                          std::memory_order_relaxed);
  }

  HazardPointers<Segment, 1> hazards_;
  std::vector<Random> random_;
  // Initialised by the constructor: where a `new` in a member's own initialiser throws, GCC 12 does
  // not give the memory back.
  alignas(cache_line_pair) std::atomic<Segment*> head_;
  alignas(cache_line_pair) std::atomic<Segment*> tail_;
};

template <class T>
class KFifoQueue : public KFifoList<T, 32> {
 public:
  static constexpr std::string_view summary =
      "k-FIFO: linked segments of 32 slots, hazard pointers";
  using KFifoList<T, 32>::KFifoList;
};

}  // namespace irt
