#include "stress/threads/sanitizer.hpp"

#include <array>
#include <cstddef>

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
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)
