#include <algorithm>
#include <boost/context/detail/fcontext.hpp>
#include <cstring>
#include <cxxabi.h>
#include <exception>
#include <stdexcept>
#include <string>
#include <sys/mman.h>
#include <utility>

#include "stress/virtual_cores/internal.hpp"

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace irt::virtual_cores {

namespace {

namespace fibers = boost::context::detail;

// Of a stack: what the calls between an access of the code and the next switch have there.
constexpr std::size_t prefetched_bytes = 512;

// A pass-through for code that runs outside of the cores: the module's global constructors.
Tenant native;

// Stacks lie at an address of their own so that pointers to them are the same in every run.
constexpr std::uintptr_t stacks_address = 0x100000000000;
std::uintptr_t stacks_end = stacks_address;

// Stacks begin at different offsets within a page, or the frames of all cores would compete for the
// same few sets of the host's first cache.
constexpr std::size_t colours = 64, colour_bytes = 64;
constexpr std::size_t colours_bytes = colours * colour_bytes;

// The C++ runtime's per-thread exception state, which belongs to a core here. The layout is the
// ABI's __cxa_eh_globals.
struct ExceptionState {
  void* caught;
  unsigned uncaught;
};

// The one of the operating-system thread that runs the cores.
ExceptionState* exception_state = nullptr;

struct alignas(64) Fiber {
  fibers::fcontext_t context;  ///< the top of its stack
  ExceptionState exceptions;
  Asked asked;
  void (*entry)(void*);
  void* argument;
  bool fresh;  ///< was never switched to
};

}  // namespace

Tenant* active = &native;
unsigned current_core = host;

namespace {
Cores* existing = nullptr;
}  // namespace

struct Cores::State {
  Tenant& tenant;
  std::size_t stack_bytes;
  // Below each stack, for large local variables to end in.
  std::size_t guard_bytes = std::max(page_bytes, stack_bytes / 8 / page_bytes * page_bytes);
  std::vector<Fiber> fibers;
  Fiber outside{};
  Fiber* here = &outside;  // in progress
  FaultHandler faults{};

  [[nodiscard]] std::size_t stride() const { return guard_bytes + stack_bytes + colours_bytes; }

  void switch_to(unsigned core) {
    Fiber& from = *here;
    Fiber& to = core == host ? outside : fibers[core];
    here = &to;
    current_core = core;
    from.exceptions = std::exchange(*exception_state, to.exceptions);
    from.asked = std::exchange(asked, to.asked);
    if (to.fresh) {
      to.fresh = false;
      arrive(fibers::jump_fcontext(to.context, &from));
    } else {
      fibers::ontop_fcontext(to.context, &from, arrive);
    }
  }

  // Runs on the fiber that was switched to, and returns to where that one left off. So each switch
  // is a call and a return to the processor, which then predicts the fiber's other returns too.
  static fibers::transfer_t arrive(fibers::transfer_t came_from) {
    static_cast<Fiber*>(came_from.data)->context = came_from.fctx;
    return came_from;
  }

  static State* running;

  static void begin(fibers::transfer_t came_from) {
    arrive(came_from);
    State& self = *running;
    const unsigned core = current_core;
    const Fiber& me = self.fibers[core];
    try {
      me.entry(me.argument);
      run_thread_exits(core);
    } catch (const std::exception& error) {
      self.tenant.failed("an exception left a thread: " + std::string(error.what()), nullptr);
    } catch (...) {
      self.tenant.failed(
          "an exception left a thread: " + demangled(abi::__cxa_current_exception_type()->name()),
          nullptr);
    }
    end_core();
  }
};

Cores::State* Cores::State::running = nullptr;

void end_core() {
  existing->switch_to(active->finished(current_core));
  active->failed("a finished core was switched to", nullptr);
}

bool is_near_a_stack(std::uintptr_t address) {
  return address >= stacks_address && address < stacks_end;
}

Cores::Cores(Tenant& tenant, unsigned count, std::size_t stack_bytes)
    : state_(new State{
          .tenant = tenant, .stack_bytes = stack_bytes, .fibers = std::vector<Fiber>(count)}) {
  if (State::running != nullptr)
    throw std::logic_error("virtual cores: one object exists already; destroy it first");
  const std::size_t bytes = count * state_->stride();
  void* stacks = mmap(reinterpret_cast<void*>(stacks_address), bytes, PROT_NONE,
                      MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED_NOREPLACE, -1, 0);
  if (stacks == MAP_FAILED)
    throw std::runtime_error("virtual cores: no room for " + std::to_string(bytes) +
                             " bytes of stacks: " + std::strerror(errno));
  for (unsigned core = 0; core < count; ++core)
    mprotect(reinterpret_cast<void*>(stack_of(core) / page_bytes * page_bytes),
             stack_bytes + colours_bytes, PROT_READ | PROT_WRITE);
  State::running = state_.get();
  existing = this;
  stacks_end = stacks_address + bytes;
}

Cores::~Cores() {
  munmap(reinterpret_cast<void*>(stacks_address), count() * state_->stride());
  State::running = nullptr;
}

void Cores::arm(unsigned core, void (*entry)(void*), void* argument) {
  forget_thread_locals(core);
  Fiber& fiber = state_->fibers[core];
  fiber = {nullptr, {}, {}, entry, argument, true};
  fiber.context =
      fibers::make_fcontext(reinterpret_cast<void*>(stack_of(core) + state_->stack_bytes),
                            state_->stack_bytes, State::begin);
}

void Cores::run(unsigned first) {
  active = &state_->tenant;
  exception_state = reinterpret_cast<ExceptionState*>(abi::__cxa_get_globals());
  const std::terminate_handler before = std::set_terminate([] {
    if (current_core == host) std::abort();
    active->failed("std::terminate was called: an exception met a noexcept function or none",
                   nullptr);
  });
  state_->switch_to(first);
  std::set_terminate(before);
  active = &native;
}

void Cores::switch_to(unsigned core) {
  if (core != current_core) state_->switch_to(core);
}

void Cores::prefetch(unsigned core) const {
  const char* const top = static_cast<const char*>(state_->fibers[core].context);
#pragma GCC unroll 8
  for (std::size_t i = 0; i < prefetched_bytes; i += 64) __builtin_prefetch(top + i);
}

unsigned Cores::count() const {
  return static_cast<unsigned>(state_->fibers.size());
}
std::size_t Cores::stack_bytes() const {
  return state_->stack_bytes;
}
Range Cores::frames_of(unsigned core) const {
  return {address_of(state_->fibers[core].context), stack_of(core) + state_->stack_bytes};
}
std::uintptr_t Cores::stack_of(unsigned core) const {
  return stacks_address + core * state_->stride() + state_->guard_bytes +
         core % colours * colour_bytes;
}

}  // namespace irt::virtual_cores
// NOLINTEND(performance-no-int-to-ptr)
