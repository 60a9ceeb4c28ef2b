#include "stress/checker/graph.hpp"

namespace irt::checker {

using virtual_cores::acquires;
using virtual_cores::releases;

void Graph::clear() {
  count_ = 0;
  location_count_ = 0;
  seq_cst_ = 0;
  for (ThreadClocks& thread : threads_) {
    thread.now = thread.causes = thread.released = thread.pending = Clock{};
    thread.events.clear();
    thread.seq_cst.clear();
    thread.seq_cst_fences.clear();
  }
}

std::uint32_t Graph::add_location(std::uintptr_t address, std::uint32_t size, Value initial) {
  const auto id = static_cast<std::uint32_t>(location_count_++);
  if (id == locations_.size()) locations_.emplace_back();
  locations_[id].address = address;
  locations_[id].size = size;
  reset_location(id, initial);
  return id;
}

void Graph::reset_location(std::uint32_t id, Value initial) {
  if (count_ == events_.size()) events_.resize(count_ + 256);
  Event& event = events_[count_];
  event = Event{};
  event.kind = EventKind::initial;
  event.writes = true;
  event.location = id;
  event.written = initial;
  locations_[id].reads.clear();
  locations_[id].readers = 0;
  locations_[id].stores.assign(1, static_cast<EventId>(count_++));
}

Event& Graph::begin(EventKind kind, unsigned thread, Order order, const void* pc) {
  if (count_ == events_.size()) events_.resize(count_ + 256);
  Event& event = events_[count_];
  ThreadClocks& mine = threads_[thread];
  event.kind = kind;
  event.thread = static_cast<std::uint8_t>(thread);
  event.order = order;
  event.blocked = event.reads = event.writes = event.failed = event.settled = event.silent = false;
  event.index = static_cast<std::uint16_t>(mine.now.count[thread] + 1);
  event.node = no_node;
  event.from = no_event;
  event.option = 0;
  event.read_stamp = event.write_stamp = 0;
  event.pc = pc;
  event.read = event.written = 0;
  event.before = mine.now;
  event.after = mine.now;
  event.after.count[thread] = event.index;
  event.causes = mine.causes;
  event.causes.count[thread] = event.index;
  event.message = Clock{};
  return event;
}

EventId Graph::find(Ref ref, std::uint32_t location) const {
  if (ref == initial_ref) return locations_[location].stores.front();
  const ThreadClocks& thread = threads_[ref >> 16U];
  const std::size_t index = ref & 0xFFFFU;
  return index <= thread.events.size() ? thread.events[index - 1] : no_event;
}

void Graph::read(Event& event, std::uint32_t id, const Event& store) {
  event.location = id;
  event.reads = true;
  event.from = id_of(store);
  event.read = store.written;
  event.causes.join(store.causes);
  locations_[id].reads.push_back(static_cast<EventId>(count_));
  locations_[id].readers |= 1U << event.thread;
  if (event.silent) return;
  if (acquires(event.order))
    event.after.join(store.message);
  else
    threads_[event.thread].pending.join(store.message);
}

void Graph::write(Event& event, std::uint32_t id, std::size_t place, Value value) {
  event.location = id;
  event.writes = true;
  event.written = value;
  std::vector<EventId>& stores = locations_[id].stores;
  stores.insert(stores.begin() + static_cast<std::ptrdiff_t>(place), static_cast<EventId>(count_));
  if (event.silent) return;
  event.message.join(releases(event.order) ? event.after : threads_[event.thread].released);
}

void Graph::complete(Event& event) {
  ThreadClocks& mine = threads_[event.thread];
  mine.now = event.after;
  mine.causes = event.causes;
  mine.events.push_back(static_cast<EventId>(count_));
  if (event.order == Order::seq_cst && event.kind != EventKind::choice) {
    event.node = static_cast<std::uint16_t>(mine.seq_cst.size());
    if (event.kind == EventKind::fence) mine.seq_cst_fences.push_back(event.node);
    mine.seq_cst.push_back(static_cast<EventId>(count_));
    ++seq_cst_;
  }
  ++count_;
}

void Graph::finish_load(Event& event, std::uint32_t id, std::size_t place) {
  read(event, id, events_[locations_[id].stores[place]]);
  complete(event);
}

void Graph::finish_store(Event& event, std::uint32_t id, std::size_t place, Value value) {
  write(event, id, place, value);
  complete(event);
}

void Graph::finish_modify(Event& event, std::uint32_t id, std::size_t place, Value value) {
  const Event& store = events_[locations_[id].stores[place]];
  read(event, id, store);
  event.message = store.message;  // the release sequence goes on
  write(event, id, place + 1, value);
  complete(event);
}

void Graph::finish_fence(Event& event) {
  ThreadClocks& mine = threads_[event.thread];
  if (acquires(event.order)) event.after.join(mine.pending);
  if (releases(event.order)) mine.released = event.after;
  complete(event);
}

void Graph::finish_choice(Event& event, std::uint32_t option) {
  event.option = option;
  complete(event);
}

void Graph::order(unsigned earlier, unsigned later) {
  threads_[later].now.join(threads_[earlier].now);
  threads_[later].causes.join(threads_[earlier].causes);
}

}  // namespace irt::checker
