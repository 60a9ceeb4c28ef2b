#include "stress/checker/strategy.hpp"

#include <algorithm>
#include <bit>

namespace irt::checker {

void Strategy::added(ExecutionState&, const Event&) {}
std::optional<std::size_t> Strategy::planned_place(ExecutionState&, Event&, std::uint32_t) {
  return std::nullopt;
}
bool Strategy::expects_more(unsigned) const {
  return false;
}
bool Strategy::expects_choice(unsigned, const void*) const {
  return false;
}
std::uint32_t Strategy::choose(ChoiceKind, std::uint32_t) {
  return 0;
}

unsigned Strategy::choose_thread(ExecutionState&, std::uint32_t runnable, unsigned current) {
  const auto count = static_cast<std::uint32_t>(std::popcount(runnable));
  const bool stays = current < 32 && (runnable >> current & 1U) != 0;
  std::uint32_t choice = count == 1 ? 0 : choose(ChoiceKind::thread, count);
  if (stays && choice == 0) return current;
  if (stays) {
    runnable &= ~(1U << current);
    --choice;
  }
  while (choice-- > 0) runnable &= runnable - 1;
  return static_cast<unsigned>(std::countr_zero(runnable));
}

std::size_t Strategy::choose_read(ExecutionState&, Event&, std::uint32_t,
                                  std::span<const ReadOption> options) {
  const auto open = static_cast<std::uint32_t>(
      std::ranges::count_if(options, [](const ReadOption& o) { return !o.taken; }));
  std::uint32_t choice = open == 1 ? 0 : choose(ChoiceKind::read, open);
  for (std::size_t i = 0;; ++i)
    if (!options[i].taken && choice-- == 0) return i;
}

std::size_t Strategy::choose_place(ExecutionState&, Event&, std::uint32_t,
                                   std::span<const std::size_t> places) {
  const auto count = static_cast<std::uint32_t>(places.size());
  return count == 1 ? 0 : choose(ChoiceKind::place, count);
}

unsigned Strategy::choose_other(ExecutionState&, Event&, unsigned count) {
  return choose(ChoiceKind::other, count);
}

}  // namespace irt::checker
