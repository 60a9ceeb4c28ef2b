#include "bench/many_core/machine/machine.hpp"

#include <algorithm>
#include <stdexcept>

namespace irt::many_core {

namespace {

std::vector<Thread> threads_on(const Profile& profile,
                               const std::vector<unsigned>& hardware_threads) {
  std::vector<Thread> threads(hardware_threads.size());
  for (unsigned i = 0; i < threads.size(); ++i) {
    threads[i].number = threads[i].event.thread = i;
    threads[i].core = Topology::place_of(profile, hardware_threads[i]);
    for (Watch& watch : threads[i].loop.watches) watch.thread = i;
  }
  return threads;
}

}  // namespace

Machine::Machine(const Profile& profile, const std::vector<unsigned>& hardware_threads,
                 std::uint64_t seed)
    : heap_(static_cast<unsigned>(hardware_threads.size())),
      loop_(profile, threads_on(profile, hardware_threads), seed, tenant_),
      state_(loop_.state()),
      accesses_(profile, loop_, heap_),
      kernel_(profile, loop_, accesses_),
      library_(heap_, accesses_, kernel_),
      tenant_(loop_, accesses_, kernel_, library_, heap_) {}

void Machine::set_up(const std::function<void()>& body) {
  const Ending ending = loop_.run_untimed([&body](unsigned) { body(); });
  if (ending.kind == Ending::Kind::failed) throw std::runtime_error(ending.message);
}

Ending Machine::run(Time count_from, Time until, const EventLoop::Body& body) {
  heap_.mark_used();
  state_.measurement.begin = count_from;
  state_.measurement.end = until;
  return loop_.run(body);
}

void Machine::work(double ns) {
  Thread& me = *state_.current;
  if (state_.timed) me.clock += picoseconds(ns * me.costs->slowdown);
}

void Machine::idle(double ns) {
  work(ns);
  loop_.sync(*state_.current);
}

Time Machine::last_clock() const {
  return std::ranges::max(state_.threads, {}, &Thread::clock).clock;
}

}  // namespace irt::many_core
