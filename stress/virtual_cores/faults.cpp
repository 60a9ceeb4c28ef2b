// Faults of the code on a core, made known to the tenant.

#include <fmt/format.h>
#include <ucontext.h>

#include "stress/virtual_cores/internal.hpp"

namespace irt::virtual_cores {

namespace {

// The fault in hand; nothing else runs between its signal and its report.
std::uintptr_t fault_address = 0;
std::uintptr_t fault_pc = 0;

// What is called instead of the instruction that failed. It needs a stack of its own, for that of
// the core may be what ran out.
alignas(16) std::array<char, 65536> report_stack;

[[noreturn]] void report_fault() {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): code is known by its address here
  const auto* pc = reinterpret_cast<const void*>(fault_pc + 1);
  active->failed(fmt::format("an access to memory that is not there ({:#x})", fault_address), pc);
}

void on_fault(int signal, siginfo_t* info, void* raw_context) {
  if (current_core == host) {  // no core's fault: the instruction is repeated, and ends the process
    std::signal(signal, SIG_DFL);
    return;
  }
  auto& registers = static_cast<ucontext_t*>(raw_context)->uc_mcontext.gregs;
  fault_address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  fault_pc = static_cast<std::uintptr_t>(registers[REG_RIP]);
  registers[REG_RIP] = reinterpret_cast<greg_t>(&report_fault);
  // Aligned as after a call.
  registers[REG_RSP] = reinterpret_cast<greg_t>(report_stack.data() + report_stack.size() - 8);
}

}  // namespace

FaultHandler::FaultHandler() {
  stack_t own{};
  own.ss_sp = stack_.data();
  own.ss_size = stack_.size();
  sigaltstack(&own, &stack_before_);
  struct sigaction action {};
  action.sa_sigaction = on_fault;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigaction(SIGSEGV, &action, &segv_before_);
  sigaction(SIGBUS, &action, &bus_before_);
}

FaultHandler::~FaultHandler() {
  sigaction(SIGSEGV, &segv_before_, nullptr);
  sigaction(SIGBUS, &bus_before_, nullptr);
  sigaltstack(&stack_before_, nullptr);
}

}  // namespace irt::virtual_cores
