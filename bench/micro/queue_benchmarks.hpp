/// What single operations of a queue cost one thread, as Google Benchmark's benchmarks.
#pragma once

#include <benchmark/benchmark.h>
#include <cstdint>
#include <memory>
#include <string>

#include "bench/micro/allocations.hpp"
#include "queues/plugin.hpp"

namespace irt::micro {

/// The queue is asked for room for so many, and holds so many where it is to be filled.
inline constexpr std::size_t capacity = 1024;

using Word = std::uint64_t;

/// `push` in batches that fill the queue, which is emptied while the clock stands still.
template <class Queue>
void push(benchmark::State& state, Queue& queue) {
  Word word = 1;
  while (state.KeepRunningBatch(capacity)) {
    for (std::size_t i = 0; i < capacity; ++i) benchmark::DoNotOptimize(queue.push(0, word));
    state.PauseTiming();
    for (std::size_t i = 0; i < capacity; ++i) queue.pop(0, word);
    state.ResumeTiming();
  }
}

/// `pop` in batches that empty the queue, which is filled while the clock stands still.
template <class Queue>
void pop(benchmark::State& state, Queue& queue) {
  Word word = 1;
  while (state.KeepRunningBatch(capacity)) {
    state.PauseTiming();
    for (std::size_t i = 0; i < capacity; ++i) queue.push(0, 1);
    state.ResumeTiming();
    for (std::size_t i = 0; i < capacity; ++i) benchmark::DoNotOptimize(queue.pop(0, word));
  }
}

/// A push and a pop, of a queue that is empty before and after; with what it allocates meanwhile.
template <class Queue>
void push_pop(benchmark::State& state, Queue& queue) {
  Word word = 1;
  const Allocations before = allocations();
  for (auto _ : state) {  // NOLINT: the variable is Google Benchmark's
    benchmark::DoNotOptimize(queue.push(0, word));
    benchmark::DoNotOptimize(queue.pop(0, word));
  }
  const Allocations after = allocations();
  const auto each = [](std::uint64_t count) {
    return benchmark::Counter(static_cast<double>(count), benchmark::Counter::kAvgIterations);
  };
  state.counters["allocations"] = each(after.count - before.count);
  state.counters["allocated_bytes"] = each(after.bytes - before.bytes);
}

/// A pop that finds nothing.
template <class Queue>
void empty_pop(benchmark::State& state, Queue& queue) {
  Word word = 1;
  for (auto _ : state) benchmark::DoNotOptimize(queue.pop(0, word));  // NOLINT: as above
}

/// A push that finds no room.
template <class Queue>
void full_push(benchmark::State& state, Queue& queue) {
  while (queue.push(0, 1)) {
  }
  for (auto _ : state) benchmark::DoNotOptimize(queue.push(0, 1));  // NOLINT: as above
}

/// Registers NAME/push, NAME/pop, ... for the concrete type, and NAME/push_pop_face for the
/// type-erased one.
template <template <class> class Q>
void add_queue(const char* name) {
  using Queue = ByWorker<Q<Word>, Word>;
  using Body = void (*)(benchmark::State&, Queue&);
  const auto add = [name](const char* what, Body body) {
    benchmark::RegisterBenchmark((std::string(name) + "/" + what).c_str(),
                                 [body](benchmark::State& state) {
                                   const auto queue = std::make_unique<Queue>(1, capacity);
                                   body(state, *queue);
                                 });
  };
  add("push", push<Queue>);
  add("pop", pop<Queue>);
  add("push_pop", push_pop<Queue>);
  benchmark::RegisterBenchmark((std::string(name) + "/push_pop_face").c_str(),
                               [](benchmark::State& state) {
                                 const std::unique_ptr<AnyWorkQueue<Word>> queue =
                                     std::make_unique<WorkQueueFace<Word, Queue>>(1, capacity);
                                 push_pop(state, *queue);
                               });
  if (Queue::claims.carries_elements) add("empty_pop", empty_pop<Queue>);
  if (Queue::claims.bounded) add("full_push", full_push<Queue>);
  benchmark::RegisterBenchmark((std::string(name) + "/construct").c_str(),
                               [](benchmark::State& state) {
                                 for (auto _ : state)  // NOLINT: as above
                                   benchmark::DoNotOptimize(std::make_unique<Queue>(1, capacity));
                               });
}

/// What the micro module of a queue shows, at the C symbol `irt_micro`.
struct BenchmarkModule {
  std::uint32_t abi_version = plugin_abi_version;
  void (*add)() = nullptr;  ///< registers the benchmarks
};

}  // namespace irt::micro
