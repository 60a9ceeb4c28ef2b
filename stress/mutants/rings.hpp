/// Bounded rings, the intrusive-style list for one consumer, and their classic mistakes.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt::stress {

enum class SpscBug {
  none,
  front_after_pop,  ///< M30: the element is read through front()'s pointer after its place was
                    ///< freed
  stale_tail,       ///< M31: an empty-looking ring is not looked at again
  one_too_many,     ///< M32: the producer may take the place that the consumer still copies
  plain_tail,       ///< M34: the tail is a plain variable
};

/// One producer, one consumer, each with a cached copy of the other's index.
template <SpscBug bug>
struct Spsc {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a ring for one producer and one consumer";
    static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                   .push = Progress::wait_free,
                                   .pop = Progress::wait_free,
                                   .bounded = true,
                                   .producers = Callers::one,
                                   .consumers = Callers::one,
                                   .reclamation = Reclamation::preallocated};

    Queue(unsigned /*workers*/, std::size_t capacity) : slots_(capacity) {}

    bool push(unsigned /*worker*/, T task) {
      const std::size_t tail = tail_;
      constexpr std::size_t extra = bug == SpscBug::one_too_many ? 1 : 0;
      if (tail - known_head_ >= slots_.size() + extra) {
        known_head_ = head_;
        if (tail - known_head_ >= slots_.size() + extra) return false;
      }
      slots_[tail % slots_.size()] = task;
      tail_ = tail + 1;
      return true;
    }

    bool pop(unsigned /*worker*/, T& task) {
      const std::size_t head = head_;
      if (head == known_tail_) {
        if (bug == SpscBug::stale_tail && head % 4 != 0) {
          known_tail_ = tail_;  // for next time
          return false;
        }
        known_tail_ = tail_;
        if (head == known_tail_) return false;
      }
      const T* front = &slots_[head % slots_.size()];
      if (bug == SpscBug::front_after_pop) head_ = head + 1;
      task = *front;
      if (bug != SpscBug::front_after_pop) head_ = head + 1;
      return true;
    }

   private:
    using Tail =
        std::conditional_t<bug == SpscBug::plain_tail, std::size_t, std::atomic<std::size_t>>;
    std::vector<T> slots_;
    alignas(128) std::atomic<std::size_t> head_{0};
    std::size_t known_tail_ = 0;
    alignas(128) Tail tail_{0};
    std::size_t known_head_ = 0;
  };
};

enum class VyukovBug {
  none,
  relaxed_ready,  ///< M15: the place's sequence number is read without acquire
  narrow,         ///< M27: sequence numbers are compared in eight bits
  boasts,         ///< M28: claims exact empty, though a stopped peer hides what is behind its place
};

/// Vyukov's bounded queue: a sequence number in each place says whose turn it is.
template <VyukovBug bug>
struct Vyukov {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "Vyukov's bounded queue";
    static constexpr Claims claims{
        .ordering =
            bug == VyukovBug::boasts ? Ordering::fifo_real_time : Ordering::per_producer_fifo,
        .push = bug == VyukovBug::boasts ? Progress::lock_free : Progress::blocking,
        .pop = bug == VyukovBug::boasts ? Progress::lock_free : Progress::blocking,
        .bounded = true,
        .reclamation = Reclamation::preallocated};

    Queue(unsigned /*workers*/, std::size_t capacity)
        : places_(std::bit_ceil(capacity < 2 ? 2 : capacity)) {
      for (std::size_t i = 0; i < places_.size(); ++i) places_[i].turn = i;
    }

    bool push(unsigned /*worker*/, T task) {
      std::size_t at = tail_.load(std::memory_order_relaxed);
      for (;;) {
        Place& place = places_[at % places_.size()];
        const Difference ahead = difference(place.turn.load(std::memory_order_acquire), at);
        if (ahead == 0) {
          if (tail_.compare_exchange_weak(at, at + 1, std::memory_order_relaxed)) {
            place.value = task;
            place.turn.store(at + 1, std::memory_order_release);
            return true;
          }
        } else if (ahead < 0) {
          return false;
        } else {
          at = tail_.load(std::memory_order_relaxed);
        }
      }
    }

    bool pop(unsigned /*worker*/, T& task) {
      constexpr auto ready =
          bug == VyukovBug::relaxed_ready ? std::memory_order_relaxed : std::memory_order_acquire;
      std::size_t at = head_.load(std::memory_order_relaxed);
      for (;;) {
        Place& place = places_[at % places_.size()];
        const Difference ahead = difference(place.turn.load(ready), at + 1);
        if (ahead == 0) {
          if (head_.compare_exchange_weak(at, at + 1, std::memory_order_relaxed)) {
            task = place.value;
            place.turn.store(at + places_.size(), std::memory_order_release);
            return true;
          }
        } else if (ahead < 0) {
          return false;
        } else {
          at = head_.load(std::memory_order_relaxed);
        }
      }
    }

   private:
    using Difference = std::conditional_t<bug == VyukovBug::narrow, std::int8_t, std::int64_t>;
    static Difference difference(std::size_t turn, std::size_t at) {
      return static_cast<Difference>(turn - at);
    }
    struct Place {
      std::atomic<std::size_t> turn{0};
      T value{};
    };
    std::vector<Place> places_;
    alignas(128) std::atomic<std::size_t> head_{0};
    alignas(128) std::atomic<std::size_t> tail_{0};
  };
};

/// Vyukov's list for many producers and one consumer. The healthy twin has a sentinel, so that its
/// list never runs out of nodes. M26: nil instead; a consumer that takes the last node while a
/// producer links the next one loses it.
template <bool has_sentinel>
struct Mpsc {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "Vyukov's list for one consumer";
    static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                   .push = Progress::wait_free,
                                   .consumers = Callers::one};

    Queue(unsigned /*workers*/, std::size_t /*capacity*/) {
      if (has_sentinel) front_ = back_ = new Node;
    }
    Queue(const Queue&) = delete;
    Queue& operator=(const Queue&) = delete;
    ~Queue() {
      for (Node* node = front_; node != nullptr;) {
        Node* next = node->next;
        delete node;
        node = next;
      }
    }

    bool push(unsigned /*worker*/, T task) {
      Node* node = new Node;
      node->value = task;
      Node* before = back_.exchange(node);
      if (has_sentinel || before != nullptr) {
        before->next = node;
      } else {
        front_ = node;
      }
      return true;
    }

    bool pop(unsigned /*worker*/, T& task) {
      Node* first = front_;
      if (has_sentinel) {
        Node* next = first->next;
        if (next == nullptr) return false;
        task = next->value;
        front_ = next;
        delete first;
        return true;
      }
      if (first == nullptr) return false;
      Node* next = first->next;
      front_ = next;
      if (next == nullptr) {
        Node* last = first;
        back_.compare_exchange_strong(last, nullptr);  // fails: somebody is linking behind `first`
      }
      task = first->value;
      garbage_.push_back(first);  // a late producer may still write to it
      return true;
    }

   private:
    struct Node {
      T value{};
      std::atomic<Node*> next{nullptr};
    };
    struct Garbage : std::vector<Node*> {
      Garbage() = default;
      Garbage(const Garbage&) = delete;
      Garbage& operator=(const Garbage&) = delete;
      ~Garbage() {
        for (Node* node : *this) delete node;
      }
    };
    alignas(128) std::atomic<Node*> back_{nullptr};
    alignas(128) std::atomic<Node*> front_{nullptr};
    Garbage garbage_;
  };
};

}  // namespace irt::stress
