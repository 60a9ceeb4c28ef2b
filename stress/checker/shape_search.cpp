#include "stress/checker/shape_search.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>

#include "stress/checker/deadline.hpp"
#include "stress/checker/progress.hpp"
#include "stress/checker/queue_client.hpp"
#include "stress/checker/report.hpp"
#include "stress/checker/verdict.hpp"

namespace irt::checker {

namespace {

std::string report_of(QueueClient& client, const Options& options, const Result& result,
                      virtual_cores::Module& module, const std::string& command) {
  const std::string hardware = words(on_x86(client.program(), options, *result.finding));
  Symbols symbols(module);
  std::string text = heading(*result.finding, symbols);
  const auto execution = repeat(client.program(), options, result.schedule);
  if (execution != nullptr) {
    for (const auto& [thread, place] : execution->allocations().failed_at())
      text += fmt::format("There was no memory for what thread {} allocates at {}.\n\n", thread,
                          symbols.name(place));
    text += picture(*execution, client.operations(), symbols);
  }
  text += "\n" + hardware;
  text += fmt::format("\nreplay: {} --shape '{}' --replay \"{}\"\n", command,
                      to_string(client.shape()), to_string(result.schedule));
  return text;
}

}  // namespace

void ShapeSearch::search(ShapeResult& shape, Search kind, const SearchBounds& bounds,
                         const std::function<void(ShapeResult)>& found) {
  QueueClient client(entry_, parse_shape(shape.shape), settings_.capacity, &module_, bounds.clocked,
                     aged_);
  Options options = settings_.options;
  options.search = kind;
  if (bounds.seed != 0) options.seed = bounds.seed;
  options.executions = std::min(options.executions, bounds.executions);
  options.limits.failing_allocations =
      std::max(options.limits.failing_allocations, bounds.failing_allocations);
  if (!entry_.claims.survives_no_memory) options.limits.failing_allocations = 0;
  if (!settings_.quiet)
    options.progress = [&](const SearchProgress& now) { say(shape.shape, shape.search, now); };
  std::string command = command_;
  if (bounds.clocked) command += " --real-time";
  if (options.limits.failing_allocations != settings_.options.limits.failing_allocations)
    command += fmt::format(" --failing-allocations {}", options.limits.failing_allocations);
  shape.report = search_.search(
      client.program(), options, bounds.seconds, shape.result,
      [&](const Options& used, const Result& result) {
        return report_of(client, used, result, module_, command);
      },
      [&](const std::string& report) {
        shape.report = report;
        found(shape);
      });
  shape.histories = std::max(shape.histories, shape.result.histories.size());
}

ShapeResult ShapeSearch::stall(const std::string& text, double seconds) {
  const Stopwatch stopwatch;
  QueueClient client(entry_, parse_shape(text), settings_.capacity, &module_);
  ShapeResult shape{.shape = text, .search = stalls_search};
  const ProgressResult stalls = check_progress(
      client.program(), settings_.options.limits, settings_.options.seed, 6, seconds,
      [&](const Execution& execution) {
        if (!settings_.reports) return;
        Symbols symbols(module_);
        Finding finding = *execution.finding();
        finding.kind = FindingKind::blocked_by_stalled_thread;
        shape.report = heading(finding, symbols) + picture(execution, client.operations(), symbols);
      });
  shape.result.executions = stalls.executions;
  shape.result.seconds = stopwatch.seconds();
  shape.result.finished = stalls.finished;
  shape.result.incomplete = stalls.incomplete;
  shape.result.incomplete_at = stalls.incomplete_at;
  search_.place(shape.result);
  shape.result.finding = stalls.finding;
  if (stalls.finding && !search_.is_new(*stalls.finding) && settings_.keep_going) {
    shape.result.finding.reset();
    shape.report.clear();
  }
  if (!shape.report.empty())
    shape.report += fmt::format(
        "\nThe queue claims that a stopped thread does not stop the others; thread {} was stopped "
        "before its step {}.\n",
        stalls.thread, stalls.stopped + 1);
  return shape;
}

std::string replay(const QueueEntry& entry, virtual_cores::Module& module,
                   const CheckSettings& settings, const std::string& shape,
                   const std::string& schedule, const std::string& dot_file) {
  QueueClient client(entry, parse_shape(shape), settings.capacity, &module,
                     settings.real_time.value_or(false));
  Result result;
  result.schedule = parse_schedule(schedule);
  const auto execution =
      repeat(client.program(), as_seen(settings, module).options, result.schedule);
  if (execution == nullptr) return "";
  Symbols symbols(module);
  if (!dot_file.empty()) std::ofstream(dot_file) << dot(*execution, symbols);
  return heading(*execution->finding(), symbols) +
         picture(*execution, client.operations(), symbols);
}

}  // namespace irt::checker
