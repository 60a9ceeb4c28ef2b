#include "stress/checker/program_command.hpp"

#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "stress/running/usage_error.hpp"

namespace irt::checker {

namespace {

using nlohmann::json;

json to_json(const ProgramSettings& settings, const ProgramResult& result,
             const std::string& verdict) {
  json j{{"program", settings.name},
         {"arguments", settings.arguments},
         {"verdict", verdict},
         {"found", result.found},
         {"proved", result.proved},
         {"threads", result.threads},
         {"seed", settings.options.seed},
         {"unseen", result.unseen.calls},
         {"unseen_instructions", result.unseen.instructions},
         {"never_freed", result.never_freed},
         {"searches", json::array()}};
  for (const SearchResult& s : result.searches) {
    const Result& r = s.result;
    json search{{"search", s.search},   {"executions", r.executions}, {"complete", r.complete},
                {"blocked", r.blocked}, {"inconsistent", r.cut},      {"seconds", r.seconds},
                {"finished", r.finished}, {"incomplete", r.incomplete}};
    if (r.finding) {
      search["finding"] = {{"kind", name_of(r.finding->kind)}, {"report", s.report}};
      search["schedule"] = to_string(r.schedule);
    }
    j["searches"].push_back(std::move(search));
  }
  return j;
}

}  // namespace

int run_program_command(const ProgramCommand& command) {
  const ProgramSettings& settings = command.settings;
  virtual_cores::Module module(command.module);
  if (!command.replay.empty()) {
    const std::string report = replay(module, settings, command.replay, command.dot_file);
    std::cout << (report.empty() ? std::string(stale_schedule) : report);
    return report.empty() ? 0 : 1;
  }
  const ProgramResult result = check_program(module, settings, [&](const std::string& schedule) {
    return fmt::format("{} --replay \"{}\"", command.command, schedule);
  });
  if (!result.unseen.refused.empty())
    throw UsageError(
        fmt::format("{} cannot be checked: {}", settings.name, result.unseen.refused));
  for (const SearchResult& search : result.searches)
    if (!search.report.empty()) std::cout << '\n' << search.report;
  if (!settings.conduct.quiet) std::cout << words(result.unseen);
  const std::string verdict = checker::verdict(settings, result);
  if (!settings.conduct.quiet) std::cout << '\n' << verdict << '\n';
  if (!command.json_file.empty())
    std::ofstream(command.json_file) << to_json(settings, result, verdict).dump(2) << '\n';
  return result.found ? 1 : 0;
}

}  // namespace irt::checker
