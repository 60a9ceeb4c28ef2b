/// A thread of a simulated machine: its clock, what it has asked for, what it is waiting for.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <vector>

#include "bench/many_core/coherence/directory.hpp"
#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::many_core {

/// A thread that sleeps in a loop, at one of the lines that the loop looks at.
struct Watch {
  Line* line = nullptr;
  Watch* next = nullptr;
  Watch* before = nullptr;
  std::uint32_t thread = 0;
};

/// A store that the thread does not wait for. Plain ones have taken effect in memory already: what
/// is not ordered by atomics nobody else may look at.
struct PostedStore {
  Line* line = nullptr;
  Time issued = 0;
  const void* pc = nullptr;
  std::uint64_t bytes = 0;
  std::uintptr_t address = 0;
  std::uint32_t size = 0;  ///< of the value, in bytes; 0 for a plain store
  virtual_cores::Value value = 0;
};

/// The stores of a thread, in program order.
class StoreBuffer {
 public:
  static constexpr std::size_t places = 48;

  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] bool full() const { return count_ == places; }
  [[nodiscard]] std::size_t size() const { return count_; }
  PostedStore& first() { return stores_[first_]; }
  PostedStore& operator[](std::size_t i) { return stores_[(first_ + i) % places]; }
  PostedStore& add(const PostedStore& store) {
    return stores_[(first_ + count_++) % places] = store;
  }
  void drop_first() {
    first_ = (first_ + 1) % places;
    --count_;
  }

 private:
  std::uint32_t first_ = 0, count_ = 0;
  std::vector<PostedStore> stores_ = std::vector<PostedStore>(places);
};

/// What a thread remembers to notice that it goes round in circles.
struct LoopState {
  static constexpr unsigned max_lines = 8;
  static constexpr unsigned longest = 64;  // loads

  const void* pc = nullptr;  ///< of the load that is thought to begin the loop
  std::uintptr_t address = 0;
  Time clock = 0;              ///< at its last round
  std::uint64_t changes = 0;   ///< `Thread::changes` then
  std::uint64_t failures = 0;  ///< `Thread::failures` then
  std::uint64_t state = 0;     ///< registers and stack then; 0: not known
  unsigned rounds = 0;         ///< without a change
  unsigned age = 0;            ///< loads since then
  bool has_slept = false;      ///< in this loop, so that looking for it is worth while
  unsigned lines = 0;          ///< in `watches`; more than max_lines: too many
  std::array<Watch, max_lines> watches;
  Time period = 0;  ///< of a round, while the thread sleeps in the loop; else 0
};

/// Who sleeps until a word is woken.
struct Sleepers {
  std::uintptr_t bucket = 0;  ///< where the kernel keeps them
  std::deque<unsigned> threads;
};

/// What every access uses comes first and lies together: with hundreds of threads most of what one
/// of them touches comes from the host's second cache.
struct alignas(line_bytes) Thread {
  Request request;
  Time clock = 0;
  Time deadline = never;  ///< when it must look up: the end of its quantum or of the run

  Event event;
  const LocalCosts* costs = nullptr;
  Time committed = 0;  ///< when the last store that was served took effect
  std::uint32_t number = 0;
  std::uint32_t core = 0;  ///< its hardware thread, as Topology numbers them

  std::uint64_t changes = 0;  ///< steps that were no repetition
  std::uint64_t failures = 0;
  std::uintptr_t stack = 0, stack_bytes = 0;
  bool draining = false;  ///< waits for `stores` to be empty
  bool crowded = false;   ///< waits for a place in `stores`
  bool parked = false, woken = false, timed_out = false;
  StoreBuffer stores;

  LoopState loop;

  Request store_request;             ///< of the first store
  Sleepers* asleep_among = nullptr;  ///< null: sleeps for a time, and nobody can wake it
  const std::function<void(unsigned thread)>* body = nullptr;
};

}  // namespace irt::many_core
