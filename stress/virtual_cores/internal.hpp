/// What the parts of the runtime share. Nobody else includes this.
#pragma once

#include <array>
#include <atomic>
#include <csignal>
#include <ctime>
#include <ucontext.h>

#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::virtual_cores {

/// Who is asked: the tenant while cores run, the defaults otherwise (constructors of globals).
extern Tenant* active;

/// Memory that the code has asked for, by a hook or by a function that reads or writes it on the
/// code's behalf.
struct Place {
  std::uintptr_t address = 0;
  std::size_t size = 0;
  const void* pc = nullptr;
};
/// The last two of the core in progress: copies and comparisons have two. A fault there is the
/// code's (faults.cpp).
class Asked {
 public:
  // Overwrites the older one: to move the newer aside would wait for what was stored just before.
  void note(const Place& place) {
    last_ ^= 1U;
    places_[last_] = place;
  }
  [[nodiscard]] const Place& last() const { return places_[last_]; }
  [[nodiscard]] const Place& before() const { return places_[last_ ^ 1U]; }

 private:
  Place places_[2];
  std::size_t last_ = 0;
};
extern Asked asked;

inline std::uintptr_t address_of(const volatile void* pointer) {
  return reinterpret_cast<std::uintptr_t>(pointer);
}
inline void ask(const volatile void* place, std::size_t size, const void* pc) {
  asked.note({address_of(place), size, pc});
  std::atomic_signal_fence(std::memory_order_seq_cst);  // noted before it can fault
}
/// Announces a plain access that the code at `pc` makes, by itself or through the runtime.
inline void announce_read(const volatile void* place, std::size_t size, const void* pc) {
  ask(place, size, pc);
  active->plain_read(address_of(place), size, pc);
}
inline void announce_write(const volatile void* place, std::size_t size, const void* pc) {
  ask(place, size, pc);
  active->plain_write(address_of(place), size, pc);
}

/// Announces the write of `size` bytes from the tenant's random numbers, and makes it.
void fill_randomly(void* to, std::size_t size, const void* pc);

/// The machine code of the modules that are loaded, and what of them nobody can write to.
void add_code(Range code);
void add_constants(Range constants);
bool is_code_of_a_module(std::uintptr_t address);
bool is_constant_of_a_module(Range bytes);
/// Has the core that a signal has interrupted call `function` instead, on a stack of its own.
void call_instead(ucontext_t& context, void (*function)());
/// An instruction was made by itself.
void single_step(ucontext_t& context);
/// Whether `address` is on a core's stack, or on the guard below one.
bool is_near_a_stack(std::uintptr_t address);

/// errno of the core in progress (thread_locals.cpp).
int& core_errno();
/// What a function returns that says by errno what went wrong: 0 for no error, else -1.
inline int set_errno(int error) {
  if (error == 0) return 0;
  core_errno() = error;
  return -1;
}

/// Of the host and of the code.
inline constexpr std::size_t page_bytes = 4096;

inline constexpr std::int64_t nanoseconds_per_second = 1'000'000'000;
inline std::int64_t nanoseconds_of(const timespec& time) {
  return time.tv_sec * nanoseconds_per_second + time.tv_nsec;
}

inline constexpr std::int64_t forever = -1;
/// Nanoseconds until `deadline`, never negative; `forever` if there is none.
inline std::int64_t until(const timespec* deadline) {
  if (deadline == nullptr) return forever;
  const std::int64_t left = nanoseconds_of(*deadline) - active->now();
  return left < 0 ? 0 : left;
}

/// The name of a function or type as the code says it.
std::string demangled(const char* name);

/// Says that the next atomic operation is the runtime's own (hooks.cpp).
void forget_registers();

/// Wild pointers, illegal instructions and divisions by zero are findings too: while this lives, a
/// fault in a core becomes a call of `Tenant::failed` (faults.cpp).
class FaultHandler {
 public:
  FaultHandler();
  FaultHandler(const FaultHandler&) = delete;
  FaultHandler& operator=(const FaultHandler&) = delete;
  ~FaultHandler();

 private:
  static constexpr std::array signals{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGTRAP, SIGABRT};

  std::array<char, 32768> stack_{};
  stack_t stack_before_{};
  std::array<struct sigaction, signals.size()> before_{};
};

/// The core in progress is at its end, wherever in its functions it is (cores.cpp).
[[noreturn]] void end_core();

// thread_local, one block per core and module (thread_locals.cpp).
void forget_thread_locals(unsigned core);
/// Runs the destructors of the core's thread_local objects, newest first.
void run_thread_exits(unsigned core);

}  // namespace irt::virtual_cores

// Where the instrumented code is that has called the function in which this stands.
#define IRT_PC __builtin_return_address(0)

// Functions that instrumented code is made to call instead of the C library's.
#define IRT_REDIRECTED extern "C" __attribute__((visibility("default")))
