/// Where atomic accesses fall: objects of what address and size.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "stress/checker/execution_state.hpp"

namespace irt::checker {

/// A location and the part of it that an access touches.
struct Part {
  std::uint32_t location;
  unsigned shift;
  Value mask;
};

class Locations {
 public:
  explicit Locations(ExecutionState& state) : state_(state) {}

  /// Where `size` bytes at `address` are. Sizes that do not agree begin the search anew, with
  /// locations wide enough.
  Part at(std::uintptr_t address, std::uint32_t size);
  /// Frames come and go at one address, so stacks are not watched; but an atomic object that was
  /// there ends with the next write to its place.
  void end_on_stack(std::uintptr_t address, std::size_t size);

 private:
  [[noreturn]] void widen(std::uintptr_t address, std::uint32_t size);

  ExecutionState& state_;
  /// Sixteen-byte units that are accessed in different sizes, and the size that covers them.
  std::unordered_map<std::uintptr_t, std::uint32_t> widened_;
  std::vector<std::uint32_t> next_;  ///< by location: another one in the same eight bytes
  bool on_stack_ = false;            ///< some are
};

}  // namespace irt::checker
