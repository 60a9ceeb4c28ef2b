#include "bench/many_core/machine/run_queues.hpp"

#include <algorithm>

namespace irt::many_core {

RunQueues::RunQueues(const Profile& profile, State& state)
    : state_(state),
      smt_(profile.smt),
      alone_(profile, 1),
      beside_sibling_(profile, profile.smt_slowdown),
      wake_latency_(picoseconds(profile.wake_latency)),
      switch_(picoseconds(profile.switch_same_core)),
      quantum_(picoseconds(profile.quantum)),
      hardware_(profile.threads()) {
  for (Thread& thread : state.threads) thread.costs = &alone_;
}

void RunQueues::start() {
  for (Thread& thread : state_.threads) {
    Hardware& hardware = hardware_[thread.core];
    if (hardware.running == nobody) {
      set_busy(thread.core, thread.number);
      state_.events.push(thread.event, 0);
    } else {
      hardware.ready.push_back(thread.number);
    }
  }
  for (unsigned place = 0; place < hardware_.size(); ++place) {
    hardware_[place].quantum_end = quantum_;
    set_deadline(place);
  }
}

void RunQueues::wake(Thread& thread, Time at) {
  if (thread.event.scheduled) state_.events.remove(thread.event);
  thread.woken = true;
  Hardware& hardware = hardware_[thread.core];
  const bool idle = hardware.running == nobody;
  const Time ready = std::max(at, thread.clock) + (idle ? wake_latency_ : 0);
  state_.measurement.note_wait(Cause::parked, thread.clock, ready);
  thread.clock = ready;
  if (idle) {
    set_busy(thread.core, thread.number);
    hardware.quantum_end = ready + quantum_;
    state_.events.push(thread.event, ready);
  } else {
    hardware.ready.push_back(thread.number);
  }
  set_deadline(thread.core);
}

void RunQueues::time_out(Thread& thread, Time at) {
  if (thread.asleep_among != nullptr) std::erase(thread.asleep_among->threads, thread.number);
  thread.timed_out = true;
  wake(thread, at);
}

void RunQueues::leave(Thread& me) {
  set_busy(me.core, nobody);
  run_next(hardware_[me.core], me.clock);
}

bool RunQueues::rotate(Thread& me) {
  Hardware& hardware = hardware_[me.core];
  if (hardware.ready.empty()) return false;
  hardware.ready.push_back(me.number);
  run_next(hardware, me.clock);
  return true;
}

// The hardware thread is free at `at`: the next of those that are ready has it.
void RunQueues::run_next(Hardware& hardware, Time at) {
  if (hardware.ready.empty()) return;
  Thread& next = state_.threads[hardware.ready.front()];
  hardware.ready.pop_front();
  set_busy(next.core, next.number);
  const Time begin = std::max(at + switch_, next.clock);
  state_.measurement.note_wait(Cause::scheduler, next.clock, begin);
  hardware.quantum_end = begin + quantum_;
  set_deadline(next.core);
  state_.events.push(next.event, begin);
}

// When the thread that runs must look up: at the end of its quantum or of the run.
void RunQueues::set_deadline(unsigned place) {
  const Hardware& hardware = hardware_[place];
  if (hardware.running == nobody) return;
  Thread& thread = state_.threads[hardware.running];
  const Time limit = state_.measurement.limit();
  thread.deadline = hardware.ready.empty() ? limit : std::min(limit, hardware.quantum_end);
  // A thread that sleeps in a loop looks up, too.
  if (thread.loop.period != 0 && thread.event.scheduled && thread.deadline < thread.event.time)
    state_.events.move(thread.event, std::max(thread.deadline, thread.clock));
}

// Notes who runs on a hardware thread; siblings are slower beside each other.
void RunQueues::set_busy(unsigned place, unsigned thread) {
  hardware_[place].running = thread;
  const unsigned first = place / smt_ * smt_;
  unsigned busy = 0;
  for (unsigned i = first; i < first + smt_; ++i) busy += hardware_[i].running != nobody ? 1 : 0;
  for (unsigned i = first; i < first + smt_; ++i)
    if (hardware_[i].running != nobody)
      state_.threads[hardware_[i].running].costs = busy > 1 ? &beside_sibling_ : &alone_;
}

}  // namespace irt::many_core
