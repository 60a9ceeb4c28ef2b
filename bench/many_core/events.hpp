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

  bool empty() const { return count_ == 0; }
  /// The next event, which stays there. There must be one.
  const Event& front() const { return *soon_[count_].event; }
  /// When the next event happens; `never` if there is none.
  Time front_time() const { return static_cast<Time>(soon_[count_].key >> 64U); }

  /// `event` must not be scheduled.
  void push(Event& event, Time time) {
    event.time = time;
    event.order = (event.line != nullptr ? 0 : thread_order) + ++sequence_;
    event.scheduled = true;
    const Entry entry{key_of(event), &event};
    if (entry.key < later_from_ && count_ == places) make_room();
    if (entry.key >= later_from_) {
      add_later(entry);
      return;
    }
    std::size_t at = ++count_;
    for (; soon_[at - 1].key < entry.key; --at) soon_[at] = soon_[at - 1];
    soon_[at] = entry;
  }

  /// `event` must be scheduled.
  void remove(Event& event) {
    event.scheduled = false;
    if (key_of(event) >= later_from_) {
      ++stale_;
      return;
    }
    std::size_t at = count_;
    while (soon_[at].event != &event) --at;
    for (; at < count_; ++at) soon_[at] = soon_[at + 1];
    if (--count_ == 0 && !later_.empty()) refill();
  }

  void move(Event& event, Time time) {
    if (event.scheduled) remove(event);
    push(event, time);
  }

  /// Takes the next event. There must be one.
  Event& pop() {
    Event& event = *soon_[count_].event;
    event.scheduled = false;
    if (--count_ == 0 && !later_.empty()) refill();
    return event;
  }

 private:
  static constexpr std::uint64_t thread_order = std::uint64_t{1} << 62U;
  static constexpr std::size_t places = 32;
  static constexpr std::size_t spare = 64;  // entries of events that are gone

  // Time, then order, in one number.
  __extension__ using Key = unsigned __int128;
  static constexpr Key last_key = Key{static_cast<std::uint64_t>(never)} << 64U | ~std::uint64_t{0};
  struct Entry {
    Key key = last_key;
    Event* event = nullptr;
  };

  static Key key_of(const Event& event) {
    return Key{static_cast<std::uint64_t>(event.time)} << 64U | event.order;
  }
  static bool is_stale(const Entry& entry) {
    return !entry.event->scheduled || entry.event->order != static_cast<std::uint64_t>(entry.key);
  }
  static bool is_later(const Entry& a, const Entry& b) { return a.key > b.key; }

  void add_later(const Entry& entry) {
    if (stale_ > spare + later_.size() / 2) {
      std::erase_if(later_, is_stale);
      std::ranges::make_heap(later_, is_later);
      stale_ = 0;
    }
    later_.push_back(entry);
    std::ranges::push_heap(later_, is_later);
  }

  // Moves half of the list to the heap.
  void make_room() {
    constexpr std::size_t half = places / 2;
    later_from_ = soon_[half].key;
    for (std::size_t i = 1; i <= half; ++i) {
      add_later(soon_[i]);
      soon_[i] = soon_[half + i];
    }
    count_ = half;
  }

  // Fills half of the list, which is empty, from the heap.
  void refill() {
    while (count_ < places / 2 && !later_.empty()) {
      std::ranges::pop_heap(later_, is_later);
      if (is_stale(later_.back())) {
        --stale_;
      } else {
        soon_[++count_] = later_.back();
      }
      later_.pop_back();
    }
    std::reverse(soon_.begin() + 1, soon_.begin() + 1 + static_cast<std::ptrdiff_t>(count_));
    later_from_ = later_.empty() ? last_key : later_.front().key;
  }

  // The next event is the last one of the list; the place before the first one stays empty.
  std::array<Entry, places + 1> soon_;
  std::size_t count_ = 0;
  Key later_from_ = last_key;  // all from here on are in the heap, all before in the list
  std::vector<Entry> later_;
  std::size_t stale_ = 0;  // of them
  std::uint64_t sequence_ = 0;
};

}  // namespace irt::many_core
