// The framework comes too late: irt::explore does not know whose assertions to ask for.

// clang-format off
#include <irt/explore.hpp>
#include <gtest/gtest.h>
// clang-format on
#include <atomic>
#include <thread>

TEST(Late, IsToldSo) {
  irt::explore([] {
    std::atomic<int> value{0};
    std::thread other([&] { value = 1; });
    EXPECT_EQ(value.load(), 1);
    other.join();
  });
}
