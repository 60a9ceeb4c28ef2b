// What queues may have besides push and pop, on every registered queue that has it.
#include <algorithm>
#include <array>
#include <chrono>
#include <gtest/gtest.h>
#include <set>
#include <thread>
#include <vector>

#include "queues/registry.hpp"
#include "queues/roles.hpp"

namespace irt {
namespace {

using Word = std::uint64_t;

/// Two workers, of whom the first pushes and the last pops.
constexpr unsigned two = 2;
constexpr unsigned popper = two - 1;

template <class Has>
std::vector<QueueEntry> entries_with(Has has) {
  const QueueRegistry registry;
  std::vector<QueueEntry> entries;
  for (const QueueEntry& entry : registry.entries())
    if (has(entry)) entries.push_back(entry);
  EXPECT_FALSE(entries.empty());
  return entries;
}

TEST(OptionalMethods, a_waiting_pop_gets_what_is_pushed_and_hears_of_the_end) {
  for (const QueueEntry& entry : entries_with([](const auto& e) { return e.methods.pop_wait; })) {
    const auto queue = entry.make_word_queue(two, 8);
    std::vector<Word> found;
    std::thread waiting([&] {
      for (Word word = 0; queue->pop_wait(popper, word);) found.push_back(word);
    });
    for (const Word word : {1U, 2U, 3U}) EXPECT_TRUE(queue->push(0, word)) << entry.name;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    queue->close();
    waiting.join();
    EXPECT_EQ(found, (std::vector<Word>{1, 2, 3})) << entry.name;
    queue->close();
    EXPECT_FALSE(queue->push(0, 4)) << entry.name;
    Word word = 0;
    EXPECT_FALSE(queue->pop(popper, word)) << entry.name;
    EXPECT_FALSE(queue->pop_wait(popper, word)) << entry.name;
  }
}

TEST(OptionalMethods, what_is_inside_when_a_queue_is_closed_can_be_popped) {
  for (const QueueEntry& entry : entries_with([](const auto& e) { return e.methods.pop_wait; })) {
    const auto queue = entry.make_word_queue(two, 8);
    for (const Word word : {1U, 2U}) EXPECT_TRUE(queue->push(0, word));
    queue->close();
    Word word = 0;
    EXPECT_TRUE(queue->pop_wait(popper, word) && word == 1) << entry.name;
    EXPECT_TRUE(queue->pop(popper, word) && word == 2) << entry.name;
    EXPECT_FALSE(queue->pop_wait(popper, word)) << entry.name;
  }
}

TEST(OptionalMethods, a_deadline_passes_and_not_before) {
  for (const QueueEntry& entry : entries_with([](const auto& e) { return e.methods.deadline; })) {
    const auto queue = entry.make_word_queue(two, 8);
    Word word = 0;
    for (const int milliseconds : {-1'000, 0, 3}) {
      const Deadline deadline = Deadline::clock::now() + std::chrono::milliseconds(milliseconds);
      EXPECT_EQ(queue->pop_wait(popper, word, deadline), PopStatus::timed_out) << entry.name;
      EXPECT_GE(Deadline::clock::now(), deadline) << entry.name;
    }
    EXPECT_EQ(queue->pop_wait(popper, word, Deadline::min()), PopStatus::timed_out) << entry.name;
    EXPECT_TRUE(queue->push(0, 5));
    EXPECT_EQ(queue->pop_wait(popper, word, Deadline::min()), PopStatus::success) << entry.name;
    EXPECT_EQ(word, 5U);
    queue->close();
    EXPECT_EQ(queue->pop_wait(popper, word, Deadline::max()), PopStatus::closed) << entry.name;
  }
}

TEST(OptionalMethods, several_at_once_are_as_so_many_calls) {
  for (const QueueEntry& entry : entries_with([](const auto& e) { return e.methods.bulk; })) {
    const auto queue = entry.make_word_queue(two, 8);
    EXPECT_EQ(queue->push_bulk(0, {}), 0U) << entry.name;
    const std::array<Word, 5> pushed{1, 2, 3, 4, 5};
    EXPECT_EQ(queue->push_bulk(0, pushed), pushed.size()) << entry.name;
    std::vector<Word> popped;
    std::array<Word, 3> some{};
    for (std::size_t found = 1; found != 0;) {
      found = queue->pop_bulk(popper, some);
      ASSERT_LE(found, some.size()) << entry.name;
      popped.insert(popped.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(found));
    }
    if (entry.claims.ordering == Ordering::unordered) std::ranges::sort(popped);
    EXPECT_TRUE(std::ranges::equal(popped, pushed)) << entry.name;
  }
}

TEST(OptionalMethods, that_a_queue_lacks_throw) {
  for (const QueueEntry& entry : entries_with([](const auto& e) { return !e.methods.pop_wait; })) {
    const auto queue = entry.make_word_queue(two, 8);
    Word word = 0;
    EXPECT_THROW(queue->pop_wait(popper, word), std::logic_error) << entry.name;
    EXPECT_THROW(queue->close(), std::logic_error) << entry.name;
  }
}

TEST(OtherElements, come_out_as_they_went_in_and_go_with_the_queue) {
  const QueueRegistry registry;
  std::set<std::string_view> tried;
  for (const QueueEntry& entry : registry.entries()) {
    for (const ElementKind& kind : element_kinds(entry)) {
      if (kind.make_queue == nullptr) continue;
      tried.insert(kind.name);
      const auto queue = kind.make_queue(two, 8);
      // Where each worker has a queue of its own, the one that pops pushes.
      const unsigned pusher = entry.claims.own_queues() ? popper : 0;
      for (Word word = 1; word <= 5; ++word) EXPECT_TRUE(queue->push(pusher, word));
      std::set<Word> popped;
      for (Word word = 0; popped.size() < 3 && queue->pop(popper, word);) popped.insert(word);
      EXPECT_EQ(popped.size(), 3U) << entry.name << ": elements " << kind.words;
      EXPECT_LE(*popped.rbegin(), 5U) << entry.name << ": elements " << kind.words;
    }
  }
  EXPECT_EQ(tried.size(), 3U);
}

TEST(Claims, name_a_word_that_may_be_pushed) {
  EXPECT_EQ(Claims{}.some_word(), 1U);
  EXPECT_EQ((Claims{.reserved = {1, 2}}.some_word()), 3U);
  EXPECT_EQ((Claims{.unused_bits = 7}.some_word()), 8U);
  EXPECT_EQ((Claims{.reserved = {8}, .unused_bits = 7}.some_word()), 16U);
  EXPECT_EQ((Claims{.reserved = {1}, .unused_bits = ~Word{1}}.some_word()), 0U) << "none";
}

}  // namespace
}  // namespace irt
