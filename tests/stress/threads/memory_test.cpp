// Memory that grows for ever is told from batches, caches and high-water marks.
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "broken_queues.hpp"
#include "reclaimers.hpp"
#include "running.hpp"
#include "stress/threads/low_water.hpp"
#include "stress/threads/sanitizer.hpp"

namespace irt::stress {
namespace {

using Growth = LowWater::Growth;

/// The verdict on a queue that holds `held(n)` bytes from n pushes, when it has seen so many.
Growth after(std::uint64_t pushes, const std::function<double(double)>& held) {
  LowWater low_water;
  std::uint64_t step = 16;
  for (std::uint64_t n = 1; n <= pushes; n += step) {
    step = std::max<std::uint64_t>(step, std::min<std::uint64_t>(n / 512, 1'024));
    low_water.add(n, static_cast<std::int64_t>(held(static_cast<double>(n))));
  }
  return low_water.growth();
}

constexpr std::uint64_t many = LowWater::enough_pushes * 65 / 64;

TEST(LowWater, AccusesNoBatchNoCacheAndNoHighWaterMark) {
  const auto batch = [](double elements) {
    return [=](double n) { return 1e5 + 32 * std::fmod(n, elements); };
  };
  const auto cache = [](double elements, double bytes) {
    return [=](double n) { return 5e3 + bytes * std::min(n, elements); };
  };
  // Whenever the run ends: within the first batch, too.
  for (std::uint64_t end = 100; end <= many; end = end * 9 / 8) {
    for (const double elements : {100.0, 51'200.0, 1e6, 5.12e6}) {
      EXPECT_NE(after(end, batch(elements)), Growth::unbounded) << elements << " until " << end;
      for (const double bytes : {0.03, 1.0, 20.0})
        EXPECT_NE(after(end, cache(2 * elements, bytes)), Growth::unbounded)
            << bytes << " until " << 2 * elements << " at " << end;
    }
    EXPECT_NE(after(end, [](double n) { return 1e4 * std::log(n); }), Growth::unbounded) << end;
    EXPECT_NE(after(end, [](double n) { return 1e4 * std::sqrt(n); }), Growth::unbounded) << end;
  }
}

TEST(LowWater, SeesWhatGrowsForEver) {
  for (const double bytes_per_push : {0.004, 0.032, 1.0, 13.0})
    EXPECT_EQ(after(many, [=](double n) { return 5e4 + bytes_per_push * n; }), Growth::unbounded)
        << bytes_per_push;
  // Beside batches that are given back.
  EXPECT_EQ(after(many, [](double n) { return 0.032 * n + 8 * std::fmod(n, 51'200); }),
            Growth::unbounded);
  // So much memory needs no so many pushes.
  EXPECT_EQ(after(1 << 17, [](double n) { return 8'192 * n; }), Growth::unbounded);
}

TEST(LowWater, KnowsWhatItCannotKnowYet) {
  const auto grows = [](double n) { return 32 * n; };
  EXPECT_EQ(after(5'120, grows), Growth::undecided);
  EXPECT_EQ(after(1'000'000, grows), Growth::undecided);
  EXPECT_EQ(after(1'000'000, [](double) { return 5e6; }), Growth::none);
  // The slope of `slight`, and half of it.
  EXPECT_NE(after(1'000'000, [](double n) { return n / 200; }), Growth::none);
  EXPECT_EQ(after(1'000'000, [](double n) { return n / 512; }), Growth::none);
}

TEST(MemorySuite, FindsLeaksHoweverSlow) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "the sanitizer's allocator is in place";
  for (const QueueEntry& entry : {reclaiming<Leaking<1'000>>("one in a thousand"),
                                  reclaiming<Leaking<1'000, InBatches<10'000>>>("beside batches"),
                                  reclaiming<Leaking<20, FromFreeList>, 512>("segments")}) {
    // It ends as soon as that is certain.
    const Result result = run(entry, 60, run_memory);
    EXPECT_EQ(claim_of(result), "reclaims memory") << entry.name << "\n" << to_text(result);
  }
}

TEST(MemorySuite, AccusesNoReclaimerThatComesLate) {
  if (sanitizer != Sanitizer::none) GTEST_SKIP() << "the sanitizer's allocator is in place";
  for (const QueueEntry& entry :
       {reclaiming<InBatches<100>, 512>("a hundred segments at once"),
        reclaiming<InBatches<3'000>, 512>("segments for 1.5 million elements at once"),
        reclaiming<InBatches<2'000'000>>("two million nodes at once"),
        reclaiming<InEpochs<200'000>>("epochs"),
        reclaiming<WithReserve<1, 1'000'000>>("a reserve of a million"),
        reclaiming<WithReserve<100, 20'000>>("a reserve that fills slowly"),
        reclaiming<FromFreeList, 64>("a free list"), broken_entry<Defect::none>()}) {
    const Result result = run(entry, 0.3, run_memory);
    EXPECT_EQ(claim_of(result), "nothing") << entry.name << "\n" << result.findings[0].evidence;
    ASSERT_FALSE(result.notes.empty()) << entry.name;
    EXPECT_NE(result.notes[0].find("bytes from"), std::string::npos) << result.notes[0];
  }
}

}  // namespace
}  // namespace irt::stress
