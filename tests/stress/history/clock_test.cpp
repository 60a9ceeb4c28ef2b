#include "stress/history/clock.hpp"

#include <chrono>
#include <gtest/gtest.h>
#include <thread>

namespace irt::stress {
namespace {

TEST(Clock, StampsRiseWithinAThread) {
  Stamp last = stamp_before();
  for (int i = 0; i < 1'000; ++i) {
    const Stamp after = stamp_after();
    const Stamp before = stamp_before();
    EXPECT_GE(after, last);
    EXPECT_GE(before, after);
    last = before;
  }
}

TEST(Clock, CalibrationKnowsTheRateAndBoundsTheError) {
  const ClockQuality quality = calibrate();
  const Stamp start = stamp_before();
  const auto clock_start = std::chrono::steady_clock::now();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const Stamp end = stamp_after();
  const std::chrono::duration<double, std::nano> passed =
      std::chrono::steady_clock::now() - clock_start;
  EXPECT_NEAR(static_cast<double>(end - start) / quality.ticks_per_nanosecond / passed.count(), 1.0,
              0.1);
  EXPECT_LT(static_cast<double>(quality.error) / quality.ticks_per_nanosecond, 1e6)
      << "counters a millisecond apart are of no use: " << quality.description;
  std::puts(quality.description.c_str());
}

}  // namespace
}  // namespace irt::stress
