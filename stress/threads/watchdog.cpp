#include "stress/threads/watchdog.hpp"

#include <fmt/format.h>

#include "stress/threads/sanitizer.hpp"
#include "stress/threads/signals.hpp"

namespace irt::stress {

using namespace std::chrono_literals;

Watchdog::Watchdog(std::vector<Slot>& slots, std::chrono::milliseconds patience,
                   Messenger& messenger)
    : slots_(slots), patience_(patience), messenger_(messenger), thread_([this] { watch(); }) {}

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
  std::uint64_t seen = operations();
  auto last_move = std::chrono::steady_clock::now();
  for (int tick = 0; !stop_.load(std::memory_order_relaxed); ++tick) {
    std::this_thread::sleep_for(20ms);
    const auto now = std::chrono::steady_clock::now();
    if (const std::uint64_t operations_now = operations(); operations_now != seen) {
      seen = operations_now;
      last_move = now;
    } else if (now - last_move > patience_) {
      report();
    }
    if (tick % 10 == 0) messenger_.progress(seen);
  }
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
    stacks[fmt::format("thread {} in {}", i, doing == Doing::push ? "push" : "pop")] = addresses;
  }
  messenger_.hang("does not hang: no operation ended for " +
                      fmt::format("{:.0f} s", std::chrono::duration<double>(patience_).count()),
                  stacks);
}

std::chrono::milliseconds hang_patience() {
  return sanitizer == Sanitizer::none ? 3s : 15s;
}

}  // namespace irt::stress
