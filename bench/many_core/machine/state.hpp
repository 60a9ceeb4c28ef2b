/// What the parts of a simulated machine share.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "bench/many_core/coherence/directory.hpp"
#include "bench/many_core/machine/counts.hpp"
#include "bench/many_core/machine/thread.hpp"

namespace irt::many_core {

struct State {
  /// `threads` has at least one.
  State(const Profile& profile, std::vector<Thread> threads_of_run, std::uint64_t seed)
      : directory(profile, events, seed),
        threads(std::move(threads_of_run)),
        current(threads.data()) {}

  /// Whether nothing else happens before the thread's next step, or before it is `ahead` of others.
  [[nodiscard]] bool is_next(const Thread& me, Time ahead) const {
    return me.clock < me.deadline && me.clock - ahead < events.front_time();
  }

  EventQueue events;  ///< of threads and lines
  Directory directory;
  std::vector<Thread> threads;
  Thread* current;     ///< in progress; outside of simulated time the first
  bool timed = false;  ///< in simulated time
  Measurement measurement;
};

}  // namespace irt::many_core
