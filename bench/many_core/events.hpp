/// What happens next: events in the order of simulated time.
///
/// A heap with four children to a node. An event that is moved or removed leaves its entry behind,
/// which is dropped when its time comes; so a step touches the events it is about and no others.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace irt::many_core {

/// Simulated time, and lengths of it, in picoseconds.
using Time = std::int64_t;
inline constexpr Time nanosecond = 1000;
inline constexpr Time never = std::numeric_limits<Time>::max();

/// Something that will happen; part of the object it happens to.
struct Event {
  Time time = 0;
  std::uint64_t order = 0;  ///< among events of the same time
  std::uint32_t index = 0;  ///< whose event it is
  bool of_line = false;     ///< a line's; comes before those of threads at the same time
  bool scheduled = false;
};

class EventQueue {
 public:
  EventQueue() = default;
  EventQueue(const EventQueue&) = delete;
  EventQueue& operator=(const EventQueue&) = delete;

  bool empty() const { return front_.event == nullptr; }
  /// The next event, which stays there. There must be one.
  const Event& front() const { return *front_.event; }
  /// When the next event happens; `never` if there is none.
  Time front_time() const { return static_cast<Time>(front_.key >> 64U); }

  /// `event` must not be scheduled.
  void push(Event& event, Time time) {
    event.time = time;
    event.order = (event.of_line ? 0 : thread_order) + ++sequence_;
    event.scheduled = true;
    const Entry entry{key_of(event), &event};
    if (front_.key < entry.key) {
      insert(entry);
      return;
    }
    if (!empty()) insert(front_);
    front_ = entry;
  }

  /// `event` must be scheduled.
  void remove(Event& event) {
    event.scheduled = false;
    if (front_.event == &event) {
      find_front();
    } else {
      ++stale_;
    }
  }

  void move(Event& event, Time time) {
    if (event.scheduled) remove(event);
    push(event, time);
  }

  /// Takes the next event. There must be one.
  Event& pop() {
    Event& event = *front_.event;
    event.scheduled = false;
    find_front();
    return event;
  }

 private:
  static constexpr std::uint64_t thread_order = std::uint64_t{1} << 62U;
  static constexpr std::size_t arity = 4;
  static constexpr std::size_t spare = 64;  // entries of events that are gone

  // Time, then order, in one number.
  __extension__ using Key = unsigned __int128;
  struct Entry {
    Key key = Key{static_cast<std::uint64_t>(never)} << 64U;
    Event* event = nullptr;
  };

  static Key key_of(const Event& event) {
    return Key{static_cast<std::uint64_t>(event.time)} << 64U | event.order;
  }
  static bool is_stale(const Entry& entry) {
    return !entry.event->scheduled || entry.event->order != static_cast<std::uint64_t>(entry.key);
  }

  void insert(const Entry& entry) {
    if (stale_ > spare + heap_.size() / 2) drop_stale();
    std::size_t hole = heap_.size();
    heap_.push_back(entry);
    while (hole > 0) {
      const std::size_t parent = (hole - 1) / arity;
      if (heap_[parent].key < entry.key) break;
      heap_[hole] = heap_[parent];
      hole = parent;
    }
    heap_[hole] = entry;
  }

  // Puts `entry` at `hole` or, where those are earlier, in the place of a descendant.
  void sink(std::size_t hole, const Entry& entry) {
    const std::size_t size = heap_.size();
    for (std::size_t child = arity * hole + 1; child < size; child = arity * hole + 1) {
      const std::size_t end = std::min(child + arity, size);
      std::size_t least = child;
      for (std::size_t i = child + 1; i < end; ++i)
        least = heap_[i].key < heap_[least].key ? i : least;
      if (entry.key < heap_[least].key) break;
      heap_[hole] = heap_[least];
      hole = least;
    }
    heap_[hole] = entry;
  }

  void find_front() {
    front_ = {};
    while (!heap_.empty() && empty()) {
      const Entry first = heap_.front(), last = heap_.back();
      heap_.pop_back();
      if (!heap_.empty()) sink(0, last);
      if (is_stale(first)) {
        --stale_;
      } else {
        front_ = first;
      }
    }
  }

  void drop_stale() {
    std::erase_if(heap_, is_stale);
    stale_ = 0;
    for (std::size_t i = heap_.size(); i-- > 0;) sink(i, Entry(heap_[i]));
  }

  Entry front_;              // not in the heap: often the only one
  std::vector<Entry> heap_;  // all others
  std::size_t stale_ = 0;    // of them
  std::uint64_t sequence_ = 0;
};

}  // namespace irt::many_core
