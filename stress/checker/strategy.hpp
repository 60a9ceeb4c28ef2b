/// Who decides. Everything that may go one way or another in an execution is asked here, and only
/// here: which thread goes on, which store a read reads, where a store is put in modification
/// order, and the rest (time-outs, spurious failures and wake-ups).
///
/// The first option is always the dullest one: the thread that runs goes on, the newest store is
/// read, a store comes last, nothing spurious happens.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "stress/checker/graph.hpp"

namespace irt::checker {

struct ExecutionState;

enum class ChoiceKind : std::uint8_t { thread, read, place, other };

/// How an execution ended.
enum class Outcome : std::uint8_t {
  complete,  ///< every thread ran to its end
  blocked,   ///< some thread waits for what another execution will bring
  found,     ///< something is wrong
  cut,       ///< the strategy gave it up: a duplicate, or not consistent
  restart,   ///< the explorer learnt something about the code and begins anew
};

/// One way a read may go.
struct ReadOption {
  std::size_t place;   ///< of the store in modification order
  bool modifies;       ///< a store follows, immediately after
  bool waits;          ///< the thread stops until there is another store
  bool taken = false;  ///< another modification has already read this store
};

/// What a search says of itself after an execution.
struct Books {
  bool left_out = false;   ///< something had to be left out, so that its end proves nothing
  bool elsewhere = false;  ///< another part of the same search makes and counts this execution too
  bool gives_up = false;   ///< the execution, although at its end, is to be passed over
  bool differs = false;    ///< it had other alternatives than the one that it was to repeat
  /// Threads that it took for equal turned out to differ, so that it proves nothing.
  bool loses_symmetry = false;
};

class Strategy {
 public:
  Strategy() = default;
  Strategy(const Strategy&) = delete;
  Strategy& operator=(const Strategy&) = delete;
  virtual ~Strategy() = default;

  /// Prepares the next execution; false when there is none.
  virtual bool begin() = 0;

  /// One of `runnable`, which has a bit for each thread and is not 0; or `virtual_cores::host` to
  /// give the execution up. `current` is the thread that runs (perhaps not runnable).
  virtual unsigned choose_thread(ExecutionState& state, std::uint32_t runnable, unsigned current);
  /// One of `options`, newest store first. Only options that are not `taken` may be chosen.
  virtual std::size_t choose_read(ExecutionState& state, Event& event, std::uint32_t location,
                                  std::span<const ReadOption> options);
  /// One of `places`, last first.
  virtual std::size_t choose_place(ExecutionState& state, Event& event, std::uint32_t location,
                                   std::span<const std::size_t> places);
  virtual unsigned choose_other(ExecutionState& state, Event& event, unsigned count);
  /// `event` is now part of the graph.
  virtual void added(ExecutionState& state, const Event& event);
  /// A place that is settled beforehand, for a strategy that repeats what it knows: of the store
  /// that `event` reads or, for a plain store, of the one before it.
  virtual std::optional<std::size_t> planned_place(ExecutionState& state, Event& event,
                                                   std::uint32_t location);
  /// Whether it is settled that `thread` goes on, however much it looks like waiting.
  [[nodiscard]] virtual bool expects_more(unsigned thread) const;
  /// Whether it is settled that the next event of `thread` is a choice at `pc`.
  [[nodiscard]] virtual bool expects_choice(unsigned thread, const void* pc) const;
  /// Whether only options that the model allows may be offered. If not, a choice that turns out to
  /// be forbidden is followed by the question for another.
  [[nodiscard]] virtual bool wants_verified() const { return true; }

  /// Whether a waiting thread goes on in the same execution once there is a new store. A strategy
  /// that explores the alternatives of each read by other means says no.
  [[nodiscard]] virtual bool resumes_waiting() const { return true; }

  [[nodiscard]] virtual Books books() const { return {}; }
  /// Estimated part of the search that is done, from 0 to 1; 0 where nobody knows.
  [[nodiscard]] virtual double explored() const { return 0; }

 protected:
  /// What the four above ask unless overridden: a number below `count`, which is at least 2.
  virtual std::uint32_t choose(ChoiceKind kind, std::uint32_t count);
};

}  // namespace irt::checker
