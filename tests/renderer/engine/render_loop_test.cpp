#include "renderer/engine/render_loop.hpp"

#include <array>
#include <gtest/gtest.h>
#include <span>
#include <utility>
#include <vector>

namespace irt {
namespace {

struct Job {
  std::span<Job> children;
  int answers = 0, first_answers = 0;
  std::atomic<bool> queued{false};
};

// A host with all that a loop asks for, and a queue of one place.
class Host {
 public:
  using Task = Job;
  struct Place {
    bool push(unsigned /*worker*/, void* job) {
      if (held != nullptr) return false;
      held = job;
      return true;
    }
    bool pop(unsigned /*worker*/, void*& job) {
      job = held;
      if (!std::exchange(hand_out_twice, false)) held = nullptr;
      return job != nullptr;
    }
    void* held = nullptr;
    bool hand_out_twice = false;
  };

  Place& queue() { return place; }
  static unsigned number() { return 0; }
  std::vector<Job*>& overflow() { return kept; }
  TaskCounts& counts() { return tasks; }
  [[nodiscard]] bool leaves_when_empty() const { return leaves; }
  bool tasks_are_lost() { return ++looks > 0; }

  std::span<Job> answer(Job& job, bool first_time) {
    EXPECT_GT(tasks.outstanding(), 0U) << "a task was done before its children were counted";
    ++job.answers;
    job.first_answers += first_time ? 1 : 0;
    return first_time ? job.children : std::span<Job>{};
  }
  void hand_on(std::span<Job> children, const auto& put) {
    EXPECT_GE(tasks.outstanding(), children.size()) << "queued before it was counted";
    for (Job& child : children) put(child);
  }

  void got() { ++gets; }
  void missed() { ++misses; }
  void waited() {}
  void overflowed() { ++overflows; }

  Place place;
  std::vector<Job*> kept;
  TaskCounts tasks{1};
  bool leaves = false;
  int looks = 0, gets = 0, misses = 0, overflows = 0;
};

using Loop = RenderLoop<Host&>;

void deal(Host& host, const std::vector<Job*>& first) {
  Loop::deal(first, host.tasks, [&](std::size_t /*i*/) -> Host& { return host; });
}

TEST(RenderLoop, AnswersEveryTaskOnceAndQueuesItsChildren) {
  std::array<Job, 6> jobs;
  jobs[0].children = std::span(jobs).subspan(2, 3);
  jobs[2].children = std::span(jobs).subspan(5, 1);
  for (const bool leaves : {false, true}) {
    for (Job& job : jobs) job.answers = job.first_answers = 0;
    Host host;
    host.leaves = leaves;
    deal(host, {jobs.data(), &jobs[1]});
    EXPECT_EQ(host.tasks.outstanding(), 2U);
    Loop::work(host);
    for (const Job& job : jobs) EXPECT_EQ(job.first_answers, 1);
    EXPECT_EQ(host.tasks.outstanding(), 0U);
    EXPECT_EQ(host.gets, 6);
    EXPECT_EQ(host.misses, 1);
    EXPECT_EQ(host.overflows, 3) << "one of the first two and two of three children";
    EXPECT_TRUE(host.kept.empty());
  }
}

TEST(RenderLoop, CountsATaskThatComesOutTwiceOnce) {
  Job job;
  Host host;
  host.place.hand_out_twice = true;
  deal(host, {&job});
  host.tasks.count(0, 1, false);  // another is still worked on: else nobody would look again
  Loop::work(host);
  EXPECT_EQ(job.answers, 2);
  EXPECT_EQ(job.first_answers, 1);
  EXPECT_EQ(host.tasks.outstanding(), 1U);
  EXPECT_EQ(host.looks, 1);
}

TEST(RenderLoop, LeavesWhenTheHostGivesUpOnALostTask) {
  Job job;
  Host host;
  deal(host, {&job});
  host.place.held = nullptr;
  Loop::work(host);
  EXPECT_EQ(job.answers, 0);
  EXPECT_EQ(host.looks, 1);
  EXPECT_EQ(host.misses, 1024);
  EXPECT_TRUE(host.tasks.all_rest()) << "the others still watch";
}

}  // namespace
}  // namespace irt
