/// What the checker found wrong.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace irt::checker {

enum class FindingKind : std::uint8_t {
  data_race,
  use_after_free,
  invalid_free,
  out_of_bounds,
  uninitialised_read,
  leak,
  deadlock,
  livelock,
  blocked_by_stalled_thread,
  failure,         ///< a failed assertion, an exception, abort()
  wrong_outcome,   ///< the scenario's judge says so
  schedule_stale,  ///< a replayed schedule does not fit the program
};

/// The kind in words: "data race".
std::string_view name_of(FindingKind kind);

struct Finding {
  FindingKind kind = FindingKind::failure;
  std::string text;  ///< one sentence; {0}, {1}, ... stand for the places below
  std::vector<const void*> places;
};

}  // namespace irt::checker
