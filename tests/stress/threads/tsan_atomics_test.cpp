// What the operations of tsan_atomics.cpp do for code under ThreadSanitizer.
#include <atomic>
#include <cstdint>
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <thread>

#include "running.hpp"
#include "stress/threads/sanitizer.hpp"

namespace irt::stress {
namespace {

const QueueEntry& from_plugin(bool racy) {
  void* object = dlopen(IRT_FENCED_PLUGIN, RTLD_NOW | RTLD_LOCAL);
  EXPECT_NE(object, nullptr) << dlerror();
  return *reinterpret_cast<const QueueEntry* (*)(bool)>(dlsym(object, "irt_fenced"))(racy);
}

TEST(TsanAtomics, FencesOfAPluginAreALimitToo) {
  if (sanitizer != Sanitizer::thread) GTEST_SKIP() << "the other builds do not look at races";
  const Result result = run_on(from_plugin(false), "spsc");
  EXPECT_EQ(claim_of(result), "nothing") << result.findings[0].evidence;
  EXPECT_TRUE(result.figures.contains("strengthened"));
}

TEST(TsanAtomics, ARaceOfAPluginThatNoFenceCoversIsAFinding) {
  if (sanitizer != Sanitizer::thread) GTEST_SKIP() << "the other builds do not look at races";
  EXPECT_EQ(claim_of(run_on(from_plugin(true), "spsc", 2)), "free of data races (ThreadSanitizer)");
}

#if defined(__x86_64__)

struct alignas(16) Halves {
  std::uint64_t low = 0, high = 0;
};

__attribute__((target("cx16"))) void count_low(Halves& halves) {
  __extension__ using Wide = unsigned __int128;
  auto& whole = reinterpret_cast<Wide&>(halves);
  for (Wide seen = 0;;) {
    const Wide was = __sync_val_compare_and_swap(&whole, seen, seen + 1);
    if (was == seen) return;
    seen = was;
  }
}

TEST(TsanAtomics, OperationsOf16BytesAreAtomicBesideThoseOf8) {
  constexpr std::uint64_t times = 3'000'000;
  Halves halves;
  std::atomic<bool> done{false};
  std::uint64_t narrow_times = 0;
  std::thread narrow([&] {
    for (; !done.load(std::memory_order_relaxed); ++narrow_times)
      __atomic_fetch_add(&halves.high, 1, __ATOMIC_RELAXED);
  });
  for (std::uint64_t i = 0; i < times; ++i) count_low(halves);
  done = true;
  narrow.join();
  EXPECT_EQ(halves.low, times);
  EXPECT_EQ(halves.high, narrow_times);
}

#endif

}  // namespace
}  // namespace irt::stress
