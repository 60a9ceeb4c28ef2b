// Handles are made and destroyed by the threads that act for their workers.

#include "queues/handles.hpp"

#include <gtest/gtest.h>
#include <new>
#include <set>
#include <thread>

#include "queues/work_queue.hpp"

namespace irt {
namespace {

/// What has become of the handles of the queues below.
struct HandlesSeen {
  int made = 0, living = 0;
  std::set<std::thread::id> threads;
  bool queue_lives = false;
  bool refuses = false;
};
HandlesSeen handles_seen;

template <class T>
class Handed {
 public:
  static constexpr std::string_view summary = "one place, reached by a handle";
  static constexpr Claims claims{.bounded = true, .max_workers = 4};

  struct Handle {
    explicit Handle(Handed& /*queue*/) {
      if (handles_seen.refuses) throw std::bad_alloc();
      ++handles_seen.made;
      ++handles_seen.living;
      handles_seen.threads.insert(std::this_thread::get_id());
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() {
      EXPECT_TRUE(handles_seen.queue_lives);
      EXPECT_TRUE(handles_seen.threads.contains(std::this_thread::get_id()));
      --handles_seen.living;
    }
  };

  Handed(unsigned /*workers*/, std::size_t /*capacity*/) { handles_seen.queue_lives = true; }
  Handed(const Handed&) = delete;
  Handed& operator=(const Handed&) = delete;
  ~Handed() { handles_seen.queue_lives = false; }

  bool push(Handle& /*handle*/, T task) {
    if (full_) return false;
    task_ = task;
    return full_ = true;
  }
  bool pop(Handle& /*handle*/, T& task) {
    if (!full_) return false;
    task = task_;
    full_ = false;
    return true;
  }
  std::size_t push_bulk(Handle& handle, std::span<const T> tasks) {
    return !tasks.empty() && push(handle, tasks[0]) ? 1 : 0;
  }
  std::size_t pop_bulk(Handle& handle, std::span<T> tasks) {
    return !tasks.empty() && pop(handle, tasks[0]) ? 1 : 0;
  }

 private:
  T task_{};
  bool full_ = false;
};

template <class T>
class LeavesWithAWord : public Handed<T> {
 public:
  using Handed<T>::Handed;
  bool push(unsigned /*worker*/, T /*task*/) { return true; }
  bool pop(unsigned /*worker*/, T& /*task*/) { return false; }
  bool leave(unsigned /*worker*/) { return true; }
};

constexpr QueueEntry handed = queue_entry<Handed>("handed");

TEST(Handles, make_a_queue_of_workers) {
  static_assert(handed.methods.leave && handed.methods.bulk && !handed.methods.pop_wait);
  static_assert(!HasWholeMethods<LeavesWithAWord<void*>, void*>);
  handles_seen = {};
  const auto queue = handed.make_word_queue(2, 1);
  std::uint64_t word = 0;
  EXPECT_EQ(handles_seen.made, 0);
  EXPECT_TRUE(queue->push(0, 7));
  EXPECT_FALSE(queue->push(0, 8));
  EXPECT_TRUE(queue->pop(1, word));
  EXPECT_EQ(word, 7U);
  EXPECT_EQ(queue->pop_bulk(1, {&word, 1}), 0U);
  EXPECT_EQ(handles_seen.made, 2);
  EXPECT_THROW(handed.make_word_queue(5, 1), std::invalid_argument);
}

TEST(Handles, go_when_their_worker_leaves_and_come_again) {
  handles_seen = {};
  const auto queue = handed.make_word_queue(2, 1);
  std::thread([&] {
    const ActsFor leaves(*queue, 1);
    queue->push(1, 7);
    EXPECT_EQ(handles_seen.living, 1);
  }).join();
  EXPECT_EQ(handles_seen.living, 0);
  queue->leave(0);  // has never come
  std::uint64_t word = 0;
  EXPECT_TRUE(queue->pop(1, word));
  EXPECT_EQ(handles_seen.made, 2);
  EXPECT_EQ(handles_seen.threads.size(), 2U);
}

TEST(Handles, go_before_their_queue) {
  handles_seen = {};
  handed.make_word_queue(2, 1)->push(1, 7);
  EXPECT_EQ(handles_seen.made, 1);
  EXPECT_EQ(handles_seen.living, 0);
}

TEST(Handles, that_cannot_be_made_leave_the_call_without_effect) {
  handles_seen = {};
  const auto queue = handed.make_word_queue(1, 1);
  handles_seen.refuses = true;
  EXPECT_THROW(queue->push(0, 7), std::bad_alloc);
  handles_seen.refuses = false;
  std::uint64_t word = 0;
  EXPECT_FALSE(queue->pop(0, word));
}

}  // namespace
}  // namespace irt
