/// Puts threads to sleep in the middle of operations, on its own initiative.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "stress/threads/slot.hpp"

namespace irt::stress {

/// A random word for each pair.
std::uint64_t mix_seed(std::uint64_t seed, std::uint64_t number);

/// While it is active, random threads are put to sleep at random moments, for up to a fifth of a
/// millisecond: long enough for others to go round a ring.
class Interrupter {
 public:
  /// `slots` outlives it.
  Interrupter(std::vector<Slot>& slots, std::uint64_t seed)
      : thread_([this, &slots, seed] { disturb(slots, seed); }) {}
  Interrupter(const Interrupter&) = delete;
  Interrupter& operator=(const Interrupter&) = delete;
  ~Interrupter();

  void set_active(bool active);

 private:
  enum class State : std::uint8_t { idle, active, over };

  void disturb(std::vector<Slot>& slots, std::uint64_t seed);

  std::atomic<State> state_{State::idle};
  std::thread thread_;
};

}  // namespace irt::stress
