#include "stress/threads/signals.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <cxxabi.h>
#include <dlfcn.h>
#include <execinfo.h>
#include <fmt/format.h>
#include <initializer_list>
#include <link.h>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <sys/syscall.h>
#include <unistd.h>
#include <vector>

#include "stress/threads/allocator.hpp"
#include "stress/threads/sanitizer.hpp"
#include "stress/threads/standing.hpp"

namespace irt::stress {
namespace {

constexpr int stall_signal = SIGUSR2;
constexpr int trace_signal = SIGUSR1;
constexpr std::uint64_t until_released = ~std::uint64_t{0};

// One order at a time: `stall` and `suspend` are called by one thread of the process.
std::atomic<std::uint64_t> stall_time{0};
std::atomic<Slot*> held{nullptr};  ///< a signal that arrives late must not hold somebody else
int crash_descriptor = -1;

void sleep_for(std::uint64_t nanoseconds) {
  const timespec time{static_cast<time_t>(nanoseconds / 1'000'000'000U),
                      static_cast<long>(nanoseconds % 1'000'000'000U)};
  nanosleep(&time, nullptr);
}

/// In the signal handler: stands still until released, if the queue is to blame for that.
void hold(Slot& slot) {
  slot.standing = where_interrupted(slot.base.load(std::memory_order_relaxed), slot.trace);
  if (slot.standing != Standing::own) {
    slot.refused.store(true, std::memory_order_relaxed);
    return;
  }
  // (1) release: pairs with the acquire load (2), which reads the trace after it
  slot.suspended.store(true, std::memory_order_release);
  while (held.load(std::memory_order_relaxed) == &slot) sleep_for(20'000);
  slot.suspended.store(false, std::memory_order_relaxed);
}

void on_stall(int /*signal*/) {
  const int saved_errno = errno;
  Slot* slot = current_slot();
  if (slot != nullptr) {
    const std::uint64_t time = stall_time.load(std::memory_order_relaxed);
    const bool inside =
        !in_allocator() && slot->doing.load(std::memory_order_relaxed) != Doing::nothing;
    if (time != until_released) {
      if (inside) sleep_for(time);
    } else if (held.load(std::memory_order_relaxed) == slot) {
      if (inside) {
        hold(*slot);
      } else {
        slot->refused.store(true, std::memory_order_relaxed);
      }
    }
  }
  errno = saved_errno;
}

void on_trace(int /*signal*/) {
  const int saved_errno = errno;
  if (Slot* slot = current_slot(); slot != nullptr) {
    slot->standing = where_interrupted(slot->base.load(std::memory_order_relaxed), slot->trace);
    // (3) release: pairs with the acquire load (4), which reads the trace after it
    slot->traced.store(true, std::memory_order_release);
  }
  errno = saved_errno;
}

/// Only calls that are allowed in a signal handler.
void on_crash(int signal) {
  Trace trace{};
  backtrace(trace.data(), static_cast<int>(trace.size()));
  std::array<char, 1024> text{};
  std::size_t at = 0;
  const auto put = [&](std::string_view part) {
    for (const char c : part) {
      if (at < text.size()) text[at++] = c;
    }
  };
  const auto put_number = [&](std::uint64_t number) {
    std::array<char, 20> digits{};
    std::size_t n = digits.size();
    do {
      digits[--n] = static_cast<char>('0' + number % 10);
      number /= 10;
    } while (number > 0);
    put({digits.data() + n, digits.size() - n});
  };
  put("{\"crash\":");
  put_number(static_cast<std::uint64_t>(signal));
  put(",\"trace\":[0");
  for (void* address : trace) {
    if (address == nullptr) break;
    put(",");
    put_number(reinterpret_cast<std::uint64_t>(address));
  }
  put("]}\n");
  if (write(crash_descriptor, text.data(), at) < 0) _exit(5);
  _exit(4);
}

void send(const Slot& slot, int signal) {
  const pid_t thread = slot.thread.load(std::memory_order_relaxed);
  if (thread != 0) syscall(SYS_tgkill, getpid(), thread, signal);
}

/// addr2line's answers, one process for all; empty where it has none.
std::vector<std::string> source_lines(const std::string& module,
                                      const std::vector<std::uint64_t>& offsets) {
  std::vector<std::string> answers(offsets.size());
  const std::string command =
      fmt::format("addr2line -Cfsp -e '{}' {:#x} 2>/dev/null", module, fmt::join(offsets, " "));
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  if (pipe == nullptr) return answers;
  for (std::string& answer : answers) {
    for (int c = std::fgetc(pipe.get()); c != EOF && c != '\n'; c = std::fgetc(pipe.get())) {
      answer += static_cast<char>(c);
    }
    if (answer.starts_with("??")) answer.clear();
    if (const auto unknown = answer.find(" at ??:"); unknown != std::string::npos) {
      answer.resize(unknown);
    }
  }
  return answers;
}

std::string own_path() {
  std::array<char, 4096> path{};
  const ssize_t size = readlink("/proc/self/exe", path.data(), path.size());
  return {path.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

struct Place {
  std::string module;        ///< its file; empty where none is known
  std::uint64_t offset = 0;  ///< in that
  std::string name;          ///< without a line of source
};

Place place_of(void* address) {
  Dl_info info{};
  link_map* map = nullptr;
  if (dladdr1(address, &info, reinterpret_cast<void**>(&map), RTLD_DL_LINKMAP) == 0) {
    return {.module = {}, .name = fmt::format("{}", address)};
  }
  // A return address points behind the call.
  Place place{.module = map->l_name[0] != '\0' ? map->l_name : own_path(),
              .offset = reinterpret_cast<std::uint64_t>(address) - map->l_addr - 1,
              .name = {}};
  if (info.dli_sname == nullptr) {
    place.name = fmt::format("{}+{:#x}", std::strrchr(info.dli_fname, '/') + 1, place.offset);
    return place;
  }
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> name(
      abi::__cxa_demangle(info.dli_sname, nullptr, nullptr, &status), std::free);
  place.name = status == 0 ? name.get() : info.dli_sname;
  return place;
}

std::vector<std::string> lines_of(const std::vector<Place>& places) {
  std::map<std::string, std::vector<std::size_t>> in;
  for (std::size_t i = 0; i < places.size(); ++i) in[places[i].module].push_back(i);
  std::vector<std::string> lines(places.size());
  for (const auto& [module, indices] : in) {
    std::vector<std::uint64_t> offsets;
    offsets.reserve(indices.size());
    for (const std::size_t i : indices) offsets.push_back(places[i].offset);
    std::vector<std::string> answers(indices.size());
    if (!module.empty()) answers = source_lines(module, offsets);
    for (std::size_t i = 0; i < indices.size(); ++i) {
      lines[indices[i]] = answers[i].empty() ? places[indices[i]].name : answers[i];
    }
  }
  return lines;
}

}  // namespace

Slot*& current_slot() {
  static thread_local Slot* slot = nullptr;
  return slot;
}

Presence::Presence(Slot& slot) {
  current_slot() = &slot;
  slot.thread.store(static_cast<pid_t>(syscall(SYS_gettid)), std::memory_order_relaxed);
}

Presence::~Presence() {
  current_slot()->thread.store(0, std::memory_order_relaxed);
  current_slot() = nullptr;
}

void install_signals() {
  Trace warm_up{};
  backtrace(warm_up.data(), static_cast<int>(warm_up.size()));
  know_machinery();
  struct sigaction action {};
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  action.sa_handler = on_stall;
  sigaction(stall_signal, &action, nullptr);
  action.sa_handler = on_trace;
  sigaction(trace_signal, &action, nullptr);
}

void stall(const Slot& slot, std::uint64_t nanoseconds) {
  stall_time.store(nanoseconds, std::memory_order_relaxed);
  send(slot, stall_signal);
}

bool suspend(Slot& slot) {
  stall_time.store(until_released, std::memory_order_relaxed);
  slot.refused.store(false, std::memory_order_relaxed);
  held.store(&slot, std::memory_order_relaxed);
  send(slot, stall_signal);
  for (int i = 0; i < 100; ++i) {
    // (2) acquire: pairs with the release store (1)
    if (slot.suspended.load(std::memory_order_acquire)) return true;
    if (slot.refused.load(std::memory_order_relaxed)) break;
    sleep_for(5'000);
  }
  release(slot);
  return false;
}

void release(Slot& slot) {
  held.store(nullptr, std::memory_order_relaxed);
  while (slot.suspended.load(std::memory_order_relaxed)) sleep_for(5'000);
}

bool ask_trace(Slot& slot) {
  slot.traced.store(false, std::memory_order_relaxed);
  send(slot, trace_signal);
  for (int i = 0; i < 500; ++i) {
    // (4) acquire: pairs with the release store (3)
    if (slot.traced.load(std::memory_order_acquire)) return true;
    sleep_for(1'000'000);
  }
  return false;
}

std::vector<std::string> describe(const Trace& trace) {
  std::vector<Place> places;
  for (void* address : trace) {
    if (address == nullptr) break;
    places.push_back(place_of(address));
  }
  std::vector<std::string> lines = lines_of(places);
  // Of a crash: the handler and the kernel's trampoline stand above what was interrupted; the
  // runner of the suite stands below.
  const auto has = [](const std::string& line, std::initializer_list<std::string_view> words) {
    return std::ranges::any_of(
        words, [&](std::string_view word) { return line.find(word) != std::string::npos; });
  };
  const auto handler = std::find_if(lines.rbegin(), lines.rend(), [&](const std::string& line) {
    return has(line, {"__restore_rt", "sigaction", "on_crash"});
  });
  lines.erase(lines.begin(), handler.base());
  const auto runner = std::ranges::find_if(lines, [&](const std::string& line) {
    return has(line, {"irt::stress::Core::", "(irt::stress::Core&)",
                      "irt::stress::Team::", "ProgressRun", "start_thread"});
  });
  lines.erase(runner, lines.end());
  return lines;
}

void report_crashes_to(int descriptor) {
  if (sanitizer != Sanitizer::none) return;
  crash_descriptor = descriptor;
  for (const int signal : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT}) std::signal(signal, on_crash);
}

}  // namespace irt::stress
