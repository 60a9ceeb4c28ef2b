/// What happens next: events in the order of simulated time.
///
/// The next few events stand in a short list, sorted, and all later ones in a heap. Where cores
/// compete nearly all of them wait at lines and few events are pending, so that taking one costs a
/// step and adding one a few. An event of the heap that is moved or removed leaves its entry
/// behind, which is dropped when its time comes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace irt::many_core {

/// Simulated time, and lengths of it, in picoseconds.
using Time = std::int64_t;
inline constexpr Time nanosecond = 1000;
inline constexpr Time never = std::numeric_limits<Time>::max();

struct Line;

/// Something that will happen; part of the object it happens to.
struct Event {
  Time time = 0;
  std::uint64_t order = 0;   ///< among events of the same time
  Line* line = nullptr;      ///< whose event it is; a line's comes before those of threads
  std::uint32_t thread = 0;  ///< whose event it is if `line` is null
  bool scheduled = false;
};

class EventQueue {
 public:
  EventQueue() = default;
  EventQueue(const EventQueue&) = delete;
  EventQueue& operator=(const EventQueue&) = delete;

  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// The next event, which stays there. There must be one.
  [[nodiscard]] const Event& front() const { return *soon_.events[count_]; }
  /// When the next event happens; `never` if there is none.
  [[nodiscard]] Time front_time() const { return soon_.times[count_]; }

  /// `event` must not be scheduled.
  void push(Event& event, Time time) {
    event.time = time;
    event.order = (event.line != nullptr ? 0 : thread_order) + ++sequence_;
    event.scheduled = true;
    if (count_ == places && is_soon(event)) make_room();
    if (!is_soon(event)) {
      add_later(event);
      return;
    }
    std::size_t at = ++count_;
    for (; soon_.is_before(at - 1, event); --at) soon_.copy(at - 1, at);
    soon_.put(at, event);
  }

  /// `event` must be scheduled.
  void remove(Event& event) {
    event.scheduled = false;
    if (!is_soon(event)) {
      ++stale_;
      return;
    }
    std::size_t at = count_;
    while (soon_.events[at] != &event) --at;
    for (; at < count_; ++at) soon_.copy(at + 1, at);
    if (--count_ == 0 && !later_.empty()) refill();
  }

  void move(Event& event, Time time) {
    if (event.scheduled) remove(event);
    push(event, time);
  }

  /// Takes the next event. There must be one.
  Event& pop() {
    Event& event = *soon_.events[count_];
    event.scheduled = false;
    if (--count_ == 0 && !later_.empty()) refill();
    return event;
  }

 private:
  static constexpr std::uint64_t thread_order = std::uint64_t{1} << 62U;
  static constexpr std::size_t places = 64;
  static constexpr std::size_t spare = 64;  // entries of events that are gone

  // Time, then order, in one number.
  __extension__ using Key = unsigned __int128;
  static constexpr Key last_key = Key{static_cast<std::uint64_t>(never)} << 64U | ~std::uint64_t{0};
  static Key key_of(const Event& event) {
    return Key{static_cast<std::uint64_t>(event.time)} << 64U | event.order;
  }

  // The list, the next event last. Before the first place stands one that nothing comes after. Each
  // figure has an array of its own: a processor that has just written two words must wait before it
  // can read both at once, which is how compilers copy entries.
  struct List {
    std::array<Time, places + 1> times{never};
    std::array<std::uint64_t, places + 1> orders{~std::uint64_t{0}};
    std::array<Event*, places + 1> events{};

    [[nodiscard]] bool is_before(std::size_t at, const Event& event) const {
      return times[at] < event.time || (times[at] == event.time && orders[at] < event.order);
    }
    void put(std::size_t at, Event& event) {
      times[at] = event.time;
      orders[at] = event.order;
      events[at] = &event;
    }
    void copy(std::size_t from, std::size_t to) {
      times[to] = times[from];
      orders[to] = orders[from];
      events[to] = events[from];
    }
  };
  // An event of the heap, as it was when it came there.
  struct Entry {
    Key key;
    Event* event;
    [[nodiscard]] bool is_stale() const { return !event->scheduled || key_of(*event) != key; }
  };
  struct IsLater {
    bool operator()(const Entry& a, const Entry& b) const { return a.key > b.key; }
  };

  // Whether the event's place is in the list.
  [[nodiscard]] bool is_soon(const Event& event) const { return key_of(event) < later_from_; }

  void add_later(Event& event) {
    if (stale_ > spare + later_.size() / 2) {
      std::erase_if(later_, [](const Entry& entry) { return entry.is_stale(); });
      std::ranges::make_heap(later_, IsLater());
      stale_ = 0;
    }
    later_.push_back({key_of(event), &event});
    std::ranges::push_heap(later_, IsLater());
  }

  // Moves half of the list to the heap.
  void make_room() {
    constexpr std::size_t half = places / 2;
    later_from_ = key_of(*soon_.events[half]);
    for (std::size_t i = 1; i <= half; ++i) {
      add_later(*soon_.events[i]);
      soon_.copy(half + i, i);
    }
    count_ = half;
  }

  // Fills half of the list, which is empty, from the heap.
  void refill() {
    std::array<Event*, places / 2> next;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    std::size_t count = 0;
    while (count < next.size() && !later_.empty()) {
      std::ranges::pop_heap(later_, IsLater());
      if (later_.back().is_stale()) {
        --stale_;
      } else {
        next[count++] = later_.back().event;
      }
      later_.pop_back();
    }
    while (count != 0) soon_.put(++count_, *next[--count]);
    later_from_ = later_.empty() ? last_key : later_.front().key;
  }

  List soon_;
  std::size_t count_ = 0;      // of the list
  Key later_from_ = last_key;  // all from here on are in the heap, all before in the list
  std::vector<Entry> later_;
  std::size_t stale_ = 0;  // of them
  std::uint64_t sequence_ = 0;
};

}  // namespace irt::many_core
