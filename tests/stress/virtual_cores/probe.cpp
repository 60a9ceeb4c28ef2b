// Instrumented code that touches every entry point of the runtime; the test watches its events.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <random>
#include <stdexcept>
#include <string>
#include <sys/random.h>
#include <thread>
#include <vector>

// The code is what is shipped, not what libraries keep for the thread sanitizer.
#if defined(__SANITIZE_THREAD__) || (defined(_GLIBCXX_TSAN) && _GLIBCXX_TSAN)
#error "virtual cores: the code is told that the thread sanitizer is on"
#endif
#if defined(__has_feature)
#if __has_feature(thread_sanitizer) || __has_feature(__thread_sanitizer__)
#error "virtual cores: the code is told that the thread sanitizer is on"
#elif !__has_feature(cxx_exceptions)
#error "virtual cores: the code is not told what the compiler can do"
#endif
#endif

namespace {

template <class T>
bool atomics_work() {
  std::atomic<T> x{5};
  T expected = 4;
  bool right = !x.compare_exchange_strong(expected, 9) && expected == 5;
  while (!x.compare_exchange_weak(expected, 12)) {
  }
  right = right && x.exchange(12) == 12 && x.fetch_add(3) == 12 && x.fetch_sub(1) == 15;
  right = right && x.fetch_and(6) == 14 && x.fetch_or(9) == 6 && x.fetch_xor(1) == 15;
  x.store(T(x.load() + 1));
  x.fetch_sub(T(16));
  return right && T(x.load()) == T(-1);
}

struct alignas(16) Pair {
  void* pointer;
  std::uint64_t tag;
};

thread_local int own_counter = 40;
thread_local std::string own_text = "own";
thread_local std::atomic<int>* last_exit = nullptr;

struct CountsItsEnd {
  ~CountsItsEnd() {
    if (last_exit != nullptr) last_exit->fetch_add(1);
  }
};
thread_local CountsItsEnd counts_its_end;

std::mutex mutex;
std::condition_variable condition;
std::atomic<int> flag;
int protected_value;
int global = 7;

}  // namespace

extern "C" {

bool irt_atomics() {
  return atomics_work<std::uint8_t>() && atomics_work<std::uint16_t>() &&
         atomics_work<std::uint32_t>() && atomics_work<std::uint64_t>();
}

bool irt_pair() {
  std::atomic<Pair> pair{Pair{nullptr, 1}};
  Pair expected = pair.load();
  return pair.compare_exchange_strong(expected, Pair{&pair, 2}) && pair.load().tag == 2 &&
         pair.load().pointer == &pair;
}

// Written so that the compiler cannot do without the accesses.
void irt_plain(volatile std::uint32_t* word, char* to, const char* from, std::size_t size) {
  word[1] = word[0];
  std::memcpy(to, from, size);
  std::atomic_thread_fence(std::memory_order_release);
}

void irt_count_own(int** where) {
  ++own_counter;
  own_text += "!";
  *where = &own_counter;
}
int irt_own_counter() {
  return own_counter * 100 + static_cast<int>(own_text.size());
}

void irt_at_exit(std::atomic<int>* count) {
  last_exit = count;
  [[maybe_unused]] volatile auto* touch = &counts_its_end;
}

void irt_wait_for_flag() {
  std::unique_lock lock(mutex);
  condition.wait(lock, [] { return flag.load() != 0; });
  protected_value = 1;
}
void irt_raise_flag() {
  {
    const std::lock_guard lock(mutex);
    flag = 1;
  }
  condition.notify_one();
}
void irt_atomic_wait() {
  flag.wait(0);
}
void irt_atomic_notify() {
  flag = 2;
  flag.notify_all();
}

int irt_count_global() {
  return ++global;
}

int irt_static() {
  static const std::vector<int> once(3, 5);
  return once[2];
}

bool irt_throw_and_catch() {
  try {
    throw std::runtime_error("as expected");
  } catch (const std::exception& error) {
    irt_atomic_wait();
    return std::string(error.what()) == "as expected";
  }
}
void irt_throw() {
  throw std::runtime_error("thrown by the probe");
}

void irt_chance(std::uint64_t* answers) {
  answers[0] = std::random_device()();
  answers[1] = 0;
  if (getrandom(answers + 1, 8, 0) != 8) answers[1] = 0;
#if !defined(__clang__)
  answers[2] = __builtin_ia32_rdtsc();
  answers[3] =
      static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
  std::uint32_t half = 0;
  bool done = false;
  asm volatile("rdrand %0" : "=r"(answers[4]), "=@ccc"(done));
  if (!done) answers[4] = 0;
  asm volatile("rdrand %0" : "=r"(half));
  answers[5] = half;
#endif
}

void irt_start_thread() {
  std::thread([] {}).join();
}

// Compiled code, and nobody sees what it does.
bool irt_elsewhere(int* numbers, std::size_t count) {
  std::qsort(numbers, count, sizeof *numbers, [](const void* a, const void* b) {
    return *static_cast<const int*>(a) - *static_cast<const int*>(b);
  });
  return std::get_terminate() != nullptr;
}

std::shared_ptr<int>* irt_share() {
  const auto first = std::make_shared<int>(3);
  return new std::shared_ptr<int>(first);
}
void irt_unshare(const std::shared_ptr<int>* shared) {
  delete shared;
}

void irt_hammer(std::atomic<std::uint64_t>* counter, std::uint64_t times) {
  for (std::uint64_t i = 0; i < times; ++i) counter->fetch_add(1, std::memory_order_relaxed);
}
}
