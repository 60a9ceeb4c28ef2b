#include "stress/threads/standing.hpp"

#include <algorithm>
#include <array>
#include <dlfcn.h>
#include <elf.h>
#include <link.h>
#include <sys/auxv.h>
#include <unwind.h>
#include <vector>

namespace irt::stress {
namespace {

struct Range {
  std::uintptr_t begin = 0;
  std::uintptr_t end = 0;

  [[nodiscard]] bool contains(std::uintptr_t address) const {
    return begin <= address && address < end;
  }
};
using Ranges = std::vector<Range>;

bool contain(const Ranges& ranges, std::uintptr_t address) {
  return std::ranges::any_of(ranges, [&](const Range& range) { return range.contains(address); });
}

Ranges machinery;     ///< all that is no queue's
Ranges unwinder;      ///< the part of it that walks stacks, and leaves them by a jump
Ranges static_guard;  ///< the part of it that waits for the first use of a local static
/// The part of it that a queue calls to lock, to wait or to nap: held there, a thread holds what
/// the queue let it hold and no lock of the library's.
Ranges own_waits;

/// One symbol of each object that is machinery; which is the object's business.
constexpr std::array machinery_symbols{"getpid", "pthread_create", "dlopen", "__cxa_throw",
                                       "_Unwind_Backtrace"};

constexpr std::array wait_symbols{
    "pthread_mutex_lock",
    "pthread_mutex_trylock",
    "pthread_mutex_timedlock",
    "pthread_mutex_clocklock",
    "pthread_mutex_unlock",
    "pthread_rwlock_rdlock",
    "pthread_rwlock_tryrdlock",
    "pthread_rwlock_wrlock",
    "pthread_rwlock_trywrlock",
    "pthread_rwlock_unlock",
    "pthread_spin_lock",
    "pthread_spin_trylock",
    "pthread_spin_unlock",
    "pthread_barrier_wait",
    "pthread_cond_wait",
    "pthread_cond_timedwait",
    "pthread_cond_clockwait",
    "pthread_cond_signal",
    "pthread_cond_broadcast",
    "_ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE",
    "_ZNSt18condition_variable10notify_oneEv",
    "_ZNSt18condition_variable10notify_allEv",
    "sem_wait",
    "sem_trywait",
    "sem_timedwait",
    "sem_clockwait",
    "sem_post",
    "syscall",
    "sched_yield",
    "nanosleep",
    "clock_nanosleep",
    "usleep",
};

/// The mapped segments of the object that has an address in `inside`.
struct Search {
  std::uintptr_t inside;
  Ranges* found;
};
int add_segments(dl_phdr_info* info, std::size_t /*size*/, void* data) {
  const auto& search = *static_cast<Search*>(data);
  Ranges segments;
  for (unsigned i = 0; i < info->dlpi_phnum; ++i) {
    const auto& header = info->dlpi_phdr[i];
    if (header.p_type != PT_LOAD) continue;
    const std::uintptr_t begin = info->dlpi_addr + header.p_vaddr;
    segments.push_back({begin, begin + header.p_memsz});
  }
  if (!contain(segments, search.inside)) return 0;
  search.found->insert(search.found->end(), segments.begin(), segments.end());
  return 1;
}
void add_object(std::uintptr_t inside, Ranges& to) {
  Search search{inside, &to};
  if (inside != 0) dl_iterate_phdr(add_segments, &search);
}

void add_function(const char* name, Ranges& to) {
  void* at = dlsym(RTLD_DEFAULT, name);
  Dl_info info{};
  void* symbol = nullptr;
  if (at == nullptr || dladdr1(at, &info, &symbol, RTLD_DL_SYMENT) == 0 || symbol == nullptr) {
    return;
  }
  const auto begin = reinterpret_cast<std::uintptr_t>(at);
  to.push_back({begin, begin + static_cast<const ElfW(Sym)*>(symbol)->st_size});
}

/// A walk over the frames of an interrupted thread, from the innermost outwards.
struct Walk {
  std::uintptr_t base;
  Trace& trace;
  std::size_t frames = 0;
  bool interrupted = false;  ///< past the signal handler's own frames
  bool complete = false;     ///< has come to the method's caller
  bool library = false;      ///< somewhere the queue called machinery that is no wait
  bool guard = false;        ///< the first use of a local static
  std::uintptr_t entry = 0;  ///< the outermost frame of machinery since the queue's last; 0: none

  /// The frames of machinery since the queue's last are all: the queue called them through `entry`.
  void leave_machinery() {
    if (entry == 0) return;
    if (contain(static_guard, entry)) guard = true;
    if (!contain(own_waits, entry)) library = true;
    entry = 0;
  }

  void see(std::uintptr_t address, bool returns_there) {
    if (frames < trace.size()) {
      // NOLINTNEXTLINE(performance-no-int-to-ptr): the trace's form
      trace[frames++] = reinterpret_cast<void*>(address);
    }
    // A call at the very end of a function returns behind the function.
    if (returns_there) --address;
    if (contain(machinery, address)) {
      entry = address;
    } else {
      leave_machinery();
    }
  }
};

_Unwind_Reason_Code step(_Unwind_Context* context, void* data) {
  Walk& walk = *static_cast<Walk*>(data);
  int exact = 0;
  const std::uintptr_t address = _Unwind_GetIPInfo(context, &exact);
  if (address == 0) return _URC_END_OF_STACK;
  // Only the frame that a signal interrupted stands at the address itself, not behind a call.
  const bool innermost = exact != 0 && !walk.interrupted;
  walk.interrupted = walk.interrupted || innermost;
  if (!walk.interrupted) return _URC_NO_REASON;
  // What the unwinder calls the CFA here is the stack pointer of the frame.
  if (walk.base != 0 && _Unwind_GetCFA(context) >= walk.base) {
    walk.complete = true;
    return _URC_END_OF_STACK;
  }
  walk.see(address, exact == 0);
  // Where it lands after a throw, the unwinder leaves a stack that nobody can walk.
  if (innermost && contain(unwinder, address)) return _URC_END_OF_STACK;
  return _URC_NO_REASON;
}

}  // namespace

void know_machinery() {
  machinery.clear();
  unwinder.clear();
  static_guard.clear();
  own_waits.clear();
  for (const char* name : machinery_symbols) {
    add_object(reinterpret_cast<std::uintptr_t>(dlsym(RTLD_DEFAULT, name)), machinery);
  }
  add_object(reinterpret_cast<std::uintptr_t>(dlsym(RTLD_DEFAULT, "_Unwind_Backtrace")), unwinder);
  add_object(getauxval(AT_BASE), machinery);
  add_object(getauxval(AT_SYSINFO_EHDR), machinery);
  for (const char* name : wait_symbols) add_function(name, own_waits);
  add_function("__cxa_guard_acquire", static_guard);
  Trace warm_up{};
  where_interrupted(nullptr, warm_up);
}

Standing where_interrupted(const void* base, Trace& trace) {
  trace.fill(nullptr);
  Walk walk{.base = reinterpret_cast<std::uintptr_t>(base), .trace = trace};
  _Unwind_Backtrace(step, &walk);
  if (!walk.complete || walk.frames == 0) return Standing::outside;
  walk.leave_machinery();
  if (walk.guard) return Standing::static_guard;
  return walk.library ? Standing::library : Standing::own;
}

const void* own_stack_pointer() {
  return __builtin_dwarf_cfa();
}

}  // namespace irt::stress
