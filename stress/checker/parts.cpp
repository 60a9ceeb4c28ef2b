#include "stress/checker/parts.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <poll.h>
#include <sched.h>
#include <stdexcept>
#include <sys/mman.h>
#include <unistd.h>

#include "stress/checker/child.hpp"
#include "stress/checker/deadline.hpp"
#include "stress/checker/result_bytes.hpp"

namespace irt::checker {

namespace {

/// So many executions are made by one process before others are asked: most searches end sooner.
constexpr std::uint64_t alone_first = 4096;
constexpr double alone_seconds = 0.1;
/// A part that makes no execution for so long after its time is up is hung.
constexpr double patience = 20;

/// What the parts tell while they work, in memory that all share.
struct Told {
  std::atomic<std::uint64_t> made{0};
  std::atomic<std::uint64_t> steps{0};
  std::atomic<double> explored{0};
};
struct Shared {
  /// The execution that found something or, if earlier, the one that shows that equal threads are
  /// not, so that all begins anew.
  std::atomic<std::uint64_t> first_finding{~std::uint64_t{0}};
  Told parts[CPU_SETSIZE];
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
static_assert(std::atomic<double>::is_always_lock_free);

class SharedMemory {
 public:
  SharedMemory() {
    void* memory =
        mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED)
      throw std::runtime_error(std::string("cannot share memory with the parts of a search: ") +
                               std::strerror(errno));
    shared_ = new (memory) Shared;
  }
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;
  ~SharedMemory() { munmap(shared_, sizeof(Shared)); }
  Shared* operator->() const { return shared_; }

 private:
  Shared* shared_;
};

// --- The parts --------------------------------------------------------------------------------

/// What a child does: its part of the search. The first byte sent says whether a result or an
/// error follows.
std::string work(const Program& program, Options options, Shared& shared) {
  Told& told = shared.parts[options.shard];
  options.stops = [&, part = options.shard, parts = options.shards](std::uint64_t made) {
    told.made.store(made, std::memory_order_relaxed);
    return made * parts + part > shared.first_finding.load(std::memory_order_relaxed);
  };
  options.progress = [&](const SearchProgress& now) {
    told.steps.store(now.steps, std::memory_order_relaxed);
    told.explored.store(now.explored, std::memory_order_relaxed);
  };
  try {
    const Result result = check(program, options);
    if (result.finding || !result.uneven.empty()) {
      const std::uint64_t mine = told.made * options.shards + options.shard;
      std::uint64_t first = shared.first_finding;
      while (mine < first && !shared.first_finding.compare_exchange_weak(first, mine)) {
      }
    }
    return 'r' + to_bytes(result);
  } catch (const std::exception& error) {
    return std::string("e") + error.what();
  }
}

/// A child and what it has sent so far.
struct Part {
  Child child;
  std::string sent{};
  std::uint64_t made = 0;  ///< when it last went on ...
  double since = 0;        ///< ... and when that was
};

class Parts {
 public:
  Parts(const Program& program, const Options& options, unsigned count) : options_(options) {
    for (unsigned part = 0; part < count; ++part)
      parts_.push_back({.child = Child([&](int line) {
                          irt::say(line,
                                   work(program, options_of(part, count), *shared_.operator->()));
                        })});
  }

  Result results() {
    while (std::ranges::any_of(parts_, [](const Part& p) { return p.child.line() >= 0; })) {
      listen();
      tell();
    }
    return merged();
  }

 private:
  [[nodiscard]] Options options_of(unsigned part, unsigned count) const {
    Options options = options_;
    options.shard = part;
    options.shards = count;
    if (options.executions != ~std::uint64_t{0})
      options.executions = options_.executions / count + (part < options_.executions % count);
    return options;
  }

  /// Takes in what has come, and waits a little if that is nothing.
  void listen() {
    std::vector<pollfd> open;
    for (const Part& part : parts_) open.push_back({part.child.line(), POLLIN, 0});
    if (poll(open.data(), open.size(), 200) < 0 && errno != EINTR)
      throw std::runtime_error(std::string("cannot listen to the parts of a search: ") +
                               std::strerror(errno));
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      Part& part = parts_[i];
      if (part.child.line() < 0) continue;
      if (open[i].revents == 0) {
        watch(i);
        continue;
      }
      char buffer[1 << 16];
      const ssize_t count = read(part.child.line(), buffer, sizeof buffer);
      if (count > 0) part.sent.append(buffer, static_cast<std::size_t>(count));
      if (count == 0 || (count < 0 && errno != EINTR)) end(i);
    }
  }

  void end(std::size_t number) {
    Part& part = parts_[number];
    part.child.join(name(number));
    if (part.sent.empty()) throw std::runtime_error(name(number) + " ended without a result");
    if (part.sent.front() == 'e') throw std::runtime_error(part.sent.substr(1));
  }

  /// Executions always end by themselves, unless the checker does not see what they do.
  void watch(std::size_t number) {
    Part& part = parts_[number];
    const std::uint64_t made = shared_->parts[number].made.load(std::memory_order_relaxed);
    const double now = stopwatch_.seconds();
    if (made != part.made || now < options_.seconds) {
      part.made = made;
      part.since = now;
    } else if (now - part.since > patience) {
      throw std::runtime_error(name(number) + " hangs in its execution " +
                               std::to_string(made + 1) +
                               ": code that the checker does not see loops for ever");
    }
  }

  void tell() {
    if (!options_.progress || stopwatch_.seconds() < told_.seconds + 2) return;
    SearchProgress now{.seconds = stopwatch_.seconds()};
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Told& part = shared_->parts[i];
      now.executions += part.made;
      now.steps = std::max<std::size_t>(now.steps, part.steps);
      now.explored += part.explored / static_cast<double>(parts_.size());
    }
    now.per_second =
        static_cast<double>(now.executions - told_.executions) / (now.seconds - told_.seconds);
    told_ = now;
    options_.progress(now);
  }

  [[nodiscard]] Result merged() const {
    Result sum;
    sum.finished = true;
    std::uint64_t first = ~std::uint64_t{0};
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      Result part = from_bytes(parts_[i].sent.substr(1));
      const std::uint64_t found_at = shared_->parts[i].made * parts_.size() + i;
      if ((part.finding || !part.uneven.empty()) && found_at < first) {
        first = found_at;
        sum.finding = std::move(part.finding);
        sum.schedule = std::move(part.schedule);
        sum.uneven = std::move(part.uneven);
      }
      sum.exchanged.orders = std::max(sum.exchanged.orders, part.exchanged.orders);
      sum.exchanged.histories = std::max(sum.exchanged.histories, part.exchanged.histories);
      sum.exchanged.executions += part.exchanged.executions;
      for (const OrderSite& site : part.order_sites)
        if (std::ranges::none_of(sum.order_sites, [&site](const auto& s) {
              return s.pc == site.pc && s.failure == site.failure;
            }))
          sum.order_sites.push_back(site);
      for (const void* place : part.never_freed)
        if (std::ranges::find(sum.never_freed, place) == sum.never_freed.end())
          sum.never_freed.push_back(place);
      sum.histories.insert(sum.histories.end(), part.histories.begin(), part.histories.end());
      if (sum.incomplete.empty() && (!part.incomplete.empty() || sum.incomplete_at == nullptr)) {
        sum.incomplete = part.incomplete;
        sum.incomplete_at = part.incomplete_at;
      }
      add_counts(sum, part);
      sum.finished = sum.finished && part.finished;
      sum.explored += part.explored / static_cast<double>(parts_.size());
    }
    std::ranges::sort(sum.histories);
    sum.histories.erase(std::unique(sum.histories.begin(), sum.histories.end()),
                        sum.histories.end());
    sum.seconds = stopwatch_.seconds();
    return sum;
  }

  [[nodiscard]] std::string name(std::size_t number) const {
    return "part " + std::to_string(number) + " of " + std::to_string(parts_.size()) +
           " of the search";
  }

  const Options& options_;
  SharedMemory shared_{};
  std::vector<Part> parts_{};
  Stopwatch stopwatch_{};
  SearchProgress told_{};
};

}  // namespace

unsigned processors() {
  cpu_set_t mine;
  if (sched_getaffinity(0, sizeof mine, &mine) != 0) return 1;
  return static_cast<unsigned>(std::max(CPU_COUNT(&mine), 1));
}

Result check_in_parts(const Program& program, const Options& options, unsigned jobs) {
  jobs = std::min<unsigned>(jobs, CPU_SETSIZE);
  if (jobs <= 1 || options.shards > 1 || options.each || options.search == Search::bounded ||
      options.seconds <= alone_seconds)
    return check(program, options);
  Options little = options;
  little.executions = std::min(options.executions, alone_first);
  little.seconds = alone_seconds;
  Result result = check(program, little);
  if (result.finding || result.finished || result.executions >= options.executions) return result;
  double spent = result.seconds;
  std::string uneven = std::move(result.uneven);
  for (;;) {
    Options rest = options;
    rest.seconds -= spent;
    rest.symmetry = rest.symmetry && uneven.empty();
    result = Parts(program, rest, jobs).results();
    spent = result.seconds += spent;
    if (result.uneven.empty()) break;
    uneven = std::move(result.uneven);
  }
  result.uneven = std::move(uneven);
  confirm(program, options, result);
  return result;
}

}  // namespace irt::checker
