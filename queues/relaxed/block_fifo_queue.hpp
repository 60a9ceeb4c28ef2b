/// BlockFIFO: windows of blocks; a push fills a block that is its worker's alone, pops empty the
/// blocks of the oldest window in any order (Koch, Sanders and Williams 2025, "BlockFIFO &
/// MultiFIFO: Scalable Relaxed Queues", arXiv 2507.22764).
///
/// When to use: many cores push and pop at once and throughput matters more than order; most
/// operations meet nobody. When not: a bound on the order must hold in every case; there are fewer
/// elements than a window has places, for then any may leave before any.
///
/// Ordering: none that is certain. Elements of one window leave in any order, those of one block in
/// that of their pushes: an element leaves before about a quarter of a window of older ones on
/// average. What goes into a block that others' pushes have left behind passes all that came since.
/// *Empty* may stand for calls in flight. Progress: lock-free, apart from the allocator. Memory: a
/// block of 15 places for each worker, rounded up to a power of two, at most 32 blocks, is a
/// window; windows that have left wait for hazard pointers, see there for the bound: an idle worker
/// keeps up to three. Unbounded. A smaller `capacity` makes smaller blocks.
///
/// How it works: bits of the last window say which of its blocks are taken. A push takes one, fills
/// it place by place, and takes another when it is full; where no block is left it links a new
/// window, with its element in the first block. Beside the places a block has two counts, of
/// elements pushed and popped, in one word. A pop goes on with the block that it used last, and
/// from an empty one to another whose bit is set in the first window. Where pushes have gone on to
/// a next window it closes the empty block, so that its push has to take another, and marks it by a
/// bit of the window. A window all of whose blocks are marked is left.
///
/// What differs from the paper and its authors' first program (Saalvage/relaxed_concurrent_fifo),
/// and why:
/// - Windows are linked, and used once. In a ring of windows a push that is stopped between its
///   look at a block and its store would write into a block that has been given on since; there
///   the program counts first and stores then, and pops wait for what was counted.
/// - An element is in its place before it is counted, so that no pop waits for it; and it is read
///   before it is counted as popped, so that two counts do for the program's three.
/// - Pops may come into the window that pushes are in. In the program they send pushes on to the
///   next one, and blocks are left half empty.
/// - Who links a window has its element inside. Else pushes could take blocks and find them closed
///   for ever.
/// - A bit that says that a block is done with is set and not cleared, so that no late hand clears
///   a block that was taken again.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/reclamation/hazard_pointers.hpp"
#include "queues/split_mix.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class BlockFifoQueue {
 public:
  static constexpr std::string_view summary =
      "BlockFIFO: windows of blocks, each filled by one worker, hazard pointers";
  static constexpr Claims claims{.ordering = Ordering::unordered,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::hazard_pointers,
                                 .elements = {.large = true}};

  BlockFifoQueue(unsigned workers, std::size_t capacity)
      : blocks_(std::min(std::bit_ceil(workers), most_blocks)),
        places_(static_cast<unsigned>(std::clamp<std::size_t>(capacity / blocks_, 1, most_places))),
        hazards_(workers, workers),
        workers_(workers),
        head_(new Window(blocks_)),
        // relaxed: construction is single-threaded
        tail_(head_.load(std::memory_order_relaxed)) {
    for (unsigned worker = 0; worker < workers; ++worker)
      workers_[worker].random = SplitMix(worker);
  }
  BlockFifoQueue(const BlockFifoQueue&) = delete;
  BlockFifoQueue& operator=(const BlockFifoQueue&) = delete;

  ~BlockFifoQueue() {
    // relaxed, twice: destruction is single-threaded
    Window* window = head_.load(std::memory_order_relaxed);
    while (window != nullptr) {
      Window* next = window->next.load(std::memory_order_relaxed);
      delete window;
      window = next;
    }
  }

  /// Adds `task` to the worker's block. Lock-free. Always true.
  bool push(unsigned worker, T task) {
    Worker& mine = workers_[worker];
    while (mine.pushes_to == nullptr || !put(*mine.pushes_to, task)) {
      mine.pushes_to = nullptr;  // from here on its window may go
      const auto guard = hazards_.guard(worker);
      Window* window = mine.slot == of_push ? guard.template protect<of_push>(tail_)
                                            : guard.template protect<of_other_push>(tail_);
      mine.pushes_to = taken_block(mine, *window);
      if (mine.pushes_to == nullptr && extend(worker, window, task)) return true;
    }
    return true;
  }

  /// Takes a task of the oldest window; false if it sees none. Lock-free.
  bool pop(unsigned worker, T& task) {
    Worker& mine = workers_[worker];
    while (mine.pops_from == nullptr || !take(*mine.pops_from, task)) {
      mine.pops_from = nullptr;  // from here on its window may go
      mine.pops_from = filled_block(worker);
      if (mine.pops_from == nullptr) return false;
    }
    return true;
  }

 private:
  enum Slot : std::size_t { of_push, of_other_push, of_pop };

  static constexpr unsigned most_blocks = 32;
  static constexpr unsigned most_places = 15;

  // The state of a block: how many were pushed, how many popped, and whether pushes may go on.
  static constexpr std::uint32_t one_pushed = 1;
  static constexpr std::uint32_t one_popped = 1U << 8U;
  static constexpr std::uint32_t closed = 1U << 16U;
  static std::uint32_t pushed(std::uint32_t state) { return state & 0xffU; }
  static std::uint32_t popped(std::uint32_t state) { return state >> 8U & 0xffU; }

  struct alignas(cache_line_pair) Block {
    std::atomic<std::uint32_t> state{0};
    std::array<T, most_places> places{};
  };

  struct Window {
    explicit Window(unsigned count) : blocks(count) {}

    std::vector<Block> blocks;
    std::atomic<Window*> next{nullptr};
    alignas(cache_line_pair) std::atomic<std::uint32_t> taken{0};  // by a push
    alignas(cache_line_pair) std::atomic<std::uint32_t> done{0};   // closed and empty
  };

  struct alignas(cache_line_pair) Worker {
    Block* pushes_to = nullptr;  // in the window that its hazard pointer names in `slot`
    Slot slot = of_push;
    Block* pops_from = nullptr;  // in the one that it names in `of_pop`
    SplitMix random{0};
  };

  // Adds `task` to a block that no other push uses; false if it is full or closed.
  bool put(Block& block, const T& task) {
    // relaxed: what is written here nobody reads before (1)
    std::uint32_t state = block.state.load(std::memory_order_relaxed);
    while ((state & closed) == 0 && pushed(state) < places_) {
      block.places[pushed(state)] = task;
      // (1) release: pairs with (2), so that the task is read as written. relaxed on
      // failure: as above
      if (block.state.compare_exchange_strong(state, state + one_pushed, std::memory_order_release,
                                              std::memory_order_relaxed))
        return true;
    }
    return false;
  }

  // Takes the oldest task of the block; false if there is none.
  bool take(Block& block, T& task) {
    for (;;) {
      // (2) acquire: pairs with (1)
      std::uint32_t state = block.state.load(std::memory_order_acquire);
      if (popped(state) == pushed(state)) return false;
      const T taken = block.places[popped(state)];
      // relaxed: the place is not written again
      if (block.state.compare_exchange_strong(state, state + one_popped,
                                              std::memory_order_relaxed)) {
        task = taken;
        return true;
      }
    }
  }

  // Takes a block of `window` for the worker's pushes; null if none is left.
  Block* taken_block(Worker& mine, Window& window) {
    // relaxed, also below: a block is taken once by being a read-modify-write, whatever its order
    std::uint32_t taken = window.taken.load(std::memory_order_relaxed);
    while (taken != all()) {
      const unsigned at = some_bit(mine, all() & ~taken);
      if (window.taken.compare_exchange_strong(taken, taken | 1U << at, std::memory_order_relaxed))
        return &window.blocks[at];
    }
    return nullptr;
  }

  // A block with a task, in the first window that is not done with; null if there is none.
  Block* filled_block(unsigned worker) {
    for (;;) {
      Window* window = hazards_.guard(worker).template protect<of_pop>(head_);
      // (4) acquire: pairs with (6), so that where there is a next window it is whole, and all
      // blocks of this one are seen taken
      Window* next = window->next.load(std::memory_order_acquire);
      // relaxed, also below: a push that returned before this pop is seen, and done bits save looks
      std::uint32_t left = window->taken.load(std::memory_order_relaxed) &
                           ~window->done.load(std::memory_order_relaxed);
      while (left != 0) {
        const unsigned at = some_bit(workers_[worker], left);
        Block& block = window->blocks[at];
        if (has_task(block, next != nullptr)) return &block;
        left &= ~(1U << at);
        // relaxed: a hint
        if (next != nullptr) window->done.fetch_or(1U << at, std::memory_order_relaxed);
      }
      if (next == nullptr) return nullptr;
      // `tail_` must have left `window` before `head_` does, or a push would find it freed
      move(tail_, window, next);
      if (move(head_, window, next)) hazards_.guard(worker).retire(window);
    }
  }

  // Whether a task is in the block. If not, and if it `closes`, none ever will be.
  bool has_task(Block& block, bool closes) {
    // relaxed: take() looks again
    std::uint32_t state = block.state.load(std::memory_order_relaxed);
    while (popped(state) == pushed(state)) {
      if (!closes || (state & closed) != 0) return false;
      // relaxed: nothing goes with it
      if (block.state.compare_exchange_strong(state, state | closed, std::memory_order_relaxed))
        return false;
    }
    return true;
  }

  // Sees to it that there is a window behind this one, and that pushes go there. True if it is this
  // worker's own, with `task`.
  bool extend(unsigned worker, Window* window, const T& task) {
    // (5) acquire: pairs with (6), so that the window we move `tail_` to is whole for who reads it
    // there
    Window* next = window->next.load(std::memory_order_acquire);
    bool is_mine = false;
    if (next == nullptr) {
      auto fresh = std::make_unique<Window>(blocks_);
      Block& block = fresh->blocks.front();
      fresh->taken.store(1, std::memory_order_relaxed);  // relaxed: (6) publishes it
      put(block, task);
      Worker& mine = workers_[worker];
      const Slot slot = mine.slot == of_push ? of_other_push : of_push;
      // Nobody else knows it yet, so that it is safe from now on, whatever is answered.
      const auto guard = hazards_.guard(worker);
      if (slot == of_push)
        guard.template try_protect<of_push>(fresh.get(), tail_, window);
      else
        guard.template try_protect<of_other_push>(fresh.get(), tail_, window);
      // (6) release: pairs with (4), (5) and (7)
      // (7) acquire: on failure; pairs with (6) for the same
      is_mine = window->next.compare_exchange_strong(next, fresh.get(), std::memory_order_release,
                                                     std::memory_order_acquire);
      if (is_mine) {
        mine.pushes_to = &block;
        mine.slot = slot;
        next = fresh.release();
      }
    }
    move(tail_, window, next);
    return is_mine;
  }

  static bool move(std::atomic<Window*>& source, Window* from, Window* to) {
    // (8) release: pairs with the load in protect() of hazard_pointers.hpp, so that `to` is whole
    // for who reads it there; and with the fence there, which is what retire() asks for. relaxed on
    // failure: another thread has done it
    return source.compare_exchange_strong(from, to, std::memory_order_release,
                                          std::memory_order_relaxed);
  }

  // The bits of all blocks of a window.
  [[nodiscard]] std::uint32_t all() const { return ~std::uint32_t{0} >> (most_blocks - blocks_); }

  // One of `bits`, which are not all zero: the first from a random one on.
  unsigned some_bit(Worker& mine, std::uint32_t bits) const {
    const auto first = static_cast<int>(mine.random.below(blocks_));
    return static_cast<unsigned>(first + std::countr_zero(std::rotr(bits, first))) % 32U;
  }

  const unsigned blocks_;
  const unsigned places_;  // of a block that are used
  HazardPointers<Window, 3> hazards_;
  std::vector<Worker> workers_;
  // Initialised by the constructor: where a `new` in a member's own initialiser throws, GCC 12 does
  // not give the memory back.
  alignas(cache_line_pair) std::atomic<Window*> head_;
  alignas(cache_line_pair) std::atomic<Window*> tail_;
};

}  // namespace irt
