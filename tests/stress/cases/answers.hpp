/// Queues whose *full* or *empty* is not what it seems: some wrong, some right once they claim no
/// more than they keep. All of them work under locks, so that nothing else is wrong.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string_view>
#include <vector>

#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// A bag that looks into one half of its places at a time: nothing is ever lost, and *empty* is
/// wrong.
template <class T, bool Fixed>
class HalfBlindCase {
 public:
  static constexpr std::string_view summary = "a bag that looks into half of its places";
  static constexpr Claims claims{.bounded = true, .reclamation = Reclamation::preallocated};

  HalfBlindCase(unsigned /*workers*/, std::size_t capacity) : places_(capacity), taken_(capacity) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (taken_[i] != 0) continue;
      places_[i] = task;
      taken_[i] = 1;
      return true;
    }
    return false;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = Fixed ? 0 : turn_++ % 2; i < places_.size(); i += Fixed ? 1 : 2) {
      if (taken_[i] == 0) continue;
      task = places_[i];
      taken_[i] = 0;
      return true;
    }
    return false;
  }

 private:
  std::mutex mutex_;
  std::vector<T> places_;
  std::vector<char> taken_;
  std::size_t turn_ = 0;
};

template <class T>
class HalfBlindBug : public HalfBlindCase<T, false> {
  using HalfBlindCase<T, false>::HalfBlindCase;
};
template <class T>
class HalfBlindFixed : public HalfBlindCase<T, true> {
  using HalfBlindCase<T, true>::HalfBlindCase;
};

/// A ring that has all its places only once something was popped. What is pushed before the threads
/// start shows it.
template <class T>
class ShortAtFirstBug {
 public:
  static constexpr std::string_view summary = "a ring that is one place short until the first pop";
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo, .bounded = true};

  ShortAtFirstBug(unsigned /*workers*/, std::size_t capacity) : capacity_(capacity) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    if (held_.size() + (popped_ ? 0 : 1) >= std::max<std::size_t>(capacity_, 2)) return false;
    held_.push_back(task);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::lock_guard lock(mutex_);
    popped_ = true;
    if (held_.empty()) return false;
    task = held_.front();
    held_.pop_front();
    return true;
  }

 private:
  std::mutex mutex_;
  std::deque<T> held_;
  std::size_t capacity_;
  bool popped_ = false;
};

/// A push takes a credit first, a pop gives it back last: *full* counts pops in flight, and pushes.
template <class T, Answer full>
class CreditedCase {
 public:
  static constexpr std::string_view summary = "a deque under a lock, with credits";
  static constexpr Claims claims{
      .ordering = Ordering::fifo_happens_before, .bounded = true, .full = full};

  CreditedCase(unsigned /*workers*/, std::size_t capacity) : credits_(capacity) {}

  bool push(unsigned /*worker*/, T task) {
    std::size_t credits = credits_.load();
    do {
      if (credits == 0) return false;
    } while (!credits_.compare_exchange_weak(credits, credits - 1));
    const std::lock_guard lock(mutex_);
    held_.push_back(task);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    {
      const std::lock_guard lock(mutex_);
      if (held_.empty()) return false;
      task = held_.front();
      held_.pop_front();
    }
    credits_.fetch_add(1);
    return true;
  }

 private:
  std::mutex mutex_;
  std::deque<T> held_;
  std::atomic<std::size_t> credits_;
};

template <class T>
class CreditedExact : public CreditedCase<T, Answer::by_ordering> {
  using CreditedCase<T, Answer::by_ordering>::CreditedCase;
};
template <class T>
class CreditedInFlight : public CreditedCase<T, Answer::calls_in_flight> {
  using CreditedCase<T, Answer::calls_in_flight>::CreditedCase;
};

/// A pop takes two and keeps one for the worker's next: *empty* speaks for that worker alone.
template <class T, Answer empty>
class HoardingCase {
 public:
  static constexpr std::string_view summary = "a deque under a lock, from which workers take two";
  static constexpr Claims claims{.empty = empty};

  HoardingCase(unsigned workers, std::size_t /*capacity*/) : kept_(workers) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    held_.push_back(task);
    return true;
  }

  bool pop(unsigned worker, T& task) {
    const std::lock_guard lock(mutex_);
    std::deque<T>& kept = kept_[worker];
    if (kept.empty()) {
      const auto end = held_.begin() + std::min<std::ptrdiff_t>(2, std::ssize(held_));
      kept.assign(held_.begin(), end);
      held_.erase(held_.begin(), end);
    }
    if (kept.empty()) return false;
    task = kept.front();
    kept.pop_front();
    return true;
  }

 private:
  std::mutex mutex_;
  std::deque<T> held_;
  std::vector<std::deque<T>> kept_;
};

template <class T>
class HoardingBoast : public HoardingCase<T, Answer::by_ordering> {
  using HoardingCase<T, Answer::by_ordering>::HoardingCase;
};
template <class T>
class HoardingHonest : public HoardingCase<T, Answer::this_worker> {
  using HoardingCase<T, Answer::this_worker>::HoardingCase;
};

/// The last of what a worker pushed is for that worker: *empty* speaks for a worker alone.
template <class T>
class LeavesOne {
 public:
  static constexpr std::string_view summary = "deques under a lock, of which others leave one";
  static constexpr Claims claims{.empty = Answer::this_worker};

  LeavesOne(unsigned workers, std::size_t /*capacity*/) : held_(workers) {}

  bool push(unsigned worker, T task) {
    const std::lock_guard lock(mutex_);
    held_[worker].push_back(task);
    return true;
  }

  bool pop(unsigned worker, T& task) {
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < held_.size(); ++i) {
      std::deque<T>& held = held_[(worker + i) % held_.size()];
      if (held.size() < (i == 0 ? 1U : 2U)) continue;
      task = held.front();
      held.pop_front();
      return true;
    }
    return false;
  }

 private:
  std::mutex mutex_;
  std::vector<std::deque<T>> held_;
};

/// Tells elements from free places by words that it keeps for itself, and is for two workers.
template <class T>
class Picky {
 public:
  static constexpr std::string_view summary = "a bag of words, four of them reserved";
  static constexpr Claims claims{.bounded = true,
                                 .max_workers = 2,
                                 .reclamation = Reclamation::preallocated,
                                 .reserved = {0, 102, ~std::uint64_t{0}},
                                 .unused_bits = 1,
                                 .survives_no_memory = false};

  Picky(unsigned workers, std::size_t capacity) : places_(capacity) {
    if (workers > 2) __builtin_trap();
  }

  bool push(unsigned /*worker*/, T task) {
    const std::uint64_t word = word_of(task);
    if (!claims.allows(word)) __builtin_trap();
    for (auto& place : places_) {
      std::uint64_t none = 0;
      if (place.compare_exchange_strong(none, word)) return true;
    }
    return false;
  }

  bool pop(unsigned /*worker*/, T& task) {
    for (auto& place : places_) {
      const std::uint64_t word = place.exchange(0);
      if (word == 0) continue;
      task = element_of<T>(word);
      return true;
    }
    return false;
  }

 private:
  std::vector<std::atomic<std::uint64_t>> places_;
};

}  // namespace irt
