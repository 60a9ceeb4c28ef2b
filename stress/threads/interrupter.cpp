#include "stress/threads/interrupter.hpp"

#include <chrono>

#include "stress/threads/signals.hpp"

namespace irt::stress {

std::uint64_t mix_seed(std::uint64_t seed, std::uint64_t number) {
  std::uint64_t z = seed * 0x9e3779b97f4a7c15U + number;
  z = (z ^ (z >> 31)) * 0xd6e8feb86659fd93U;
  return z ^ (z >> 32);
}

Interrupter::~Interrupter() {
  state_.store(State::over, std::memory_order_relaxed);
  state_.notify_one();
  thread_.join();
}

void Interrupter::set_active(bool active) {
  const State state = active ? State::active : State::idle;
  if (state_.exchange(state, std::memory_order_relaxed) != state) state_.notify_one();
}

void Interrupter::disturb(std::vector<Slot>& slots, std::uint64_t seed) {
  std::uint64_t random = seed;
  for (;;) {
    state_.wait(State::idle, std::memory_order_relaxed);
    if (state_.load(std::memory_order_relaxed) == State::over) return;
    random = mix_seed(random, 1);
    stall(slots[random % slots.size()], 1'000 + (random >> 20) % 200'000);
    std::this_thread::sleep_for(std::chrono::microseconds(10 + (random >> 40) % 60));
  }
}

}  // namespace irt::stress
