/// What the parts of the runtime share. Nobody else includes this.
#pragma once

#include <array>
#include <csignal>

#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::virtual_cores {

/// Who is asked: the tenant while cores run, the defaults otherwise (constructors of globals).
extern Tenant* active;

/// Says that the next atomic operation is the runtime's own (hooks.cpp).
void forget_registers();

/// Wild pointers are findings too: while this lives, a fault in a core becomes a call of
/// `Tenant::failed` (faults.cpp).
class FaultHandler {
 public:
  FaultHandler();
  FaultHandler(const FaultHandler&) = delete;
  FaultHandler& operator=(const FaultHandler&) = delete;
  ~FaultHandler();

 private:
  std::array<char, 16384> stack_{};
  stack_t stack_before_{};
  struct sigaction segv_before_ {};
  struct sigaction bus_before_ {};
};

// thread_local, one block per core and module (thread_locals.cpp).
void forget_thread_locals(unsigned core);
/// Runs the destructors of the core's thread_local objects, newest first.
void run_thread_exits(unsigned core);

}  // namespace irt::virtual_cores

// Functions that instrumented code is made to call instead of the C library's.
#define IRT_REDIRECTED extern "C" __attribute__((visibility("default")))
