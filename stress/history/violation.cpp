#include "stress/history/violation.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <span>

namespace irt::stress {
namespace {

std::string call(const Operation& operation) {
  switch (operation.kind) {
    case Kind::push:
      return "push " + element_name(operation.value);
    case Kind::full:
      return "push " + element_name(operation.value) + " full";
    case Kind::pop:
      return "pop  " + element_name(operation.value);
    case Kind::empty:
      return "pop  empty";
    case Kind::closed:
      return "pop  closed";
    case Kind::timed_out:
      return "pop  timed out";
    case Kind::close:
      return "close";
    case Kind::leave:
      return "leave";
    case Kind::meet:
      return "meet";
  }
  return "?";
}

std::string who(const Culprit& culprit) {
  return culprit.worker == drain_worker ? "drain" : fmt::format("worker {}", culprit.worker);
}

}  // namespace

std::string_view promise(Pattern pattern) {
  switch (pattern) {
    case Pattern::fresh:
      return "pops only what was pushed";
    case Pattern::repeat:
      return "every element leaves once";
    case Pattern::order:
      return "order of elements";
    case Pattern::witness:
      return "empty only when empty";
    case Pattern::lost:
      return "no element is lost";
    case Pattern::full:
      return "full only when full";
    case Pattern::rank:
      return "bound of the relaxation";
    case Pattern::closed:
      return "closing is the end of pushes, of waiting and of elements";
  }
  return "?";
}

std::string element_name(Element e) {
  if (producer_of(e) > 0xffff) return fmt::format("{:#x}", e);
  return fmt::format("{}:{}", producer_of(e), sequence_of(e));
}

std::string explain(const Violation& violation, double ticks_per_nanosecond) {
  constexpr double columns = 40;
  std::string text = violation.text + "\n";
  Stamp first = never;
  Stamp last = 0;
  for (const Culprit& c : violation.culprits) {
    first = std::min(first, c.operation.invoked);
    last = std::max(last, c.operation.returned);
  }
  const double scale = last > first ? (columns - 1) / static_cast<double>(last - first) : 0;
  const auto column = [&](Stamp at) {
    return static_cast<std::size_t>(static_cast<double>(at - first) * scale);
  };
  for (const Culprit& c : violation.culprits) {
    std::string bar(static_cast<std::size_t>(columns), ' ');
    const std::size_t from = column(c.operation.invoked);
    const std::size_t to = column(c.operation.returned);
    std::ranges::fill(std::span(bar).subspan(from, to - from), '-');
    bar[from] = '|';
    bar[to] = '|';
    const auto time = [&](Stamp at) {
      return ticks_per_nanosecond > 0
                 ? fmt::format("{:.0f}", static_cast<double>(at - first) / ticks_per_nanosecond)
                 : fmt::format("{}", at);
    };
    text += fmt::format("  {:<10} {:<16} {} {} .. {}{}\n", who(c), call(c.operation), bar,
                        time(c.operation.invoked), time(c.operation.returned),
                        ticks_per_nanosecond > 0 ? " ns" : "");
  }
  return text;
}

}  // namespace irt::stress
