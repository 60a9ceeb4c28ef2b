/// What the tests of every framework test.
#pragma once

#include <atomic>
#include <thread>

/// What two threads that add one each come to: two, if each adds at once.
inline int additions_made(bool at_once) {
  std::atomic<int> sum{0};
  const auto add = [&] {
    if (at_once)
      sum.fetch_add(1);
    else
      sum = sum + 1;
  };
  std::thread other(add);
  add();
  other.join();
  return sum;
}
