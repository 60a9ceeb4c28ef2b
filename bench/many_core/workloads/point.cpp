#include "bench/many_core/workloads/point.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <sys/resource.h>

#include "bench/many_core/workloads/contended.hpp"
#include "bench/many_core/workloads/hot_lines.hpp"
#include "bench/results/order_of_elements.hpp"
#include "queues/split_mix.hpp"
#include "queues/work_queue.hpp"
#include "renderer/engine/time_histogram.hpp"
#include "stress/virtual_cores/queue_modules.hpp"

namespace irt::many_core {

std::string_view scenario_of(const Point& point) {
  return point.scenario == nullptr ? "primitive" : point.scenario->name;
}

Roles roles_of(const Point& point) {
  if (point.scenario == nullptr) return {point.threads, point.threads, 0};
  return point.scenario->roles(point.threads).together()
             ? all_do_both(point.threads)
             : apart(point.producers, point.threads - point.producers);
}

namespace {

constexpr std::size_t longest_burst = 16;

// Producers of a queue without a bound wait while so many elements are inside: else they would
// leave slower consumers behind, and most operations would be pushes.
constexpr std::int64_t most_inside = 1024;
constexpr double held_back_ns = 500;

// How often a thread looks whether the others have come to a barrier.
constexpr double look_ns = 50;

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
  std::uint64_t pushed_sum = 0, popped_sum = 0, last_popped = 0;
  std::vector<stress::Operation> log;  // what succeeded
  Time began = 0;                      // the call that was made last
  Tally pushes, pops;
};

// Of all threads; it takes no accesses, for it is none of the queue's.
class Barrier {
 public:
  // False, to all alike, once time is up.
  bool pass(Machine& machine, unsigned threads) {
    const unsigned mine = passed_;
    if (++arrived_ == threads) {
      arrived_ = 0;
      ended_ = machine.over();
      ++passed_;
    }
    while (passed_ == mine) machine.idle(look_ns);
    return !ended_;
  }

 private:
  unsigned arrived_ = 0, passed_ = 0;
  bool ended_ = false;
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

  // Of all operations since the start, see stress::Relaxation; null where there are two queues.
  nlohmann::json order();

 private:
  using Queue = AnyWorkQueue<std::uint64_t>;
  class Hand;

  void make() {
    if (point_.scenario == nullptr) {
      for (const Contended& each :
           all_contended(module_.function<decltype(irt_contended)>("irt_contended")))
        if (each.name == point_.subject) primitive_ = &each;
      object_ = primitive_->make(point_.threads);
      return;
    }
    entry_ = &virtual_cores::queue_of(module_);
    queues_.push_back(entry_->make_word_queue(point_.threads, point_.capacity).release());
    if (point_.scenario->has_two_queues())
      queues_.push_back(entry_->make_word_queue(point_.threads, point_.capacity).release());
    if (!entry_->claims.bounded) backlog_ = most_inside;
    prefill();
  }

  // Every worker gets its share, for queues of which each worker has one.
  void prefill() {
    const double wanted = static_cast<double>(point_.capacity) * point_.scenario->prefill;
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(wanted); ++i) {
      // No worker's, and none of the small words that a queue may keep for itself.
      const std::uint64_t element = std::uint64_t{1} << 39U | i;
      if (!queues_[0]->push(static_cast<unsigned>(i % point_.threads), element)) return;
      prefill_.push_back({0, 0, element, stress::Kind::push});
      ++prefilled_;
      prefilled_sum_ += element;
    }
    leave_all(*queues_[0], point_.threads);
  }

  void act(unsigned thread);

  // Both roles are spread alike over the machine: by turns where neighbours have neighbouring
  // numbers, in halves where these alternate between sockets.
  [[nodiscard]] bool pushes(unsigned thread) const {
    if (point_.placement == Placement::spread) return thread < point_.producers;
    const auto before = [this](unsigned n) {
      return (n * point_.producers + point_.threads - 1) / point_.threads;
    };
    return before(thread + 1) > before(thread);
  }

  // Makes `operation`; with `again` until it succeeds or time is up.
  template <class Operation>
  bool attempt(unsigned thread, Tally& tally, bool again, Operation operation) {
    const Time begin = machine_.clock();
    const std::uint64_t failures = machine_.failures(thread);
    bool done = operation();
    if (!done && !again) machine_.count_failure();
    while (!done && again && !machine_.over()) {
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
    return done;
  }

  void work(Worker& me) {
    if (point_.work_ns > 0) machine_.work(point_.work_ns * vary(me));
  }

  // A factor within a tenth of one, so that threads do not march in step.
  static double vary(Worker& me) {
    return 0.9 + 0.2 * static_cast<double>(me.random.next() >> 11U) * 0x1p-53;
  }

  // What went in and did not come out is still there.
  void check_conservation(Ending& ending) {
    if (queues_.empty() || !entry_->claims.carries_elements) return;
    std::uint64_t count = prefilled_, sum = prefilled_sum_;
    for (const Worker& worker : workers_) {
      count += worker.pushes.all - worker.pops.all;
      sum += worker.pushed_sum - worker.popped_sum;
    }
    try {
      machine_.set_up([&] {
        for (Queue* queue : queues_)
          for (unsigned worker = 0; worker < point_.threads; ++worker)
            for (std::uint64_t element = 0; queue->pop(worker, element); --count) sum -= element;
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
  std::vector<Queue*> queues_;  // not destroyed: the process ends
  std::uint64_t prefilled_ = 0, prefilled_sum_ = 0;
  std::vector<stress::Operation> prefill_;
  std::int64_t inside_ = 0;     // elements that were pushed and not popped
  std::uint64_t finished_ = 0;  // tasks
  std::int64_t backlog_ = std::numeric_limits<std::int64_t>::max();
  const Contended* primitive_ = nullptr;
  void* object_ = nullptr;
  Barrier barrier_;
};

// Operations succeed, are counted and take their time as `attempt` says.
class Run::Hand {
 public:
  Hand(Queue& queue, Run& run, unsigned thread)
      : run_(run), thread_(thread), me_(run.workers_[thread]), queue_(queue) {}

  [[nodiscard]] bool running() const { return !run_.machine_.over(); }
  bool push() { return pushed(fresh(), Tries::one); }
  bool pop() { return popped(Tries::one); }
  bool push_tagged(unsigned tag) { return pushed(fresh() * contention::tags + tag, Tries::one); }
  bool pop_tagged(unsigned& tag) {
    if (!popped(Tries::one)) return false;
    tag = static_cast<unsigned>(me_.last_popped % contention::tags);
    return true;
  }
  bool push_until_accepted() { return pushed(fresh(), Tries::all); }
  bool pop_until_found() { return popped(Tries::all); }
  std::size_t push_bulk() {
    std::array<std::uint64_t, contention::bulk> elements{};
    std::uint64_t element = fresh();
    for (std::uint64_t& each : elements) each = element++;
    const std::size_t taken = several(
        me_.pushes, [&] { return std::min(queue_.push_bulk(thread_, elements), elements.size()); });
    for (std::size_t i = 0; i < taken; ++i) {
      me_.pushed_sum += elements[i];
      log(stress::Kind::push, elements[i]);
    }
    run_.inside_ += static_cast<std::int64_t>(taken);
    return taken;
  }
  std::size_t pop_bulk(std::size_t most) {
    std::array<std::uint64_t, contention::bulk> elements{};
    const auto room = std::span(elements).first(std::min(most, elements.size()));
    const std::size_t found =
        several(me_.pops, [&] { return std::min(queue_.pop_bulk(thread_, room), room.size()); });
    for (std::size_t i = 0; i < found; ++i) {
      me_.popped_sum += elements[i];
      log(stress::Kind::pop, elements[i]);
    }
    run_.inside_ -= static_cast<std::int64_t>(found);
    return found;
  }
  bool pop_wait() {
    return popped(Tries::one, [this](std::uint64_t& e) { return queue_.pop_wait(thread_, e); });
  }
  void close() { queue_.close(); }
  bool put() { return pushed(fresh(), Tries::all_and_work); }
  bool put_back() { return running() && pushed(me_.last_popped, Tries::all_and_work); }
  bool take() { return popped(Tries::all_and_work); }
  void work() { run_.work(me_); }
  std::uint64_t random(std::uint64_t bound) { return me_.random.below(bound); }
  [[nodiscard]] bool produces() const { return run_.pushes(thread_); }
  bool consumers_caught_up() {
    for (;;) {
      if (run_.machine_.over()) return false;
      if (run_.inside_ < run_.backlog_) return true;
      run_.machine_.idle(held_back_ns);
    }
  }
  void rest() {
    const double pause = run_.point_.scenario->producer_pause_ns;
    if (pause > 0) run_.machine_.work(pause * vary(me_));
  }
  [[nodiscard]] bool leads() const { return thread_ == 0; }
  void finished_one() { ++run_.finished_; }
  [[nodiscard]] bool all_finished(std::uint64_t tasks) const { return run_.finished_ >= tasks; }
  bool meet() { return run_.barrier_.pass(run_.machine_, run_.point_.threads); }
  [[nodiscard]] contention::Burst burst() const {
    return {.size = static_cast<unsigned>(run_.burst_), .works_after_each = true};
  }

 private:
  enum class Tries : std::uint8_t { one, all, all_and_work };

  [[nodiscard]] std::uint64_t fresh() const {
    return std::uint64_t{thread_ + 1} << 40U | (me_.pushes.all + 1);
  }
  bool pushed(std::uint64_t element, Tries tries) {
    const bool done = made(me_.pushes, tries, stress::Kind::push, element,
                           [&] { return queue_.push(thread_, element); });
    if (done) me_.pushed_sum += element;
    run_.inside_ += done ? 1 : 0;
    return done;
  }
  bool popped(Tries tries) {
    return popped(tries, [this](std::uint64_t& e) { return queue_.pop(thread_, e); });
  }
  template <class Pop>
  bool popped(Tries tries, Pop pop) {
    std::uint64_t element = 0;
    const bool done =
        made(me_.pops, tries, stress::Kind::pop, element, [&] { return pop(element); });
    if (done) me_.popped_sum += me_.last_popped = element;
    run_.inside_ -= done ? 1 : 0;
    return done;
  }
  /// A call for several: all that it moves are operations, which took as long as it did.
  template <class Call>
  std::size_t several(Tally& tally, Call call) {
    std::size_t moved = 0;
    const auto counted = tally.counted;
    run_.attempt(thread_, tally, false, [&] {
      me_.began = run_.machine_.clock();
      return (moved = call()) != 0;
    });
    if (moved > 1) {
      tally.all += moved - 1;
      if (tally.counted != counted) tally.counted += moved - 1;
    }
    return moved;
  }
  template <class Operation>
  bool made(Tally& tally, Tries tries, stress::Kind kind, const std::uint64_t& element,
            Operation operation) {
    const bool done = run_.attempt(thread_, tally, tries != Tries::one, [&] {
      me_.began = run_.machine_.clock();
      return operation();
    });
    if (done) log(kind, element);
    if (done && tries == Tries::all_and_work) work();
    return done;
  }

  // With the clock at the end of what was made.
  void log(stress::Kind kind, std::uint64_t element) {
    me_.log.push_back({static_cast<stress::Stamp>(me_.began),
                       static_cast<stress::Stamp>(run_.machine_.clock()), element, kind});
  }

  Run& run_;
  unsigned thread_;
  Worker& me_;
  Queue& queue_;
};

void Run::act(unsigned thread) {
  if (primitive_ != nullptr) {
    Worker& me = workers_[thread];
    while (!machine_.over()) {
      const bool done = attempt(thread, me.pushes, true, [&] {
        primitive_->step(object_, thread);
        return true;
      });
      if (done) work(me);
    }
    return;
  }
  contention::play<Hand>(point_.scenario->program, *queues_.front(), queues_.back(), *this, thread);
  if (entry_->methods.leave)
    for (Queue* queue : queues_) queue->leave(thread);
}

nlohmann::json latency_of(const Tally& tally) {
  if (tally.counted == 0) return nullptr;
  return {{"counts", tally.latency.counts}, {"max", static_cast<double>(tally.longest) / 1e3}};
}

nlohmann::json Run::order() {
  if (queues_.size() != 1 || !entry_->claims.carries_elements) return nullptr;
  std::vector<std::vector<stress::Operation>> logs{std::move(prefill_)};
  for (Worker& worker : workers_) logs.push_back(std::move(worker.log));
  return results::order_of(std::move(logs), 0);
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
      {"order", order()},
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
