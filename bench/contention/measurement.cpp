#include "bench/contention/measurement.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <mutex>
#include <numeric>
#include <optional>
#include <span>
#include <thread>

#include "bench/contention/counting.hpp"
#include "bench/contention/named_events.hpp"
#include "bench/contention/placement.hpp"
#include "bench/contention/resources.hpp"
#include "queues/registry.hpp"

namespace irt::contention {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

double since(Clock::time_point begin) {
  return Seconds(Clock::now() - begin).count();
}

/// What all threads have done at one moment.
struct Snapshot {
  Clock::time_point at;
  Sample sums;
  std::vector<std::uint64_t> operations;  ///< by thread
};

Snapshot look(const Table& table) {
  Snapshot now;
  now.operations.reserve(table.counts.size());
  now.at = Clock::now();
  for (const Counts& one : table.counts) {
    const std::uint64_t pushes = one.pushes.load(std::memory_order_relaxed);
    const std::uint64_t pops = one.pops.load(std::memory_order_relaxed);
    now.operations.push_back(pushes + pops);
    now.sums.pushes += pushes;
    now.sums.pops += pops;
    now.sums.failed_pushes += one.failed_pushes.load(std::memory_order_relaxed);
    now.sums.failed_pops += one.failed_pops.load(std::memory_order_relaxed);
    now.sums.held_back += one.held_back.load(std::memory_order_relaxed);
  }
  return now;
}

/// Standard deviation over mean; infinite where nothing happened.
double variation(std::span<const double> values) {
  const double n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return mean > 0 ? std::sqrt(squares / (n - 1)) / mean : std::numeric_limits<double>::infinity();
}

/// Least over most operations of a thread, among those with the same part.
double fairness(const Roles& roles, const std::vector<std::uint64_t>& operations) {
  const auto within = [&](std::size_t from, std::size_t to) {
    if (from >= to) return 1.0;
    const auto [least, most] = std::ranges::minmax(std::span(operations).subspan(from, to - from));
    return most == 0 ? 0 : static_cast<double>(least) / static_cast<double>(most);
  };
  if (roles.together()) return within(0, roles.workers);
  return std::min(within(0, roles.producers), within(roles.producers, roles.workers));
}

std::vector<HardwareEvent> with_perf_names(std::vector<HardwareEvent> events) {
  events.insert(events.begin(), hardware_events().begin(), hardware_events().end());
  return events;
}

/// What counts beside the threads, over all turns.
class Meters {
 public:
  void start() {
    energy_.start();
    counters_.start();
  }
  void stop() {
    counters_.stop();
    if (const auto joules = energy_.joules()) joules_ = joules_.value_or(0) + *joules;
  }
  void read_into(Sample& sample) const {
    sample.counters = counters_.read();
    if (joules_) sample.energy_joules = *joules_;
    const std::string& uncounted =
        counters_.missing().empty() ? named_.missing : counters_.missing();
    for (const std::string& why : {energy_.missing(), uncounted}) {
      if (!why.empty()) sample.missing.push_back(why);
    }
  }

 private:
  EnergyMeter energy_;
  EventsByName named_ = events_by_name();
  HardwareCounters counters_{with_perf_names(named_.events)};
  std::optional<double> joules_;
};

/// How far threads have come that wait for each other.
struct Muster {
  std::atomic<unsigned> present{0}, finished{0};
  std::atomic<bool> go{false};
};

class Measurement {
 public:
  Measurement(const Job& job, const SubjectMaker& make)
      : job_(job),
        scenario_(*scenario_at(job.scenario).scenario),
        table_(Roles{job.threads, job.producers, job.consumers}),
        operations_(job.threads, 0) {
    table_.backlog = job.capacity;
    table_.pause_steps = steps_for(1000, job.pace);
    SplitMix seeds(job.seed);
    for (unsigned i = 0; i < job.threads; ++i) {
      const Waits own(steps_for(job.work_ns, job.pace), job.work_spread, seeds.next());
      seats_.push_back(std::make_unique<Seat>(table_, i, own, seeds.next()));
      seats_.back()->producer_pause_steps = steps_for(scenario_.producer_pause_ns, job.pace);
      if (logged()) {
        // Beyond the end, for who goes on until it asks; and touched, so that no page is missing.
        seats_.back()->log_room = std::min(most_logged, most_logged_by_all / job.threads);
        seats_.back()->log.resize(seats_.back()->log_room + 4096);
        seats_.back()->log.clear();
      }
    }
    // The histograms and whatever else is ours is in place: what comes now is the queue's.
    memory_.emplace();
    subject_ = make(job.threads, job.capacity, scenario_.has_two_queues());
  }

  Sample run(const std::function<void()>& await_turn,
             const std::function<void(const Sample&)>& on_hang) {
    prefill();
    sample_.work_ns_measured =
        job_.work_ns > 0 ? measure_wait_ns(steps_for(job_.work_ns, job_.pace)) : 0;
    if (stamped()) {
      ticks_per_nanosecond_ = stress::calibrate().ticks_per_nanosecond;
      sample_.clock_ns = measure_clock_ns(ticks_per_nanosecond_);
    }
    if (logged()) {
      await_turn();
      clock_error_ = stress::calibrate().error;
      start();
      until_logged();
    } else {
      start();
      warm_up();
      for (unsigned i = 0; i < job_.turns; ++i) {
        await_turn();
        std::this_thread::sleep_for(Seconds(job_.settling_seconds));
        turn();
      }
    }
    sample_.fairness = fairness(table_.roles, operations_);
    meters_.read_into(sample_);
    await_turn();
    table_.stop.store(true, std::memory_order_relaxed);
    if (!stopped_in_time()) {
      sample_.status = "hung";
      sample_.message =
          fmt::format("{} of {} threads did not stop within {} s",
                      job_.threads - muster_.finished.load(), job_.threads, job_.patience_seconds);
      on_hang(sample_);
    }
    for (std::thread& thread : threads_) thread.join();
    sample_.memory_peak_bytes = memory_->peak_bytes();
    if (const auto held = memory_->held_bytes()) sample_.memory_held_bytes = *held;
    sample_.all_operations = look(table_).sums.operations();
    if (stamped()) {
      sample_.push_times = times(&Seat::push_times);
      sample_.pop_times = times(&Seat::pop_times);
    }
    if (logged()) sample_.order = order();
    if (job_.queue != no_queue) take_stock();
    // Where the machine put a thread off, others may wait for it, spinning: then the rate is none,
    // but not by the queue's fault.
    if (!logged() && sample_.operations() == 0 &&
        sample_.cpu_seconds > 0.9 * sample_.seconds * job_.threads) {
      fail(fmt::format("no operation succeeded in {:.2f} s", sample_.seconds));
    }
    return sample_;
  }

 private:
  // Operations of a thread, and of all threads, for half a gigabyte.
  static constexpr std::size_t most_logged = std::size_t{1} << 18;
  static constexpr std::size_t most_logged_by_all = std::size_t{1} << 24;

  [[nodiscard]] bool stamped() const { return job_.pass == Pass::stamped; }
  [[nodiscard]] bool logged() const { return job_.pass == Pass::logged; }

  void fail(const std::string& why) {
    if (sample_.status != "ok") return;
    sample_.status = "failed";
    sample_.message = why;
  }

  // Every worker gets its share, for queues of which each worker has one.
  void prefill() {
    const auto wanted =
        static_cast<std::uint64_t>(static_cast<double>(job_.capacity) * scenario_.prefill);
    for (std::uint64_t i = 0; i < wanted; ++i) {
      // No worker's, and none of the small words that a queue may keep for itself.
      const std::uint64_t element = (std::uint64_t{1} << 39U) | i;
      const stress::Stamp begin = stress::stamp_before();
      const bool taken = subject_->push(static_cast<unsigned>(i % job_.threads), element);
      if (logged()) prefill_.push_back({begin, stress::stamp_after(), element, stress::Kind::push});
      if (!taken) {
        fail(fmt::format("full after {} of {} elements, below its capacity", i, job_.capacity));
        return;
      }
      ++prefilled_;
      prefilled_sum_ += element;
    }
    for (unsigned worker = 0; worker < job_.threads; ++worker) subject_->leave(worker);
  }

  void start() {
    for (unsigned i = 0; i < job_.threads; ++i) {
      threads_.emplace_back([this, i] { one_thread(i); });
    }
    while (muster_.present.load(std::memory_order_relaxed) < job_.threads) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    // (1) release: pairs with (2), so that threads see the queue as it was made and filled
    muster_.go.store(true, std::memory_order_release);
  }

  void one_thread(unsigned i) {
    if (!job_.processors.empty()) {
      const std::string why = bind_to(job_.processors[i % job_.processors.size()]);
      const std::lock_guard lock(sample_mutex_);
      if (!why.empty()) sample_.not_pinned = why;
    }
    muster_.present.fetch_add(1, std::memory_order_relaxed);
    // (2) acquire: pairs with (1)
    while (!muster_.go.load(std::memory_order_acquire)) std::this_thread::yield();
    try {
      subject_->run(scenario_.program, *seats_[i], stamped() || logged());
    } catch (const std::exception& error) {
      const std::lock_guard lock(sample_mutex_);
      fail(error.what());
      table_.stop.store(true, std::memory_order_relaxed);
      table_.gate.abandon();
    }
    subject_->leave(i);
    if (job_.pass == Pass::counted) {
      const std::lock_guard lock(sample_mutex_);
      sample_.events += events_of_this_thread();
    }
    // (3) release: pairs with (4), so that the coordinator may free what this thread used
    muster_.finished.fetch_add(1, std::memory_order_release);
  }

  void warm_up() {
    constexpr std::chrono::milliseconds slice(10);
    const Clock::time_point begin = Clock::now();
    std::vector<double> rates;
    Snapshot before = look(table_);
    while (since(begin) < job_.warmup_seconds) {
      std::this_thread::sleep_for(slice);
      const Snapshot now = look(table_);
      const double operations =
          static_cast<double>(now.sums.operations() - before.sums.operations());
      rates.push_back(operations / Seconds(now.at - before.at).count());
      before = now;
      if (rates.size() < steady_slices) continue;
      sample_.variation = variation(std::span(rates).last(steady_slices));
      const bool all_started = std::ranges::find(now.operations, 0U) == now.operations.end();
      sample_.steady = all_started && sample_.variation < steady_variation;
      if (sample_.steady) break;
    }
    if (!std::isfinite(sample_.variation)) sample_.variation = 0;  // which JSON does not know
  }

  void until_logged() {
    const Clock::time_point begin = Clock::now();
    while (since(begin) < job_.seconds && !table_.stop.load(std::memory_order_relaxed))
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  [[nodiscard]] results::OrderOfElements order() {
    std::vector<std::vector<stress::Operation>> logs{std::move(prefill_)};
    for (const auto& seat : seats_) logs.push_back(std::move(seat->log));
    return results::order_of(std::move(logs), clock_error_);
  }

  void turn() {
    meters_.start();
    const Usage usage = usage_so_far(threads_);
    const Snapshot begin = look(table_);
    std::this_thread::sleep_until(begin.at + Seconds(job_.seconds / job_.turns));
    const Usage now = usage_so_far(threads_);
    const Snapshot end = look(table_);
    meters_.stop();

    sample_.seconds += Seconds(end.at - begin.at).count();
    for (std::uint64_t Sample::*count : {&Sample::pushes, &Sample::pops, &Sample::failed_pushes,
                                         &Sample::failed_pops, &Sample::held_back}) {
      sample_.*count += end.sums.*count - begin.sums.*count;
    }
    for (std::size_t i = 0; i < operations_.size(); ++i) {
      operations_[i] += end.operations[i] - begin.operations[i];
    }
    sample_.cpu_seconds += now.cpu_seconds - usage.cpu_seconds;
    sample_.context_switches += now.context_switches - usage.context_switches;
  }

  [[nodiscard]] bool stopped_in_time() const {
    const Clock::time_point begin = Clock::now();
    // (4) acquire: pairs with (3)
    while (muster_.finished.load(std::memory_order_acquire) < job_.threads) {
      if (since(begin) > job_.patience_seconds) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
  }

  [[nodiscard]] Times times(Histogram Seat::*which) const {
    Histogram ticks;
    for (const auto& seat : seats_) ticks.merge((*seat).*which);
    const double per_tick = 1 / ticks_per_nanosecond_;
    Histogram nanoseconds;
    std::vector<std::pair<std::size_t, std::uint64_t>> converted;
    const auto convert = [&](std::uint64_t value) {
      return static_cast<std::uint64_t>(std::llround(static_cast<double>(value) * per_tick));
    };
    for (const auto& [index, count] : ticks.buckets()) {
      const std::uint64_t value = std::min(Histogram::upper_end(index), ticks.max());
      converted.emplace_back(Histogram::index_of(convert(value)), count);
    }
    nanoseconds.add(converted, convert(ticks.max()));
    return {.buckets = nanoseconds.buckets(), .max = nanoseconds.max()};
  }

  // Everything that went in has come out or is still inside, once; where there are elements.
  void take_stock() {
    if (is_registered(job_.queue, ModuleKind::plugin) &&
        !QueueRegistry().at_or_counter(job_.queue).claims.carries_elements)
      return;
    std::uint64_t in = prefilled_sum_, out = 0;
    std::uint64_t pushes = prefilled_, pops = 0;
    for (const auto& seat : seats_) {
      in += seat->in;
      out += seat->out;
    }
    const Snapshot end = look(table_);
    pushes += end.sums.pushes;
    pops += end.sums.pops;
    std::uint64_t left = 0, element = 0;
    for (bool found = true; found && pops + left <= pushes;) {
      found = false;
      for (unsigned worker = 0; worker < job_.threads; ++worker) {
        if (pops + left > pushes || !subject_->pop(worker, element)) continue;
        found = true;
        ++left;
        out += element;
      }
    }
    if (pops + left != pushes || in != out) {
      fail(fmt::format("{} elements went in; {} came out and {} were still inside{}", pushes, pops,
                       left, pops + left == pushes ? ", but not the same ones" : ""));
    }
  }

  const Job& job_;
  const Scenario& scenario_;
  Table table_;
  std::vector<std::unique_ptr<Seat>> seats_;
  std::vector<std::uint64_t> operations_;  // by thread, of all turns
  std::optional<MemoryUse> memory_;
  std::unique_ptr<Subject> subject_;
  Meters meters_;
  std::vector<std::thread> threads_;
  Muster muster_;
  std::mutex sample_mutex_;
  std::uint64_t prefilled_ = 0, prefilled_sum_ = 0;
  std::vector<stress::Operation> prefill_;  // of a logged pass
  stress::Stamp clock_error_ = 0;
  double ticks_per_nanosecond_ = 1;
  Sample sample_;
};

}  // namespace

Sample measure(const Job& job, const SubjectMaker& make, const std::function<void()>& await_turn,
               const std::function<void(const Sample&)>& on_hang) {
  return Measurement(job, make).run(await_turn, on_hang);
}

double measure_clock_ns(double ticks_per_nanosecond) {
  constexpr int readings = 2001;
  std::vector<std::uint64_t> distances(readings);
  for (std::uint64_t& distance : distances) {
    const std::uint64_t begin = stress::stamp_before();
    distance = stress::stamp_after() - begin;
  }
  std::ranges::nth_element(distances, distances.begin() + readings / 2);
  return static_cast<double>(distances[readings / 2]) / ticks_per_nanosecond;
}

}  // namespace irt::contention
