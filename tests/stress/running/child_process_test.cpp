// Processes that are spoken to, stopped, and whatever may become of them.
#include "stress/running/child_process.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <iostream>
#include <stdexcept>
#include <string>
#include <sys/mman.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace irt {
namespace {

constexpr double patience = 60;
const std::atomic<bool> never{false};

void sleep_ms(int milliseconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

// Answers every line, until an empty one.
void echo(int line) {
  speak_by_standard_streams(line);
  for (std::string said; std::getline(std::cin, said) && !said.empty();) {
    std::cout << "heard " << said << std::endl;
  }
  std::cout << "bye";
}

TEST(ChildProcess, HearsAndAnswersUntilItEnds) {
  ChildProcess child(echo);
  child.tell("one\ntwo\n");
  EXPECT_EQ(child.line(patience, never), "heard one");
  EXPECT_EQ(child.line(patience, never), "heard two");
  child.tell("\n");
  const Ending ending = child.end(patience, never);
  EXPECT_EQ(ending.status, "ok") << ending.message;
  EXPECT_EQ(ending.answer, "bye");
}

TEST(ChildProcess, OneThatDiesHasNoMoreToSay) {
  ChildProcess child([](int) {
    std::cerr << "something broke\n";
    std::abort();
  });
  EXPECT_EQ(child.line(patience, never), std::nullopt);
  child.tell("to nobody");
  child.stop();
  child.go_on();
  const Ending ending = child.end(patience, never);
  EXPECT_EQ(ending.status, "crashed");
  EXPECT_NE(ending.message.find(": something broke"), std::string::npos) << ending.message;
}

TEST(ChildProcess, OneThatThrowsOrSaysNothingHasFailed) {
  const Ending thrown =
      in_child(patience, never, []() -> std::string { throw std::runtime_error("no luck"); });
  EXPECT_EQ(thrown.status, "failed");
  EXPECT_NE(thrown.message.find("no luck"), std::string::npos);
  EXPECT_EQ(in_child(patience, never, [] { return std::string(); }).status, "failed");
}

TEST(ChildProcess, OneThatBecomesAnotherProgramAnswersLikeIt) {
  ChildProcess child([](int line) {
    speak_by_standard_streams(line);
    become({"printf", "%s by name", "found"});
  });
  EXPECT_EQ(child.end(patience, never).answer, "found by name");
  const Ending missing = in_child(patience, never, []() -> std::string { become({"/no/such"}); });
  EXPECT_EQ(missing.message, "exit code 1: /no/such cannot be started");
}

TEST(ChildProcess, OneThatIsSilentIsKilled) {
  ChildProcess child([](int) { pause(); });
  EXPECT_EQ(child.line(0.05, never), std::nullopt);
  EXPECT_EQ(child.end(patience, never).status, "hung");
}

TEST(ChildProcess, OneThatWasStoppedCanBeCancelled) {
  ChildProcess child([](int) { pause(); });
  child.stop();
  const std::atomic<bool> cancelled{true};
  EXPECT_EQ(child.line(patience, cancelled), std::nullopt);
  child.end(patience, cancelled);
}

/// A counter in memory that child and parent share.
struct Shared {
  Shared()
      : count(static_cast<std::atomic<unsigned long>*>(
            mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))) {}
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;
  ~Shared() { munmap(count, 4096); }
  void await_more() const {
    for (const unsigned long before = *count; *count == before;) sleep_ms(1);
  }
  std::atomic<unsigned long>* count;
};

TEST(ChildProcess, NoThreadRunsWhileItIsStopped) {
  const Shared shared;
  ChildProcess child([&shared](int) {
    std::array<std::thread, 3> threads;
    for (std::thread& thread : threads) {
      thread = std::thread([&shared] {
        for (;;) ++*shared.count;
      });
    }
    threads[0].join();
  });
  for (int i = 0; i < 10; ++i) {
    shared.await_more();
    child.stop();
    const unsigned long stopped = *shared.count;
    sleep_ms(2);
    EXPECT_EQ(*shared.count, stopped);
    child.go_on();
  }
}

// A zombie has ended, too; whether somebody has asked after it is not ours.
bool has_ended(pid_t process) {
  std::ifstream stat("/proc/" + std::to_string(process) + "/stat");
  std::string number, name, state;
  return !(stat >> number >> name >> state) || state == "Z";
}

TEST(ChildProcess, AStoppedOneDoesNotOutliveItsParent) {
  const Shared grandchild;
  const pid_t parent = fork();
  if (parent == 0) {
    ChildProcess child([&grandchild](int) {
      *grandchild.count = static_cast<unsigned long>(getpid());
      for (;;) pause();
    });
    while (*grandchild.count == 0) sleep_ms(1);
    child.stop();
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(parent, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  const auto process = static_cast<pid_t>(*grandchild.count);
  ASSERT_GT(process, 0);
  for (int i = 0; i < 3000 && !has_ended(process); ++i) sleep_ms(10);
  EXPECT_TRUE(has_ended(process));
}

}  // namespace
}  // namespace irt
