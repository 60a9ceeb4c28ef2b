// Which of these pass and which do not is known to outside_test.sh.

#include <atomic>
#include <gtest/gtest.h>
#include <irt/explore.hpp>
#include <thread>
#include <vector>

namespace {

class SpinLock {
 public:
  explicit SpinLock(std::memory_order order) : order_(order) {}
  void lock() {
    while (held_.exchange(true, std::memory_order_acquire)) {
    }
  }
  void unlock() { held_.store(false, order_); }

 private:
  std::atomic<bool> held_{false};
  std::memory_order order_;
};

irt::Explored count_two(std::memory_order order) {
  return irt::explore([order] {
    SpinLock lock(order);
    int inside = 0;
    const auto enter = [&] {
      lock.lock();
      ++inside;
      lock.unlock();
    };
    std::thread other(enter);
    enter();
    other.join();
    EXPECT_EQ(inside, 2);
  });
}

}  // namespace

TEST(Right, Excludes) {
  const irt::Explored explored = count_two(std::memory_order_release);
  EXPECT_TRUE(explored.whole);
  EXPECT_GT(explored.executions, 1U);
}
TEST(Right, FindsItsVariablesAsTheyWere) {
  int runs = 0;
  std::vector<int> kept(1, 7);
  irt::explore([&] {
    std::atomic<int> value{0};
    std::thread other([&] { value = 1; });
    kept.push_back(value.load());
    other.join();
    EXPECT_EQ(++runs, 1);
    EXPECT_EQ(kept.size(), 2U);
    kept = {};
  });
  EXPECT_EQ(runs, 0);
  EXPECT_EQ(kept, std::vector<int>(1, 7));
}
TEST(Wrong, UnlocksTooWeakly) {
  count_two(std::memory_order_relaxed);
}
TEST(Wrong, ExpectsWhatMayBeLater) {
  irt::explore([] {
    std::atomic<int> value{0};
    std::thread other([&] { value = 1; });
    EXPECT_EQ(value.load(), 1);
    other.join();
  });
}
TEST(Wrong, ExploresNothing) {
  irt::explore([] {});
}
