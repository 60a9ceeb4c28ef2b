/// A deque of one owner and any number of thieves (Chase and Lev 2005, "Dynamic Circular
/// Work-Stealing Deque", SPAA), with the memory orders of Lê, Pop, Cohen and Zappa Nardelli 2013,
/// "Correct and Efficient Work-Stealing for Weak Memory Models", PPoPP.
///
/// When to use: as a part of a queue that has one for each worker (stealing_queues.hpp). When not:
/// others than the owner push, or the oldest word must always leave first.
///
/// Ordering: the owner takes the newest word, a thief the oldest. Progress: wait-free, apart from
/// the allocator; `steal` may answer that it lost a race, to a call that has taken a word. Memory:
/// an array of 8 bytes per place that doubles when it is full and never shrinks. A thief may read
/// an old array at any time, so all are kept until destruction; the old ones together are smaller
/// than the last. Unbounded.
///
/// How it works: the words are in places `top` to `bottom - 1`, place `i` of `n` at `i mod n` of
/// the array. The owner pushes at `bottom` and takes from there, thieves move `top` on by
/// compare-and-swap. `top` only grows, so no thief takes one state for another (ABA). The owner
/// competes by compare-and-swap for the last word only. That no thief gets the word which the owner
/// takes without is Dekker's pattern: the owner moves `bottom` back and then reads `top`; a thief
/// reads `top`, which the thief before it has moved, and then `bottom`.
///
/// What differs from the papers, and why:
/// - The accesses have the orders that the second paper gives to fences beside them. That costs the
///   same on x86-64, less on Armv8, and ThreadSanitizer understands it.
/// - Its compare-and-swaps are seq_cst. C++20 orders the accesses around them without that.
/// - The array is published by release and acquire. As printed, a thief may read it before it is
///   filled (Norris and Demsky 2013, "CDSchecker", OOPSLA).
/// - The owner of an empty deque, or of a single word, sees that before it moves `bottom`, and
///   saves a full barrier. Where it was wrong, it moves `bottom` forth before the compare-and-swap.
/// - A push reads `top`, which thieves write, only when its place may not be free by what the last
///   such look showed.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/distributed/theft.hpp"

namespace irt {

class ChaseLevDeque {
 public:
  /// With places for `capacity` words at first, rounded up to a power of two, and at least 2.
  explicit ChaseLevDeque(std::size_t capacity)
      : places_(new Places(std::bit_ceil(std::max<std::size_t>(capacity, 2)))) {}
  ChaseLevDeque(const ChaseLevDeque&) = delete;
  ChaseLevDeque& operator=(const ChaseLevDeque&) = delete;

  ~ChaseLevDeque() {
    // relaxed: destruction is single-threaded
    delete places_.load(std::memory_order_relaxed);
  }

  /// Adds `word` as the newest. For the owner. Wait-free, apart from the allocator.
  void push(std::uint64_t word) {
    // relaxed, twice: only the owner writes them
    const std::uint64_t bottom = bottom_.load(std::memory_order_relaxed);
    Places* places = places_.load(std::memory_order_relaxed);
    if (bottom - top_seen_ == places->size() && room() == 0) places = grow(*places, bottom);
    places->write(bottom, word);
    // (2) release: pairs with (7), so that the word is read as written
    bottom_.store(bottom + 1, std::memory_order_release);
  }

  /// Takes the newest word; false if there is none. For the owner. Wait-free.
  bool take(std::uint64_t& word) {
    // relaxed, three times: only the owner writes the two; (4) or the compare-and-swap finds out
    // where `top` has moved
    const std::uint64_t bottom = bottom_.load(std::memory_order_relaxed);
    const Places& places = *places_.load(std::memory_order_relaxed);
    std::uint64_t top = top_.load(std::memory_order_relaxed);
    if (top == bottom) return false;
    const std::uint64_t newest = bottom - 1;
    if (top != newest) {
      // (3) seq_cst: with (4) pairs with (6) and (7), so that a thief who does not see it here has
      // a `top` from before (4). As a release for (7) it passes on what push() released
      bottom_.store(newest, std::memory_order_seq_cst);
      // (4) seq_cst: pairs with (6), as (3) says
      top = top_.load(std::memory_order_seq_cst);
      if (top < newest) {
        word = places.read(newest);
        return true;
      }
      // (5) release: pairs with (7), for thieves may still find the word
      bottom_.store(bottom, std::memory_order_release);
      if (top == bottom) return false;
    }
    word = places.read(newest);
    // relaxed: of those who want the word one gets it by atomicity, whatever the order
    return top_.compare_exchange_strong(top, bottom, std::memory_order_relaxed);
  }

  /// Takes the oldest word. For all but the owner. Wait-free.
  Theft steal(std::uint64_t& word) {
    // (6) seq_cst: with (7) pairs with (3) and (4)
    std::uint64_t top = top_.load(std::memory_order_seq_cst);
    // (7) seq_cst: pairs with (3), as (6) says; as an acquire with (2), (3) and (5)
    const std::uint64_t bottom = bottom_.load(std::memory_order_seq_cst);
    // In the midst of take() `bottom` may be one less than `top`.
    if (static_cast<std::int64_t>(bottom - top) <= 0) return Theft::empty;
    // (8) acquire: pairs with (10), so that the array is read as filled
    word = places_.load(std::memory_order_acquire)->read(top);
    // (9) release: pairs with (1). relaxed on failure: nothing was read but a change
    return top_.compare_exchange_strong(top, top + 1, std::memory_order_release,
                                        std::memory_order_relaxed)
               ? Theft::taken
               : Theft::lost;
  }

  /// About how many words are inside. Wait-free.
  [[nodiscard]] std::size_t about() const {
    // relaxed, twice: nothing rests on it
    const std::uint64_t top = top_.load(std::memory_order_relaxed);
    const std::uint64_t bottom = bottom_.load(std::memory_order_relaxed);
    return bottom > top ? bottom - top : 0;
  }

  /// How many words find a place without allocation. For the owner. Wait-free.
  std::size_t room() {
    // (1) acquire: pairs with (9), so that a thief has read a place before it is written again.
    // Weaker orders would show in load buffering alone, which the checker does not explore
    top_seen_ = top_.load(std::memory_order_acquire);
    // relaxed, twice: only the owner writes them
    const std::uint64_t bottom = bottom_.load(std::memory_order_relaxed);
    return places_.load(std::memory_order_relaxed)->size() - (bottom - top_seen_);
  }

 private:
  class Places {
   public:
    explicit Places(std::size_t size) : words_(size) {}

    [[nodiscard]] std::size_t size() const { return words_.size(); }
    [[nodiscard]] std::uint64_t read(std::uint64_t at) const {
      // relaxed: (7) has acquired the word, or (9) fails
      return words_[at & (size() - 1)].load(std::memory_order_relaxed);
    }
    void write(std::uint64_t at, std::uint64_t word) {
      // relaxed: (2) or (10) releases the word
      words_[at & (size() - 1)].store(word, std::memory_order_relaxed);
    }
    void keep(Places& older) { older_.reset(&older); }

   private:
    std::vector<std::atomic<std::uint64_t>> words_;
    std::unique_ptr<Places> older_;
  };

  // Puts the words into an array of twice the size.
  Places* grow(Places& full, std::uint64_t bottom) {
    auto larger = std::make_unique<Places>(2 * full.size());
    for (std::uint64_t at = top_seen_; at != bottom; ++at) larger->write(at, full.read(at));
    larger->keep(full);
    // (10) release: pairs with (8)
    places_.store(larger.get(), std::memory_order_release);
    return larger.release();
  }

  // What thieves write, and what only the owner does.
  alignas(cache_line_pair) std::atomic<std::uint64_t> top_{0};
  alignas(cache_line_pair) std::atomic<std::uint64_t> bottom_{0};
  std::atomic<Places*> places_;
  std::uint64_t top_seen_ = 0;  // by room(): at most `top_`
};

}  // namespace irt
