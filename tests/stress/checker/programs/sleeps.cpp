// finds: nothing
// sleeping passes time, on the clock of whoever hears of it too
#include <atomic>
#include <chrono>
#include <thread>

using Clock = std::chrono::steady_clock;
std::atomic<bool> woken{false};
Clock::time_point slept_until;

int main() {
  using namespace std::chrono_literals;
  const auto begin = Clock::now();
  std::thread sleeper([] {
    std::this_thread::sleep_for(10ms);
    slept_until = Clock::now();
    woken.store(true, std::memory_order_release);
  });
  if (woken.load(std::memory_order_acquire) && Clock::now() < slept_until) return 1;
  sleeper.join();
  if (Clock::now() - begin < 10ms) return 2;
  std::this_thread::sleep_until(begin + 1s);
  return Clock::now() < begin + 1s ? 3 : 0;
}
