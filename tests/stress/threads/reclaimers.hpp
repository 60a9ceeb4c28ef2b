/// A queue under a lock whose blocks are given back late, in batches, never, or nearly all.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt::stress {

/// A block of so many elements.
template <std::size_t places>
struct Block {
  std::array<std::uint64_t, places> words{};
};

/// Frees so many at once.
template <std::size_t batch>
class InBatches {
 public:
  template <class B>
  struct Scheme {
    std::unique_ptr<B> reused() { return nullptr; }
    void retire(std::unique_ptr<B> block) {
      retired.push_back(std::move(block));
      if (retired.size() == batch) retired.clear();
    }
    std::vector<std::unique_ptr<B>> retired;
  };
};

/// Three lists, of which one is freed whenever an epoch of so many retirements ends.
template <std::size_t epoch>
class InEpochs {
 public:
  template <class B>
  struct Scheme {
    std::unique_ptr<B> reused() { return nullptr; }
    void retire(std::unique_ptr<B> block) {
      limbo[now % 3].push_back(std::move(block));
      if (++retired % epoch == 0) limbo[++now % 3].clear();
    }
    std::array<std::vector<std::unique_ptr<B>>, 3> limbo;
    std::size_t retired = 0;
    std::size_t now = 0;
  };
};

/// Keeps one in `every` until it has `most`, for bad days.
template <std::size_t every, std::size_t most>
class WithReserve {
 public:
  template <class B>
  struct Scheme {
    std::unique_ptr<B> reused() { return nullptr; }
    void retire(std::unique_ptr<B> block) {
      if (++retired % every == 0 && reserve.size() < most) reserve.push_back(std::move(block));
    }
    std::vector<std::unique_ptr<B>> reserve;
    std::size_t retired = 0;
  };
};

/// Gives nothing back; uses everything again.
struct FromFreeList {
  template <class B>
  struct Scheme {
    std::unique_ptr<B> reused() {
      if (free.empty()) return nullptr;
      std::unique_ptr<B> block = std::move(free.back());
      free.pop_back();
      return block;
    }
    void retire(std::unique_ptr<B> block) { free.push_back(std::move(block)); }
    std::vector<std::unique_ptr<B>> free;
  };
};

/// Loses one in `every`; `then` takes the others.
template <std::size_t every, class Then = InBatches<1>>
class Leaking {
 public:
  template <class B>
  struct Scheme {
    std::unique_ptr<B> reused() { return others.reused(); }
    void retire(std::unique_ptr<B> block) {
      if (++retired % every == 0) {
        lost.push_back(std::move(block));
      } else {
        others.retire(std::move(block));
      }
    }
    typename Then::template Scheme<B> others;
    std::deque<std::unique_ptr<B>> lost;
    std::size_t retired = 0;
  };
};

template <class Reclaimer, std::size_t places = 1>
struct Reclaiming {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "blocks under a lock, and a reclaimer";
    static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                   .reclamation = Reclamation::epochs};

    Queue(unsigned /*workers*/, std::size_t /*capacity*/) {}

    bool push(unsigned /*worker*/, T task) {
      const std::lock_guard lock(mutex_);
      if (tail_ % places == 0) {
        std::unique_ptr<Block<places>> block = scheme_.reused();
        blocks_.push_back(block ? std::move(block) : std::make_unique<Block<places>>());
      }
      blocks_.back()->words[tail_++ % places] = word_of(task);
      return true;
    }

    bool pop(unsigned /*worker*/, T& task) {
      const std::lock_guard lock(mutex_);
      if (head_ == tail_) return false;
      task = element_of<T>(blocks_.front()->words[head_ % places]);
      if (++head_ % places == 0) {
        scheme_.retire(std::move(blocks_.front()));
        blocks_.pop_front();
      }
      return true;
    }

   private:
    std::mutex mutex_;
    std::deque<std::unique_ptr<Block<places>>> blocks_;
    std::uint64_t head_ = 0;
    std::uint64_t tail_ = 0;
    typename Reclaimer::template Scheme<Block<places>> scheme_;
  };
};

template <class Reclaimer, std::size_t places = 1>
QueueEntry reclaiming(std::string_view name) {
  return queue_entry<Reclaiming<Reclaimer, places>::template Queue>(name);
}

}  // namespace irt::stress
