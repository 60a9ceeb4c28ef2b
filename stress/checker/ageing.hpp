/// Memory of a queue that has been used for long: many pairs of a push and a pop are made before an
/// execution begins, natively and unwatched, once; the executions after it begin with a copy.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stress/checker/heap.hpp"

namespace irt::checker {

/// What ageing has left in memory. Ages of one thing are reached from each other, upwards.
struct AgedMemory {
  std::string what;       ///< was aged: memory of something else is of no use
  std::uint64_t age = 0;  ///< calls of Program::grow_older so far
  void* made = nullptr;   ///< by the first of them, for the program
  Heap::Image heap{};
  std::vector<char> globals{};
};

struct ExecutionState;

/// Ages the program of `state`, or takes from its AgedMemory what came of that before.
void age(ExecutionState& state);

}  // namespace irt::checker
