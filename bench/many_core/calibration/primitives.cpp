#include "bench/many_core/calibration/primitives.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <linux/futex.h>
#include <memory>
#include <mutex>
#include <numeric>
#include <random>
#include <sched.h>
#include <sys/syscall.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "renderer/tracing/stopwatch.hpp"

namespace irt::many_core {
namespace {

// A pair of lines, so that the one fetched beside it is nobody's.
struct alignas(128) Line {
  std::atomic<std::uint64_t> word{0};
};

void pin(Cpu cpu) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(cpu, &set);
  if (sched_setaffinity(0, sizeof set, &set) != 0) {
    throw std::system_error(errno, std::generic_category(),
                            "cannot bind a thread to processor " + std::to_string(cpu));
  }
}

double nanoseconds(std::uint64_t from, std::uint64_t to) {
  const std::uint64_t nothing = ticks_of_nothing();
  const std::uint64_t ticks = to - from;
  return static_cast<double>(ticks > nothing ? ticks - nothing : 0) * nanoseconds_per_tick();
}

// Two threads wait for each other by spinning, which takes as long as it takes to have both run at
// once: on a crowded machine, too long. Each side gives up by itself.
class Limit {
 public:
  // Waits for `done`; false if it took too long. To be asked often: it looks at the clock seldom.
  template <class Done>
  [[nodiscard]] bool await(Done done) const {
    for (unsigned i = 1; !done(); ++i) {
      if (i % looks == 0 && Clock::now() > end_) return false;
    }
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr unsigned looks = 1U << 14U;
  Clock::time_point end_ = Clock::now() + std::chrono::seconds(4);
};

template <class Step>
Spread time_steps(unsigned steps, Step step) {
  constexpr unsigned bursts = 200;
  std::vector<double> samples;
  for (unsigned burst = 0; burst < bursts; ++burst) {
    const std::uint64_t begin = ticks_now();
    for (unsigned i = 0; i < steps; ++i) step();
    samples.push_back(nanoseconds(begin, ticks_now()) / steps);
  }
  return summarise(std::move(samples));
}

Spread scaled(Spread spread, double factor) {
  spread.median *= factor;
  spread.low *= factor;
  spread.high *= factor;
  return spread;
}

void pause_once() {
#if defined(__x86_64__)
  _mm_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

// Keeps the compiler from knowing what `value` is.
template <class T>
void obscure(T& value) {
  asm volatile("" : "+r"(value));
}

long futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value) {
  return syscall(SYS_futex, &word, operation | FUTEX_PRIVATE_FLAG, value, nullptr, nullptr, 0);
}

// Runs `first` on `a` while `second` runs on `b`. What either throws ends up here.
template <class First, class Second>
void side_by_side(Cpu a, Cpu b, First first, Second second) {
  std::exception_ptr error;
  std::atomic<int> ready{0};  // 2: both are bound; negative: one is not
  const auto start = [&](Cpu cpu, auto& body) {
    try {
      pin(cpu);
    } catch (...) {
      error = std::current_exception();
      ready = -8;
    }
    ++ready;
    while (ready == 1) std::this_thread::yield();
    if (ready == 2) body();
  };
  {
    std::jthread other([&] { start(b, second); });
    std::jthread one([&] { start(a, first); });
  }
  if (error) std::rethrow_exception(error);
}

Spread measure_dram() {
#if defined(__x86_64__)
  constexpr std::size_t count = 64;
  const auto lines = std::make_unique<std::array<Line, count>>();
  std::vector<double> samples;
  for (unsigned burst = 0; burst < 200; ++burst) {
    for (Line& line : *lines) _mm_clflush(&line);
    _mm_mfence();
    std::uint64_t at = 0;  // each address waits for the load before
    const std::uint64_t begin = ticks_now();
    for (std::size_t i = 0; i < count; ++i) {
      at += (*lines)[(i * 37 + at) % count].word.load(std::memory_order_relaxed);
    }
    obscure(at);
    samples.push_back(nanoseconds(begin, ticks_now()) / count);
  }
  return summarise(std::move(samples));
#else
  return {};
#endif
}

Spread measure_hand_over(Cpu cpu) {
  constexpr unsigned rounds = 20, bursts = 60;
  std::atomic<std::uint32_t> turn{0};
  // seq_cst: the futex calls are full fences anyway.
  const auto hand_over = [&turn](std::uint32_t from) {
    turn = from ^ 1U;
    futex(turn, FUTEX_WAKE, 1);
    while (turn != from) futex(turn, FUTEX_WAIT, from ^ 1U);
  };
  std::vector<double> samples;
  side_by_side(
      cpu, cpu,
      [&] {
        for (unsigned burst = 0; burst < bursts; ++burst) {
          const std::uint64_t begin = ticks_now();
          for (unsigned i = 0; i < rounds; ++i) hand_over(0);
          samples.push_back(nanoseconds(begin, ticks_now()) / (2 * rounds));
        }
        turn = 2;
        futex(turn, FUTEX_WAKE, 1);
      },
      [&] {
        while (true) {
          std::uint32_t seen = turn;
          while (seen == 0) {
            futex(turn, FUTEX_WAIT, 0);
            seen = turn;
          }
          if (seen == 2) return;
          turn = 0;
          futex(turn, FUTEX_WAKE, 1);
        }
      });
  return summarise(std::move(samples));
}

// Turns `mine` into `theirs` so many times, as often as the other side turns it back.
bool play(std::atomic<std::uint64_t>& word, std::uint64_t mine, std::uint64_t theirs,
          unsigned rounds, const Limit& limit) {
  for (unsigned i = 0; i < rounds; ++i) {
    const bool turned = limit.await([&] {
      std::uint64_t seen = mine;
      return word.compare_exchange_strong(seen, theirs);
    });
    if (!turned) return false;
  }
  return true;
}

Spread ping_pong(Cpu a, Cpu b) {
  constexpr unsigned rounds = 50, bursts = 20, lines = 24;
  std::vector<Line> ring(lines);
  std::vector<double> samples;
  const Limit limit;
  const auto serve = [&] {
    for (Line& line : ring) {
      std::vector<double> of_line;
      for (unsigned burst = 0; burst < bursts; ++burst) {
        const std::uint64_t begin = ticks_now();
        if (!play(line.word, 0, 1, rounds, limit)) return;
        of_line.push_back(nanoseconds(begin, ticks_now()) / (2 * rounds));
      }
      // Lines differ, by where their home is; bursts on one only by disturbances.
      samples.push_back(summarise(std::move(of_line)).median);
    }
  };
  side_by_side(a, b, serve, [&] {
    for (Line& line : ring) {
      if (!play(line.word, 1, 0, rounds * bursts, limit)) return;
    }
  });
  return summarise(std::move(samples));
}

// `visit(line)` returns 0; the next line's address waits for that.
template <class Visit>
Spread chain(Cpu a, Cpu b, Visit visit) {
  constexpr unsigned count = 256, bursts = 60;
  std::vector<Line> lines(count);
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::shuffle(order, std::mt19937(1));
  Line phase;
  std::vector<double> samples;
  const Limit limit;
  const auto await = [&](std::uint64_t wanted) {
    return limit.await([&] {
      // (1) acquire: pairs with the release store (2) of the other side
      return phase.word.load(std::memory_order_acquire) == wanted;
    });
  };
  // (2) release: pairs with the acquire load (1) of the other side
  const auto pass_on = [&](std::uint64_t next) {
    phase.word.store(next, std::memory_order_release);
  };
  const auto visit_all = [&] {
    for (unsigned burst = 0; burst < bursts && await(2 * burst + 1); ++burst) {
      std::uint64_t before = 0;
      const std::uint64_t begin = ticks_now();
      for (const std::uint32_t index : order) before = visit(lines[index + before].word);
      obscure(before);
      samples.push_back(nanoseconds(begin, ticks_now()) / count);
      pass_on(2 * burst + 2);
    }
  };
  side_by_side(a, b, visit_all, [&] {
    for (unsigned burst = 0; burst < bursts && await(2 * burst); ++burst) {
      for (Line& line : lines) line.word.fetch_add(0, std::memory_order_relaxed);
      pass_on(2 * burst + 1);
    }
  });
  return summarise(std::move(samples));
}

void spin_for(double ns) {
  const std::uint64_t begin = ticks_now();
  while (nanoseconds(begin, ticks_now()) < ns) pause_once();
}

}  // namespace

Spread summarise(std::vector<double> samples) {
  Spread spread;
  spread.bursts = samples.size();
  if (samples.empty()) return spread;
  std::ranges::sort(samples);
  const auto at = [&](double share) {
    return samples[static_cast<std::size_t>(share * static_cast<double>(samples.size() - 1))];
  };
  const auto end = std::ranges::upper_bound(samples, 2 * at(0.25));
  spread.dropped = static_cast<std::size_t>(samples.end() - end);
  samples.erase(end, samples.end());
  spread.low = at(0.1);
  spread.median = at(0.5);
  spread.high = at(0.9);
  return spread;
}

Spread measure_cycle() {
  constexpr unsigned unrolled = 16;  // what the loop itself takes is then little
  // No addition of a constant: recent cores do these while renaming registers.
  std::uint64_t x = 0, y = 1;
  obscure(y);
  return scaled(time_steps(200,
                           [&x, &y] {
#pragma GCC unroll 16
                             for (unsigned i = 0; i < unrolled; ++i) {
                               x ^= y;
                               obscure(x);
                             }
                           }),
                1.0 / unrolled);
}

Alone measure_alone(Cpu cpu) {
  constexpr unsigned many = 2000;
  Alone alone;
  std::jthread([&] {
    pin(cpu);
    spin_for(20e6);  // the clock rises under load
    Line line;
    std::atomic<std::uint64_t>& word = line.word;
    alone.cycle = measure_cycle();
    std::atomic<void*> self{nullptr};
    self = &self;
    auto* at = &self;
    alone.load = time_steps(many, [&at] {
      at = static_cast<std::atomic<void*>*>(at->load(std::memory_order_relaxed));
    });
    obscure(at);
    alone.store = time_steps(many, [&word] { word.store(1, std::memory_order_release); });
    alone.rmw = time_steps(many, [&word] { word.fetch_add(1); });
    std::array<volatile std::uint32_t, 8> plain{};
    alone.plain = scaled(time_steps(many / 8,
                                    [&plain] {
                                      for (volatile std::uint32_t& p : plain) {
                                        [[maybe_unused]] const std::uint32_t value = p;
                                      }
                                    }),
                         1.0 / 8);
    alone.pause = time_steps(many / 8, pause_once);
    alone.dram = measure_dram();
    std::mutex mutex;
    alone.mutex = time_steps(many, [&mutex] { const std::scoped_lock lock(mutex); });
    alone.syscall = time_steps(many / 8, [] { syscall(SYS_getppid); });
  }).join();
  alone.hand_over = measure_hand_over(cpu);
  return alone;
}

Between measure_between(Cpu a, Cpu b) {
  Between between;
  between.ping_pong = ping_pong(a, b);
  between.load = chain(a, b, [](auto& word) { return word.load(std::memory_order_relaxed); });
  between.fetch_add = chain(a, b, [](auto& word) { return word.fetch_add(0); });
  between.swap = chain(a, b, [](auto& word) {
    std::uint64_t seen = 0;
    word.compare_exchange_strong(seen, 0);
    return seen;
  });
  return between;
}

Wake measure_wake(Cpu waker, Cpu sleeper) {
  constexpr std::uint32_t rounds = 200;
  constexpr double until_asleep_ns = 100'000;
  std::atomic<std::uint32_t> word{0};
  std::array<std::uint64_t, rounds> called{}, returned{}, awake{};
  std::vector<double> empty_calls, calls, latencies;
  side_by_side(
      waker, sleeper,
      [&] {
        std::atomic<std::uint32_t> nobody{0};
        empty_calls = {time_steps(100, [&] { futex(nobody, FUTEX_WAKE, 1); }).median};
        for (std::uint32_t i = 0; i < rounds; ++i) {
          spin_for(until_asleep_ns);
          called[i] = ticks_now();
          word = i + 1;
          futex(word, FUTEX_WAKE, 1);
          returned[i] = ticks_now();
        }
      },
      [&] {
        for (std::uint32_t i = 0; i < rounds; ++i) {
          while (word <= i) futex(word, FUTEX_WAIT, i);
          awake[i] = ticks_now();
        }
      });
  for (std::uint32_t i = 0; i < rounds; ++i) {
    calls.push_back(std::max(nanoseconds(called[i], returned[i]) - empty_calls[0], 0.0));
    latencies.push_back(awake[i] > returned[i] ? nanoseconds(returned[i], awake[i]) : 0);
  }
  Wake wake;
  wake.call = summarise(std::move(calls));
  wake.latency = summarise(std::move(latencies));
  return wake;
}

Spread measure_contended(const std::vector<Cpu>& cpus, double work_ns) {
  constexpr unsigned bursts = 40;
  constexpr std::uint64_t per_burst = 2000;
  const auto cycles = static_cast<unsigned>(work_ns / std::max(measure_cycle().median, 0.01));
  Line line;
  std::atomic<unsigned> bound{0};
  std::vector<double> samples;
  const auto all = static_cast<unsigned>(cpus.size());
  std::vector<std::jthread> threads;
  for (unsigned index = 0; index < all; ++index) {
    threads.emplace_back([&, index] {
      pin(cpus[index]);
      ++bound;
      while (bound < all) std::this_thread::yield();
      std::uint64_t mark = ticks_now(), at = 0, x = 0;
      while (at < bursts * per_burst) {
        const std::uint64_t before = at;
        at = line.word.fetch_add(1, std::memory_order_relaxed);
        if (index == 0 && at / per_burst != before / per_burst) {
          // The first thread samples; between two looks the count may have gone on by some more.
          const std::uint64_t now = ticks_now();
          samples.push_back(nanoseconds(mark, now) / static_cast<double>(per_burst));
          mark = now;
        }
        for (unsigned i = 0; i < cycles; ++i) {
          x ^= at;
          obscure(x);
        }
      }
    });
  }
  threads.clear();
  return summarise(std::move(samples));
}

Spread measure_run(Cpu a, Cpu b) {
  constexpr unsigned bursts = 200, per_burst = 2000;
  Line line;
  std::vector<double> samples;
  std::atomic<bool> stop{false};
  side_by_side(
      a, b,
      [&] {
        std::uint64_t last = 0;
        for (unsigned i = 0; i < bursts; ++i) {
          unsigned runs = 0;
          for (unsigned k = 0; k < per_burst; ++k) {
            // relaxed, here and below: a counter, and a hint to stop
            const std::uint64_t mine = line.word.fetch_add(1, std::memory_order_relaxed);
            runs += mine != last + 1 ? 1 : 0;
            last = mine;
          }
          samples.push_back(static_cast<double>(per_burst) / std::max(runs, 1U));
        }
        stop.store(true, std::memory_order_relaxed);
      },
      [&] {
        while (!stop.load(std::memory_order_relaxed))
          line.word.fetch_add(1, std::memory_order_relaxed);
      });
  return summarise(std::move(samples));
}

}  // namespace irt::many_core
