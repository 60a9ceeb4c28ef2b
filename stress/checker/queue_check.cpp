#include "stress/checker/queue_check.hpp"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <utility>

#include "stress/checker/batteries.hpp"
#include "stress/checker/parts.hpp"
#include "stress/checker/progress.hpp"
#include "stress/checker/report.hpp"

namespace irt::checker {

namespace {

std::string_view name_of(Search search) {
  switch (search) {
    case Search::exhaustive:
      return "exhaustive";
    case Search::bounded:
      return "bounded";
    case Search::random:
      return "random";
    case Search::pct:
      return "pct";
    case Search::pos:
      return "pos";
  }
  return "?";
}

/// What the exhaustive search is called when a clock orders the calls.
constexpr const char* timed_search = "real time";

/// Whether its search leaves nothing out when it comes to its end.
bool searched_whole(const ShapeResult& s) {
  return s.search == name_of(Search::exhaustive) || s.search == timed_search;
}

std::string report_of(QueueClient& client, const Options& options, const Result& result,
                      virtual_cores::Module& module, const std::string& command) {
  Symbols symbols(module);
  const Finding& finding = *result.finding;
  std::string text =
      fmt::format("{}: {}\n\n", checker::name_of(finding.kind), sentence(finding, symbols));
  const auto execution = repeat(client.scenario(), options, result.schedule);
  if (execution != nullptr) {
    text += picture(*execution, client.operations(), symbols);
  }
  text += fmt::format("\nreplay: {} --shape '{}' --replay \"{}\"\n", command,
                      to_string(client.shape()), to_string(result.schedule));
  return text;
}

/// "3.1e+04 in all?": what an estimate is worth.
std::string estimate(std::uint64_t executions, double explored) {
  if (explored <= 0) return "";
  return fmt::format("  about {:.0g} in all", static_cast<double>(executions) / explored);
}

void say(std::string_view shape, std::string_view search, const SearchProgress& now) {
  fmt::print(stderr, "  {:<12} {:<11} {:>9} executions {:>8.1f} s  {:.0f}/s, {} steps{}\n", shape,
             search, now.executions, now.seconds, now.per_second, now.steps,
             estimate(now.executions, now.explored));
}

void say(const ShapeResult& s) {
  const Result& r = s.result;
  std::string verdict = "nothing found" + estimate(r.executions, r.explored);
  if (r.finding)
    verdict = std::string(checker::name_of(r.finding->kind));
  else if (r.finished && searched_whole(s))
    verdict = s.proved ? "proved" : "explored whole, not proved: " + s.unproved;
  else if (r.finished)
    verdict = "nothing within the bound";
  else if (!r.incomplete.empty())
    verdict = "not proved: " + r.incomplete;
  fmt::print("  {:<12} {:<11} {:>9} executions {:>8.3f} s  {:>5} histories  {}\n", s.shape,
             s.search, r.executions, r.seconds, s.histories, verdict);
  std::fflush(stdout);
}

/// The checks of one queue, one after the other, until something is found or time is up.
class QueueCheck {
 public:
  QueueCheck(const QueueEntry& entry, virtual_cores::Module& module, const CheckSettings& settings,
             const std::string& command)
      : entry_(entry),
        module_(module),
        settings_(settings),
        command_(command),
        shapes_(settings.shapes.empty() ? battery(entry.claims) : settings.shapes),
        clocked_(settings.real_time.value_or(false)) {}

  QueueResult run() {
    all_.unseen = module_.unseen_calls();
    if (settings_.reports) all_.unseen_instructions = Symbols(module_).unseen_instructions();
    if (!all_.unseen.empty())
      all_.unproved = "it calls compiled code";
    else if (!all_.unseen_instructions.empty())
      all_.unproved = "not all that it does to memory is seen";
    // Proofs first, of all shapes; then samples of those that were too large for one. Who finishes
    // early leaves the time to the rest.
    const auto open = search_all(shapes_, settings_.search.value_or(Search::exhaustive),
                                 settings_.search ? 1.0 : 0.5);
    if (!settings_.search) {
      double until = 0.5;
      for (const Search search : {Search::pos, Search::bounded, Search::pct})
        search_all(open, search, until += 0.15);
      for (const std::string& shape : shapes_to_stall())
        if (!all_.found) stall(shape);
      if (!settings_.real_time && entry_.claims.ordering == Ordering::fifo_real_time) {
        clocked_ = true;
        search_all(shapes_, Search::exhaustive, 1.0);
      }
    }
    return std::move(all_);
  }

 private:
  /// Where a stopped thread must not stop the others. If only pushes claim that, a pop may wait.
  [[nodiscard]] std::vector<std::string> shapes_to_stall() const {
    if (!settings_.progress || entry_.claims.push == irt::Progress::blocking) return {};
    if (entry_.claims.pop == irt::Progress::blocking)
      return entry_.claims.producers == Callers::one ? std::vector<std::string>{}
                                                     : std::vector<std::string>{"EE|EE"};
    std::vector<std::string> result;
    for (const std::string& shape : shapes_)
      if (shape.find_first_of("WFT") == std::string::npos) result.push_back(shape);
    return result;
  }

  /// Searches each of `shapes` until the part `until` of the time is used up, and returns those
  /// whose search did not come to its end.
  std::vector<std::string> search_all(const std::vector<std::string>& shapes, Search kind,
                                      double until) {
    std::vector<std::string> open;
    if (kind == Search::pos || kind == Search::pct || kind == Search::random) {
      if (!all_.found && !shapes.empty()) sample(shapes, kind, until);
      return open;
    }
    for (std::size_t i = 0; i < shapes.size() && !all_.found; ++i) {
      const double left = until * settings_.seconds - elapsed();
      ShapeResult shape{.shape = shapes[i], .search = label(kind)};
      search(shape, kind, left / static_cast<double>(shapes.size() - i), settings_.options.seed);
      if (!shape.result.finished) open.push_back(shapes[i]);
      add(std::move(shape));
    }
    return open;
  }

  /// Samples of all shapes in turn, in rounds that take longer and longer, so that none waits for
  /// the others.
  void sample(const std::vector<std::string>& shapes, Search kind, double until) {
    std::vector<ShapeResult> results;
    results.reserve(shapes.size());
    for (const std::string& shape : shapes)
      results.push_back({.shape = shape, .search = label(kind)});
    constexpr std::uint64_t next_seed = 1'000'003;  // a round begins where no other one does
    std::uint64_t seed = settings_.options.seed;
    const auto found = [](const ShapeResult& s) { return s.result.finding.has_value(); };
    const auto any = [&] { return std::any_of(results.begin(), results.end(), found); };
    double slice = 0.01;
    do {
      for (std::size_t i = 0; i < results.size() && !any(); ++i) {
        const double left = until * settings_.seconds - elapsed();
        search(results[i], kind, std::min(slice, left / static_cast<double>(results.size() - i)),
               seed);
      }
      slice *= 2;
      seed += next_seed;
    } while (!any() && elapsed() < until * settings_.seconds);
    for (ShapeResult& shape : results) add(std::move(shape));
  }

  [[nodiscard]] std::string label(Search kind) const {
    return clocked_ && kind == Search::exhaustive ? timed_search : std::string(name_of(kind));
  }

  /// One search, whose work is added to what `shape` holds already.
  void search(ShapeResult& shape, Search kind, double seconds, std::uint64_t seed) {
    QueueClient client(entry_, parse_shape(shape.shape), settings_.capacity, &module_, clocked_);
    Options options = settings_.options;
    options.search = kind;
    options.seed = seed;
    options.seconds = std::max(seconds, 0.01);
    if (!entry_.claims.survives_no_memory) options.limits.failing_allocations = 0;
    if (!settings_.quiet)
      options.progress = [&](const SearchProgress& now) { say(shape.shape, shape.search, now); };
    const Result before =
        std::exchange(shape.result, check_in_parts(client.scenario(), options, settings_.jobs));
    shape.result.executions += before.executions;
    shape.result.complete += before.complete;
    shape.result.blocked += before.blocked;
    shape.result.cut += before.cut;
    if (shape.result.incomplete.empty()) shape.result.incomplete = before.incomplete;
    shape.result.seconds += before.seconds;
    shape.histories = std::max(shape.histories, shape.result.histories.size());
    if (!shape.result.finding || !settings_.reports) return;
    const Result simple = simplest(client.scenario(), options, shape.result);
    shape.report =
        report_of(client, options, simple, module_, command_ + (clocked_ ? " --real-time" : ""));
  }

  void stall(const std::string& text) {
    QueueClient client(entry_, parse_shape(text), settings_.capacity, &module_);
    ShapeResult shape{text, "stalls", {}, 0, ""};
    const ProgressResult stalls = check_progress(
        client.scenario(), settings_.options.limits, settings_.options.seed, 6,
        [&](const Execution& execution) {
          if (!settings_.reports) return;
          Symbols symbols(module_);
          shape.report =
              fmt::format("{}: {}\n\n{}", checker::name_of(FindingKind::blocked_by_stalled_thread),
                          sentence(*execution.finding(), symbols),
                          picture(execution, client.operations(), symbols));
        });
    shape.result.executions = stalls.executions;
    shape.result.finding = stalls.finding;
    if (!shape.report.empty())
      shape.report += fmt::format(
          "\nThe queue claims that a stopped thread does not stop the others; thread {} was "
          "stopped "
          "before its step {}.\n",
          stalls.thread, stalls.stopped + 1);
    add(std::move(shape));
  }

  void add(ShapeResult shape) {
    shape.unproved = all_.unproved;
    shape.proved = shape.result.finished && !shape.result.finding && searched_whole(shape) &&
                   shape.unproved.empty();
    if (!settings_.quiet) say(shape);
    all_.found = all_.found || shape.result.finding;
    all_.shapes.push_back(std::move(shape));
  }

  [[nodiscard]] double elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

  const QueueEntry& entry_;
  virtual_cores::Module& module_;
  const CheckSettings& settings_;
  const std::string& command_;
  std::vector<std::string> shapes_;
  bool clocked_;  ///< calls are ordered by a clock
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  QueueResult all_;
};

}  // namespace

QueueResult check_queue(const QueueEntry& entry, virtual_cores::Module& module,
                        const CheckSettings& settings, const std::string& command) {
  return QueueCheck(entry, module, settings, command).run();
}

std::string replay(const QueueEntry& entry, virtual_cores::Module& module,
                   const CheckSettings& settings, const std::string& shape,
                   const std::string& schedule, const std::string& dot_file) {
  QueueClient client(entry, parse_shape(shape), settings.capacity, &module,
                     settings.real_time.value_or(false));
  Result result;
  result.schedule = parse_schedule(schedule);
  const auto execution = repeat(client.scenario(), settings.options, result.schedule);
  if (execution == nullptr) return "";
  result.finding = execution->finding();
  Symbols symbols(module);
  if (!dot_file.empty()) std::ofstream(dot_file) << dot(*execution, symbols);
  return fmt::format("{}: {}\n\n", checker::name_of(result.finding->kind),
                     sentence(*result.finding, symbols)) +
         picture(*execution, client.operations(), symbols);
}

}  // namespace irt::checker
