/// A bag of words under a lock that keeps something for itself, and claims so or does not.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt::stress {

/// What it keeps: the word of ones, a small word, a bit of each word, all but eight workers.
enum class Keeps { nothing, ones, word, high_bit, low_bit, seats };

constexpr Claims claims_of(Keeps keeps, bool told) {
  Claims claims;
  if (!told) return claims;
  claims.all_ones_reserved = keeps == Keeps::ones;
  if (keeps == Keeps::word) claims.reserved = {7};
  if (keeps == Keeps::high_bit) claims.unused_bits = std::uint64_t{1} << 63;
  if (keeps == Keeps::low_bit) claims.unused_bits = 1;
  if (keeps == Keeps::seats) claims.max_workers = 8;
  return claims;
}

template <Keeps keeps, bool told>
struct Claiming {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary =
        "a bag under a lock that keeps something for itself";
    static constexpr Claims claims = claims_of(keeps, told);

    Queue(unsigned /*workers*/, std::size_t /*capacity*/) {}

    bool push(unsigned worker, T task) {
      const std::lock_guard lock(mutex_);
      std::uint64_t word = word_of(task);
      if (keeps == Keeps::ones && word == ~std::uint64_t{0}) return true;
      if (keeps == Keeps::word && word == 7) return true;
      if (keeps == Keeps::high_bit) word &= ~(std::uint64_t{1} << 63);
      if (keeps == Keeps::low_bit) word &= ~std::uint64_t{1};
      sit_down(worker);
      held_.push_back(element_of<T>(word));
      return true;
    }

    bool pop(unsigned worker, T& task) {
      const std::lock_guard lock(mutex_);
      sit_down(worker);
      if (held_.empty()) return false;
      task = held_.back();
      held_.pop_back();
      return true;
    }

   private:
    static void sit_down(unsigned worker) {
      if (keeps == Keeps::seats && worker >= 8) throw std::out_of_range("eight seats, all taken");
    }
    std::mutex mutex_;
    std::vector<T> held_;
  };
};

}  // namespace irt::stress
