#include "stress/threads/low_water.hpp"

#include <algorithm>
#include <bit>

namespace irt::stress {

void LowWater::add(std::uint64_t pushes, std::int64_t bytes) {
  if (pushes < parts) return;
  const auto doubling = static_cast<unsigned>(std::bit_width(pushes)) - 1;
  const auto part = static_cast<unsigned>(pushes * parts >> doubling) % parts;
  now_ = doubling * parts + part;
  Mark& mark = lowest_.at(now_);
  if (mark.pushes == 0) mark = {pushes, bytes};
  mark.bytes = std::min(mark.bytes, bytes);
}

std::array<LowWater::Mark, LowWater::judged> LowWater::marks() const {
  std::array<Mark, judged> result{};
  if (now_ == 0) return result;
  result.back() = lowest_.at(now_ - 1);
  for (unsigned i = 1; i < judged && i <= now_ / parts; ++i) {
    const auto first = lowest_.begin() + (now_ / parts - i) * parts;
    Mark& mark = result.at(judged - 1 - i);
    for (auto part = first; part != first + parts; ++part) {
      if (part->pushes == 0) continue;
      if (mark.pushes == 0) mark = *part;
      mark.bytes = std::min(mark.bytes, part->bytes);
    }
  }
  return result;
}

LowWater::Growth LowWater::growth() const {
  const std::array<Mark, judged> held = marks();
  for (const Mark& mark : held)
    if (mark.pushes == 0) return Growth::undecided;
  // What falls was a batch.
  const auto [low, high] = std::minmax_element(
      held.begin(), held.end(), [](const Mark& a, const Mark& b) { return a.bytes < b.bytes; });
  const std::int64_t noise = (high->bytes - low->bytes) / 4;
  for (unsigned i = 1; i < judged; ++i)
    if (held.at(i).bytes < held.at(i - 1).bytes - noise) return Growth::none;
  const auto slope = [&](unsigned from, unsigned to) {
    return static_cast<double>(held.at(to).bytes - held.at(from).bytes) /
           static_cast<double>(held.at(to).pushes - held.at(from).pushes);
  };
  constexpr unsigned last = judged - 1;
  if (slope(last - 2, last) < slight) return Growth::none;
  if (held.back().pushes < enough_pushes / 16 * 15 && held.back().bytes < enough_bytes)
    return Growth::undecided;
  // Of a root of the pushes the later slope would be half the earlier one.
  constexpr double like_a_line = 0.85;
  return slope(last - 2, last) < like_a_line * slope(0, last - 2) ? Growth::none
                                                                  : Growth::unbounded;
}

}  // namespace irt::stress
