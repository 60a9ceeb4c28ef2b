// Faults of the code on a core, made known to the tenant.

#include <algorithm>
#include <dlfcn.h>
#include <fmt/format.h>
#include <ucontext.h>
#include <unistd.h>
#include <vector>

#include "stress/virtual_cores/internal.hpp"

namespace irt::virtual_cores {

namespace {

std::vector<Range>& code() {
  static std::vector<Range> modules;
  return modules;
}
std::vector<Range>& constants() {
  static std::vector<Range> modules;
  return modules;
}
bool is_in(const std::vector<Range>& ranges, Range bytes) {
  return std::ranges::any_of(ranges, [bytes](Range range) {
    return bytes.begin >= range.begin && bytes.end <= range.end;
  });
}

// The fault in hand; nothing else runs between its signal and its report.
int fault_signal = 0;
std::uintptr_t fault_address = 0;
std::uintptr_t fault_pc = 0;
bool stack_used_up = false;

// Whether `place`, which the code has asked for, is where the fault is. Words of up to 16 bytes are
// accessed as a whole. The kernel does not say which address it was if there can be no such one.
bool is_at(const Place& place, const siginfo_t& info) {
  if (info.si_code == SI_KERNEL)
    return place.address >> 47U != 0 && place.address >> 47U != 0x1FFFF;
  const auto address = reinterpret_cast<std::uintptr_t>(info.si_addr);
  return place.size != 0 && address >= (place.address & ~std::uintptr_t{15}) &&
         address < place.address + place.size + 15;
}

[[noreturn]] void end_without_verdict(std::uintptr_t pc) {
  Dl_info object{};
  // NOLINTNEXTLINE(performance-no-int-to-ptr): code is known by its address here
  const bool known = dladdr(reinterpret_cast<const void*>(pc), &object) != 0;
  const auto base = known ? reinterpret_cast<std::uintptr_t>(object.dli_fbase) : 0;
  dup2(refusals_to, 2);
  fmt::print(stderr,
             "irt: a crash in {} at {:#x}, outside of the code that is looked at: nothing is said "
             "about that code. --shape, --seed or --strategy may lead past it; the line above is "
             "what a report of it needs, with the command.\n",
             known ? object.dli_fname : "unknown code", pc - base);
  _exit(3);
}

// What is called instead of the instruction that failed. It needs a stack of its own, for that of
// the core may be what ran out.
alignas(16) std::array<char, 65536> report_stack;

[[noreturn]] void report_fault() {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): code is known by its address here
  const auto* pc = reinterpret_cast<const void*>(fault_pc + 1);
  switch (fault_signal) {
    case SIGILL:
      active->failed("an illegal instruction, as __builtin_trap() is one,", pc);
    case SIGFPE:
      active->failed("a division by zero, or with a result that does not fit,", pc);
    case SIGTRAP:
      active->failed("a breakpoint", pc);
    default:
      if (stack_used_up)
        active->failed("the end of the stack, by a recursion without end or large local variables,",
                       pc);
      active->failed(fmt::format("an access to memory that is not there ({:#x})", fault_address),
                     pc);
  }
}

// Signals that no access to memory is at fault for.
void on_trap(int signal, std::uintptr_t pc, ucontext_t& context) {
  if (signal == SIGTRAP) --pc;  // a breakpoint is behind it by now
  if (signal == SIGABRT || !is_code_of_a_module(pc)) end_without_verdict(pc);
  fault_signal = signal;
  fault_pc = pc;
  call_instead(context, &report_fault);
}

void on_fault(int signal, siginfo_t* info, void* raw_context) {
  if (signal == SIGTRAP && info->si_code == TRAP_TRACE)
    return single_step(*static_cast<ucontext_t*>(raw_context));
  if (current_core == host) {  // no core's fault: the instruction is repeated, and ends the process
    std::signal(signal, SIG_DFL);
    return;
  }
  auto& context = *static_cast<ucontext_t*>(raw_context);
  const auto pc = static_cast<std::uintptr_t>(context.uc_mcontext.gregs[REG_RIP]);
  if (signal != SIGSEGV && signal != SIGBUS) return on_trap(signal, pc, context);
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  const Place* const place = is_at(asked.last(), *info)     ? &asked.last()
                             : is_at(asked.before(), *info) ? &asked.before()
                                                            : nullptr;
  // A jump to nowhere has its target for pc.
  const bool jumped = pc == address;
  // The code's last call may have met the end of the stack within the runtime.
  stack_used_up = is_near_a_stack(address);
  const Place* const caller = stack_used_up ? &asked.last() : place;
  const bool known_caller =
      caller != nullptr && is_code_of_a_module(reinterpret_cast<std::uintptr_t>(caller->pc) - 1);
  if (!is_code_of_a_module(pc) && !jumped && !known_caller) end_without_verdict(pc);
  fault_signal = signal;
  fault_address = address;
  fault_pc = is_code_of_a_module(pc) || !known_caller
                 ? pc
                 : reinterpret_cast<std::uintptr_t>(caller->pc) - 1;
  call_instead(context, &report_fault);
}

}  // namespace

void call_instead(ucontext_t& context, void (*function)()) {
  auto& registers = context.uc_mcontext.gregs;
  registers[REG_RIP] = reinterpret_cast<greg_t>(function);
  // Aligned as after a call.
  registers[REG_RSP] = reinterpret_cast<greg_t>(report_stack.data() + report_stack.size() - 8);
}

void add_code(Range range) {
  code().push_back(range);
}

void add_constants(Range range) {
  constants().push_back(range);
}

bool is_code_of_a_module(std::uintptr_t address) {
  return is_in(code(), {address, address + 1});
}

bool is_constant_of_a_module(Range bytes) {
  return is_in(constants(), bytes);
}

FaultHandler::FaultHandler() {
  stack_t own{};
  own.ss_sp = stack_.data();
  own.ss_size = stack_.size();
  sigaltstack(&own, &stack_before_);
  struct sigaction action {};
  action.sa_sigaction = on_fault;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigaddset(&action.sa_mask, SIGPROF);  // which may ask for single steps
  for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &action, &before_[i]);
}

FaultHandler::~FaultHandler() {
  for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &before_[i], nullptr);
  sigaltstack(&stack_before_, nullptr);
}

}  // namespace irt::virtual_cores
