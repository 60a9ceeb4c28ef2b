#include "stress/checker/accesses.hpp"

namespace irt::checker {

using virtual_cores::Access;

void Accesses::mean(const Request& request, Event& event, Meaning meaning) {
  event.kind = meaning == Meaning::modify ? EventKind::modify : EventKind::load;
  event.order = meaning == Meaning::modify ? request.success
                : meaning == Meaning::load ? request.failure
                                           : Order::relaxed;
  event.blocked = meaning == Meaning::wait;
  event.failed = request.compares && meaning == Meaning::load;
}

void Accesses::note_write(const Event& event, Value before) {
  ++state_.stores;
  const Location& location = state_.graph.location(event.location);
  if (event.written != before) loops_.note_effect();
  if (location.stores.back() == state_.graph.id_of(event) && !is_made_up(location.address))
    virtual_cores::write_memory(location.address, location.size, event.written);
}

// Outside of the threads' time everything happens before or after everything else, so that a read
// finds what memory holds and nothing needs an event.
void Accesses::step_alone(const Access& access, bool writes) {
  if (!state_.observed()) return alone_.pass_unwatched();
  if (!is_made_up(access.address))
    state_.note(writes ? Look::Kind::write : Look::Kind::read, access.address, access.size);
  watch_.touch(access.address, access.size, writes, true, access.pc);
  alone_.step(access.address, access.size, writes, access.pc);
}

Value Accesses::load(const Access& access) {
  if (state_.phase != Phase::parallel) {
    step_alone(access, false);
    return virtual_cores::read_memory(access.address, access.size);
  }
  loops_.enter(access.pc);
  turns_.reach(access.address, false);
  const Order order = order_of(access, EventKind::load);
  return read_now(
      {access.address, access.size, access.pc, order, order, false},
      [](Value) { return Meaning::load; }, [](Value value) { return value; });
}

Value Accesses::modify(const Access& access, virtual_cores::Modification operation, Value operand) {
  const auto changed = [&](Value value) {
    return virtual_cores::apply(operation, value, operand, access.size);
  };
  if (state_.phase != Phase::parallel) {
    step_alone(access, true);
    const Value before = virtual_cores::read_memory(access.address, access.size);
    virtual_cores::write_memory(access.address, access.size, changed(before));
    return before;
  }
  loops_.enter(access.pc);
  turns_.reach(access.address, true);
  const Order order = order_of(access, EventKind::modify);
  return read_now(
      {access.address, access.size, access.pc, order, order}, [](Value) { return Meaning::modify; },
      changed);
}

bool Accesses::compare_exchange(const Access& access, Order failure, bool weak, Value& expected,
                                Value desired) {
  const Value wanted = expected;
  if (state_.phase != Phase::parallel) {
    step_alone(access, true);
    expected = virtual_cores::read_memory(access.address, access.size);
    if (expected == wanted) virtual_cores::write_memory(access.address, access.size, desired);
    return expected == wanted;
  }
  loops_.enter(access.pc);
  const bool fails = weak && state_.limits.weak_may_fail && loops_.chosen_once(access.pc);
  turns_.reach(access.address, true);
  const Order success = order_of(access, EventKind::modify);
  expected = read_now(
      {.address = access.address,
       .size = access.size,
       .pc = access.pc,
       .success = success,
       .failure = orders_.at(access.pc, true, EventKind::modify, failure),
       .writes = !fails,
       .compares = true},
      [&](Value value) { return value == wanted && !fails ? Meaning::modify : Meaning::load; },
      [&](Value) { return desired; });
  return expected == wanted && !fails;
}

void Accesses::store(const Access& access, Value value) {
  if (state_.phase != Phase::parallel) {
    step_alone(access, true);
    return virtual_cores::write_memory(access.address, access.size, value);
  }
  turns_.reach(access.address, true);
  watch_.touch(access.address, access.size, true, true, access.pc);
  if (!loops_.goes_on(access.pc)) {
    alone_.note_write(access.address, access.size);
    return virtual_cores::write_memory(access.address, access.size, value);
  }
  const std::uint32_t id = locations_.at(access.address, access.size).location;
  Graph& graph = state_.graph;
  if (graph.location(id).size != access.size) {
    // A part of a wider location is put in place as if by a modification of the whole.
    read_now(
        {access.address, access.size, access.pc, access.order, access.order},
        [](Value) { return Meaning::modify; }, [value](Value) { return value; });
    return;
  }
  Event& event = graph.begin(EventKind::store, state_.current(), order_of(access, EventKind::store),
                             access.pc);
  const std::size_t last = graph.location(id).stores.size();
  const std::size_t place = choose_place_of_store(event, id);
  graph.finish_store(event, id, place, value);
  loops_.note_effect();
  note_write(event, value);
  state_.add_step(event, last - place);
}

std::size_t Accesses::choose_place_of_store(Event& event, std::uint32_t location) {
  if (const auto planned = state_.strategy->planned_place(state_, event, location)) return *planned;
  Graph& graph = state_.graph;
  places_.clear();
  const std::size_t last = graph.location(location).stores.size();
  const std::size_t lowest = lowest_readable(graph, event.thread, location) + 1;
  for (std::size_t p = last + 1; p-- > lowest;)
    if (free_to_place(graph, location, p) && (p == last || graph.allows(event, location, p)))
      places_.push_back(p);
  return places_[state_.strategy->choose_place(state_, event, location, places_)];
}

void Accesses::fence(Order order, const void* pc) {
  if (state_.phase != Phase::parallel) return;
  turns_.reach(0, false);
  if (!loops_.goes_on(pc)) return;
  Event& event = state_.graph.begin(EventKind::fence, state_.current(),
                                    orders_.at(pc, false, EventKind::fence, order), pc);
  state_.graph.finish_fence(event);
  state_.add_step(event, 0);
}

}  // namespace irt::checker
