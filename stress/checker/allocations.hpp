/// malloc and free of the code.
#pragma once

#include <cstdint>
#include <unordered_set>
#include <utility>
#include <vector>

#include "stress/checker/alone.hpp"
#include "stress/checker/execution_state.hpp"
#include "stress/checker/loops.hpp"
#include "stress/checker/memory_watch.hpp"

namespace irt::checker {

class Allocations {
 public:
  Allocations(ExecutionState& state, Alone& alone, Loops& loops, MemoryWatch& watch)
      : state_(state), alone_(alone), loops_(loops), watch_(watch) {}

  /// The next execution begins.
  void begin() { failed_at_.clear(); }

  void* allocate(std::size_t size, std::size_t alignment, const void* pc);
  void release(std::uintptr_t address, const void* pc);

  /// Whether threads have allocated memory in any execution so far.
  [[nodiscard]] bool any() const { return any_; }
  /// Where each allocation was made that has failed by choice in the last execution, and by whom.
  [[nodiscard]] const std::vector<std::pair<unsigned, const void*>>& failed_at() const {
    return failed_at_;
  }
  /// Whether the code has freed what it allocated at `pc` in any execution so far.
  [[nodiscard]] bool frees_from(const void* pc) const { return freed_from_.contains(pc); }
  /// How many of `thread` have.
  [[nodiscard]] unsigned failed(unsigned thread) const;

 private:
  void* block(std::size_t size, std::size_t alignment, const void* pc);

  ExecutionState& state_;
  Alone& alone_;
  Loops& loops_;
  MemoryWatch& watch_;
  std::vector<std::pair<unsigned, const void*>> failed_at_;
  std::unordered_set<const void*> freed_from_;
  bool any_ = false;
};

}  // namespace irt::checker
