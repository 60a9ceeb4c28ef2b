#include "bench/many_core/machine/machine.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>
#include <stdexcept>

namespace irt::many_core {

using virtual_cores::host;

std::string_view name_of(Cause cause) {
  static constexpr std::array<std::string_view, causes> names{"transfer", "queueing", "stores",
                                                              "spinning", "parked",   "scheduler"};
  return names[static_cast<std::size_t>(cause)];
}

std::vector<unsigned> place(const Profile& profile, unsigned threads, Placement placement) {
  std::vector<unsigned> order(profile.threads());
  for (unsigned i = 0; i < order.size(); ++i) order[i] = i;
  // Where a hardware thread comes in the order, as its rank among those like it, then the rest.
  const auto by = [&order](auto key) {
    std::ranges::stable_sort(order, [key](unsigned a, unsigned b) { return key(a) < key(b); });
  };
  if (placement == Placement::siblings)
    by([&profile](unsigned thread) { return profile.core_of(thread); });
  if (placement == Placement::spread) {
    const unsigned per_socket = profile.cores() / profile.sockets;
    by([&profile, per_socket](unsigned thread) {
      return std::pair(thread / profile.cores(), profile.core_of(thread) % per_socket);
    });
  }
  std::vector<unsigned> places;
  for (unsigned i = 0; i < threads; ++i) places.push_back(order[i % order.size()]);
  return places;
}

std::vector<Level> levels(const Profile& profile, Placement placement) {
  const std::vector<unsigned> order = place(profile, profile.threads(), placement);
  const auto first = [&order](auto is_beyond) {
    return static_cast<unsigned>(std::ranges::find_if(order, is_beyond) - order.begin());
  };
  std::vector<Level> found;
  const auto within = [&](Distance most, std::string_view name) {
    found.push_back(
        {first([&](unsigned thread) { return profile.distance(order[0], thread) > most; }), name});
  };
  within(Distance::same_cache, "one cache");
  within(Distance::same_node, "one node");
  within(Distance::same_socket, "one socket");
  std::set<unsigned> cores;
  found.push_back(
      {first([&](unsigned thread) { return !cores.insert(profile.core_of(thread)).second; }),
       "a core each"});
  found.push_back({profile.threads(), "all hardware threads"});
  std::erase_if(found, [](const Level& level) { return level.threads < 2; });
  // Of those at the same number the last is the largest group.
  std::ranges::reverse(found);
  std::ranges::stable_sort(found, {}, &Level::threads);
  const auto alike = [](const Level& a, const Level& b) { return a.threads == b.threads; };
  found.erase(std::unique(found.begin(), found.end(), alike), found.end());
  return found;
}

Machine::Machine(const Profile& profile, const std::vector<unsigned>& hardware_threads,
                 std::uint64_t seed)
    : profile_(profile),
      alone_(profile, 1),
      beside_sibling_(profile, profile.smt_slowdown),
      syscall_(picoseconds(profile.syscall)),
      futex_wait_(picoseconds(profile.futex_wait)),
      wake_call_(picoseconds(profile.wake_call)),
      wake_latency_(picoseconds(profile.wake_latency)),
      switch_(picoseconds(profile.switch_same_core)),
      quantum_(picoseconds(profile.quantum)),
      directory_(profile, events_, seed),
      heap_(static_cast<unsigned>(hardware_threads.size())),
      threads_(hardware_threads.size()),
      hardware_(profile.threads()),
      cores_(*this, static_cast<unsigned>(hardware_threads.size())) {
  for (unsigned i = 0; i < threads_.size(); ++i) {
    Thread& thread = threads_[i];
    thread.number = thread.event.thread = i;
    thread.core = Topology::place_of(profile, hardware_threads[i]);
    thread.costs = &alone_;
    thread.stack = cores_.stack_of(i);
    thread.stack_bytes = cores_.stack_bytes();
    for (Watch& watch : thread.loop.watches) watch.thread = i;
  }
}

Machine::~Machine() = default;

namespace {
// What a fiber begins with; one machine runs at a time.
Machine* running = nullptr;
}  // namespace

void Machine::enter(void* argument) {
  const unsigned thread = static_cast<Thread*>(argument)->number;
  if (running->timed_) {
    running->body_(thread);
  } else {
    running->set_up_();
  }
}

void Machine::set_up(const std::function<void()>& body) {
  running = this;
  timed_ = false;
  set_up_ = body;
  ending_ = {};
  cores_.arm(0, enter, threads_.data());
  cores_.run(going_on(0));
  if (ending_.kind == Ending::Kind::failed) throw std::runtime_error(ending_.message);
}

Ending Machine::run(Time count_from, Time until, std::function<void(unsigned)> body) {
  running = this;
  heap_.mark_used();
  body_ = std::move(body);
  count_from_ = count_from;
  until_ = until;
  limit_ = until + patience;
  mark_ = count_from;
  ending_ = {};
  left_ = static_cast<unsigned>(threads_.size());
  for (Thread& thread : threads_) {
    cores_.arm(thread.number, enter, &thread);
    Hardware& hardware = hardware_[thread.core];
    if (hardware.running == nobody) {
      set_busy(thread.core, thread.number);
      events_.push(thread.event, 0);
    } else {
      hardware.ready.push_back(thread.number);
    }
  }
  for (unsigned place = 0; place < hardware_.size(); ++place) {
    hardware_[place].quantum_end = quantum_;
    set_deadline(place);
  }
  timed_ = true;
  cores_.run(going_on(next_thread()));
  timed_ = false;
  return ending_;
}

// Handles what happens to lines until something happens to a thread: returns that one.
unsigned Machine::next_thread() {
  while (!events_.empty()) {
    Event& event = next_event();
    if (event.line != nullptr) {
      const unsigned next = serve(*event.line, event.time, never);
      if (next != host) return next;
      continue;
    }
    Thread& thread = threads_[event.thread];
    if (thread.parked && !thread.woken) {
      time_out(thread, event.time);
      continue;
    }
    thread.clock = std::max(thread.clock, event.time);
    return event.thread;
  }
  if (left_ != 0) {
    ending_ = {Ending::Kind::asleep,
               fmt::format("{} of {} threads sleep, and nobody is left to wake them", left_,
                           threads_.size())};
  }
  return host;
}

// What happens before the thread's next step happens first. Lines need no other fiber for it.
void Machine::let_others(Thread& me, Time ahead) {
  const Time limit = me.clock - ahead;
  while (events_.front_time() < mark_ && events_.front().line != nullptr) {
    const Event& event = next_event();
    const unsigned next = serve(*event.line, event.time, limit);
    if (next != host) {
      events_.push(me.event, me.clock);
      cores_.switch_to(going_on(next));
      return;
    }
    if (limit < events_.front_time()) return;
  }
  events_.push(me.event, me.clock);
  go_on();
}

// Serves a request. Where the thread that sent it goes on before anything else happens, and before
// `limit`, returns it instead of making an event of it.
unsigned Machine::serve(Line& line, Time now, Time limit) {
  if (now < line.available) {  // it was used meanwhile
    events_.push(line.event, line.available);
    return host;
  }
  const unsigned owner = line.owner;
  const auto [request, done, moved] = directory_.serve(line, now);
  counts_.transfers += moved ? 1 : 0;
  if (line.watchers != nullptr && (request->want != Want::copy || owner != line.owner))
    wake_watchers(line, now);
  Thread& thread = threads_[request->thread];
  cores_.prefetch(thread.number);
  if (request->posted) {
    commit_store(thread, line, done);
    return host;
  }
  note_wait(Cause::queueing, request->arrival, now);
  note_wait(Cause::transfer, request->issued + (now - request->arrival), done);
  if (done >= std::min(events_.front_time(), limit)) {
    events_.push(thread.event, done);
    return host;
  }
  ++events_taken_;
  thread.clock = done;
  return thread.number;
}

// Events from `mark_` on: the first begins to count, those after `until_` are counted, too, for a
// run must end.
void Machine::pass_mark(Time time) {
  if (!counting_) start_counting();
  mark_ = until_ + 1;
  if (time > until_ && ++events_after_ > patience_events) end_late(time);
}

void Machine::start_counting() {
  counting_ = true;
  counts_ = {};
  directory_.reset_statistics();
}

// Time is up, for this quantum or for the run.
void Machine::reach_deadline(Thread& me) {
  if (me.clock >= limit_) end_late(me.clock);
  give_way(me);
}

void Machine::end_late(Time time) {
  end(Ending::Kind::late,
      fmt::format("{} of {} threads are still busy {:.1f} ms after they should have stopped", left_,
                  threads_.size(), static_cast<double>(time - until_) / 1e9));
}

void Machine::end(Ending::Kind kind, const std::string& message) {
  ending_ = {kind, message};
  cores_.switch_to(host);
  std::abort();  // nobody switches back
}

unsigned Machine::finished(unsigned core) {
  if (!timed_) return host;
  Thread& thread = threads_[core];
  --left_;
  set_busy(thread.core, nobody);
  run_next(hardware_[thread.core], thread.clock);
  return going_on(next_thread());
}

void Machine::on_failure(const std::string& what, const void* /*pc*/) {
  if (virtual_cores::current_core == host) throw std::runtime_error(what);
  end(Ending::Kind::failed, what);
}

Time Machine::last_clock() const {
  return std::ranges::max(threads_, {}, &Thread::clock).clock;
}

void Machine::work(double ns) {
  if (timed_) me_->clock += picoseconds(ns * me_->costs->slowdown);
}

std::int64_t Machine::now() {
  return timed_ && virtual_cores::current_core != host ? me_->clock / nanosecond : 0;
}

}  // namespace irt::many_core
