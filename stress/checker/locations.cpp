#include "stress/checker/locations.hpp"

#include <algorithm>

namespace irt::checker {

namespace {

Value mask_of(std::uint32_t size) {
  return size == sizeof(Value) ? ~Value{0} : (Value{1} << (8 * size)) - 1;
}

}  // namespace

void Locations::widen(std::uintptr_t address, std::uint32_t size) {
  // An access that crosses eight bytes, or is wider, takes the whole sixteen.
  const std::uintptr_t unit = address & ~std::uintptr_t{15};
  const bool eight = (address & 7U) + size <= 8 && widened_.count(unit) == 0;
  widened_[unit] = eight ? 8 : 16;
  state_.conclusion.stop(Outcome::restart);
}

Part Locations::at(std::uintptr_t address, std::uint32_t size) {
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
  Cell& cell = state_.heap.cell(base);
  const auto covers = [&](std::uint32_t id) {
    const Location& l = state_.graph.location(id);
    return l.address < base + whole && base < l.address + l.size;
  };
  for (std::uint32_t link = cell.location; link != 0; link = next_[link - 1]) {
    if (!covers(link - 1)) continue;
    const Location& found = state_.graph.location(link - 1);
    const bool other = found.address != base || found.size != whole;
    if (other && on_stack_ && state_.is_stack(base)) {
      cell.location = 0;  // of a frame that is gone
      break;
    }
    if (other) widen(std::min(found.address, base), std::max(found.size, whole));
    part.location = link - 1;
    const auto bytes = static_cast<std::uint8_t>(((1U << std::min(whole, 8U)) - 1) << (base & 7U));
    if ((cell.replaced & bytes) != 0) {
      cell.replaced = static_cast<std::uint8_t>(cell.replaced & ~bytes);
      state_.graph.reset_location(part.location, virtual_cores::read_memory(base, whole));
    }
    return part;
  }
  if (whole == 16 && state_.heap.cell(base + 8).location != 0) widen(address, 16);
  const Value initial = is_made_up(base) ? 0 : virtual_cores::read_memory(base, whole);
  part.location = state_.graph.add_location(base, whole, initial);
  next_.resize(part.location);
  next_.push_back(cell.location);
  cell.location = part.location + 1;
  if (whole == 16) state_.heap.cell(base + 8).location = part.location + 1;
  on_stack_ = on_stack_ || state_.on_own_stack(address);
  return part;
}

void Locations::end_on_stack(std::uintptr_t address, std::size_t size) {
  if (!on_stack_) return;
  for (std::uintptr_t at = address & ~std::uintptr_t{7}; at < address + size; at += 8)
    if (Cell& cell = state_.heap.cell(at); cell.location != 0) cell.replaced = 0xFF;
}

}  // namespace irt::checker
