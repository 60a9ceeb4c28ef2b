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
  use_after_return,  ///< of a variable of a function that has returned
  double_free,
  invalid_free,  ///< of what is not the beginning of a block
  out_of_bounds,
  uninitialised_read,
  leak,
  deadlock,
  livelock,
  blocked_by_stalled_thread,
  failure,         ///< a failed assertion, an exception, abort()
  wrong_outcome,   ///< the program's judge says so
  schedule_stale,  ///< a replayed schedule does not fit the program
};

/// The kind in words: "data race".
std::string_view name_of(FindingKind kind);

/// What a thread did that the finding speaks of: a plain access, an allocation, a free.
struct Moment {
  unsigned thread = 0;
  std::uint16_t after = 0;  ///< so many events of its own
  const void* pc = nullptr;
  std::string what;  ///< "plain write"
  std::string note;  ///< what is wrong with it, with places as in the finding's text; may be empty
};

struct Finding {
  FindingKind kind = FindingKind::failure;
  std::string text;  ///< one sentence; {0}, {1}, ... stand for the places below
  std::vector<const void*> places;
  std::vector<Moment> moments{};  ///< for the columns of a report
};

/// Whether both are of one kind and at the same places in the code; without places, whether they
/// say the same but for numbers.
bool same_place(const Finding& a, const Finding& b);

}  // namespace irt::checker
