#include "bench/report/tables.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "bench/report/facts.hpp"

namespace irt::report {
namespace {

using Json = nlohmann::ordered_json;

struct Column {
  const Field* field;
  std::string title;
  std::string method{}, percentile{};  // of latencies
};

// The figures of a family that have a column.
std::vector<Column> columns_of(Family family) {
  std::vector<Column> columns;
  for (const Field& field : results::fields) {
    if ((field.by & tools_of(family)) == 0) continue;
    const bool choice = field.role == results::Role::choice;
    if (!choice && !field.heading.empty()) columns.push_back({&field, std::string(field.heading)});
    if (field.key != "latency_ns") continue;
    for (const char* method : {"push", "pop"}) {
      for (const char* percentile : {"p50", "p99", "p99.99", "max"}) {
        columns.push_back(
            {&field, fmt::format("{} {} [ns]", method, percentile), method, percentile});
      }
    }
  }
  return columns;
}

// Of the time, the share of each cause that has one.
Json shares(const Run& run) {
  const auto causes = run.fields.find("waiting");
  if (causes == run.fields.end() || !causes->is_object()) return nullptr;
  std::vector<std::string> parts;
  for (const auto& [cause, share] : causes->items()) {
    if (!share.is_number() || share.get<double>() < 0.005) continue;
    parts.push_back(fmt::format("{} {:.0f} %", cause, 100 * share.get<double>()));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

Json latency(const Run& run, const Column& column) {
  const auto latency = run.fields.find(column.field->key);
  if (latency == run.fields.end() || !latency->is_object()) return nullptr;
  const auto times = latency->find(column.method);
  if (times == latency->end() || !times->is_object()) return nullptr;
  const auto time = times->find(column.percentile);
  return time != times->end() && time->is_number() ? Json(*time) : Json();
}

Json cell(const Run& run, const Column& column) {
  if (!column.method.empty()) return latency(run, column);
  if (column.field->key == "waiting") return shares(run);
  if (const auto value = run.number(*column.field)) return *value;
  const std::string text = run.text(*column.field);
  return text.empty() ? Json() : Json(text);
}

std::string status_cell(const Run& run) {
  const std::string message = run.text("message");
  return run.status() == "ok" || message.empty() ? run.status() : run.status() + ": " + message;
}

// Choices in which no run differs have no column.
Json runs_table(const Results& results, Family family, const char* title) {
  std::vector<const Run*> runs;
  for (const Run& run : results.runs) {
    if (run.family == family) runs.push_back(&run);
  }
  if (runs.empty()) return nullptr;
  // What tells runs apart and has no column of its own: a column where it does so here.
  std::vector<Column> shown, origin;
  for (const Field& field : results::fields) {
    if (!field.tells_apart || (field.by & tools_of(family)) == 0) continue;
    const bool always = field.key == "scenario" && family == Family::operations;
    const bool differs = std::ranges::any_of(
        runs, [&](const Run* run) { return run->text(field) != runs.front()->text(field); });
    const bool own =
        field.place == results::Place::subject || field.key == "kind" || field.key == "source";
    if (own || !(always || differs || field.key == "threads")) continue;
    const bool late = field.place == results::Place::origin;
    (late ? origin : shown).push_back({&field, with_unit(field)});
  }
  std::ranges::move(columns_of(family), std::back_inserter(shown));
  std::ranges::move(origin, std::back_inserter(shown));

  Json columns = Json::array({family == Family::micro ? "benchmark" : "queue"});
  for (const Column& column : shown) columns.push_back(column.title);
  for (const char* name : {"source", "environment", "status"}) columns.push_back(name);
  Json rows = Json::array();
  for (const Run* run : runs) {
    Json row = Json::array({run->subject()});
    for (const Column& column : shown) row.push_back(cell(*run, column));
    row.push_back(run->simulated() ? "simulated" : "measured");
    row.push_back(environment_name(run->environment));
    row.push_back(status_cell(*run));
    rows.push_back(std::move(row));
  }
  return {{"title", title}, {"columns", columns}, {"rows", rows}};
}

// One row per condition, one column per environment.
Json environments_table(const Results& results) {
  Json columns = Json::array({"condition"}), rows = Json::array();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < results.environments.size(); ++i) {
    columns.push_back(environment_name(i));
    for (const auto& [name, value] : results.environments[i].items()) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  for (const std::string& name : names) {
    Json row = Json::array({name});
    for (const Json& environment : results.environments) {
      const auto found = environment.find(name);
      const bool known = found != environment.end() && !found->is_null();
      row.push_back(!known               ? Json(not_recorded)
                    : found->is_string() ? *found
                                         : Json(found->dump()));
    }
    rows.push_back(std::move(row));
  }
  return {{"title", "Environments"}, {"columns", columns}, {"rows", rows}};
}

}  // namespace

nlohmann::ordered_json tables_of(const Results& results) {
  Json tables = Json::array();
  for (const auto& [family, title] :
       {std::pair(Family::frames, "Frames"), std::pair(Family::operations, "Operations"),
        std::pair(Family::micro, "Micro benchmarks")}) {
    Json table = runs_table(results, family, title);
    if (!table.is_null()) tables.push_back(std::move(table));
  }
  tables.push_back(environments_table(results));
  return tables;
}

}  // namespace irt::report
