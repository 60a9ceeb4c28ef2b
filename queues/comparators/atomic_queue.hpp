/// The rings of max0x7ba's atomic_queue, four variants.
///
/// When to use: few threads, each on a core of its own, and the least delay between them. When not:
/// threads may be stopped (more threads than cores): who has a slot's ticket makes others spin.
///
/// Ordering: none that may be relied on. Tickets are in order, but a slot belongs to whoever comes:
/// a consumer that stalls between its ticket and its slot until the others have gone once round the
/// ring exchanges its element with the one of the next round. Progress: blocking. Memory:
/// `capacity` slots, allocated once; at least 64, or 4,096 in the variants with states. Bounded.
///
/// How it works: push and pop take tickets and then spin on the ticket's slot. `AtomicQueue` keeps
/// an element in one atomic word, of which one value means *nobody here*: this is the word with all
/// bits set, which therefore cannot be an element. `AtomicQueue2` keeps any element beside a state.
/// The optimistic variants take a push's ticket by one fetch-and-add where the others repeat a
/// compare-and-swap. Where the ring is full their push waits for a pop, and their pop for a push,
/// which may never come; the contract wants an answer. So pop is the other variants', and push
/// looks at the length first and has a ring with room for all workers that look at the same time.
///
/// Where memory for the second array cannot be had, the variants with states lose the first.
///
/// The 2022 version in Debian takes an element out by an exchange with release order only. On
/// x86-64 that is enough. By the letter of C++ nothing makes what a producer wrote before the push
/// visible after the pop.
#pragma once

#include <algorithm>
#include <atomic_queue/atomic_queue.h>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt {
namespace atomic_queues {

/// Capacities are `unsigned`, and the ring rounds them up to a power of two.
inline unsigned ring_size(std::size_t capacity) {
  return static_cast<unsigned>(std::clamp<std::size_t>(capacity, 1, std::size_t{1} << 30U));
}

/// What a ring of `capacity` needs to have: after a look at an outdated length each worker may add
/// one element too many, and is granted a few.
inline std::size_t with_room_for(unsigned workers, std::size_t capacity) {
  return capacity + 4 * std::size_t{workers};
}

template <class Ring>
bool push_optimistically(Ring& ring, std::size_t capacity, typename Ring::value_type element) {
  if (ring.was_size() >= capacity) return false;
  ring.push(element);
  return true;
}

/// The ring of words. Its "nobody here" is the word 0, so words go in complemented.
template <class T>
class Words {
 public:
  explicit Words(std::size_t capacity) : ring_(ring_size(capacity)) {}

  bool pop(unsigned /*worker*/, T& task) {
    std::uint64_t word = 0;
    if (!ring_.try_pop(word)) return false;
    task = element_of<T>(~word);
    return true;
  }

 protected:
  atomic_queue::AtomicQueueB<std::uint64_t> ring_;
};

/// The ring of elements with states.
template <class T>
class States {
 public:
  explicit States(std::size_t capacity) : ring_(ring_size(capacity)) {}

  bool pop(unsigned /*worker*/, T& task) { return ring_.try_pop(task); }

 protected:
  atomic_queue::AtomicQueueB2<T> ring_;
};

inline constexpr Claims claims{
    .bounded = true, .reclamation = Reclamation::preallocated, .survives_no_memory = false};
inline constexpr Claims claims_of_words{
    .bounded = true, .reclamation = Reclamation::preallocated, .all_ones_reserved = true};

}  // namespace atomic_queues

template <class T>
class AtomicQueue : public atomic_queues::Words<T> {
 public:
  static constexpr std::string_view summary = "atomic_queue AtomicQueue: a ring of atomic words";
  static constexpr Claims claims = atomic_queues::claims_of_words;

  AtomicQueue(unsigned /*workers*/, std::size_t capacity) : atomic_queues::Words<T>(capacity) {}

  /// Adds `task`; false if the ring is full. Blocking.
  bool push(unsigned /*worker*/, T task) { return this->ring_.try_push(~word_of(task)); }
};

template <class T>
class OptimistAtomicQueue : public atomic_queues::Words<T> {
 public:
  static constexpr std::string_view summary =
      "atomic_queue OptimistAtomicQueue: push by fetch-and-add";
  static constexpr Claims claims = atomic_queues::claims_of_words;

  OptimistAtomicQueue(unsigned workers, std::size_t capacity)
      : atomic_queues::Words<T>(atomic_queues::with_room_for(workers, capacity)),
        capacity_(capacity) {}

  /// Adds `task`; false if `capacity` are there. Blocking.
  bool push(unsigned /*worker*/, T task) {
    return atomic_queues::push_optimistically(this->ring_, capacity_, ~word_of(task));
  }

 private:
  std::size_t capacity_;
};

template <class T>
class AtomicQueue2 : public atomic_queues::States<T> {
 public:
  static constexpr std::string_view summary = "atomic_queue AtomicQueue2: a ring with states";
  static constexpr Claims claims = atomic_queues::claims;

  AtomicQueue2(unsigned /*workers*/, std::size_t capacity) : atomic_queues::States<T>(capacity) {}

  /// Adds `task`; false if the ring is full. Blocking.
  bool push(unsigned /*worker*/, T task) { return this->ring_.try_push(task); }
};

template <class T>
class OptimistAtomicQueue2 : public atomic_queues::States<T> {
 public:
  static constexpr std::string_view summary =
      "atomic_queue OptimistAtomicQueue2: states, push by fetch-and-add";
  static constexpr Claims claims = atomic_queues::claims;

  OptimistAtomicQueue2(unsigned workers, std::size_t capacity)
      : atomic_queues::States<T>(atomic_queues::with_room_for(workers, capacity)),
        capacity_(capacity) {}

  /// Adds `task`; false if `capacity` are there. Blocking.
  bool push(unsigned /*worker*/, T task) {
    return atomic_queues::push_optimistically(this->ring_, capacity_, task);
  }

 private:
  std::size_t capacity_;
};

}  // namespace irt
