/// Schedules as text, and their repetition.
///
///     s:a3b'1a2    thread 0 makes three steps, thread 1 one that reads the store before the
///     newest,
///                  thread 0 two more
///
/// A letter names the thread, a number how many steps it makes in a row, ' and a number what was
/// chosen in the last of them where it was not the dullest: how far from the newest store it read
/// or how far from the last place it stored; ? and a number which option it took. The text begins
/// with `s:`, or with `g:` if threads that wait stay where they are (see dpor.hpp).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "stress/checker/execution_state.hpp"

namespace irt::checker {

struct Schedule {
  std::vector<Step> steps;
  bool waiting_resumes = true;
};

/// What to say of one that does not find again what it was found with.
inline constexpr const char* stale_schedule =
    "The schedule finds nothing now: the code, its compiler or an option of the run (capacity, "
    "--reuse, --spurious, --weak, --failing-allocations, --real-time) is not what it was.\n";

std::string to_string(const Schedule& schedule);
/// Throws std::invalid_argument that says what is wrong with `text`.
Schedule parse_schedule(std::string_view text);

/// Repeats a schedule once. Where it does not fit, `fits` says so; what comes after its end is the
/// dullest choice each time.
class Replay : public Strategy {
 public:
  explicit Replay(Schedule schedule);

  bool begin() override;
  unsigned choose_thread(ExecutionState& state, std::uint32_t runnable, unsigned current) override;
  unsigned choose_other(ExecutionState& state, Event& event, unsigned count) override;
  std::optional<std::size_t> planned_place(ExecutionState& state, Event& event,
                                           std::uint32_t location) override;
  void added(ExecutionState& state, const Event& event) override;
  [[nodiscard]] bool expects_more(unsigned thread) const override {
    return remaining_[thread] != 0;
  }
  [[nodiscard]] bool expects_choice(unsigned thread, const void* pc) const override;
  [[nodiscard]] bool resumes_waiting() const override { return schedule_.waiting_resumes; }

  /// Whether every step so far was as the schedule says.
  [[nodiscard]] bool fits() const { return fits_; }

 private:
  Schedule schedule_;
  std::size_t position_ = 0;
  std::vector<std::uint32_t> remaining_;
  bool begun_ = false;
  bool fits_ = true;
};

}  // namespace irt::checker
