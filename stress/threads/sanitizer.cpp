#include "stress/threads/sanitizer.hpp"

#include <array>
#include <cstddef>
#include <sys/mman.h>

namespace {
constexpr std::array suppressed{
    irt::stress::Suppression{"race:boost::lockfree", "boostorg/lockfree#78",
                             "reads a node that may be in use again, and discards what it read"},
    irt::stress::Suppression{"race:tbb::detail", "uxlfoundation/oneTBB#1290",
                             "the library's allocator is not instrumented, so that the reuse of "
                             "its pages looks like a race"},
};
/// One pattern a line. A constant: ThreadSanitizer asks before anything can be called.
constexpr auto suppression_lines = [] {
  std::array<char, 128> text{};
  std::size_t at = 0;
  for (const irt::stress::Suppression& s : suppressed) {
    for (const char c : s.pattern) text.at(at++) = c;
    text.at(at++) = '\n';
  }
  return text;
}();
}  // namespace

std::span<const irt::stress::Suppression> irt::stress::suppressions() {
  return suppressed;
}

// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming)
// Options that make the first report end the process with an exit code of its own. The names are
// the sanitizers' own interface.
extern "C" const char* __tsan_default_options();
extern "C" const char* __tsan_default_options() {
  return "halt_on_error=1:exitcode=66:history_size=4:report_signal_unsafe=0";
}
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() {
  return suppression_lines.data();
}
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "exitcode=67:detect_leaks=1:detect_stack_use_after_return=0:alloc_dealloc_mismatch=1";
}
extern "C" const char* __ubsan_default_options();
extern "C" const char* __ubsan_default_options() {
  return "halt_on_error=1:print_stacktrace=1:exitcode=68";
}

namespace {
/// In memory that parent and children share: a child that ThreadSanitizer ends can say no more.
std::uint64_t* const fences = [] {
  void* page = mmap(nullptr, sizeof(std::uint64_t), PROT_READ | PROT_WRITE,
                    MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  static std::uint64_t own = 0;
  return page == MAP_FAILED ? &own : static_cast<std::uint64_t*>(page);
}();
}  // namespace

std::uint64_t irt::stress::fences_executed() {
  return __atomic_load_n(fences, __ATOMIC_RELAXED);
}
void irt::stress::forget_fences() {
  __atomic_store_n(fences, 0, __ATOMIC_RELAXED);
}

#if defined(__SANITIZE_THREAD__)
// The linker's --wrap leads every std::atomic_thread_fence of instrumented code through here. The
// counter is touched without instrumentation, so that it orders nothing in TSan's eyes.
extern "C" void __real___tsan_atomic_thread_fence(int order);
extern "C" void __wrap___tsan_atomic_thread_fence(int order);
extern "C" __attribute__((no_sanitize("thread"))) void __wrap___tsan_atomic_thread_fence(
    int order) {
  if (fences != nullptr) __atomic_fetch_add(fences, 1, __ATOMIC_RELAXED);
  __real___tsan_atomic_thread_fence(order);
}
#endif
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)
