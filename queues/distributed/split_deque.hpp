/// A deque of one owner and any number of thieves, split into what is the owner's alone and what
/// others may steal (after van Dijk and van de Pol 2014, "Lace: Non-blocking Split Deque for
/// Work-Stealing", Euro-Par Workshops).
///
/// When to use: as a part of a queue that has one for each worker (split_queues.hpp). When not: all
/// that is inside must be seen by others at any time.
///
/// Ordering: the owner takes the newest of its own words, all others and the owner after that the
/// oldest. Progress: `push` is wait-free, apart from the allocator, `take` lock-free; `steal` is
/// wait-free and may answer that it lost a race, to a call that has done something. Memory: an
/// array of 8 bytes per place that doubles when it is full and never shrinks. A thief may read an
/// old array at any time, so all are kept until destruction; the old ones together are smaller than
/// the last. Unbounded.
///
/// How it works: the words are in places `tail` to `bottom - 1`, place `i` of `n` at `i mod n` of
/// the array. The first of them are shared: `tail` and how many they are stand in one word, so that
/// some are taken, or given, by one operation on that word. The rest is the owner's, who pushes and
/// pops there without any that others could see: no barrier, no compare-and-swap. All that the
/// owner does about others is to look at the word, which only a theft takes out of its cache. When
/// nothing is shared and the owner has two words, or takes one of two, it shares the older half.
/// When it has none of its own, it steals from itself: some of the oldest words that are shared,
/// which it copies behind the last. So a place is never given twice at the same tail, and a thief
/// that slept cannot take one state for another (ABA).
///
/// So words may be unseen by others: those of the owner's alone once all that was shared is stolen,
/// until the owner's next call. One that leaves shares all it has.
///
/// What differs from the paper, and why:
/// - There a thief that finds nothing raises a flag, and the owner shares when it sees it. Here the
///   owner sees that nothing is shared, and shares before anybody has to wait for it.
/// - There the owner takes back the newest of what is shared, whose end stands beside the word, and
///   needs a fence for that.
/// - A theft takes half of what is shared.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/distributed/theft.hpp"

namespace irt {

class SplitDeque {
 public:
  /// With places for `capacity` words at first, rounded up to a power of two, and at least 2.
  explicit SplitDeque(std::size_t capacity)
      : places_(new Places(std::bit_ceil(std::max<std::size_t>(capacity, 2)))) {}
  SplitDeque(const SplitDeque&) = delete;
  SplitDeque& operator=(const SplitDeque&) = delete;

  ~SplitDeque() {
    // relaxed: destruction is single-threaded
    delete places_.load(std::memory_order_relaxed);
  }

  /// Adds `word` as the newest. For the owner. Wait-free, apart from the allocator.
  void push(std::uint64_t word) {
    // relaxed: only the owner writes it
    Places* places = places_.load(std::memory_order_relaxed);
    if (bottom_ - tail_seen_ == places->size() && room() == 0) places = grow(*places);
    places->write(bottom_, word);
    ++bottom_;
    if (bottom_ - split_ >= 2) share_if_nothing_is();
  }

  /// Takes the newest word, or where all are shared the oldest; false if there is none. For the
  /// owner. Lock-free.
  bool take(std::uint64_t& word) {
    if (bottom_ == split_) {
      Theft theft = Theft::lost;
      while (theft == Theft::lost) theft = steal(word, *this);
      return theft == Theft::taken;
    }
    --bottom_;
    // relaxed: only the owner writes it
    word = places_.load(std::memory_order_relaxed)->read(bottom_);
    if (bottom_ != split_) share_if_nothing_is();
    return true;
  }

  /// Shares all words, as far as the count has bits for them. For the owner. Wait-free.
  void leave() {
    // relaxed: at worst it was more, and fewer are shared
    const Shared shared{shared_.load(std::memory_order_relaxed)};
    share(std::min(bottom_ - split_, Shared::most - shared.count()));
  }

  /// Takes the oldest word that is shared, and moves more, half of them all and at most 15, to
  /// `thief`, whose owner calls. Wait-free.
  Theft steal(std::uint64_t& word, SplitDeque& thief) {
    // (2) acquire: pairs with (4), so that the words are read as written
    Shared shared{shared_.load(std::memory_order_acquire)};
    if (shared.count() == 0) return Theft::empty;
    const std::size_t half = (shared.count() + 1) / 2;
    const std::size_t count = half == 1 ? 1 : std::min({half, most_stolen, 1 + thief.room()});
    std::array<std::uint64_t, most_stolen> words{};
    // (3) acquire: pairs with (6), so that the array is read as filled
    const Places& places = *places_.load(std::memory_order_acquire);
    for (std::size_t i = 0; i < count; ++i) words[i] = places.read(shared.tail() + i);
    // (5) release: pairs with (1). Only a machine whose loads may wait for later stores shows it,
    // which the checker's memory model leaves out. relaxed on failure: nothing was read but a
    // change
    if (!shared_.compare_exchange_strong(shared.word, shared.without(count).word,
                                         std::memory_order_release, std::memory_order_relaxed))
      return Theft::lost;
    word = words[0];
    for (std::size_t i = 1; i < count; ++i) thief.push(words[i]);
    return Theft::taken;
  }

 private:
  /// `tail` above how many words from there on are shared. The tail wraps round after 2^40 words,
  /// so that a thief which sleeps through all of them takes one state for another.
  struct Shared {
    static constexpr unsigned count_bits = 24;
    static constexpr std::uint64_t most = (std::uint64_t{1} << count_bits) - 1;

    std::uint64_t word = 0;

    [[nodiscard]] std::uint64_t tail() const { return word >> count_bits; }
    [[nodiscard]] std::uint64_t count() const { return word & most; }
    [[nodiscard]] Shared without(std::uint64_t oldest) const {
      return {word + (oldest << count_bits) - oldest};
    }
  };

  static constexpr std::size_t most_stolen = 16;  // by one call

  /// How many words find a place without allocation. For the owner. Wait-free.
  std::size_t room() {
    // (1) acquire: pairs with (5), so that a thief has read a place before it is written again
    const Shared shared{shared_.load(std::memory_order_acquire)};
    tail_seen_ = split_ - shared.count();
    // relaxed: only the owner writes it
    return places_.load(std::memory_order_relaxed)->size() - (bottom_ - tail_seen_);
  }

  // The older half of the owner's words, where nothing is shared.
  void share_if_nothing_is() {
    // relaxed: a theft that is seen late is one that leaves something
    const Shared shared{shared_.load(std::memory_order_relaxed)};
    if (shared.count() == 0) share(std::min((bottom_ - split_ + 1) / 2, Shared::most));
  }

  void share(std::uint64_t given) {
    split_ += given;
    // (4) release: pairs with (2)
    shared_.fetch_add(given, std::memory_order_release);
  }

  class Places {
   public:
    explicit Places(std::size_t size) : words_(size) {}

    [[nodiscard]] std::size_t size() const { return words_.size(); }
    [[nodiscard]] std::uint64_t read(std::uint64_t at) const {
      // relaxed: (2) has acquired the word, or (5) fails
      return words_[at & (size() - 1)].load(std::memory_order_relaxed);
    }
    void write(std::uint64_t at, std::uint64_t word) {
      // relaxed: (4) or (6) releases the word
      words_[at & (size() - 1)].store(word, std::memory_order_relaxed);
    }
    void keep(Places& older) { older_.reset(&older); }

   private:
    std::vector<std::atomic<std::uint64_t>> words_;
    std::unique_ptr<Places> older_;
  };

  // Puts the words into an array of twice the size.
  Places* grow(Places& full) {
    auto larger = std::make_unique<Places>(2 * full.size());
    for (std::uint64_t at = tail_seen_; at != bottom_; ++at) larger->write(at, full.read(at));
    larger->keep(full);
    // (6) release: pairs with (3)
    places_.store(larger.get(), std::memory_order_release);
    return larger.release();
  }

  // What thieves write, and what only the owner does.
  alignas(cache_line_pair) std::atomic<std::uint64_t> shared_{0};
  alignas(cache_line_pair) std::atomic<Places*> places_;
  std::uint64_t bottom_ = 0;
  std::uint64_t split_ = 0;      // the end of what is shared
  std::uint64_t tail_seen_ = 0;  // by room(): at most the tail
};

}  // namespace irt
