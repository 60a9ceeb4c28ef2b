#include "stress/threads/watchdog.hpp"

#include <fmt/format.h>

#include "stress/threads/allocator.hpp"
#include "stress/threads/kernel_view.hpp"
#include "stress/threads/perturbation.hpp"
#include "stress/threads/sanitizer.hpp"
#include "stress/threads/signals.hpp"

namespace irt::stress {

using namespace std::chrono_literals;

Watchdog::Watchdog(std::vector<Slot>& slots, std::chrono::milliseconds patience,
                   Messenger& messenger)
    : slots_(slots),
      patience_(patience),
      messenger_(messenger),
      cpu_times_(slots.size()),
      thread_([this] { watch(); }) {}

Watchdog::~Watchdog() {
  stop_.store(true, std::memory_order_relaxed);
  thread_.join();
  messenger_.progress(operations());
}

std::uint64_t Watchdog::operations() const {
  std::uint64_t sum = 0;
  for (const Slot& slot : slots_) sum += slot.done.load(std::memory_order_relaxed);
  return sum;
}

void Watchdog::watch() {
  const OutsideAccounting outside;
  std::uint64_t seen = operations();
  auto last_move = std::chrono::steady_clock::now();
  bool remembered = false;
  for (int tick = 0; !stop_.load(std::memory_order_relaxed); ++tick) {
    std::this_thread::sleep_for(20ms);
    const auto still = std::chrono::steady_clock::now() - last_move;
    if (const std::uint64_t operations_now = operations(); operations_now != seen) {
      seen = operations_now;
      last_move += still;
      remembered = false;
    } else if (still > patience_ / 4 && !remembered) {
      remember();
      remembered = true;
    } else if (still > patience_ * 20 || (still > patience_ && all_had_their_turn())) {
      report();
    }
    if (tick % 10 == 0) messenger_.progress(seen);
  }
}

void Watchdog::remember() {
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const pid_t thread = slots_[i].thread.load(std::memory_order_relaxed);
    if (thread == 0) continue;
    stop_disturbing(thread);
    cpu_times_[i] = cpu_time(thread).value_or(0);
  }
}

bool Watchdog::all_had_their_turn() const {
  constexpr std::uint64_t share = 20'000'000;  // nanoseconds; an operation takes microseconds
  bool anybody = false;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (slots_[i].doing.load(std::memory_order_relaxed) == Doing::nothing) continue;
    anybody = true;
    const pid_t thread = slots_[i].thread.load(std::memory_order_relaxed);
    if (!sleeps(thread) && cpu_time(thread).value_or(0) < cpu_times_[i] + share) return false;
  }
  return anybody;
}

void Watchdog::report() {
  nlohmann::json stacks = nlohmann::json::object();
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    if (slot.thread.load(std::memory_order_relaxed) == 0) continue;
    const Doing doing = slot.doing.load(std::memory_order_relaxed);
    if (doing == Doing::nothing) continue;
    nlohmann::json addresses = nlohmann::json::array();
    if (ask_trace(slot)) {
      for (void* address : slot.trace)
        addresses.push_back(reinterpret_cast<std::uint64_t>(address));
    }
    stacks[fmt::format("thread {} in {}", i, name(doing))] = addresses;
  }
  messenger_.hang("does not hang: no operation ended for " +
                      fmt::format("{:.0f} s", std::chrono::duration<double>(patience_).count()),
                  stacks);
}

std::chrono::milliseconds hang_patience() {
  return sanitizer == Sanitizer::none ? 3s : 15s;
}

}  // namespace irt::stress
