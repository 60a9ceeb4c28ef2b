#include "stress/threads/sanitizer.hpp"

#include <atomic>

// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming)
// Options that make the first report end the process with an exit code of its own. The names are
// the sanitizers' own interface.
extern "C" const char* __tsan_default_options();
extern "C" const char* __tsan_default_options() {
  return "halt_on_error=1:exitcode=66:history_size=4:report_signal_unsafe=0";
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
std::atomic<std::uint64_t> fences{0};
}  // namespace

std::uint64_t irt::stress::fences_executed() {
  return fences.load(std::memory_order_relaxed);
}

#if defined(__SANITIZE_THREAD__)
// The linker's --wrap leads every std::atomic_thread_fence of instrumented code through here. The
// counter is touched without instrumentation, so that it orders nothing in TSan's eyes.
extern "C" void __real___tsan_atomic_thread_fence(int order);
extern "C" void __wrap___tsan_atomic_thread_fence(int order);
extern "C" __attribute__((no_sanitize("thread"))) void __wrap___tsan_atomic_thread_fence(
    int order) {
  __atomic_fetch_add(reinterpret_cast<std::uint64_t*>(&fences), 1, __ATOMIC_RELAXED);
  __real___tsan_atomic_thread_fence(order);
}
#endif
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)
