/// BWOS: a stack of blocks for each worker, of which the owner has the uppermost for itself and
/// thieves empty the lowest (Wang, Trach, Fu, Behrens, Schwender, Liu, Lei, Vafeiadis, Härtig and
/// Chen 2023, "BWoS: Formally Verified Block-based Work Stealing for Parallel Processing", OSDI).
///
/// When to use: tasks are so short that the barrier of a deque's `take` shows, and so many that a
/// block of them more or less on one worker does not matter. When not: few and long tasks, or a
/// worker that pushes and does not come back, for what is in the owner's block can be had by nobody
/// else until the owner goes on to another or leaves.
///
/// Ordering: none. *Empty* speaks for this worker alone: others may have a block in hand. Progress:
/// `push` is wait-free, apart from the allocator, `pop` lock-free. Memory: blocks of 128 bytes with
/// 15 tasks, as many for each worker as it had in use at once, rounded up to a power of two; they
/// are kept until destruction. Unbounded.
///
/// How it works: an owner pushes to its own block and pops from there without telling anybody. When
/// the block is full it is granted to thieves, and the owner goes up to the next. When it is empty
/// the owner takes over what thieves have left of the block beneath. A thief takes the oldest task
/// of the lowest block. Owner and thieves so meet in one word of each block, its state, and only
/// where the owner changes blocks: how many tasks thieves have taken, or that it is the owner's. A
/// grant gives the state a new version, so that a thief who is late does not take one grant for
/// another; it reads the task before its compare-and-swap, which fails then. An owner that leaves
/// lends its block to thieves, and takes back what is left when it returns.
///
/// Blocks are numbered from the lowest on. `lowest_` only grows, and only past a block that thieves
/// have emptied, beneath which the owner never comes again. So the block of number `i` is at
/// `i mod n` of `n`, as in a ring, and is used again when `lowest_` has passed it. If it has not,
/// the ring is doubled.
///
/// What differs from the paper, and why:
/// - The ring grows where the paper's is full.
/// - A thief reads a task before the compare-and-swap, not after it. So nobody counts thieves that
///   are still reading, and an owner never has to wait for one.
/// - A block's state has a version in place of its round, as the same round may be granted again.
/// - Victims are visited from a random one on (stealing_queues.hpp). The paper's probability that
///   grows with a victim's length needs this length, which its owner would have to tell.
/// - Workers may leave. There, thieves never get what is in an owner's block.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/distributed/stealing_queues.hpp"
#include "queues/distributed/theft.hpp"
#include "queues/distributed/victims.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// The stack of one owner, in blocks of `each` words. Methods as of `ChaseLevDeque`.
template <unsigned each>
class BlockDeque {
 public:
  /// With blocks for `capacity` words at first.
  explicit BlockDeque(std::size_t capacity)
      : ring_(new Ring(std::bit_ceil(capacity / each + 1))),
        // relaxed: construction is single-threaded
        block_(&ring_.load(std::memory_order_relaxed)->at(0)) {}
  BlockDeque(const BlockDeque&) = delete;
  BlockDeque& operator=(const BlockDeque&) = delete;

  ~BlockDeque() {
    // relaxed: destruction is single-threaded
    delete ring_.load(std::memory_order_relaxed);
  }

  /// Adds `word` as the newest. For the owner. Wait-free, apart from the allocator.
  void push(std::uint64_t word) {
    if (end_ == each) go_up();
    block_->write(end_++, word);
  }

  /// Takes the newest word; false if there is none. For the owner. Wait-free.
  bool take(std::uint64_t& word) {
    if (end_ == begin_ && !go_down()) return false;
    word = block_->read(--end_);
    return true;
  }

  /// Lends the owner's block to thieves until its next call. For the owner. Wait-free.
  void leave() {
    if (begin_ == end_) return;
    // Thieves take what is at the end of a block.
    const std::uint64_t up = each - end_;
    for (std::uint64_t at = end_; at != begin_; --at)
      block_->write(at - 1 + up, block_->read(at - 1));
    begin_ += up;
    grant(lent);
    begin_ = end_ = each;
    lent_ = true;
  }

  /// Takes the oldest word that is granted. For all but the owner. Lock-free; `empty` if none is,
  /// and `lost` says that another call took the word or the owner its block.
  Theft steal(std::uint64_t& word) {
    for (;;) {
      // (1) acquire: pairs with (4), so that the ring has the block
      std::uint64_t lowest = lowest_.load(std::memory_order_acquire);
      // (2) acquire: pairs with (7), so that the ring is read as filled
      Block& block = ring_.load(std::memory_order_acquire)->at(lowest);
      // (3) acquire: pairs with (8), so that words are read as written, and so that below we see
      // `lowest_` as far as the owner did who has used the block again
      std::uint64_t state = block.state.load(std::memory_order_acquire);
      // relaxed: (3) says what must be seen
      if (lowest_.load(std::memory_order_relaxed) != lowest) continue;
      const std::uint64_t stolen = state & count_mask;
      if (stolen == owned || (stolen == each && (state & lent) != 0)) return Theft::empty;
      if (stolen == each) {
        // (4) release: pairs with (1) and (6). relaxed on failure: another thread has done it
        lowest_.compare_exchange_strong(lowest, lowest + 1, std::memory_order_release,
                                        std::memory_order_relaxed);
        continue;
      }
      word = block.read(stolen);
      // (5) release: pairs with (9), so that the word is read before its place is used again; as
      // for (6) and (9), weaker orders would show in load buffering alone, which the checker does
      // not explore. relaxed on failure: nothing was read but a change
      return block.state.compare_exchange_strong(state, state + 1, std::memory_order_release,
                                                 std::memory_order_relaxed)
                 ? Theft::taken
                 : Theft::lost;
    }
  }

 private:
  // A state is a version, a flag, and a count: of the words that were stolen, or that nobody may
  // steal. The flag says that the owner has no block above.
  static constexpr std::uint64_t next_version = std::uint64_t{1} << 16U;
  static constexpr std::uint64_t lent = next_version / 2;
  static constexpr std::uint64_t count_mask = lent - 1;
  static constexpr std::uint64_t owned = count_mask;
  static_assert(each > 0 && each < owned);

  struct alignas(cache_line_pair) Block {
    std::atomic<std::uint64_t> state{owned};
    std::array<std::atomic<std::uint64_t>, each> words{};

    [[nodiscard]] std::uint64_t read(std::uint64_t at) const {
      // relaxed: of a thief, (3) has acquired the word, or (5) fails
      return words[at].load(std::memory_order_relaxed);
    }
    void write(std::uint64_t at, std::uint64_t word) {
      // relaxed: (8) releases the word
      words[at].store(word, std::memory_order_relaxed);
    }
  };

  class Ring {
   public:
    /// Of blocks that are all new.
    explicit Ring(std::size_t size) : fresh_(size), blocks_(size) {
      for (std::size_t i = 0; i < size; ++i) blocks_[i] = &fresh_[i];
    }
    /// Of those of `older`, which is kept, for the last numbers up to `last`, and as many new ones
    /// for the next.
    Ring(Ring& older, std::uint64_t last) : fresh_(older.size()), blocks_(2 * older.size()) {
      for (std::size_t i = 0; i < older.size(); ++i) {
        blocks_[(last - i) & (size() - 1)] = &older.at(last - i);
        blocks_[(last + 1 + i) & (size() - 1)] = &fresh_[i];
      }
      older_.reset(&older);
    }

    [[nodiscard]] std::size_t size() const { return blocks_.size(); }
    [[nodiscard]] Block& at(std::uint64_t number) const { return *blocks_[number & (size() - 1)]; }

   private:
    std::vector<Block> fresh_;
    std::vector<Block*> blocks_;
    std::unique_ptr<Ring> older_;
  };

  // Grants the owner's block, which is full, and goes on in the next.
  void go_up() {
    if (std::exchange(lent_, false) && !take_over(*block_)) {
      begin_ = end_ = 0;
      return;
    }
    // relaxed: only the owner writes it
    Ring* ring = ring_.load(std::memory_order_relaxed);
    // (6) acquire: pairs with (4), so that thieves have read the block that is used again; see (5)
    if (number_ + 1 - lowest_.load(std::memory_order_acquire) == ring->size()) {
      ring = new Ring(*ring, number_);
      // (7) release: pairs with (2)
      ring_.store(ring, std::memory_order_release);
    }
    Block& next = ring->at(number_ + 1);
    // relaxed, twice: only the owner changes a state that is not granted; (8) releases it to
    // thieves that come to the next block, and who is late may take it for nothing to steal
    next.state.store(next.state.load(std::memory_order_relaxed) | owned, std::memory_order_relaxed);
    grant(0);
    block_ = &next;
    ++number_;
    begin_ = end_ = 0;
  }

  // Goes back to what is left of the owner's block, or of the one beneath; false if nothing is.
  bool go_down() {
    if (std::exchange(lent_, false)) {
      if (take_over(*block_)) return true;
      begin_ = end_ = 0;
    }
    // relaxed: only the owner writes it
    if (!take_over(ring_.load(std::memory_order_relaxed)->at(number_ - 1))) return false;
    --number_;
    return true;
  }

  // Lets thieves have the owner's block from `begin_` on.
  void grant(std::uint64_t flag) {
    // relaxed: as in go_up()
    const std::uint64_t state = block_->state.load(std::memory_order_relaxed);
    const std::uint64_t version = (state & ~(next_version - 1)) + next_version;
    // (8) release: pairs with (3)
    block_->state.store(version | flag | begin_, std::memory_order_release);
  }

  // Makes what thieves have left of `block` the owner's again; false if nothing is.
  bool take_over(Block& block) {
    // (9) acquire: here and below; pairs with (5). relaxed on failure: the next one confirms it
    std::uint64_t state = block.state.load(std::memory_order_acquire);
    while ((state & count_mask) < each) {
      if (!block.state.compare_exchange_strong(state, state | owned, std::memory_order_acquire,
                                               std::memory_order_relaxed))
        continue;
      block_ = &block;
      begin_ = state & count_mask;
      end_ = each;
      return true;
    }
    return false;
  }

  // What thieves look at, and what only the owner does.
  alignas(cache_line_pair) std::atomic<std::uint64_t> lowest_{0};
  std::atomic<Ring*> ring_;
  alignas(cache_line_pair) Block* block_;  // the owner's, and its number
  std::uint64_t number_ = 0;
  std::uint64_t begin_ = 0;  // words of the block
  std::uint64_t end_ = 0;
  bool lent_ = false;
};

/// The queue, in blocks of `each`: so many tasks at most has a worker that nobody can steal.
template <class T, unsigned each>
class Bwos : public Stealing<T, BlockDeque<each>, RandomVictims, false> {
  using Base = Stealing<T, BlockDeque<each>, RandomVictims, false>;

 public:
  static constexpr Claims claims = [] {
    Claims claims = Base::claims;
    claims.empty = Answer::this_worker;
    return claims;
  }();
  using Base::Base;
};

template <class T>
class BwosQueues : public Bwos<T, 15> {
 public:
  static constexpr std::string_view summary =
      "BWoS: a stack of blocks for each worker, owner and thieves in different ones";
  using Bwos<T, 15>::Bwos;
};

}  // namespace irt
