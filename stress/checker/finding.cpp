#include "stress/checker/finding.hpp"

namespace irt::checker {

std::string_view name_of(FindingKind kind) {
  switch (kind) {
    case FindingKind::data_race:
      return "data race";
    case FindingKind::use_after_free:
      return "use after free";
    case FindingKind::use_after_return:
      return "use after return";
    case FindingKind::double_free:
      return "double free";
    case FindingKind::invalid_free:
      return "invalid free";
    case FindingKind::out_of_bounds:
      return "access out of bounds";
    case FindingKind::uninitialised_read:
      return "read of uninitialised memory";
    case FindingKind::leak:
      return "memory leak";
    case FindingKind::deadlock:
      return "deadlock";
    case FindingKind::livelock:
      return "livelock";
    case FindingKind::blocked_by_stalled_thread:
      return "blocked by a stalled thread";
    case FindingKind::failure:
      return "failure";
    case FindingKind::wrong_outcome:
      return "wrong outcome";
    case FindingKind::schedule_stale:
      return "schedule does not fit";
  }
  return "?";
}

bool same_place(const Finding& a, const Finding& b) {
  const auto without_numbers = [](std::string text) {
    std::erase_if(text, [](char c) { return c >= '0' && c <= '9'; });
    return text;
  };
  if (a.kind != b.kind || a.places != b.places) return false;
  return !a.places.empty() || without_numbers(a.text) == without_numbers(b.text);
}

}  // namespace irt::checker
