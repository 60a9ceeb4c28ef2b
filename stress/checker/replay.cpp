#include "stress/checker/replay.hpp"

#include <charconv>
#include <stdexcept>

#include "stress/checker/coherence.hpp"

namespace irt::checker {

namespace {

constexpr auto option_kind = static_cast<std::uint8_t>(EventKind::choice);

bool is_option(const Step& step) {
  return step.kind == option_kind;
}

}  // namespace

std::string to_string(const Schedule& schedule) {
  std::string text = schedule.waiting_resumes ? "s:" : "g:";
  const std::vector<Step>& steps = schedule.steps;
  for (std::size_t i = 0; i < steps.size();) {
    std::size_t end = i + 1;
    while (end < steps.size() && steps[end].thread == steps[i].thread &&
           steps[end - 1].choice == 0 && !is_option(steps[end - 1]))
      ++end;
    const Step& last = steps[end - 1];
    text += static_cast<char>('a' + last.thread);
    if (end - i > 1) text += std::to_string(end - i);
    if (is_option(last))
      text += "?" + std::to_string(last.choice);
    else if (last.choice != 0)
      text += "'" + std::to_string(last.choice);
    i = end;
  }
  return text;
}

Schedule parse_schedule(std::string_view text) {
  const auto wrong = [text](const std::string& what) {
    return std::invalid_argument("schedule \"" + std::string(text) + "\": " + what +
                                 "; one looks like s:a3b'1a2");
  };
  if (!text.starts_with("s:") && !text.starts_with("g:"))
    throw wrong("begins with neither s: nor g:");
  Schedule schedule;
  schedule.waiting_resumes = text[0] == 's';
  const char* at = text.data() + 2;
  const char* end = text.data() + text.size();
  const auto number = [&](std::uint32_t fallback) {
    std::uint32_t value = fallback;
    at = std::from_chars(at, end, value).ptr;
    return value;
  };
  while (at != end) {
    const int thread = *at++ - 'a';
    if (thread < 0 || thread >= static_cast<int>(max_threads))
      throw wrong("has a step of no thread");
    const std::uint32_t count = number(1);
    if (count == 0 || count > 1'000'000) throw wrong("has a run of no length");
    for (std::uint32_t i = 0; i < count; ++i)
      schedule.steps.push_back({static_cast<std::uint8_t>(thread), 0, 0});
    if (at != end && (*at == '\'' || *at == '?')) {
      if (*at++ == '?') schedule.steps.back().kind = option_kind;
      schedule.steps.back().choice = static_cast<std::uint16_t>(number(0));
    }
  }
  return schedule;
}

Replay::Replay(Schedule schedule) : schedule_(std::move(schedule)), remaining_(max_threads) {
  for (const Step& step : schedule_.steps) ++remaining_[step.thread];
}

bool Replay::begin() {
  const bool first = !begun_;
  begun_ = true;
  return first;
}

unsigned Replay::choose_thread(ExecutionState& state, std::uint32_t runnable, unsigned current) {
  while (position_ < schedule_.steps.size()) {
    const unsigned thread = schedule_.steps[position_].thread;
    if ((runnable >> thread & 1U) != 0) return thread;
    fits_ = false;  // go on without the steps that cannot be made
    --remaining_[thread];
    ++position_;
  }
  return Strategy::choose_thread(state, runnable, current);
}

std::optional<std::size_t> Replay::planned_place(ExecutionState& state, Event& event,
                                                 std::uint32_t location) {
  if (position_ == schedule_.steps.size()) return std::nullopt;
  const Graph& graph = state.graph;
  const bool stores = event.kind == EventKind::store;
  const std::size_t last = graph.location(location).stores.size() - (stores ? 0 : 1);
  const std::size_t lowest = lowest_readable(graph, event.thread, location) + (stores ? 1 : 0);
  const std::size_t choice = schedule_.steps[position_].choice;
  if (choice > last - lowest) fits_ = false;
  return choice > last - lowest ? last : last - choice;
}

bool Replay::expects_choice(unsigned thread, const void*) const {
  for (std::size_t i = position_; i < schedule_.steps.size(); ++i)
    if (schedule_.steps[i].thread == thread) return is_option(schedule_.steps[i]);
  return false;
}

unsigned Replay::choose_other(ExecutionState&, Event&, unsigned count) {
  const unsigned option =
      position_ < schedule_.steps.size() ? schedule_.steps[position_].choice : 0;
  if (option >= count) fits_ = false;
  return option < count ? option : 0;
}

void Replay::added(ExecutionState&, const Event& event) {
  if (position_ == schedule_.steps.size()) return;
  const Step& step = schedule_.steps[position_++];
  --remaining_[step.thread];
  if (step.thread != event.thread) fits_ = false;
}

}  // namespace irt::checker
