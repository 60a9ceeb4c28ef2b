// Code that goes on without an event, looked at instruction by instruction.
//
// A timer of the processor's time interrupts the core now and then. If nothing has happened for a
// while but computation, its next instructions are made one at a time (the processor's trap flag),
// and its state is compared with an earlier one: Brent's cycle detection (1980) over registers,
// vectors and stack. If the state comes back, and all instructions in between only computed
// (pure.hpp), it will come back for ever. Whether anything else has no end is not asked.

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <sys/time.h>
#include <ucontext.h>

#include "stress/virtual_cores/internal.hpp"
#include "stress/virtual_cores/pure.hpp"

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

// What computing code may call: it changes nothing that anybody could look at.
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
void __tsan_func_entry(void*);
void __tsan_func_exit();
int irt_vc_sched_yield();
void irt_vc_cpu_pause();
int irt_vc_usleep(unsigned);
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
}

namespace irt::virtual_cores {

namespace {

constexpr double tick_seconds = 0.01;
constexpr std::uintptr_t red_zone = 128;
constexpr greg_t trap_flag = 0x100, resume_flag = 0x10000;
// Of FXSAVE's area: what is behind belongs to the kernel.
constexpr std::size_t vector_bytes = 416;
// A search takes that many, ten microseconds each at worst, and is made again after twice the time.
constexpr unsigned fewest_instructions = 512, most_instructions = 8'192;

template <class F>
std::uintptr_t address_of_function(F* function) {
  return reinterpret_cast<std::uintptr_t>(function);
}

bool is_neutral(std::uintptr_t entry) {
  return entry == address_of_function(&__tsan_func_entry) ||
         entry == address_of_function(&__tsan_func_exit) ||
         entry == address_of_function(&irt_vc_sched_yield) ||
         entry == address_of_function(&irt_vc_cpu_pause) ||
         entry == address_of_function(&irt_vc_usleep);
}

/// All that computing code can tell two moments by.
class State {
 public:
  explicit State(std::size_t stack_bytes)
      : stack_(std::make_unique_for_overwrite<char[]>(stack_bytes + red_zone)) {}

  void take(const ucontext_t& context, std::uintptr_t stack_end) {
    registers_ = registers_of(context);
    std::memcpy(vectors_.data(), context.uc_mcontext.fpregs, vector_bytes);
    const char* top = top_of(context);
    std::memcpy(stack_.get(), top, bytes_from(top, stack_end));
  }
  [[nodiscard]] bool is(const ucontext_t& context, std::uintptr_t stack_end) const {
    if (registers_ != registers_of(context)) return false;
    const char* top = top_of(context);
    return std::memcmp(vectors_.data(), context.uc_mcontext.fpregs, vector_bytes) == 0 &&
           std::memcmp(stack_.get(), top, bytes_from(top, stack_end)) == 0;
  }

 private:
  using Registers = std::array<greg_t, REG_EFL + 1>;

  static Registers registers_of(const ucontext_t& context) {
    Registers result;
    std::copy_n(context.uc_mcontext.gregs, result.size(), result.begin());
    result[REG_EFL] &= ~(trap_flag | resume_flag);
    return result;
  }
  static std::size_t bytes_from(const char* top, std::uintptr_t stack_end) {
    return stack_end - reinterpret_cast<std::uintptr_t>(top);
  }
  static const char* top_of(const ucontext_t& context) {
    return reinterpret_cast<const char*>(context.uc_mcontext.gregs[REG_RSP]) - red_zone;
  }

  Registers registers_{};
  std::array<char, vector_bytes> vectors_{};
  std::unique_ptr<char[]> stack_;
};

/// Whether a state comes back, by one that is marked and replaced after ever longer.
class Cycle {
 public:
  explicit Cycle(std::size_t stack_bytes) : mark_(stack_bytes) {}

  void begin() {
    since_ = power_ = 0;
    pure_ = inside_ = false;
  }

  /// The next instruction is at `pc`, the code's `own` or one that it has called. True if the state
  /// is that of the mark, and nothing but computation lies between.
  bool closes(const ucontext_t& context, std::uintptr_t pc, bool own, Range stack) {
    if (!own && inside_) pure_ = pure_ && is_neutral(pc);
    inside_ = own;
    if (own && look(context, pc, stack)) return true;
    ++since_;
    return false;
  }

  /// The first instruction of the frame that calls all others in it.
  [[nodiscard]] std::uintptr_t place() const { return place_; }

 private:
  bool look(const ucontext_t& context, std::uintptr_t pc, Range stack) {
    const auto top = static_cast<std::uintptr_t>(context.uc_mcontext.gregs[REG_RSP]);
    if (top < stack.begin + red_zone || top > stack.end) {
      pure_ = false;
      return false;
    }
    const bool again = power_ != 0 && mark_.is(context, stack.end);
    if (again && pure_) return true;
    if (again || since_ >= power_) {
      mark_.take(context, stack.end);
      power_ = std::max(2 * power_, 1U);
      since_ = 0;
      pure_ = true;
      place_ = outermost_ = 0;
    }
    if (top > outermost_ || (top == outermost_ && pc < place_)) {
      outermost_ = top;
      place_ = pc;
    }
    pure_ = pure_ && only_computes(context, stack);
    return false;
  }

  State mark_;
  unsigned since_ = 0, power_ = 0;  ///< instructions, and after how many a mark is replaced
  bool pure_ = false;               ///< since the mark
  std::uintptr_t place_ = 0, outermost_ = 0;
  bool inside_ = false;  ///< the last instruction was the code's own
};

struct Report {
  std::uintptr_t pc = 0;
  bool endless = false;
  double seconds = 0;
} report;

[[noreturn]] void report_spin();

}  // namespace

struct SpinWatch::Search {
  Search(const Cores& c, Computing& told) : cores(c), computing(told), cycle(c.stack_bytes()) {}

  const Cores& cores;
  Computing& computing;
  unsigned core = host;
  std::uint64_t beats = 0;
  double seconds = 0;         ///< without a beat
  double next = 0;            ///< search then ...
  unsigned instructions = 0;  ///< ... through so many
  bool searching = false;
  unsigned made = 0;
  Cycle cycle;

  static Search* running;
  struct sigaction before {};

  void forget() {
    core = current_core;
    beats = computing.beats();
    seconds = 0;
    next = 2 * tick_seconds;
    instructions = fewest_instructions;
  }

  void tick(ucontext_t& context) {
    if (current_core != core || core == host || computing.beats() != beats) return forget();
    seconds += tick_seconds;
    if (!computing.patient(seconds)) {
      // The runtime and the tenant must not be left in the middle of what they do.
      const auto pc = static_cast<std::uintptr_t>(context.uc_mcontext.gregs[REG_RIP]);
      if (is_code_of_a_module(pc)) conclude(context, pc, false);
      return;
    }
    // The code may have put back flags of before.
    if (searching) context.uc_mcontext.gregs[REG_EFL] |= trap_flag;
    if (searching || seconds < next) return;
    searching = true;
    next *= 2;
    instructions = std::min(2 * instructions, most_instructions);
    made = 0;
    cycle.begin();
    context.uc_mcontext.gregs[REG_EFL] |= trap_flag;
  }

  void end(ucontext_t& context) {
    searching = false;
    context.uc_mcontext.gregs[REG_EFL] &= ~trap_flag;
  }

  void conclude(ucontext_t& context, std::uintptr_t pc, bool endless) {
    end(context);
    report = {pc, endless, seconds};
    call_instead(context, &report_spin);
  }

  void step(ucontext_t& context) {
    if (current_core != core || computing.beats() != beats) {
      forget();
      return end(context);
    }
    const auto pc = static_cast<std::uintptr_t>(context.uc_mcontext.gregs[REG_RIP]);
    const bool own = is_code_of_a_module(pc);
    ++made;
    const std::uintptr_t bottom = cores.stack_of(core);
    if (cycle.closes(context, pc, own, {bottom, bottom + cores.stack_bytes()}))
      return conclude(context, cycle.place(), true);
    if (made == instructions) end(context);
  }

  static void on_tick(int, siginfo_t*, void* context) {
    running->tick(*static_cast<ucontext_t*>(context));
  }
};

SpinWatch::Search* SpinWatch::Search::running = nullptr;

namespace {

void report_spin() {
  SpinWatch::Search::running->computing.spins(reinterpret_cast<const void*>(report.pc + 1),
                                              report.endless, report.seconds);
  std::abort();
}

}  // namespace

void single_step(ucontext_t& context) {
  SpinWatch::Search* const search = SpinWatch::Search::running;
  if (search != nullptr && search->searching)
    search->step(context);
  else  // the code has put back flags of before
    context.uc_mcontext.gregs[REG_EFL] &= ~trap_flag;
}

SpinWatch::SpinWatch(const Cores& cores, Computing& computing)
    : search_(new Search(cores, computing)) {
  Search::running = search_.get();
  struct sigaction action {};
  action.sa_sigaction = Search::on_tick;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESTART;
  sigaddset(&action.sa_mask, SIGTRAP);
  sigaction(SIGPROF, &action, &search_->before);
  constexpr timeval tick{0, static_cast<suseconds_t>(tick_seconds * 1e6)};
  const itimerval timer{tick, tick};
  setitimer(ITIMER_PROF, &timer, nullptr);
}

SpinWatch::~SpinWatch() {
  const itimerval none{};
  setitimer(ITIMER_PROF, &none, nullptr);
  sigaction(SIGPROF, &search_->before, nullptr);
  Search::running = nullptr;
}

}  // namespace irt::virtual_cores
// NOLINTEND(performance-no-int-to-ptr)
