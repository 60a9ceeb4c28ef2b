// Numbered work by several processes.

#include "stress/checker/worker_pool.hpp"

#include <chrono>
#include <csignal>
#include <gtest/gtest.h>
#include <stdexcept>
#include <thread>
#include <unistd.h>

namespace irt::checker {
namespace {

using Bytes = std::optional<std::string>;

std::string message_of(WorkerPool& pool) {
  try {
    pool.next();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(WorkerPool, tells_results_in_order_whoever_is_slow) {
  const pid_t parent = getpid();
  WorkerPool pool(3, 60, [parent](std::uint64_t number) -> Bytes {
    if (getpid() == parent || number >= 10) return std::nullopt;
    std::this_thread::sleep_for(std::chrono::milliseconds(10 * (3 - number % 3)));
    return std::string(number * 20'000, static_cast<char>('a' + number));
  });
  for (std::size_t number = 0; number < 10; ++number)
    EXPECT_EQ(pool.next(), std::string(number * 20'000, static_cast<char>('a' + number)));
  EXPECT_EQ(pool.next(), std::nullopt);
}

TEST(WorkerPool, says_what_ended_a_worker) {
  WorkerPool throwing(2, 60, [](std::uint64_t) -> Bytes { throw std::invalid_argument("bad"); });
  EXPECT_EQ(message_of(throwing), "bad");
  WorkerPool crashing(2, 60, [](std::uint64_t) -> Bytes {
    std::signal(SIGSEGV, SIG_DFL);
    raise(SIGSEGV);
    return "";
  });
  EXPECT_NE(message_of(crashing).find("signal 11"), std::string::npos);
  WorkerPool hanging(1, 0.1, [](std::uint64_t) -> Bytes {
    for (;;) pause();
  });
  EXPECT_NE(message_of(hanging).find("hangs"), std::string::npos);
}

TEST(WorkerPool, ends_workers_that_are_not_asked_any_more) {
  WorkerPool pool(2, 60, [](std::uint64_t) -> Bytes { return std::string(100'000, 'x'); });
  EXPECT_TRUE(pool.next());
}

}  // namespace
}  // namespace irt::checker
