/// Waiting for another thread without a lock: pause first, then give the core away.
#pragma once

#include <thread>

namespace irt {

/// Call it once per failed attempt. The first attempts cost a few cycles; from then on the core is
/// yielded, because the thread waited for may be the one that has no core.
class SpinWait {
 public:
  void operator()() {
    if (attempts_ < attempts_before_yield) {
      for (unsigned i = 0; i < (1u << attempts_); ++i) pause();
      ++attempts_;
    } else {
      std::this_thread::yield();
    }
  }

  void reset() { attempts_ = 0; }

 private:
  static constexpr unsigned attempts_before_yield = 6;

  static void pause() {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    asm volatile("yield");
#endif
  }

  unsigned attempts_ = 0;
};

}  // namespace irt
