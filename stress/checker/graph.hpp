/// An execution as the standard sees it: events, what each read read from, and the order of stores
/// at each location. This file is the memory model.
///
/// The model is C++20 ([intro.races], [atomics.order], [atomics.fences]) without load buffering:
/// events are added one at a time, and a read chooses among the stores that are there.
///
///   - *Coherence* (coherence.hpp): a read may not read a store that is followed, in modification
///   order, by one
///     that happens before the read or was read by a read that happens before it; a store comes
///     after all such (write-write, read-read, read-write, write-read coherence).
///   - *Modification order* need not be the order of execution: a store may be put before stores
///     that were executed earlier, if coherence allows.
///   - *Read-modify-writes* follow immediately on the store they read.
///   - *Synchronisation*: an acquire read that reads from a release store, or from a chain of
///     read-modify-writes that begins with one (C++20's release sequences), or the same through
///     fences.
///   - *seq_cst*: a total order of seq_cst operations must exist that agrees with
///     strongly-happens-before and with coherence-ordered-before as C++20 defines them, fences
///     included (sc_order.cpp).
///   - *Failed compare-exchanges* are loads and may read any store a load may.
///
/// Not modelled: load buffering (reading a store that depends on the read's own outcome, or that
/// comes later in program order), consume (taken as acquire), and the tearing of accesses of
/// different sizes to the same bytes: a location has the size of the widest access.
#pragma once

#include <cstdint>
#include <vector>

#include "stress/checker/clock.hpp"
#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::checker {

using virtual_cores::Order;
using virtual_cores::Value;

enum class EventKind : std::uint8_t { initial, load, store, modify, fence, choice };

/// The number of an event in its execution.
using EventId = std::uint32_t;
inline constexpr EventId no_event = ~EventId{0};
inline constexpr std::uint16_t no_node = 0xFFFF;

/// An event's name that survives in another execution: the thread and its place there, or
/// `initial_ref` for the initial store of whatever location is meant.
using Ref = std::uint32_t;
inline constexpr Ref initial_ref = ~Ref{0};

struct Event {
  EventKind kind = EventKind::load;
  std::uint8_t thread = 0;
  Order order = Order::relaxed;
  bool blocked = false;          ///< a read that waits for another store
  bool reads = false;            ///< has a store it read from
  bool writes = false;           ///< is in its location's modification order
  bool failed = false;           ///< a compare-exchange that wrote nothing
  bool settled = false;          ///< a read of which no other way is looked at
  bool silent = false;           ///< has its place in every order and synchronises with nothing
  std::uint16_t index = 0;       ///< in its thread, from 1
  std::uint16_t node = no_node;  ///< among the seq_cst operations of its thread
  std::uint32_t location = 0;    ///< of loads, stores and modifications
  EventId from = no_event;       ///< the store read
  std::uint32_t option = 0;      ///< what a choice chose
  std::uint32_t read_stamp = 0;
  std::uint32_t write_stamp = 0;
  const void* pc = nullptr;
  Value read = 0;
  Value written = 0;
  Clock before;   ///< what happens before it, without what it acquires
  Clock after;    ///< what happens before its successor in the thread
  Clock message;  ///< what who acquires from it gets
  Clock causes;   ///< program order and reads-from, whatever the memory orders

  [[nodiscard]] Ref ref() const {
    return kind == EventKind::initial ? initial_ref : (Ref{thread} << 16U) | index;
  }
};

/// Whether `event` is in the past that `clock` has.
inline bool happens_before(const Event& event, const Clock& clock) {
  return event.kind == EventKind::initial || clock.count[event.thread] >= event.index;
}

/// An atomic object: an address, a size, its stores in modification order and its reads.
struct Location {
  std::uintptr_t address = 0;
  std::uint32_t size = 0;
  std::vector<EventId> stores;  ///< the first is the initial one
  std::vector<EventId> reads;   ///< loads and modifications, in order of execution
  std::uint32_t readers = 0;    ///< a bit for each thread that has some
};

/// What a thread carries besides its program: see [atomics.fences].
struct ThreadClocks {
  Clock now;
  Clock causes;
  Clock released;  ///< by its last release fence
  Clock pending;   ///< what an acquire fence would acquire
  std::vector<EventId> events;
  std::vector<EventId> seq_cst;               ///< seq_cst accesses and fences
  std::vector<std::uint16_t> seq_cst_fences;  ///< the fences among them, by their numbers
};

class Graph {
 public:
  /// With `on_x86` executions are those that x86 has, see tso_order.cpp.
  explicit Graph(unsigned threads, bool on_x86 = false) : threads_(threads), on_x86_(on_x86) {}

  void clear();

  /// A location that had no access yet, with what memory holds there.
  std::uint32_t add_location(std::uintptr_t address, std::uint32_t size, Value initial);
  /// A plain write has replaced what the location held; everything before happens before it.
  void reset_location(std::uint32_t location, Value initial);

  /// Begins an event of `thread`; one of the four below completes it. The reference is valid until
  /// the next call.
  Event& begin(EventKind kind, unsigned thread, Order order, const void* pc);

  /// Completes a load that reads the store at `place`.
  void finish_load(Event& event, std::uint32_t location, std::size_t place);
  /// Completes a store put at `place`, after which it is the store there.
  void finish_store(Event& event, std::uint32_t location, std::size_t place, Value value);
  /// Completes a modification that reads the store at `place` and writes `value`.
  void finish_modify(Event& event, std::uint32_t location, std::size_t place, Value value);
  void finish_fence(Event& event);
  void finish_choice(Event& event, std::uint32_t option);

  /// Whether a total order of the seq_cst operations exists with `event`, if one exists without it
  /// and nothing that happens after it.
  [[nodiscard]] bool keeps_seq_cst_order(const Event& event) const;
  /// That, and what x86 keeps besides if this is on x86.
  [[nodiscard]] bool keeps_orders(const Event& event) const {
    return keeps_seq_cst_order(event) && (!on_x86_ || keeps_total_store_order(event));
  }
  /// Whether one exists once `event`, not yet completed, is finished at `place`.
  bool allows(Event& event, std::uint32_t location, std::size_t place);

  /// `thread` goes on to a new moment, so that what it did by now can be told from what follows.
  void tick(unsigned thread) {
    ++threads_[thread].now.count[thread];
    threads_[thread].causes.count[thread] = threads_[thread].now.count[thread];
  }
  /// All that `earlier` did happens before what `later` does next: it created it or saw it end.
  void order(unsigned earlier, unsigned later);
  /// `event`, the last one, has also these causes.
  void depend(Event& event, const Clock& causes) {
    event.causes.join(causes);
    threads_[event.thread].causes = event.causes;
  }

  [[nodiscard]] const Event& event(EventId id) const { return events_[id]; }
  Event& event(EventId id) { return events_[id]; }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] const Location& location(std::uint32_t id) const { return locations_[id]; }
  [[nodiscard]] std::size_t locations() const { return location_count_; }
  [[nodiscard]] const ThreadClocks& thread(unsigned id) const { return threads_[id]; }
  [[nodiscard]] EventId id_of(const Event& event) const {
    return static_cast<EventId>(&event - events_.data());
  }
  [[nodiscard]] EventId find(Ref ref, std::uint32_t location) const;

 private:
  [[nodiscard]] bool keeps_total_store_order(const Event& event) const;
  void complete(Event& event);
  void read(Event& event, std::uint32_t location, const Event& store);
  void write(Event& event, std::uint32_t location, std::size_t place, Value value);

  std::vector<Event> events_;  ///< the first count_ are in use
  std::size_t count_ = 0;
  std::vector<Location> locations_;
  std::size_t location_count_ = 0;
  std::vector<ThreadClocks> threads_;
  std::size_t seq_cst_ = 0;  ///< accesses and fences of that order
  bool on_x86_ = false;
};

}  // namespace irt::checker
