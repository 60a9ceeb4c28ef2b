/// One line per worker thread that others may look at while it runs: what it is doing, how far it
/// is, and where it stands. Written by its own thread, read by watchdog and interrupter.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>
#include <sys/types.h>

#include "stress/history/operation.hpp"

namespace irt::stress {

/// Which method a thread is in.
enum class Doing : std::uint8_t { nothing, push, pop, leave };

constexpr std::string_view name(Doing doing) {
  constexpr std::array<std::string_view, 4> names{"nothing", "push", "pop", "leave"};
  return names.at(static_cast<std::size_t>(doing));
}

/// In whose code a thread stands.
enum class Standing : std::uint8_t {
  outside,       ///< in no method of a queue, or nobody can tell
  own,           ///< in the queue's code, or in a lock or nap of its own choice
  library,       ///< the queue called the C or C++ library and stands somewhere in there
  static_guard,  ///< as `library`: it waits for another's first use of a local static
};

/// Return addresses, innermost first; unused places are null.
using Trace = std::array<void*, 32>;

/// All accesses are relaxed: a slot informs, it must not order what the queue leaves unordered.
struct alignas(128) Slot {
  std::atomic<std::uint64_t> done{0};  ///< operations finished
  std::atomic<Doing> doing{Doing::nothing};
  std::atomic<pid_t> thread{0};  ///< kernel thread id; 0 while nobody stands here
  /// The stack pointer of whoever calls the queue: deeper frames are the queue's. Set before
  /// `doing`, by those who want to know where a thread stands.
  std::atomic<const void*> base{nullptr};

  // The signal handlers' side.
  std::atomic<bool> suspended{false};  ///< the thread is held by the handler, inside an operation
  std::atomic<bool> refused{false};    ///< asked to be held, it stood in no operation and ran on
  std::atomic<bool> traced{false};     ///< `trace` is complete
  Trace trace{};
  Standing standing = Standing::outside;  ///< of the trace
};

/// The slot of the calling thread, for the signal handlers; null outside worker threads.
Slot*& current_slot();

/// Registers the calling thread in `slot` for its lifetime.
class Presence {
 public:
  explicit Presence(Slot& slot);
  Presence(const Presence&) = delete;
  Presence& operator=(const Presence&) = delete;
  ~Presence();
};

}  // namespace irt::stress
