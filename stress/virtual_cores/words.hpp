/// Words of memory by which the runtime's own functions let threads wait for each other. Nobody
/// outside of the runtime includes this.
#pragma once

#include <climits>
#include <cstdint>

#include "stress/virtual_cores/internal.hpp"

namespace irt::virtual_cores::words {

/// Whom these functions ask: the registers that the code had at an atomic operation of before are
/// not those that it has now.
inline Tenant& tenant() {
  forget_registers();
  return *active;
}

/// To wake.
inline constexpr unsigned everybody = INT_MAX;

inline std::uint32_t load(const std::uint32_t& word, const void* pc) {
  return static_cast<std::uint32_t>(tenant().load({address_of(&word), 4, Order::acquire, pc}));
}
inline void store(std::uint32_t& word, std::uint32_t value, const void* pc) {
  tenant().store({address_of(&word), 4, Order::release, pc}, value);
}
inline std::uint32_t add(std::uint32_t& word, std::uint32_t value, const void* pc) {
  return static_cast<std::uint32_t>(
      tenant().modify({address_of(&word), 4, Order::acq_rel, pc}, Modification::fetch_add, value));
}
/// Whether it was `expected`.
inline bool swap_if(std::uint32_t& word, std::uint32_t expected, std::uint32_t desired,
                    const void* pc) {
  Value seen = expected;
  return tenant().compare_exchange({address_of(&word), 4, Order::acq_rel, pc}, Order::acquire,
                                   false, seen, desired);
}
inline std::uint32_t exchange(std::uint32_t& word, std::uint32_t value, const void* pc) {
  return static_cast<std::uint32_t>(
      tenant().modify({address_of(&word), 4, Order::acq_rel, pc}, Modification::exchange, value));
}

}  // namespace irt::virtual_cores::words
