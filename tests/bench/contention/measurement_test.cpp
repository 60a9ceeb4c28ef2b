// The pitfalls that other benchmarks fell into, each as a test.
#include "bench/contention/measurement.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <linux/perf_event.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "bench/contention/hardware_counters.hpp"
#include "bench/contention/placement.hpp"
#include "bench/contention/resources.hpp"
#include "bench/contention/subjects.hpp"
#include "queues/blocking/mutex_queue.hpp"

namespace irt::contention {
namespace {

using std::chrono::milliseconds;

void never(const Sample& sample) {
  FAIL() << sample.message;
}

/// Without anyone else to take turns with.
Sample measure(const Job& job, const SubjectMaker& make,
               const std::function<void(const Sample&)>& on_hang) {
  return contention::measure(
      job, make, [] {}, on_hang);
}

Job job_for(const std::string& scenario, unsigned threads) {
  const Roles roles = scenario_at(scenario).roles(threads);
  Job job;
  job.queue = no_queue;
  job.scenario = scenario;
  job.threads = roles.workers;
  job.producers = roles.producers;
  job.consumers = roles.consumers;
  job.capacity = 1024;
  job.seconds = 0.2;
  job.warmup_seconds = 1;
  return job;
}

/// Each operation of a worker takes the time that is set for it; the first may take longer. Asleep,
/// so that the machine's load matters little.
class Metronome {
 public:
  struct Pace {
    milliseconds each{1}, first{0};
  };

  explicit Metronome(std::vector<Pace> paces)
      : paces_(std::move(paces)), started_(paces_.size(), 0) {}

  bool push(unsigned worker, std::uint64_t /*element*/) { return tick(worker); }
  bool pop(unsigned worker, std::uint64_t& /*element*/) { return tick(worker); }

 private:
  bool tick(unsigned worker) {
    std::this_thread::sleep_for(paces_[worker].each);
    if (started_[worker] == 0) std::this_thread::sleep_for(paces_[worker].first);
    started_[worker] = 1;
    return true;
  }

  std::vector<Pace> paces_;
  std::vector<char> started_;  // not bool: each worker writes its own
};

Sample measure_metronome(const Job& job, const std::vector<Metronome::Pace>& paces) {
  return measure(
      job,
      [&](unsigned, std::size_t, bool) -> std::unique_ptr<Subject> {
        return std::make_unique<SubjectOf<Metronome>>(std::make_unique<Metronome>(paces), nullptr);
      },
      never);
}

double rate(const Sample& sample) {
  return static_cast<double>(sample.operations()) / sample.seconds;
}

TEST(Pitfalls, TheRateIsThatOfAllThreadsOverOneInterval) {
  // One thread does 1,000 operations a second, seven do 50: 1,350. From the slowest thread it would
  // be 400 at most, from summed thread times 170, from the fastest thread 8,000.
  std::vector<Metronome::Pace> paces(8, {.each = milliseconds(20), .first = {}});
  paces[0].each = milliseconds(1);
  const Sample sample = measure_metronome(job_for("pairs", 8), paces);
  EXPECT_GT(rate(sample), 450);
  EXPECT_LT(rate(sample), 1350 * 1.1);
  EXPECT_LT(sample.fairness, 0.4);
  EXPECT_GE(sample.seconds, 0.2);
}

TEST(Pitfalls, StartingThreadsIsNotTimed) {
  // The last thread needs 300 ms for its first operation, more than the timed interval.
  std::vector<Metronome::Pace> paces(4, {.each = milliseconds(4), .first = {}});
  paces[3].first = milliseconds(300);
  const Sample sample = measure_metronome(job_for("pairs", 4), paces);
  EXPECT_GT(sample.fairness, 0.3);
}

TEST(Pitfalls, FailedPopsAreNotWork) {
  /// Gives every tenth time.
  class Stingy {
   public:
    bool push(unsigned /*worker*/, std::uint64_t /*element*/) { return true; }
    bool pop(unsigned /*worker*/, std::uint64_t& /*element*/) { return ++tries_ % 10 == 0; }

   private:
    unsigned tries_ = 0;
  };
  const Sample sample = measure(
      job_for("pairs", 1),
      [](unsigned, std::size_t, bool) -> std::unique_ptr<Subject> {
        return std::make_unique<SubjectOf<Stingy>>(std::make_unique<Stingy>(), nullptr);
      },
      never);
  ASSERT_GT(sample.pops, 100U);
  EXPECT_NEAR(static_cast<double>(sample.failed_pops) / static_cast<double>(sample.pops), 9, 0.2);
  EXPECT_NEAR(static_cast<double>(sample.pushes) / static_cast<double>(sample.pops), 1, 0.01);
  EXPECT_EQ(sample.operations(), sample.pushes + sample.pops);
}

TEST(Pitfalls, WorkIsNotOptimisedAwayAndScales) {
  const Pace pace = measure_pace();
  const auto wait = [&](double ns) { return measure_wait_ns(steps_for(ns, pace)); };
  for (const double ns : {50.0, 100.0, 1000.0, 10'000.0}) {
    EXPECT_NEAR(wait(ns) / ns, 1, 0.25) << ns;
  }
  EXPECT_EQ(steps_for(0, pace), 0U);
  EXPECT_GE(steps_for(0.001, pace), 1U);
  EXPECT_NEAR(wait(10'000) / wait(1'000), 10, 2);

  // In the loop itself: an operation comes after each 20 us of work, so that is the most. The host
  // may run faster than when its pace was measured: what the work takes is measured on both sides.
  Job job = job_for("pairs", 1);
  job.work_ns = 20'000;
  job.pace = pace;
  const QueueRegistry queues;
  const double before = wait(job.work_ns);
  const Sample sample = measure(job, subject_maker(queues, no_queue), never);
  const double after = wait(job.work_ns);
  EXPECT_LT(rate(sample), 1e9 / std::min(before, after) * 1.1);
  EXPECT_GT(sample.operations(), 0U);
}

TEST(Pitfalls, SpreadWorkKeepsItsMeanAndItsRange) {
  Waits waits(1000, 0.5, 42), same(1000, 0.5, 42), constant(1000, 0, 42);
  double sum = 0;
  for (int i = 0; i < 10'000; ++i) {
    const std::uint64_t steps = waits.next();
    EXPECT_EQ(steps, same.next());
    EXPECT_EQ(constant.next(), 1000U);
    ASSERT_GE(steps, 500U);
    ASSERT_LE(steps, 1500U);
    sum += static_cast<double>(steps);
  }
  EXPECT_NEAR(sum / 10'000, 1000, 15);
}

TEST(Pitfalls, ThreadsShareNoLineThatOneOfThemWrites) {
  const Table table(Roles{4, 4, 4});
  const auto line = [](const void* address) {
    return reinterpret_cast<std::uintptr_t>(address) / cache_line_pair;
  };
  for (unsigned i = 0; i < 4; ++i) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(&table.counts[i]) % cache_line_pair, 0U);
    EXPECT_NE(line(&table.stop), line(&table.counts[i]));
    for (unsigned other = 0; other < i; ++other) {
      EXPECT_NE(line(&table.counts[i].held_back), line(&table.counts[other].pushes));
    }
  }
}

TEST(Pitfalls, TheLoopCostsLessThanAReadingOfTheClock) {
  const QueueRegistry queues;
  const Sample sample = measure(job_for("pairs", 1), subject_maker(queues, no_queue), never);
  const double ns = sample.cpu_seconds * 1e9 / static_cast<double>(sample.operations());
  EXPECT_LT(ns, measure_clock_ns(stress::calibrate().ticks_per_nanosecond));
  EXPECT_TRUE(sample.push_times.buckets.empty());
}

TEST(Latency, IsThatOfEachOperationOfItsOwn) {
  Job job = job_for("pairs", 2);
  job.pass = Pass::stamped;
  const Sample sample = measure_metronome(
      job, {{.each = milliseconds(3), .first = {}}, {.each = milliseconds(3), .first = {}}});
  Histogram pops;
  pops.add(sample.pop_times.buckets, sample.pop_times.max);
  EXPECT_GE(pops.quantile(0.01), 2'950'000U);
  EXPECT_GT(sample.clock_ns, 0);
  EXPECT_FALSE(sample.push_times.buckets.empty());
}

/// What went in last comes out first.
struct Stack {
  Stack(unsigned, std::size_t) {}
  bool push(unsigned, std::uint64_t element) {
    const std::lock_guard lock(mutex);
    elements.push_back(element);
    return true;
  }
  bool pop(unsigned, std::uint64_t& element) {
    const std::lock_guard lock(mutex);
    if (elements.empty()) return false;
    element = elements.back();
    elements.pop_back();
    return true;
  }
  std::mutex mutex;
  std::vector<std::uint64_t> elements;
};

TEST(Order, IsThatOfAllOperations) {
  for (const char* scenario : {"rush", "prefilled", "fib"}) {
    Job job = job_for(scenario, 2);
    job.queue = "mutex";
    job.pass = Pass::logged;
    const Sample queue = measure(job, maker_of<MutexQueue<std::uint64_t>>(), never);
    const Sample stack = measure(job, maker_of<Stack>(), never);
    for (const Sample* sample : {&queue, &stack}) {
      EXPECT_EQ(sample->status, "ok") << scenario << ": " << sample->message;
      EXPECT_GT(sample->order.operations, 1000U) << scenario;
    }
    EXPECT_EQ(queue.order.rank_error_max, 0U) << scenario;
    EXPECT_GT(stack.order.rank_error_mean, 1) << scenario;
    EXPECT_GE(static_cast<double>(stack.order.rank_error_max), stack.order.rank_error_mean);
    EXPECT_LT(queue.order.pushes_overtaken, 0.9) << scenario;
    if (std::string_view(scenario) != "rush") continue;
    // Of each burst all but the last one, of which only the end of its push overlaps others.
    EXPECT_GT(stack.order.pushes_overtaken, 0.8);
    EXPECT_LT(stack.order.pushes_overtaken, 1);
  }
}

TEST(Measurement, EveryProgramRunsOnAQueueAndLosesNothing) {
  for (const Scenario& scenario : scenarios()) {
    for (const unsigned threads : {1U, 2U, 5U}) {
      if (threads < scenario.least_threads) continue;
      Job job = job_for(std::string(scenario.name), threads);
      job.queue = "mutex";
      job.seconds = 0.15;  // so that each thread has its turn on a busy machine
      job.warmup_seconds = 0.1;
      job.work_spread = 0.5;
      const Sample sample = measure(job, maker_of<MutexQueue<std::uint64_t>>(), never);
      EXPECT_EQ(sample.status, "ok") << scenario.name << ": " << sample.message;
      EXPECT_GT(sample.operations(), 0U) << scenario.name;
    }
  }
}

TEST(Measurement, ProducersWaitForConsumersAtTheCapacity) {
  Job job = job_for("3x1", 4);
  job.queue = "mutex";
  job.capacity = 256;
  job.warmup_seconds = 0.1;
  const Sample sample = measure(job, maker_of<MutexQueue<std::uint64_t>>(), never);
  EXPECT_EQ(sample.status, "ok") << sample.message;
  EXPECT_LT(sample.pushes, sample.pops + 256 + 4 * 64 + 1000);
}

TEST(Measurement, WithoutProcessorTimeNoOperationsAreNoFailure) {
  Job job = job_for("pairs", 1);
  job.seconds = 0.05;
  job.warmup_seconds = 0;
  const Sample sample = measure_metronome(job, {{.each = milliseconds(500), .first = {}}});
  EXPECT_EQ(sample.operations(), 0U);
  EXPECT_EQ(sample.status, "ok") << sample.message;
}

TEST(Measurement, AQueueThatNeverGivesAnythingHasFailed) {
  /// Takes and gives nothing, at once.
  struct Refusing {
    static bool push(unsigned /*worker*/, std::uint64_t /*element*/) { return false; }
    static bool pop(unsigned /*worker*/, std::uint64_t& /*element*/) { return false; }
  };
  Job job = job_for("pairs", 1);
  job.seconds = 0.02;
  job.warmup_seconds = 0;
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::chrono::steady_clock::now() < patience) {
    const Sample sample = measure(
        job,
        [](unsigned, std::size_t, bool) -> std::unique_ptr<Subject> {
          return std::make_unique<SubjectOf<Refusing>>(std::make_unique<Refusing>(), nullptr);
        },
        never);
    ASSERT_EQ(sample.operations(), 0U);
    if (sample.status == "ok") continue;  // the machine gave the thread too little
    EXPECT_EQ(sample.status, "failed");
    EXPECT_NE(sample.message.find("no operation succeeded"), std::string::npos);
    return;
  }
  FAIL() << "never noticed";
}

TEST(Measurement, AProcessorThatIsNotThereIsSaid) {
  EXPECT_NE(bind_to(1'000'000), "");
  Job job = job_for("pairs", 1);
  job.processors = {1'000'000};
  job.seconds = 0.01;
  job.warmup_seconds = 0;
  const QueueRegistry queues;
  EXPECT_NE(measure(job, subject_maker(queues, no_queue), never).not_pinned, "");
}

TEST(Resources, AnEnergyCounterThatWrapsAround) {
  const std::filesystem::path root =
      std::filesystem::path(testing::TempDir()) / ("irt-rapl-" + std::to_string(getpid()));
  const auto write = [&](const char* name, std::uint64_t value) {
    std::filesystem::create_directories((root / name).parent_path());
    std::ofstream(root / name) << value << '\n';
  };
  write("intel-rapl:0/energy_uj", 9'000'000);
  write("intel-rapl:0/max_energy_range_uj", 10'000'000);
  write("intel-rapl:0:0/energy_uj", 5);  // a part of the package
  EnergyMeter meter(root);
  meter.start();
  write("intel-rapl:0/energy_uj", 1'000'000);
  EXPECT_DOUBLE_EQ(meter.joules().value(), 2);
  write("intel-rapl:0/energy_uj", 1'500'000);
  write("intel-rapl:1/energy_uj", 250'000);  // of a package that came later: not ours
  EXPECT_DOUBLE_EQ(meter.joules().value(), 2.5);
  EXPECT_EQ(meter.missing(), "");
  std::filesystem::remove_all(root);
}

TEST(Resources, WhyThereIsNoEnergyIsSaid) {
  EXPECT_NE(EnergyMeter("/no/such/place").missing().find("no RAPL counters"), std::string::npos);
  EXPECT_FALSE(EnergyMeter("/no/such/place").joules());
  // A package whose counter cannot be read, as by users that are not root.
  const std::filesystem::path root =
      std::filesystem::path(testing::TempDir()) / ("irt-shut-" + std::to_string(getpid()));
  std::filesystem::create_directories(root / "intel-rapl:0/energy_uj");
  const EnergyMeter meter(root);
  EXPECT_NE(meter.missing().find("not readable by this user"), std::string::npos);
  EXPECT_FALSE(meter.joules());
  std::filesystem::remove_all(root);
}

TEST(Resources, HardwareCountersCountOrSayWhyNot) {
  HardwareCounters counters(hardware_events());
  counters.start();
  busy_wait(1'000'000);
  counters.stop();
  const auto figures = counters.read();
  EXPECT_EQ(figures.is_null(), !counters.missing().empty());
  if (figures.contains("instructions")) {
    EXPECT_GE(figures["instructions"].get<double>(), 2e6);
  }
}

TEST(Resources, EventsAreThoseOfThreadsStartedLater) {
  // The kernel's own events, which virtual machines have, too, and one that does not exist.
  constexpr std::array events{
      HardwareEvent{"task_clock", PERF_TYPE_SOFTWARE, PERF_COUNT_SW_TASK_CLOCK},
      HardwareEvent{"no_such_event", PERF_TYPE_SOFTWARE, 12'345}};
  HardwareCounters counters(events);
  if (!counters.missing().empty()) GTEST_SKIP() << counters.missing();
  const auto busy_ms = [] {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
  };
  const auto work_20_ms = [&] {
    while (busy_ms() < 20) busy_wait(1000);
  };
  std::thread(work_20_ms).join();
  counters.start();
  std::thread first(work_20_ms), second(work_20_ms);
  first.join();
  second.join();
  counters.stop();
  const auto figures = counters.read();
  EXPECT_FALSE(figures.contains("no_such_event"));
  EXPECT_GE(figures["task_clock"].get<double>(),
            39e6);  // nanoseconds, of both and not of the one before
  EXPECT_LE(figures["task_clock"].get<double>(), 55e6);
}

TEST(Resources, MemoryThatAQueueTakesIsSeen) {
  const MemoryUse use;
  const std::vector<char> block(64U << 20U, 'x');
  EXPECT_GE(use.peak_bytes(), 60U << 20U);
}

TEST(Resources, APeakStaysAndWhatIsGivenBackIsNotHeld) {
  const MemoryUse use;
  if (!use.held_bytes()) GTEST_SKIP() << "another allocator than the C library's";
  {
    const std::vector<char> block(64U << 20U, 'x');
    EXPECT_GE(use.held_bytes(), 64U << 20U);
  }
  EXPECT_GE(use.peak_bytes(), 60U << 20U);
  EXPECT_LT(use.held_bytes(), 1U << 20U);
}

TEST(Resources, BlocksOfThreadsThatEndedAreStillHeld) {
  const MemoryUse use;
  if (!use.held_bytes()) GTEST_SKIP() << "another allocator than the C library's";
  std::vector<std::unique_ptr<char[]>> blocks(1000);
  std::thread([&blocks] {
    for (auto& block : blocks) block = std::make_unique<char[]>(1000);
  }).join();
  EXPECT_GE(use.held_bytes(), 1'000'000U);
  EXPECT_LT(use.held_bytes(), 2'000'000U);
}

}  // namespace
}  // namespace irt::contention
