// Where atomic accesses fall: objects of what address and size.

#include <algorithm>

#include "stress/checker/execution.hpp"

namespace irt::checker {

namespace {

Value mask_of(std::uint32_t size) {
  return size == sizeof(Value) ? ~Value{0} : (Value{1} << (8 * size)) - 1;
}

}  // namespace

void Execution::widen(std::uintptr_t address, std::uint32_t size) {
  // An access that crosses eight bytes, or is wider, takes the whole sixteen.
  const std::uintptr_t unit = address & ~std::uintptr_t{15};
  const bool eight = (address & 7U) + size <= 8 && widened_.count(unit) == 0;
  widened_[unit] = eight ? 8 : 16;
  stop(Outcome::restart);
}

Execution::Part Execution::part_at(std::uintptr_t address, std::uint32_t size) {
  std::uintptr_t base = address;
  std::uint32_t whole = size;
  if (!widened_.empty()) {
    const auto wide = widened_.find(address & ~std::uintptr_t{15});
    if (wide != widened_.end()) {
      whole = std::max(size, wide->second);
      base = address & ~std::uintptr_t{whole - 1};
      if (address + size > base + whole) widen(address, 16);
    }
  }
  Part part{0, static_cast<unsigned>(8 * (address - base)), mask_of(size)};
  Cell& cell = heap_.cell(base);
  const auto covers = [&](std::uint32_t id) {
    const Location& l = graph_.location(id);
    return l.address < base + whole && base < l.address + l.size;
  };
  for (std::uint32_t link = cell.location; link != 0; link = next_location_[link - 1]) {
    if (!covers(link - 1)) continue;
    const Location& found = graph_.location(link - 1);
    if (found.address != base || found.size != whole)
      widen(std::min(found.address, base), std::max(found.size, whole));
    part.location = link - 1;
    const auto bytes = static_cast<std::uint8_t>(((1U << std::min(whole, 8U)) - 1) << (base & 7U));
    if ((cell.replaced & bytes) != 0) {
      cell.replaced = static_cast<std::uint8_t>(cell.replaced & ~bytes);
      graph_.reset_location(part.location, virtual_cores::read_memory(base, whole));
    }
    return part;
  }
  if (whole == 16 && heap_.cell(base + 8).location != 0) widen(address, 16);
  const Value initial = base >> 63U != 0 ? 0 : virtual_cores::read_memory(base, whole);
  part.location = graph_.add_location(base, whole, initial);
  next_location_.resize(part.location);
  next_location_.push_back(cell.location);
  cell.location = part.location + 1;
  if (whole == 16) heap_.cell(base + 8).location = part.location + 1;
  if (on_own_stack(address)) stack_locations_ = true;
  return part;
}

}  // namespace irt::checker
