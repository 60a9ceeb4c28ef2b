#include "stress/checker/queue_check.hpp"

#include <fmt/format.h>
#include <fstream>
#include <iostream>

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

std::string report_of(QueueClient& client, const Options& options, const Result& result,
                      virtual_cores::Module& module, const std::string& command) {
  Symbols symbols(module);
  const Finding& finding = *result.finding;
  std::string text =
      fmt::format("{}: {}\n\n", checker::name_of(finding.kind), sentence(finding, symbols));
  const auto execution = repeat(client.scenario(), options, result.schedule);
  if (execution != nullptr) {
    text += columns(*execution, client.operations(), symbols);
    text += "\n" + history(client.operations());
  }
  text += fmt::format("\nreplay: {} --shape '{}' --replay \"{}\"\n", command,
                      to_string(client.shape()), to_string(result.schedule));
  return text;
}

void say(const ShapeResult& s) {
  const Result& r = s.result;
  std::string verdict = "nothing found";
  if (r.finding)
    verdict = std::string(checker::name_of(r.finding->kind));
  else if (r.finished && s.search == "exhaustive")
    verdict = "proved";
  else if (r.finished)
    verdict = "nothing within the bound";
  fmt::print("  {:<12} {:<11} {:>9} executions {:>8.3f} s  {:>5} histories  {}\n", s.shape,
             s.search, r.executions, r.seconds, s.histories, verdict);
  std::fflush(stdout);
}

}  // namespace

QueueResult check_queue(const QueueEntry& entry, virtual_cores::Module& module,
                        const CheckSettings& settings, const std::string& command) {
  QueueResult all;
  all.unseen = module.unseen_calls();
  const std::vector<std::string> shapes =
      settings.shapes.empty() ? battery(entry.claims) : settings.shapes;
  const auto run = [&](const std::string& text, Search search) {
    QueueClient client(entry, parse_shape(text), settings.capacity, &module);
    Options options = settings.options;
    options.search = search;
    options.seconds = settings.seconds;
    ShapeResult shape{text, std::string(name_of(search)), check(client.scenario(), options), 0, ""};
    shape.histories = client.histories();
    if (shape.result.finding) {
      Options plain = options;
      const Result simple = simplest(client.scenario(), plain, shape.result);
      shape.report = report_of(client, plain, simple, module, command);
      all.found = true;
    }
    if (!settings.quiet) say(shape);
    all.shapes.push_back(std::move(shape));
    return all.shapes.back().result.finished || all.found;
  };
  for (const std::string& shape : shapes) {
    if (settings.search) {
      run(shape, *settings.search);
    } else if (!run(shape, Search::exhaustive)) {
      for (const Search search : {Search::bounded, Search::pos, Search::pct})
        if (!all.found) run(shape, search);
    }
    if (all.found) return all;
  }
  const bool claims_progress =
      entry.claims.push != Progress::blocking || entry.claims.pop != Progress::blocking;
  if (settings.progress && claims_progress && !settings.search) {
    for (const std::string& text : shapes) {
      if (text.find('W') != std::string::npos) continue;  // waits for another by design
      QueueClient client(entry, parse_shape(text), settings.capacity, &module);
      const ProgressResult stalls =
          check_progress(client.scenario(), settings.options.limits, settings.options.seed, 6);
      ShapeResult shape{text, "stalls", {}, 0, ""};
      shape.result.executions = stalls.executions;
      shape.result.finding = stalls.finding;
      if (stalls.finding) {
        Symbols symbols(module);
        shape.report = fmt::format(
            "{}: {}\n\n{}\nThe queue claims that a stopped thread does not stop the others; thread "
            "{} was stopped before its step {}.\n",
            checker::name_of(stalls.finding->kind), sentence(*stalls.finding, symbols),
            history(client.operations()), stalls.thread, stalls.stopped + 1);
        all.found = true;
      }
      if (!settings.quiet) say(shape);
      all.shapes.push_back(std::move(shape));
      if (all.found) return all;
    }
  }
  return all;
}

std::string replay(const QueueEntry& entry, virtual_cores::Module& module,
                   const CheckSettings& settings, const std::string& shape,
                   const std::string& schedule, const std::string& dot_file) {
  QueueClient client(entry, parse_shape(shape), settings.capacity, &module);
  Result result;
  result.schedule = parse_schedule(schedule);
  const auto execution = repeat(client.scenario(), settings.options, result.schedule);
  if (execution == nullptr) return "";
  result.finding = execution->finding();
  Symbols symbols(module);
  if (!dot_file.empty()) std::ofstream(dot_file) << dot(*execution, symbols);
  return fmt::format("{}: {}\n\n", checker::name_of(result.finding->kind),
                     sentence(*result.finding, symbols)) +
         columns(*execution, client.operations(), symbols) + "\n" + history(client.operations());
}

}  // namespace irt::checker
