/// Which sanitizer this program was built with.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace irt::stress {

enum class Sanitizer : std::uint8_t { none, thread, address };

#if defined(__SANITIZE_THREAD__)
inline constexpr Sanitizer sanitizer = Sanitizer::thread;
#elif defined(__SANITIZE_ADDRESS__)
inline constexpr Sanitizer sanitizer = Sanitizer::address;
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
inline constexpr Sanitizer sanitizer = Sanitizer::thread;
#elif __has_feature(address_sanitizer)
inline constexpr Sanitizer sanitizer = Sanitizer::address;
#else
inline constexpr Sanitizer sanitizer = Sanitizer::none;
#endif
#else
inline constexpr Sanitizer sanitizer = Sanitizer::none;
#endif

constexpr std::string_view sanitizer_name() {
  switch (sanitizer) {
    case Sanitizer::none:
      return "none";
    case Sanitizer::thread:
      return "tsan";
    case Sanitizer::address:
      return "asan";
  }
  return "?";
}

/// Reports that ThreadSanitizer leaves out, each for a reason that its maintainers know.
struct Suppression {
  std::string_view pattern;  ///< as ThreadSanitizer reads it
  std::string_view issue;    ///< where it stands upstream
  std::string_view reason;
};
std::span<const Suppression> suppressions();

/// How many fences this process and its children have executed, since `forget_fences`, that
/// ThreadSanitizer does not understand. Always 0 without ThreadSanitizer.
std::uint64_t fences_executed();
void forget_fences();

/// From now on ThreadSanitizer takes every atomic access of this process as acquire and release:
/// what it still reports is a race whatever the fences do. Nothing without ThreadSanitizer.
void strengthen_atomics();

}  // namespace irt::stress
