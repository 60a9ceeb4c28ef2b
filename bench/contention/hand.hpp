/// The operations of one thread on one queue, as the programs of stress/scenarios/contention.hpp
/// use them: counted, and stamped where latency is measured.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "bench/contention/seat.hpp"
#include "queues/work_queue.hpp"
#include "stress/history/clock.hpp"

namespace irt::contention {

/// The queue's concrete type, so that its operations can be inlined as in a program that uses it.
/// Counts are kept in registers and published by a plain store each: hence `always_inline`, for a
/// call that is none leaves the hand in registers.
template <class Queue, bool stamped>
class Hand {
 public:
  Hand(Queue& queue, Seat& seat)
      : queue_(queue),
        seat_(seat),
        counts_(seat.table.counts[seat.worker]),
        stop_(seat.table.stop),
        worker_(seat.worker),
        waits_(seat.waits) {}
  Hand(const Hand&) = delete;
  Hand& operator=(const Hand&) = delete;
  ~Hand() {
    seat_.in += in_;
    seat_.out += out_;
  }

  [[nodiscard, gnu::always_inline]] bool running() const {
    return !stop_.load(std::memory_order_relaxed);
  }

  /// One try each, with a fresh element; the element with a tag.
  [[gnu::always_inline]] bool push() { return push(fresh()); }
  [[gnu::always_inline]] bool pop() {
    // Not the member itself: the queue's code might keep its address, and with it the whole hand.
    std::uint64_t element = 0;
    const bool found = pop(element);
    if (found) taken_ = element;
    return found;
  }
  [[gnu::always_inline]] bool push_tagged(unsigned tag) { return push(fresh() * tags + tag); }
  [[gnu::always_inline]] bool pop_tagged(unsigned& tag) {
    const bool found = pop();
    if (found) tag = static_cast<unsigned>(taken_ % tags);
    return found;
  }

  /// Tries until it succeeds; false where the measurement ends before.
  [[gnu::always_inline]] bool push_until_accepted() { return push_until_accepted(fresh()); }
  [[gnu::always_inline]] bool pop_until_found() {
    while (running()) {
      if (pop()) return true;
    }
    return false;
  }

  /// `bulk` elements in a call, and up to so many; how many went in, and came out. The time of a
  /// call is that of one operation.
  [[gnu::always_inline]] std::size_t push_bulk() {
    std::array<std::uint64_t, bulk> elements;
    std::uint64_t element = fresh();
    for (std::uint64_t& each : elements) each = element++;
    const std::size_t taken = timed(seat_.push_times, [&]() -> std::size_t {
      if constexpr (HasBulk<Queue, std::uint64_t>)
        return std::min(queue_.push_bulk(worker_, elements), bulk);
      return 0;
    });
    for (std::size_t i = 0; i < std::min(taken + 1, bulk); ++i) pushed(i < taken, elements[i]);
    return taken;
  }
  [[gnu::always_inline]] std::size_t pop_bulk(std::size_t most) {
    std::array<std::uint64_t, bulk> elements;
    const std::span room = std::span(elements).first(std::min(most, bulk));
    const std::size_t found = timed(seat_.pop_times, [&]() -> std::size_t {
      if constexpr (HasBulk<Queue, std::uint64_t>)
        return std::min(queue_.pop_bulk(worker_, room), room.size());
      return 0;
    });
    if (found == 0) popped(false, 0);
    for (const std::uint64_t element : room.first(found)) popped(true, element);
    return found;
  }

  /// Sleeps until there is an element; false once the queue is closed.
  [[gnu::always_inline]] bool pop_wait() {
    std::uint64_t element = 0;
    const bool found = timed(seat_.pop_times, [&] {
      if constexpr (PopsWaiting<Queue, std::uint64_t>) return queue_.pop_wait(worker_, element);
      return false;
    });
    return popped(found, element);
  }
  void close() {
    if constexpr (PopsWaiting<Queue, std::uint64_t>) queue_.close();
  }

  /// Pushes and pops until it succeeds, with work after it. To ask whether a push came before the
  /// end takes registers that loops then lack, and loops that go on ask `running`.
  [[gnu::always_inline]] bool put() {
    push_until_accepted();
    work();
    return true;
  }
  [[gnu::always_inline]] void put_back() {
    push_until_accepted(taken_);
    work();
  }
  [[gnu::always_inline]] bool take() {
    const bool found = pop_until_found();
    work();
    return found;
  }

  /// The work between operations.
  [[gnu::always_inline]] void work() { busy_wait(waits_.next()); }

  [[gnu::always_inline]] std::uint64_t random(std::uint64_t bound) {
    return seat_.random.below(bound);
  }
  [[nodiscard, gnu::always_inline]] bool produces() const {
    return seat_.table.roles.pushes(worker_);
  }
  [[nodiscard, gnu::always_inline]] bool leads() const { return worker_ == 0; }
  [[gnu::always_inline]] bool meet() { return seat_.table.gate.pass(stop_); }
  [[gnu::always_inline]] void finished_one() {
    counts_.finished.store(++finished_, std::memory_order_relaxed);
  }
  [[nodiscard]] bool all_finished(std::uint64_t tasks) const {
    return seat_.table.finished() >= tasks;
  }
  static constexpr Burst burst() { return {}; }

  /// Waits while the queue holds more than `backlog` elements, or an unbounded queue would grow as
  /// long as producers are faster than consumers. Looks at the others' counts every 64 pushes, from
  /// afar enough not to disturb them. False once the measurement has ended.
  [[gnu::always_inline]] bool consumers_caught_up() {
    if (pushes_ % 64 != 0) return running();
    while (running() && seat_.table.inside() > seat_.table.backlog) {
      counts_.held_back.store(++held_back_, std::memory_order_relaxed);
      busy_wait(seat_.table.pause_steps);
    }
    return running();
  }
  [[gnu::always_inline]] void rest() { busy_wait(seat_.producer_pause_steps); }

 private:
  /// What `call` answers; where it succeeds, with its time.
  template <class Call>
  [[gnu::always_inline]] auto timed(Histogram& times, Call call) {
    const std::uint64_t begin = stamped ? stress::stamp_before() : 0;
    const auto answer = call();
    const std::uint64_t end = stamped ? stress::stamp_after() : 0;
    if (stamped && answer != 0) {
      times.record(end - begin);
      last_ = {begin, end};
    }
    return answer;
  }
  /// The operation that was timed last, and succeeded.
  [[gnu::always_inline]] void log(stress::Kind kind, std::uint64_t element) {
    if constexpr (stamped) {
      if (seat_.log_room == 0) return;
      seat_.log.push_back({last_.begin, last_.end, element, kind});
      // Who goes on for a moment, since not every loop asks, is logged still.
      if (seat_.log.size() >= seat_.log_room)
        seat_.table.stop.store(true, std::memory_order_relaxed);
    }
  }
  /// An element that no other push of the measurement brings.
  [[nodiscard, gnu::always_inline]] std::uint64_t fresh() const {
    return (std::uint64_t{worker_ + 1} << 40) | pushes_;
  }
  [[gnu::always_inline]] bool push(std::uint64_t element) {
    return pushed(timed(seat_.push_times, [&] { return queue_.push(worker_, element); }), element);
  }
  [[gnu::always_inline]] bool pop(std::uint64_t& element) {
    const bool found = timed(seat_.pop_times, [&] { return queue_.pop(worker_, element); });
    return popped(found, element);
  }
  [[gnu::always_inline]] bool push_until_accepted(std::uint64_t element) {
    while (running()) {
      if (push(element)) return true;
    }
    return false;
  }
  [[gnu::always_inline]] bool pushed(bool accepted, std::uint64_t element) {
    if (accepted) {
      counts_.pushes.store(++pushes_, std::memory_order_relaxed);
      in_ += element;
      log(stress::Kind::push, element);
    } else {
      counts_.failed_pushes.store(++failed_pushes_, std::memory_order_relaxed);
    }
    return accepted;
  }
  [[gnu::always_inline]] bool popped(bool found, std::uint64_t element) {
    if (found) {
      counts_.pops.store(++pops_, std::memory_order_relaxed);
      out_ += element;
      log(stress::Kind::pop, element);
    } else {
      counts_.failed_pops.store(++failed_pops_, std::memory_order_relaxed);
    }
    return found;
  }

  Queue& queue_;
  Seat& seat_;
  Counts& counts_;
  const std::atomic<bool>& stop_;
  unsigned worker_;
  Waits waits_;
  std::uint64_t pushes_ = 0, pops_ = 0, failed_pushes_ = 0, failed_pops_ = 0, held_back_ = 0;
  std::uint64_t finished_ = 0;
  struct {
    stress::Stamp begin = 0, end = 0;
  } last_;
  std::uint64_t in_ = 0, out_ = 0;
  std::uint64_t taken_ = 0;  ///< the last element popped
};

}  // namespace irt::contention
