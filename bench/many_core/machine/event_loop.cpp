#include "bench/many_core/machine/event_loop.hpp"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <stdexcept>

namespace irt::many_core {

using virtual_cores::host;

EventLoop::EventLoop(const Profile& profile, std::vector<Thread> threads, std::uint64_t seed,
                     virtual_cores::Tenant& tenant)
    : state_(profile, std::move(threads), seed),
      stores_(profile, state_),
      run_queues_(profile, state_),
      cores_(tenant, static_cast<unsigned>(state_.threads.size())) {
  for (Thread& thread : state_.threads) {
    thread.stack = cores_.stack_of(thread.number);
    thread.stack_bytes = cores_.stack_bytes();
  }
}

void EventLoop::enter(void* argument) {
  const Thread& thread = *static_cast<const Thread*>(argument);
  (*thread.body)(thread.number);
}

Ending EventLoop::run_untimed(const Body& body) {
  ending_ = {};
  state_.threads[0].body = &body;
  cores_.arm(0, enter, state_.threads.data());
  cores_.run(going_on(0));
  return ending_;
}

Ending EventLoop::run(const Body& body) {
  ending_ = {};
  mark_ = state_.measurement.begin;
  left_ = static_cast<unsigned>(state_.threads.size());
  for (Thread& thread : state_.threads) {
    thread.body = &body;
    cores_.arm(thread.number, enter, &thread);
  }
  run_queues_.start();
  state_.timed = true;
  cores_.run(going_on(next_thread()));
  state_.timed = false;
  going_on(0);
  return ending_;
}

// Handles what happens to lines until something happens to a thread: returns that one.
unsigned EventLoop::next_thread() {
  while (!state_.events.empty()) {
    Event& event = next_event();
    if (event.line != nullptr) {
      const unsigned next = serve(*event.line, event.time, never);
      if (next != host) return next;
      continue;
    }
    Thread& thread = state_.threads[event.thread];
    if (thread.parked && !thread.woken) {
      run_queues_.time_out(thread, event.time);
      continue;
    }
    thread.clock = std::max(thread.clock, event.time);
    return event.thread;
  }
  if (left_ != 0) {
    ending_ = {Ending::Kind::asleep,
               fmt::format("{} of {} threads sleep, and nobody is left to wake them", left_,
                           state_.threads.size())};
  }
  return host;
}

// What happens before the thread's next step happens first. Lines need no other fiber for it.
void EventLoop::let_others(Thread& me, Time ahead) {
  EventQueue& events = state_.events;
  const Time limit = me.clock - ahead;
  while (events.front_time() < mark_ && events.front().line != nullptr) {
    const Event& event = next_event();
    const unsigned next = serve(*event.line, event.time, limit);
    if (next != host) {
      events.push(me.event, me.clock);
      cores_.switch_to(going_on(next));
      return;
    }
    if (limit < events.front_time()) return;
  }
  events.push(me.event, me.clock);
  wait();
}

// Serves a request. Where the thread that sent it goes on before anything else happens, and before
// `limit`, returns it instead of making an event of it.
unsigned EventLoop::serve(Line& line, Time now, Time limit) {
  if (now < line.available) {  // it was used meanwhile
    state_.events.push(line.event, line.available);
    return host;
  }
  const unsigned owner = line.owner;
  const auto [request, done, moved] = state_.directory.serve(line, now);
  Measurement& measurement = state_.measurement;
  measurement.counts.transfers += moved ? 1 : 0;
  if (line.watchers != nullptr && (request->want != Want::copy || owner != line.owner))
    wake_watchers(line, now);
  Thread& thread = state_.threads[request->thread];
  cores_.prefetch(thread.number);
  if (request->posted) {
    stores_.commit(thread, line, done);
    return host;
  }
  measurement.note_wait(Cause::queueing, request->arrival, now);
  measurement.note_wait(Cause::transfer, request->issued + (now - request->arrival), done);
  if (done >= std::min(state_.events.front_time(), limit)) {
    state_.events.push(thread.event, done);
    return host;
  }
  thread.clock = done;
  return thread.number;
}

// Somebody takes the line: whoever sleeps there in a loop goes on when its round is over.
void EventLoop::wake_watchers(const Line& line, Time now) {
  for (const Watch* watch = line.watchers; watch != nullptr; watch = watch->next) {
    Thread& thread = state_.threads[watch->thread];
    const Time period = thread.loop.period;
    const Time since = thread.clock;
    const Time next = since + (now - since + period - 1) / period * period;
    if (thread.event.scheduled && next < thread.event.time) state_.events.move(thread.event, next);
  }
}

// Events from `mark_` on: the first begins to count, those after the end are counted, too, for a
// run must end.
void EventLoop::pass_mark(Time time) {
  Measurement& measurement = state_.measurement;
  if (mark_ <= measurement.end) {
    measurement.counts = {};
    state_.directory.reset_statistics();
    mark_ = measurement.end + 1;
  }
  if (time > measurement.end && ++events_after_ > patience_events) end_late(time);
}

// Time is up, for this quantum or for the run.
void EventLoop::reach_deadline(Thread& me) {
  if (me.clock >= state_.measurement.limit()) end_late(me.clock);
  give_way(me);
}

void EventLoop::end_late(Time time) {
  end(Ending::Kind::late,
      fmt::format("{} of {} threads are still busy {:.1f} ms after they should have stopped", left_,
                  state_.threads.size(), static_cast<double>(time - state_.measurement.end) / 1e9));
}

void EventLoop::fail(const std::string& what) {
  if (virtual_cores::current_core == host) throw std::runtime_error(what);
  end(Ending::Kind::failed, what);
}

void EventLoop::end(Ending::Kind kind, const std::string& message) {
  ending_ = {kind, message};
  cores_.switch_to(host);
  std::abort();  // nobody switches back
}

unsigned EventLoop::finish(Thread& me) {
  if (!state_.timed) return host;
  --left_;
  run_queues_.leave(me);
  return going_on(next_thread());
}

}  // namespace irt::many_core
