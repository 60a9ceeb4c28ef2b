/// What happens next: events in the order of simulated time.
///
/// A timing wheel (Varghese and Lauck 1987): buckets of about a nanosecond, each a sorted list,
/// and a bit for each bucket that is not empty, so that adding and taking cost a few steps however
/// many cores there are. What lies beyond the wheel waits in an ordered set.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>

namespace irt::many_core {

/// Simulated time, and lengths of it, in picoseconds.
using Time = std::int64_t;
inline constexpr Time nanosecond = 1000;
inline constexpr Time never = std::numeric_limits<Time>::max();

/// Something that will happen; part of the object it happens to.
struct Event {
  Time time = 0;
  std::uint64_t order = 0;  ///< among events of the same time
  Event* next = nullptr;
  Event* before = nullptr;
  std::uint32_t index = 0;  ///< whose event it is
  bool of_line = false;     ///< a line's; comes before those of threads at the same time
  bool scheduled = false;
};

class EventQueue {
 public:
  EventQueue() = default;
  EventQueue(const EventQueue&) = delete;
  EventQueue& operator=(const EventQueue&) = delete;

  bool empty() const { return front_ == nullptr; }
  /// The next event, which stays there. There must be one.
  const Event& front() const { return *front_; }
  /// When the next event happens; `never` if there is none.
  Time front_time() const { return front_time_; }

  /// `event` must not be scheduled; `time` must not be before the last event taken.
  void push(Event& event, Time time) {
    event.time = time;
    event.order = (event.of_line ? 0 : thread_order) + ++sequence_;
    event.scheduled = true;
    if (time - now_ >= horizon) {
      far_.insert(&event);
    } else {
      insert(event);
    }
    if (front_ == nullptr || is_before(event, *front_)) set_front(&event);
  }

  void remove(Event& event) {
    event.scheduled = false;
    if (far_.erase(&event) == 0) unlink(event);
    if (front_ == &event) find_front();
  }

  void move(Event& event, Time time) {
    if (event.scheduled) remove(event);
    push(event, time);
  }

  /// Notes that something happens at `time` that was never in the queue; as if pushed and taken.
  void skip_to(Time time) { now_ = time; }

  /// Takes the next event. There must be one.
  Event& pop() {
    Event& event = *front_;
    now_ = event.time;
    event.scheduled = false;
    if (far_.empty() || far_.erase(&event) == 0) unlink(event);
    while (!far_.empty() && (*far_.begin())->time - now_ < horizon) {
      Event& near = **far_.begin();
      far_.erase(far_.begin());
      insert(near);
    }
    find_front();
    return event;
  }

 private:
  static constexpr std::size_t buckets = 2048;
  static constexpr Time bucket_width = 1024;
  static constexpr Time horizon = (buckets - 1) * bucket_width;
  static constexpr std::uint64_t thread_order = std::uint64_t{1} << 62U;

  struct Bucket {
    Event* first = nullptr;
    Event* last = nullptr;
  };
  struct Earlier {
    bool operator()(const Event* a, const Event* b) const { return is_before(*a, *b); }
  };

  static bool is_before(const Event& a, const Event& b) {
    return a.time != b.time ? a.time < b.time : a.order < b.order;
  }
  static std::size_t bucket_of(Time time) {
    return static_cast<std::size_t>(time / bucket_width) % buckets;
  }

  void set_front(Event* event) {
    front_ = event;
    front_time_ = event == nullptr ? never : event->time;
  }

  void insert(Event& event) {
    const std::size_t index = bucket_of(event.time);
    Bucket& bucket = buckets_[index];
    Event* before = bucket.last;  // most events are later than those that are there
    while (before != nullptr && is_before(event, *before)) before = before->before;
    event.before = before;
    event.next = before == nullptr ? bucket.first : before->next;
    (event.before == nullptr ? bucket.first : event.before->next) = &event;
    (event.next == nullptr ? bucket.last : event.next->before) = &event;
    used_[index / 64] |= std::uint64_t{1} << index % 64;
    used_words_ |= 1U << index / 64;
  }

  void unlink(Event& event) {
    const std::size_t index = bucket_of(event.time);
    Bucket& bucket = buckets_[index];
    (event.before == nullptr ? bucket.first : event.before->next) = event.next;
    (event.next == nullptr ? bucket.last : event.next->before) = event.before;
    if (bucket.first != nullptr) return;
    used_[index / 64] &= ~(std::uint64_t{1} << index % 64);
    if (used_[index / 64] == 0) used_words_ &= ~(1U << index / 64);
  }

  // The wheel holds less than one turn, so the first bucket from now on has the next event.
  void find_front() {
    const std::size_t start = bucket_of(now_);
    std::size_t at = start / 64;
    std::uint64_t word = used_[at] & ~std::uint64_t{0} << start % 64;
    if (word == 0) {
      const std::uint32_t later = std::rotr(used_words_, static_cast<int>(at + 1));
      if (later == 0) {
        set_front(far_.empty() ? nullptr : *far_.begin());
        return;
      }
      at = (at + 1 + static_cast<std::size_t>(std::countr_zero(later))) % used_.size();
      word = used_[at];
    }
    set_front(buckets_[at * 64 + static_cast<std::size_t>(std::countr_zero(word))].first);
  }

  std::array<Bucket, buckets> buckets_{};
  std::array<std::uint64_t, buckets / 64> used_{};  // a bit for each bucket with events
  std::uint32_t used_words_ = 0;                    // a bit for each word of `used_` that is not 0
  std::set<Event*, Earlier> far_;
  Event* front_ = nullptr;
  Time front_time_ = never;
  Time now_ = 0;
  std::uint64_t sequence_ = 0;
};

}  // namespace irt::many_core
