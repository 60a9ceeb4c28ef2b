/// What the code does to atomic objects, put into the graph. An access passes, in this order: the
/// loop that it may be in (loops.hpp), the turn of its thread (turns.hpp), its order as it may be
/// weakened (memory_orders.hpp), the watch on memory (memory_watch.hpp), its location
/// (locations.hpp), the strategy's choice, the graph, and becomes a step.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "stress/checker/alone.hpp"
#include "stress/checker/coherence.hpp"
#include "stress/checker/execution_state.hpp"
#include "stress/checker/locations.hpp"
#include "stress/checker/loops.hpp"
#include "stress/checker/memory_orders.hpp"
#include "stress/checker/memory_watch.hpp"
#include "stress/checker/turns.hpp"

namespace irt::checker {

class Accesses {
 public:
  /// What a read means, by the value it finds.
  enum class Meaning : std::uint8_t { load, modify, wait };

  /// A read that may write.
  struct Request {
    std::uintptr_t address;
    std::uint32_t size;
    const void* pc;
    Order success;
    Order failure;
    bool writes = true;     ///< it may
    bool silent = false;    ///< see Event
    bool compares = false;  ///< and writes nothing if it finds another value
  };

  Accesses(ExecutionState& state, Turns& turns, Alone& alone, Loops& loops, MemoryWatch& watch,
           Locations& locations)
      : state_(state),
        turns_(turns),
        alone_(alone),
        loops_(loops),
        watch_(watch),
        locations_(locations) {}

  Value load(const virtual_cores::Access& access);
  void store(const virtual_cores::Access& access, Value value);
  Value modify(const virtual_cores::Access& access, virtual_cores::Modification operation,
               Value operand);
  bool compare_exchange(const virtual_cores::Access& access, Order failure, bool weak,
                        Value& expected, Value desired);
  void fence(Order order, const void* pc);

  /// Reads what `decide(value)` gives a meaning, and writes `new_value(value)` where that is to
  /// modify. Waits its turn and, until it finds something else, where the meaning is to wait.
  template <class Decide, class NewValue>
  Value read(const Request& request, Decide decide, NewValue new_value) {
    turns_.reach(request.address, request.writes);
    return read_now(request, decide, new_value);
  }
  /// The same for what only looks, and never waits.
  Value look(const Request& request) {
    return read(
        request, [](Value) { return Meaning::load; }, [](Value value) { return value; });
  }
  /// The same for what always modifies.
  template <class NewValue>
  Value change(const Request& request, NewValue new_value) {
    return read(
        request, [](Value) { return Meaning::modify; }, new_value);
  }

  /// Those of the code in executions to come.
  [[nodiscard]] MemoryOrders& orders() { return orders_; }

 private:
  template <class Decide, class NewValue>
  Value read_now(const Request& request, Decide decide, NewValue new_value);
  template <class Decide, class NewValue>
  Value read_alone(const Request& request, Decide decide, NewValue new_value);
  template <class Decide>
  std::size_t choose_place(const Request& request, Event& event, const Part& part, Decide decide);
  std::size_t choose_place_of_store(Event& event, std::uint32_t location);
  static void mean(const Request& request, Event& event, Meaning meaning);
  void note_write(const Event& event, Value before);
  void step_alone(const virtual_cores::Access& access, bool writes);
  Order order_of(const virtual_cores::Access& access, EventKind kind) {
    return orders_.at(access.pc, false, kind, access.order);
  }
  [[nodiscard]] Value value_at(const Part& part, std::size_t place) const {
    const Graph& graph = state_.graph;
    return graph.event(graph.location(part.location).stores[place]).written >> part.shift &
           part.mask;
  }

  ExecutionState& state_;
  Turns& turns_;
  Alone& alone_;
  Loops& loops_;
  MemoryWatch& watch_;
  Locations& locations_;
  MemoryOrders orders_;
  std::vector<ReadOption> options_;
  std::vector<std::size_t> places_;
};

// The thread has begun to run alone: memory holds every value.
template <class Decide, class NewValue>
Value Accesses::read_alone(const Request& request, Decide decide, NewValue new_value) {
  if (is_made_up(request.address))
    state_.conclusion.give_up("a thread that makes too many steps waits or wakes");
  const Value value = virtual_cores::read_memory(request.address, request.size);
  const Meaning meaning = decide(value);
  if (meaning == Meaning::wait) alone_.conclude(true, request.pc);
  if (meaning == Meaning::modify) {
    alone_.note_write(request.address, request.size);
    virtual_cores::write_memory(request.address, request.size, new_value(value));
  }
  return value;
}

template <class Decide, class NewValue>
Value Accesses::read_now(const Request& request, Decide decide, NewValue new_value) {
  Graph& graph = state_.graph;
  for (;;) {
    if (!loops_.goes_on(request.pc)) return read_alone(request, decide, new_value);
    loops_.expect_news(request.pc);
    if (!is_made_up(request.address))
      watch_.touch(request.address, request.size, request.writes, true, request.pc);
    const Part part = locations_.at(request.address, request.size);
    const std::uint32_t id = part.location;
    const std::size_t newest = graph.location(id).stores.size() - 1;
    Event& event = graph.begin(EventKind::load, state_.current(), request.success, request.pc);
    event.silent = request.silent;
    const std::size_t place =
        state_.phase == Phase::parallel ? choose_place(request, event, part, decide) : newest;
    const Value value = value_at(part, place);
    const Meaning meaning = decide(value);
    mean(request, event, meaning);
    if (!event.settled) loops_.stop_insisting();
    if (meaning == Meaning::wait) {
      if (state_.phase == Phase::parallel && !state_.strategy->resumes_waiting()) {
        graph.finish_load(event, id, place);
        state_.add_step(event, newest - place);
      }
      turns_.wait(id + 1, request.pc);
      continue;
    }
    if (meaning == Meaning::modify) {
      const Value whole = graph.event(graph.location(id).stores[place]).written;
      const Value written = (whole & ~(part.mask << part.shift)) | (new_value(value) & part.mask)
                                                                       << part.shift;
      graph.finish_modify(event, id, place, written);
      note_write(event, whole);
    } else {
      graph.finish_load(event, id, place);
    }
    const EventId from = event.from;
    state_.add_step(event, newest - place);
    loops_.note_read(request.pc, from);
    return value;
  }
}

template <class Decide>
std::size_t Accesses::choose_place(const Request& request, Event& event, const Part& part,
                                   Decide decide) {
  Graph& graph = state_.graph;
  const std::uint32_t id = part.location;
  const std::size_t newest = graph.location(id).stores.size() - 1;
  const EventId insisted = loops_.insisted_on(request.pc);
  const auto same = insisted != no_event ? find_place(graph, id, insisted) : std::nullopt;
  if (const auto planned = state_.strategy->planned_place(state_, event, id)) {
    event.settled = same == planned && decide(value_at(part, *planned)) == Meaning::load;
    return *planned;
  }
  if (same) {
    mean(request, event, Meaning::load);
    event.settled = decide(value_at(part, *same)) == Meaning::load &&
                    *same >= lowest_readable(graph, event.thread, id) &&
                    graph.allows(event, id, *same);
    if (event.settled) return *same;
  }
  options_.clear();
  std::size_t lowest = loops_.must_be_fresh() ? newest : lowest_readable(graph, event.thread, id);
  if (const EventId old = loops_.worn_out(request.pc); old != no_event)
    if (const auto at = find_place(graph, id, old)) lowest = std::max(lowest, *at + 1);
  const bool verified = state_.strategy->wants_verified();
  for (std::size_t p = newest + 1; p-- > lowest;) {
    const Meaning meaning = decide(value_at(part, p));
    if (meaning == Meaning::wait && p != newest) continue;
    const bool modifies = meaning == Meaning::modify;
    const bool taken = modifies && !free_to_modify(graph, id, p);
    mean(request, event, meaning);
    if (!taken && verified && p != newest && !graph.allows(event, id, p)) continue;
    options_.push_back({p, modifies, meaning == Meaning::wait, taken});
  }
  if (state_.strategy->resumes_waiting()) {
    std::erase_if(options_, [](const ReadOption& o) { return o.taken; });
    if (options_.size() > 1) std::erase_if(options_, [](const ReadOption& o) { return o.waits; });
  }
  for (;;) {
    const std::size_t chosen = state_.strategy->choose_read(state_, event, id, options_);
    const ReadOption option = options_[chosen];
    mean(request, event, decide(value_at(part, option.place)));
    if (verified || option.place == newest || graph.allows(event, id, option.place))
      return option.place;
    options_.erase(options_.begin() + static_cast<std::ptrdiff_t>(chosen));
  }
}

}  // namespace irt::checker
