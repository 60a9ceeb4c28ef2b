/// What happens next, in the order of simulated time: threads run, lines serve requests.
///
/// A thread runs on until its clock would pass the next event (`sync`), or until it has nothing to
/// do before its own (`wait`). Its fiber then takes the events that come first: what happens to
/// lines happens there, and fibers are switched when it is another thread's turn.
#pragma once

#include <functional>
#include <string>

#include "bench/many_core/machine/posted_stores.hpp"
#include "bench/many_core/machine/run_queues.hpp"
#include "bench/many_core/machine/state.hpp"
#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::many_core {

/// How a run ended.
struct Ending {
  enum class Kind : std::uint8_t {
    finished,  ///< every thread returned
    asleep,    ///< all that are left wait for each other
    late,      ///< some did not return, long after they should have
    failed,    ///< the code cannot go on
  };
  Kind kind = Kind::finished;
  std::string message;
};

class EventLoop {
 public:
  using Body = std::function<void(unsigned thread)>;
  static constexpr std::uint64_t patience_events = 50'000'000;

  /// `threads` has at least one; each knows its number and its core.
  EventLoop(const Profile& profile, std::vector<Thread> threads, std::uint64_t seed,
            virtual_cores::Tenant& tenant);

  State& state() { return state_; }
  PostedStores& stores() { return stores_; }
  RunQueues& run_queues() { return run_queues_; }

  /// Runs `body(0)` as thread 0, outside of simulated time.
  Ending run_untimed(const Body& body);
  /// Runs `body(thread)` on every thread, from time 0. Counting begins with the measured part. Who
  /// has not returned at its limit is late; so are all when as many events as `patience_events`
  /// have passed since its end.
  Ending run(const Body& body);

  // Of the thread in progress.
  /// It has nothing to do until its event.
  void wait() { cores_.switch_to(going_on(next_thread())); }
  /// What happens before its next step happens first.
  void sync(Thread& me, Time ahead = 0) {
    if (me.clock >= me.deadline) reach_deadline(me);
    if (me.clock - ahead >= state_.events.front_time()) let_others(me, ahead);
  }
  /// Others that are ready for its hardware thread run first.
  void give_way(Thread& me) {
    if (run_queues_.rotate(me)) wait();
  }
  /// It has returned. Who goes on, or the host.
  unsigned finish(Thread& me);
  /// The code cannot go on.
  [[noreturn]] void fail(const std::string& what);

 private:
  static void enter(void* thread);

  // Notes that `thread`, or the host, goes on now.
  unsigned going_on(unsigned thread) {
    if (thread != virtual_cores::host) state_.current = &state_.threads[thread];
    return thread;
  }
  // Takes the next event. There must be one.
  Event& next_event() {
    Event& event = state_.events.pop();
    if (event.time >= mark_) pass_mark(event.time);
    return event;
  }
  void pass_mark(Time time);
  unsigned next_thread();
  void let_others(Thread& me, Time ahead);
  unsigned serve(Line& line, Time now, Time limit);
  void wake_watchers(const Line& line, Time now);
  void reach_deadline(Thread& me);
  [[noreturn]] void end_late(Time time);
  [[noreturn]] void end(Ending::Kind kind, const std::string& message);

  State state_;
  PostedStores stores_;
  RunQueues run_queues_;
  virtual_cores::Cores cores_;
  unsigned left_ = 0;  // threads that have not returned
  Time mark_ = 0;      // events before it are neither the first that counts nor after the end
  std::uint64_t events_after_ = 0;
  Ending ending_;
};

}  // namespace irt::many_core
