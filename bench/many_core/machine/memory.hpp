/// The real memory of the code that is simulated: as virtual_cores::read_memory and the others, but
/// inline and on half as many bits for words of eight bytes, which nearly all are.
#pragma once

#include <cstddef>
#include <cstdint>

#include "stress/virtual_cores/virtual_cores.hpp"

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace irt::many_core {

inline virtual_cores::Value read_memory(std::uintptr_t address, std::size_t size) {
  return size == 8 ? *reinterpret_cast<const volatile std::uint64_t*>(address)
                   : virtual_cores::read_memory(address, size);
}

inline void write_memory(std::uintptr_t address, std::size_t size, virtual_cores::Value value) {
  if (size == 8) {
    *reinterpret_cast<volatile std::uint64_t*>(address) = static_cast<std::uint64_t>(value);
  } else {
    virtual_cores::write_memory(address, size, value);
  }
}

inline virtual_cores::Value result_of(virtual_cores::Modification operation,
                                      virtual_cores::Value before, virtual_cores::Value operand,
                                      std::size_t size) {
  return size == 8 ? virtual_cores::apply(operation, static_cast<std::uint64_t>(before),
                                          static_cast<std::uint64_t>(operand), size)
                   : virtual_cores::apply(operation, before, operand, size);
}

}  // namespace irt::many_core
// NOLINTEND(performance-no-int-to-ptr)
