#include "bench/many_core/workloads/point.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <sys/resource.h>

#include "bench/many_core/workloads/contended.hpp"
#include "bench/many_core/workloads/hot_lines.hpp"
#include "queues/split_mix.hpp"
#include "queues/work_queue.hpp"
#include "renderer/engine/time_histogram.hpp"
#include "stress/virtual_cores/queue_modules.hpp"

namespace irt::many_core {

std::string_view name_of(Scenario scenario) {
  static constexpr std::array<std::string_view, 4> names{"pairs", "producers-consumers", "bursts",
                                                         "primitive"};
  return names[static_cast<std::size_t>(scenario)];
}

namespace {

constexpr std::size_t longest_burst = 16;

// Producers of a queue without a bound wait while so many elements are inside: else they would
// leave slower consumers behind, and most operations would be pushes.
constexpr std::int64_t most_inside = 1024;
constexpr double held_back_ns = 500;

// Operations of one kind.
struct Tally {
  std::uint64_t all = 0, counted = 0, failed = 0;  // since the start; in the measured time
  Time longest = 0;
  TimeHistogram latency;

  Tally& operator+=(const Tally& other) {
    all += other.all;
    counted += other.counted;
    failed += other.failed;
    latency += other.latency;
    longest = std::max(longest, other.longest);
    return *this;
  }
};

struct alignas(line_bytes) Worker {
  SplitMix random{0};
  std::uint64_t pushed_sum = 0, popped_sum = 0;
  Tally pushes, pops;
};

class Run {
 public:
  Run(const Profile& profile, const Point& point, std::uint64_t seed)
      : point_(point),
        machine_(profile, place(profile, point.threads, point.placement), seed),
        module_(point.module),
        workers_(point.threads),
        // All together fit into the queue, or those who wait for room would hold what others wait
        // for.
        burst_(std::clamp<std::size_t>(point.capacity / point.threads, 1, longest_burst)) {
    for (unsigned i = 0; i < point.threads; ++i) workers_[i].random = SplitMix(seed * 1000 + i);
    machine_.set_up([this] { make(); });
  }

  Ending operate() {
    const Time begin = picoseconds(point_.warm_up_ns);
    Ending ending = machine_.run(begin, begin + picoseconds(point_.measured_ns),
                                 [this](unsigned thread) { act(thread); });
    // A queue whose pop waits leaves its consumers asleep at the end.
    if (ending.kind == Ending::Kind::asleep && machine_.last_clock() >= begin) ending = {};
    if (ending.kind == Ending::Kind::late && primitive_ != nullptr && primitive_->waits)
      ending = {};
    if (ending.kind == Ending::Kind::finished) check_conservation(ending);
    return ending;
  }

  nlohmann::json result(const Ending& ending, bool explain);

 private:
  void make() {
    if (point_.scenario == Scenario::primitive) {
      for (const Contended& each :
           all_contended(module_.function<decltype(irt_contended)>("irt_contended")))
        if (each.name == point_.subject) primitive_ = &each;
      object_ = primitive_->make(point_.threads);
      return;
    }
    entry_ = &virtual_cores::queue_of(module_);
    queue_ = entry_->make_word_queue(point_.threads, point_.capacity).release();
    if (!entry_->claims.bounded) backlog_ = most_inside;
  }

  void act(unsigned thread) {
    Worker& me = workers_[thread];
    while (!machine_.over()) {
      switch (point_.scenario) {
        case Scenario::pairs:
          if (push(thread, me)) pop(thread, me);
          break;
        case Scenario::sides:
          if (!pushes(thread)) {
            pop(thread, me);
          } else if (inside_ < backlog_) {
            push(thread, me);
          } else {
            machine_.idle(held_back_ns);
          }
          break;
        case Scenario::bursts:
          for (std::size_t i = 0; i < burst_ && push(thread, me);) ++i;
          for (std::size_t i = 0; i < burst_ && pop(thread, me);) ++i;
          break;
        case Scenario::primitive:
          attempt(thread, me, me.pushes, [&] {
            primitive_->step(object_, thread);
            return true;
          });
          break;
      }
    }
  }

  // Both roles are spread alike over the machine: by turns where neighbours have neighbouring
  // numbers, in halves where these alternate between sockets.
  bool pushes(unsigned thread) const {
    if (point_.placement == Placement::spread) return thread < point_.producers;
    const auto before = [this](unsigned n) {
      return (n * point_.producers + point_.threads - 1) / point_.threads;
    };
    return before(thread + 1) > before(thread);
  }

  // Repeats `operation` until it succeeds or time is up; then works.
  template <class Operation>
  bool attempt(unsigned thread, Worker& me, Tally& tally, Operation operation) {
    const Time begin = machine_.clock();
    const std::uint64_t failures = machine_.failures(thread);
    bool done = operation();
    while (!done && !machine_.over()) {
      machine_.count_failure();
      done = operation();
    }
    const Time end = machine_.clock();
    if (done) ++tally.all;
    if (machine_.counts_at(end)) {
      tally.failed += machine_.failures(thread) - failures;
      if (done) {
        ++tally.counted;
        tally.latency.add(static_cast<std::uint64_t>((end - begin) / nanosecond));
        tally.longest = std::max(tally.longest, end - begin);
      }
    }
    if (done && point_.work_ns > 0) machine_.work(point_.work_ns * vary(me));
    return done;
  }

  bool push(unsigned thread, Worker& me) {
    const std::uint64_t element = std::uint64_t{thread + 1} << 40U | (me.pushes.all + 1);
    const bool done = attempt(thread, me, me.pushes, [&] { return queue_->push(thread, element); });
    if (done) me.pushed_sum += element;
    inside_ += done ? 1 : 0;
    return done;
  }

  bool pop(unsigned thread, Worker& me) {
    std::uint64_t element = 0;
    const bool done = attempt(thread, me, me.pops, [&] { return queue_->pop(thread, element); });
    if (done) me.popped_sum += element;
    inside_ -= done ? 1 : 0;
    return done;
  }

  // A factor within a tenth of one, so that threads do not march in step.
  static double vary(Worker& me) {
    return 0.9 + 0.2 * static_cast<double>(me.random.next() >> 11U) * 0x1p-53;
  }

  // What went in and did not come out is still there.
  void check_conservation(Ending& ending) {
    if (queue_ == nullptr || !entry_->claims.carries_elements) return;
    std::uint64_t count = 0, sum = 0;
    for (const Worker& worker : workers_) {
      count += worker.pushes.all - worker.pops.all;
      sum += worker.pushed_sum - worker.popped_sum;
    }
    try {
      machine_.set_up([&] {
        for (unsigned worker = 0; worker < point_.threads; ++worker) {
          for (std::uint64_t element = 0; queue_->pop(worker, element); --count) sum -= element;
        }
      });
    } catch (const std::exception&) {
      return;  // its pop waits for ever where there is nothing
    }
    if (count != 0 || sum != 0)
      ending = {Ending::Kind::failed, "what came out of the queue is not what went in"};
  }

  Point point_;
  Machine machine_;
  virtual_cores::Module module_;
  std::vector<Worker> workers_;
  std::size_t burst_;
  const QueueEntry* entry_ = nullptr;
  AnyWorkQueue<std::uint64_t>* queue_ = nullptr;  // not destroyed: the process ends
  std::int64_t inside_ = 0;                       // elements
  std::int64_t backlog_ = std::numeric_limits<std::int64_t>::max();
  const Contended* primitive_ = nullptr;
  void* object_ = nullptr;
};

nlohmann::json latency_of(const Tally& tally) {
  if (tally.counted == 0) return nullptr;
  return {{"counts", tally.latency.counts}, {"max", static_cast<double>(tally.longest) / 1e3}};
}

nlohmann::json Run::result(const Ending& ending, bool explain) {
  Tally pushes, pops;
  std::uint64_t least = ~std::uint64_t{0}, most = 0;
  for (unsigned i = 0; i < workers_.size(); ++i) {
    const Worker& worker = workers_[i];
    pushes += worker.pushes;
    pops += worker.pops;
    const std::uint64_t mine = worker.pushes.counted + worker.pops.counted;
    least = std::min(least, mine);
    most = std::max(most, mine);
  }
  const Counts& counts = machine_.counts();
  const double all_time = point_.measured_ns * 1e3 * point_.threads;
  nlohmann::json waiting;
  for (std::size_t i = 0; i < causes; ++i)
    waiting[std::string(name_of(static_cast<Cause>(i)))] =
        static_cast<double>(counts.waited[i]) / all_time;
  const std::uint64_t operations = pushes.counted + pops.counted;
  const bool idle = ending.kind == Ending::Kind::finished && operations == 0;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  nlohmann::json result{
      {"status", ending.kind == Ending::Kind::finished ? idle ? "hung" : "ok"
                 : ending.kind == Ending::Kind::failed ? "failed"
                                                       : "hung"},
      {"message", idle ? "no operation has succeeded" : ending.message},
      {"pushes", pushes.counted},
      {"pops", pops.counted},
      {"failed_pushes", pushes.failed},
      {"failed_pops", pops.failed},
      {"operations_per_second", static_cast<double>(operations) / (point_.measured_ns * 1e-9)},
      {"fairness", most == 0 ? 0 : static_cast<double>(least) / static_cast<double>(most)},
      {"latency", {{"push", latency_of(pushes)}, {"pop", latency_of(pops)}}},
      {"accesses", counts.accesses},
      {"transfers", counts.transfers},
      {"swaps", counts.swaps},
      {"failed_swaps", counts.failed_swaps},
      {"sleeps", counts.sleeps},
      {"waiting", waiting},
      {"hot_lines", nullptr},
      {"cpu_seconds", static_cast<double>(usage.ru_utime.tv_sec) +
                          1e-6 * static_cast<double>(usage.ru_utime.tv_usec)},
      {"memory_bytes", usage.ru_maxrss * 1024},
  };
  if (explain) result["hot_lines"] = hot_lines(machine_, module_);
  return result;
}

}  // namespace

nlohmann::json simulate(const Profile& profile, const Point& point, std::uint64_t seed,
                        bool explain) {
  Run run(profile, point, seed);
  return run.result(run.operate(), explain);
}

}  // namespace irt::many_core
