// What `pop` does on an empty queue: one thread tries.
#include <atomic>
#include <chrono>
#include <thread>

#include "stress/threads/kernel_view.hpp"
#include "stress/threads/signals.hpp"
#include "stress/threads/suites.hpp"

namespace irt::stress {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// Waits until `answered`, or until `thread` has had a second and its share of a processor; a
/// thread that sleeps has had it.
bool answers_in_time(const std::atomic<bool>& answered, const std::atomic<pid_t>& thread) {
  constexpr std::uint64_t share = 200'000'000;  // nanoseconds
  const auto start = Clock::now();
  const std::uint64_t cpu = cpu_time(thread).value_or(0);
  while (!answered) {
    const auto passed = Clock::now() - start;
    if (passed > 20s) return false;
    if (passed > 1s && (sleeps(thread) || cpu_time(thread).value_or(0) > cpu + share)) return false;
    if (passed < 1ms) {
      std::this_thread::yield();
    } else {
      std::this_thread::sleep_for(1ms);
    }
  }
  return true;
}

void pop_once(const QueueEntry& entry, Messenger& messenger) {
  const Roles roles = roles_within(entry.claims, apart(1, 1));
  const auto queue = entry.make_word_queue(roles.workers, 4);
  Slot slot;
  std::atomic<bool> ready{false};
  std::atomic<bool> answered{false};
  std::thread popper([&] {
    const Presence presence(slot);
    ready = true;
    Element e = 0;
    queue->pop(roles.workers - 1, e);
    answered = true;
    queue->leave(roles.workers - 1);
    // The slot is kept until somebody has seen the answer.
    while (slot.done == 0) std::this_thread::yield();
  });
  while (!ready) std::this_thread::yield();
  messenger.figure("answers", answers_in_time(answered, slot.thread));
  if (!answered) _exit(0);  // nobody can join a thread that waits for ever
  slot.done = 1;
  popper.join();
}

}  // namespace

bool pop_answers_on_empty(const QueueEntry& queue) {
  Result result;
  run_in_child(
      result, 5, 30, [&](Messenger& messenger) { pop_once(queue, messenger); },
      [](std::uint64_t) {});
  // Whatever else went wrong, the suites find out themselves.
  return result.figures.value("answers", true);
}

}  // namespace irt::stress
