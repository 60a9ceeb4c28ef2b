#include "stress/checker/queue_check.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "stress/checker/all_clients.hpp"
#include "stress/checker/batteries.hpp"
#include "stress/checker/deadline.hpp"
#include "stress/checker/generated_shapes.hpp"
#include "stress/checker/parking.hpp"
#include "stress/checker/result_bytes.hpp"
#include "stress/checker/shape_search.hpp"
#include "stress/checker/unseen.hpp"
#include "stress/checker/verdict.hpp"
#include "stress/checker/worker_pool.hpp"

namespace irt::checker {

namespace {

/// Parts of the time by which each kind of search is to be done. Who finishes early leaves the rest
/// to those that follow; what is left at last belongs to generated shapes.
namespace until {
constexpr double first_look = 0.03;  // for each shape
constexpr double elements = 0.2;
constexpr double proofs = 0.6;
constexpr double pos = 0.66;
constexpr double bounded = 0.7;
constexpr double pct = 0.75;
constexpr double no_memory = 0.82;
constexpr double stalls = 0.86;
constexpr double aged = 0.9;
constexpr double real_time = 0.95;
constexpr double all = 1;
}  // namespace until

/// Who waits for an element that there was no memory for would wait for ever.
bool waits(const std::string& shape) {
  return shape.find('P') != std::string::npos;
}

/// Where a stopped thread must not stop the others. If only pushes claim that, a pop may wait.
std::vector<std::string> shapes_to_stall(const std::vector<std::string>& shapes,
                                         const Claims& claims) {
  if (claims.push == Progress::blocking) return {};
  if (claims.pop == Progress::blocking)
    return claims.one_producer() ? std::vector<std::string>{} : std::vector<std::string>{"EE|EE"};
  std::vector<std::string> result;
  for (const std::string& shape : shapes)
    if (shape.find_first_of("WFTXPLC") == std::string::npos) result.push_back(shape);
  return result;
}

/// What one shape came to, as bytes; empty if there is a finding.
std::string to_bytes(const std::vector<ShapeResult>& results) {
  Writer writer;
  for (const ShapeResult& shape : results) {
    if (shape.result.finding) return "";
    writer.put_all(shape.search);
    writer.put(shape.histories);
    writer.put_all(checker::to_bytes(shape.result));
  }
  return std::move(writer.bytes);
}

std::vector<ShapeResult> from_bytes(const std::string& bytes, const std::string& shape,
                                    Origin origin) {
  std::vector<ShapeResult> results;
  for (Reader reader{bytes}; reader.at < bytes.size();) {
    ShapeResult& result = results.emplace_back(ShapeResult{.shape = shape, .origin = origin});
    result.search = reader.take_all<std::string>();
    result.histories = reader.take<std::size_t>();
    result.result = checker::from_bytes(reader.take_all<std::string>());
  }
  return results;
}

/// The checks of one queue, one after the other, until something is found or time is up.
class QueueCheck {
 public:
  QueueCheck(const QueueEntry& entry, virtual_cores::Module& module, const CheckSettings& settings,
             const std::string& command)
      : entry_(entry),
        module_(module),
        settings_(as_seen(settings, module)),
        shapes_(settings.shapes.empty() ? battery(entry.claims, entry.methods) : settings.shapes),
        command_(command),
        searches_(entry, module, settings_, command_),
        clocked_(settings.real_time.value_or(false)) {
    std::erase_if(shapes_, [&](const std::string& shape) {
      return may_starve(parse_shape(shape), entry_.claims, settings_.capacity);
    });
  }

  QueueResult run() {
    all_.unseen = unseen_of(module_);
    if (!settings_.reports) {
      all_.unseen.instructions.clear();
      all_.unseen.refused.clear();
      if (all_.unseen.calls.empty()) all_.unseen.unproved.clear();
    }
    if (!all_.unseen.refused.empty()) return std::move(all_);
    if (!settings_.quiet && pop_waits(entry_, module_))
      fmt::print(
          "the pop of an empty queue does not return: the contract has pop_wait, with close(), for "
          "a pop that waits (queues/work_queue.hpp)\n");
    if (settings_.all_clients != 0)
      search_clients();
    else if (settings_.search)
      search_all(shapes_, *settings_.search, until::all);
    else
      search_by_default();
    return std::move(all_);
  }

 private:
  // Proofs first, of all shapes; then samples of those that were too large for one.
  void search_by_default() {
    // Each gets a little first, so that one that is too large does not take from those that are
    // not.
    most_seconds_ = until::first_look * settings_.seconds;
    auto open = search_all(shapes_, Search::exhaustive, until::proofs);
    most_seconds_ = 1e9;
    const bool chosen = !settings_.shapes.empty();
    if (!chosen) search_elements();
    const auto large = search_all(deferred_, Search::exhaustive, until::proofs);
    open.insert(open.end(), large.begin(), large.end());
    search_all(open, Search::pos, until::pos);
    search_all(open, Search::bounded, until::bounded);
    search_all(open, Search::pct, until::pct);
    search_without_memory();
    stop_threads();
    if (!chosen) search_aged();
    if (!settings_.real_time && entry_.claims.ordering == Ordering::fifo_real_time) {
      clocked_ = true;
      search_all(shapes_, Search::exhaustive, until::real_time);
      clocked_ = false;
    }
    if (!chosen) search_generated();
  }

  [[nodiscard]] bool done() const { return all_.found && !settings_.keep_going; }
  /// Queues that are to be aged by 2^32 pairs need the most of the time for that.
  [[nodiscard]] double left(double part) const {
    if (settings_.old && part < until::aged) part *= 0.2;
    return part * settings_.seconds - stopwatch_.seconds();
  }
  /// Of what is left by then, for one of so many searches.
  [[nodiscard]] double share(double part, std::size_t searches) const {
    return left(part) / static_cast<double>(searches);
  }

  /// Searches each of `shapes` until the part `part` of the time is used up, and returns those
  /// whose search did not come to its end.
  std::vector<std::string> search_all(const std::vector<std::string>& shapes, Search kind,
                                      double part) {
    std::vector<std::string> open;
    if (kind == Search::pos || kind == Search::pct || kind == Search::random) {
      if (!done() && !shapes.empty()) sample(shapes, kind, part);
      return open;
    }
    for (std::size_t i = 0; i < shapes.size() && !done(); ++i) {
      ShapeResult shape{.shape = shapes[i], .search = label(kind)};
      const double seconds = share(part, shapes.size() - i);
      if (left(until::all) > 0) search(shape, kind, {.seconds = std::min(seconds, most_seconds_)});
      if (shape.result.allocates) allocating_.insert(shapes[i]);
      if (most_seconds_ < seconds && !shape.result.finished && !shape.result.finding &&
          shape.result.incomplete.empty()) {
        deferred_.push_back(shapes[i]);
        continue;
      }
      if (!shape.result.finished) open.push_back(shapes[i]);
      add(std::move(shape));
    }
    return open;
  }

  /// Samples of all shapes in turn, in rounds that take longer and longer, so that none waits for
  /// the others.
  void sample(const std::vector<std::string>& shapes, Search kind, double part) {
    std::vector<ShapeResult> results;
    results.reserve(shapes.size());
    for (const std::string& shape : shapes)
      results.push_back({.shape = shape, .search = label(kind)});
    constexpr std::uint64_t next_seed = 1'000'003;  // a round begins where no other one does
    std::uint64_t seed = settings_.options.seed;
    const auto found = [](const ShapeResult& s) { return s.result.finding.has_value(); };
    const auto any = [&] { return std::ranges::any_of(results, found); };
    double slice = 0.01;
    do {
      for (std::size_t i = 0; i < results.size() && !any(); ++i)
        search(results[i], kind,
               {.seconds = std::min(slice, share(part, results.size() - i)), .seed = seed});
      slice *= 2;
      seed += next_seed;
    } while (!any() && left(part) > 0);
    add(std::move(results));
  }

  /// One allocation of the threads fails, where they allocate; then the queue is used once more.
  void search_without_memory() {
    const bool promised = entry_.claims.survives_no_memory && settings_.no_memory;
    if (!promised || settings_.options.limits.failing_allocations != 0) return;
    std::vector<std::string> shapes;
    for (const std::string& shape : shapes_)
      if (allocating_.contains(shape) && !waits(shape)) shapes.push_back(shape);
    for (std::size_t i = 0; i < shapes.size() && !done(); ++i) {
      Shape used_again = parse_shape(shapes[i]);
      if (settings_.shapes.empty() && used_again.epilogue.empty()) used_again.epilogue = "E";
      ShapeResult shape{.shape = to_string(used_again), .search = poor_search};
      search(shape, Search::exhaustive,
             {.seconds = share(until::no_memory, shapes.size() - i), .failing_allocations = 1});
      add(std::move(shape));
    }
  }

  /// How far a small search goes: a number, so that what is found does not depend on the machine.
  struct Small {
    Origin origin = Origin::battery;
    std::uint64_t whole = 0;    ///< executions of the whole search, at most
    std::uint64_t samples = 0;  ///< and of the one after it, if that was not enough
    unsigned failing_allocations = 0;
  };

  /// The search of one shape, and its samples if there are any.
  std::vector<ShapeResult> search_small(ShapeSearch& searches, const std::string& text,
                                        const Small& small, double seconds) {
    const auto found = [this](ShapeResult shape) { add(std::move(shape)); };
    std::vector<ShapeResult> results{
        {.shape = text, .search = label(Search::exhaustive), .origin = small.origin}};
    searches.search(results[0], Search::exhaustive,
                    {.seconds = seconds,
                     .executions = small.whole,
                     .clocked = clocked_,
                     .failing_allocations = small.failing_allocations},
                    found);
    const Result& whole = results[0].result;
    if (whole.finished || whole.finding || !whole.incomplete.empty() || small.samples == 0 ||
        done())
      return results;
    ShapeResult sampled{.shape = text, .search = label(Search::pos), .origin = small.origin};
    searches.search(sampled, Search::pos,
                    {.seconds = std::min(seconds, left(until::all)),
                     .executions = small.samples,
                     .clocked = clocked_,
                     .failing_allocations = small.failing_allocations},
                    found);
    results.push_back(std::move(sampled));
    return results;
  }

  using ShapeAt = std::function<std::string(std::uint64_t)>;
  using SecondsFor = std::function<double(std::uint64_t)>;

  /// Small searches of shapes 0 to `count`, while there is time; returns of how many.
  std::uint64_t search_many(std::uint64_t count, const Small& small, const ShapeAt& shape_at,
                            const SecondsFor& seconds_for) {
    std::unique_ptr<WorkerPool> pool;
    if (settings_.jobs > 1 && settings_.options.shards == 1)
      pool = workers(count, small, shape_at, seconds_for);
    for (std::uint64_t i = 0; i < count && !done(); ++i) {
      std::vector<ShapeResult> results;
      if (pool != nullptr) {
        const std::optional<std::string> told = pool->next();
        if (!told) return i;
        results = from_bytes(*told, shape_at(i), small.origin);
      } else if (left(until::all) <= 0) {
        return i;
      }
      // What a worker finds is found again here, where what is known and reported already is.
      if (results.empty())
        results = search_small(searches_, shape_at(i), small,
                               std::max(seconds_for(i), pool == nullptr ? 0.0 : 2.0));
      add(std::move(results));
    }
    return count;
  }

  std::unique_ptr<WorkerPool> workers(std::uint64_t count, const Small& small,
                                      const ShapeAt& shape_at, const SecondsFor& seconds_for) {
    CheckSettings own = settings_;
    own.jobs = 1;
    own.quiet = true;
    own.reports = own.keep_going = false;
    return std::make_unique<WorkerPool>(
        settings_.jobs, settings_.seconds + 120,
        [&, own, searches = std::shared_ptr<ShapeSearch>()](
            std::uint64_t i) mutable -> std::optional<std::string> {
          if (i >= count || left(until::all) <= 0) return std::nullopt;
          if (searches == nullptr)
            searches = std::make_shared<ShapeSearch>(entry_, module_, own, no_command_);
          return to_bytes(search_small(*searches, shape_at(i), small, seconds_for(i)));
        });
  }

  void stop_threads() {
    if (!settings_.progress) return;
    const std::vector<std::string> shapes = shapes_to_stall(shapes_, entry_.claims);
    for (std::size_t i = 0; i < shapes.size() && !done(); ++i)
      add(searches_.stall(shapes[i], share(until::stalls, shapes.size() - i)));
  }

  // The first shapes of the battery, with elements that the queue claims to take besides words.
  void search_elements() {
    constexpr std::size_t most_calls = 4;
    std::vector<std::string> shapes;
    for (const std::string& shape : shapes_)
      if (calls_of(parse_shape(shape)) <= most_calls &&
          obstacle({.pop_wait = true}, parse_shape(shape)).empty())
        shapes.push_back(shape);
    for (const ElementKind& kind : element_kinds(entry_)) {
      if (kind.make_queue == nullptr) continue;
      const QueueEntry entry = through_elements(entry_, kind);
      const std::string command = command_ + " --element " + std::string(kind.name);
      ShapeSearch searches(entry, module_, settings_, command);
      // A copy that throws is one that finds no memory.
      const unsigned most_failing = kind.name == "copied" && settings_.no_memory ? 1 : 0;
      for (unsigned failing = 0; failing <= most_failing; ++failing)
        for (std::size_t i = 0; i < shapes.size() && !done(); ++i) {
          if (failing != 0 && waits(shapes[i])) continue;
          const Small small{.origin = Origin::elements,
                            .whole = 2'000,
                            .samples = 200,
                            .failing_allocations = failing};
          add(search_small(searches, shapes[i], small, share(until::elements, shapes.size() - i)));
        }
    }
    say_sum(Origin::elements);
  }

  void search_aged() {
    const std::vector<std::string> shapes = aged_battery(entry_.claims, settings_.old);
    for (std::size_t i = 0; i < shapes.size() && !done(); ++i) {
      const Small small{.origin = Origin::aged, .whole = 1'000, .samples = 200};
      add(search_small(searches_, shapes[i], small, share(until::aged, shapes.size() - i)));
    }
    say_sum(Origin::aged);
  }

  void search_generated() {
    if (!entry_.claims.allows_workers(2)) return;
    GeneratedShapes shapes(entry_.claims, entry_.methods, settings_.options.seed);
    std::vector<std::string> drawn;
    search_many(
        settings_.generated, {.origin = Origin::generated, .whole = 2'000, .samples = 500},
        [&](std::uint64_t i) {
          while (drawn.size() <= i) drawn.push_back(to_string(shapes.next()));
          return drawn[i];
        },
        [this](std::uint64_t) { return std::min(left(until::all), 2.0); });
    say_sum(Origin::generated);
  }

  void search_clients() {
    all_.all_clients = settings_.all_clients;
    const std::vector<std::string> clients = all_clients(entry_.claims, settings_.all_clients);
    // The large ones come last and need most.
    const std::uint64_t tried = search_many(
        clients.size(), {.origin = Origin::clients, .whole = ~std::uint64_t{0}},
        [&](std::uint64_t i) { return clients[i]; },
        [&](std::uint64_t i) {
          return 4 * settings_.jobs * left(until::all) /
                 static_cast<double>(clients.size() - i + 3);
        });
    if (!done()) all_.not_tried = clients.size() - tried;
    say_sum(Origin::clients);
  }

  [[nodiscard]] std::string label(Search kind) const {
    return clocked_ && kind == Search::exhaustive ? timed_search : std::string(name_of(kind));
  }

  void add(ShapeResult shape) { checker::add(all_, std::move(shape), settings_.quiet); }
  void add(std::vector<ShapeResult> shapes) {
    for (ShapeResult& shape : shapes) add(std::move(shape));
  }
  void say_sum(Origin origin) const {
    if (!settings_.quiet) say(origin, all_);
  }

  void search(ShapeResult& shape, Search kind, SearchBounds bounds) {
    if (shape.search.empty()) shape.search = label(kind);
    bounds.clocked = clocked_;
    searches_.search(shape, kind, bounds, [this](ShapeResult found) { add(std::move(found)); });
  }

  const QueueEntry& entry_;
  virtual_cores::Module& module_;
  const CheckSettings settings_;
  std::vector<std::string> shapes_;
  std::set<std::string> allocating_;   ///< shapes whose threads allocate
  double most_seconds_ = 1e9;          ///< of one search in search_all; who needs more ...
  std::vector<std::string> deferred_;  ///< ... comes again
  const std::string no_command_{};
  const std::string command_;
  ShapeSearch searches_;
  bool clocked_;  ///< calls are ordered by a clock
  Stopwatch stopwatch_;
  QueueResult all_;
};

}  // namespace

CheckSettings as_seen(CheckSettings settings, virtual_cores::Module& module) {
  settings.options.limits = as_seen(settings.options.limits, module);
  return settings;
}

QueueResult check_queue(const QueueEntry& entry, virtual_cores::Module& module,
                        const CheckSettings& settings, const std::string& command) {
  return QueueCheck(entry, module, settings, command).run();
}

}  // namespace irt::checker
