/// An execution as far as it has come: what its parts share, and all that strategies see of it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "stress/checker/conclusion.hpp"
#include "stress/checker/diary.hpp"
#include "stress/checker/graph.hpp"
#include "stress/checker/heap.hpp"
#include "stress/checker/program.hpp"
#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::checker {

/// A step of an execution, for replay and for the reader.
struct Step {
  std::uint8_t thread = 0;
  std::uint8_t kind = 0;  ///< EventKind
  /// Distance from the newest store read, from the last place, or option.
  std::uint16_t choice = 0;
  friend bool operator==(const Step&, const Step&) = default;
};

/// `endless`: one thread of `parallel` runs on by itself, to see whether it ever ends.
enum class Phase : std::uint8_t { idle, ageing, prepare, parallel, endless, finish };

/// Addresses that no program has, of a futex's sleepers, a clock, a thread's end, begin with this
/// bit.
inline constexpr std::uintptr_t made_up = std::uintptr_t{1} << 63U;
constexpr bool is_made_up(std::uintptr_t address) {
  return address >= made_up;
}

struct ExecutionState {
  /// What the next event of a thread will touch: an address, or 0.
  struct Pending {
    std::uintptr_t address = 0;
    bool writes = false;
  };

  ExecutionState(const Program& checked, const Limits& bounds, virtual_cores::Tenant& tenant);

  /// The next execution begins.
  void begin(Strategy& decides);
  /// Makes `core` begin with `work`, which must live as long as it runs.
  void arm(unsigned core, const std::function<void()>& work);
  void run_main(const std::function<void()>& work) {
    arm(threads, work);
    cores.run(threads);
  }
  /// Notes in the diary, if one is kept, what the thread in progress does besides its events.
  void note(Look::Kind kind, std::uintptr_t address, std::size_t size) {
    if (diary != nullptr && phase >= Phase::parallel) take_down(kind, address, size);
  }

  /// `event` is complete and becomes a step; `choice` as there.
  void add_step(const Event& event, std::size_t choice) {
    if (phase != Phase::parallel) return;
    walk = 0;
    ++beats;
    conclusion.check_time(1 + steps.size() / 32);  // strategies go through those before
    steps.push_back(
        {event.thread, static_cast<std::uint8_t>(event.kind), static_cast<std::uint16_t>(choice)});
    strategy->added(*this, event);
  }
  /// A step that only chooses: which of `count` ways the code at `pc` goes.
  unsigned choose(unsigned count, const void* pc);

  [[nodiscard]] unsigned current() const { return cores.current(); }
  [[nodiscard]] std::size_t events_of(unsigned thread) const {
    return graph.thread(thread).events.size();
  }
  [[nodiscard]] bool observed() const { return phase > Phase::ageing; }
  [[nodiscard]] bool on_own_stack(std::uintptr_t address) const {
    return address - stacks[current()] < stack_bytes;
  }
  [[nodiscard]] bool is_stack(std::uintptr_t address) const {
    return owner_of_stack(address) < stacks.size();
  }
  /// The core on whose stack `address` is; another number if it is on none.
  [[nodiscard]] std::size_t owner_of_stack(std::uintptr_t address) const;
  /// Whether it is in a variable of the module.
  [[nodiscard]] bool is_global(std::uintptr_t address) const;
  /// Stands for the registers of the core in progress and what is on its stack.
  [[nodiscard]] std::uint64_t hash_of_core() const;

  void take_down(Look::Kind kind, std::uintptr_t address, std::size_t size);

  const Program& program;
  const Limits limits;
  unsigned threads;  ///< from 0; the one that prepares and finishes has this number
  virtual_cores::Cores cores;
  std::vector<std::uintptr_t> stacks;  ///< of the cores: lowest addresses
  std::size_t stack_bytes;
  Conclusion conclusion{cores};
  Graph graph;
  Heap heap;
  Strategy* strategy = nullptr;
  Phase phase = Phase::idle;
  std::vector<Step> steps;  ///< what was chosen, in order
  std::vector<Pending> pending;
  std::uint64_t stores = 0;
  std::uint64_t walk = 0;   ///< accesses to memory since the last event, or since the phase began
  std::uint64_t beats = 0;  ///< changes with whatever the code does but compute
  Diary* diary = nullptr;
};

}  // namespace irt::checker
