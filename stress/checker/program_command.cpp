#include "stress/checker/program_command.hpp"

#include <algorithm>
#include <filesystem>
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
    json search{{"search", s.search},     {"executions", r.executions}, {"complete", r.complete},
                {"blocked", r.blocked},   {"inconsistent", r.cut},      {"seconds", r.seconds},
                {"finished", r.finished}, {"incomplete", r.incomplete}};
    if (r.finding) {
      search["finding"] = {{"kind", name_of(r.finding->kind)}, {"report", s.report}};
      search["schedule"] = to_string(r.schedule);
    }
    j["searches"].push_back(std::move(search));
  }
  return j;
}

/// As who reads the results knows it: from the directory that the tool was called in.
std::string path_from_here(const std::string& file) {
  const std::filesystem::path path = std::filesystem::weakly_canonical(file);
  const std::string relative = path.lexically_relative(std::filesystem::current_path());
  return relative.empty() || relative.starts_with("..") ? path.string() : relative;
}

/// SARIF 2.1.0 (OASIS): each finding as a result with its first place, and the others related.
json to_sarif(const ProgramResult& result) {
  const auto location = [](const symbols::Line& line) {
    return json{{"physicalLocation",
                 {{"artifactLocation", {{"uri", path_from_here(line.file)}}},
                  {"region", {{"startLine", std::max(line.number, 1U)}}}}}};
  };
  json results = json::array();
  for (const SearchResult& s : result.searches) {
    if (!s.result.finding) continue;
    json found{{"ruleId", name_of(s.result.finding->kind)},
               {"level", "error"},
               {"message", {{"text", s.sentence}}},
               {"locations", json::array()},
               {"relatedLocations", json::array()}};
    for (const symbols::Line& place : s.places)
      found[found["locations"].empty() ? "locations" : "relatedLocations"].push_back(
          location(place));
    results.push_back(std::move(found));
  }
  return {{"$schema", "https://json.schemastore.org/sarif-2.1.0.json"},
          {"version", "2.1.0"},
          {"runs", {{{"tool", {{"driver", {{"name", "irt check"}}}}}, {"results", results}}}}};
}

}  // namespace

int run_program_command(const ProgramCommand& command) {
  const ProgramSettings& settings = command.settings;
  virtual_cores::Module module(command.module, virtual_cores::Module::Constructs::each_program);
  if (!command.replay.empty()) {
    const std::string report = replay(module, settings, command.replay, command.dot_file);
    std::cout << (report.empty() ? std::string(stale_schedule) : report);
    return report.empty() ? 0 : 1;
  }
  const ProgramResult result = check_program(module, settings, [&](const std::string& schedule) {
    return fmt::format("{} --replay \"{}\"", command.command, schedule);
  });
  if (!result.unseen.refused.empty())
    throw UsageError(fmt::format("{} cannot be checked: {}", settings.name, result.unseen.refused));
  for (const SearchResult& search : result.searches)
    if (!search.report.empty()) std::cout << '\n' << search.report;
  if (!settings.conduct.quiet) std::cout << words(result.unseen);
  const std::string verdict = checker::verdict(settings, result);
  if (!settings.conduct.quiet) std::cout << '\n' << verdict << '\n';
  if (!command.json_file.empty())
    std::ofstream(command.json_file) << to_json(settings, result, verdict).dump(2) << '\n';
  if (!command.sarif_file.empty())
    std::ofstream(command.sarif_file) << to_sarif(result).dump(2) << '\n';
  return result.found ? 1 : 0;
}

}  // namespace irt::checker
