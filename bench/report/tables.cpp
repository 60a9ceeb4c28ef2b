#include "bench/report/tables.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "bench/report/facts.hpp"
#include "bench/report/metrics.hpp"

namespace irt {
namespace {

using Json = nlohmann::ordered_json;

struct Column {
  std::string_view key, title;
};

constexpr Column frame_columns[] = {
    {"fps", "frames/s"},
    {"fps_low", "from"},
    {"fps_high", "to"},
    {"speed_up", "speed-up"},
    {"rays_per_second", "rays/s"},
    {"get_ns", "get median [ns]"},
    {"get_ns_p99", "get p99 [ns]"},
    {"get_ns_mean", "get mean [ns]"},
    {"add_ns", "add median [ns]"},
    {"add_ns_p99", "add p99 [ns]"},
    {"add_ns_mean", "add mean [ns]"},
    {"failed_gets_per_frame", "failed pops/frame"},
    {"overflowed_per_frame", "failed pushes/frame"},
    {"idle_ms", "idle [ms]"},
    {"barrier_wait_ms", "barrier [ms]"},
    {"imbalance", "imbalance"},
    {"waiting", "waiting, by cause"},
    {"work_per_task_ns", "work per task [ns]"},
    {"repetitions", "repetitions"},
};
constexpr Column operation_columns[] = {
    {"operations_per_second", "operations/s"},
    {"operations_per_second_low", "from"},
    {"operations_per_second_high", "to"},
    {"failed_pops_per_second", "failed pops/s"},
    {"failed_pushes_per_second", "failed pushes/s"},
    {"fairness", "fairness"},
    {"push p50", "push p50 [ns]"},
    {"push p99", "push p99 [ns]"},
    {"push p99.99", "push p99.99 [ns]"},
    {"push max", "push max [ns]"},
    {"pop p50", "pop p50 [ns]"},
    {"pop p99", "pop p99 [ns]"},
    {"pop p99.99", "pop p99.99 [ns]"},
    {"pop max", "pop max [ns]"},
    {"retries_per_operation", "retries/operation"},
    {"cas_failures_per_success", "failed CAS per success"},
    {"transfers_per_operation", "line transfers/operation"},
    {"waiting", "waiting, by cause"},
    {"context_switches_per_second", "context switches/s"},
    {"memory_peak_bytes", "most memory [bytes]"},
    {"energy_joules", "energy [J]"},
    {"repetitions", "repetitions"},
};
constexpr Column micro_columns[] = {
    {"ns_per_operation", "ns/iteration"},
    {"ns_per_operation_low", "from"},
    {"ns_per_operation_high", "to"},
    {"repetitions", "repetitions"},
};

std::span<const Column> columns_of(Family family) {
  if (family == Family::frames) return frame_columns;
  if (family == Family::operations) return operation_columns;
  return micro_columns;
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

Json cell(const Run& run, std::string_view key) {
  if (const std::size_t space = key.find(' '); space != std::string_view::npos) {
    const auto latency = run.fields.find("latency_ns");
    if (latency == run.fields.end() || !latency->is_object()) return nullptr;
    const auto times = latency->find(key.substr(0, space));
    if (times == latency->end() || !times->is_object()) return nullptr;
    const auto time = times->find(key.substr(space + 1));
    return time != times->end() && time->is_number() ? Json(*time) : Json();
  }
  if (key == "waiting") return shares(run);
  if (const auto value = run.number(key)) return *value;
  const std::string text = run.text(key);
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
  std::vector<Column> shown;
  const auto add_differing = [&](std::string_view key, std::string_view name) {
    const bool differs = std::ranges::any_of(
        runs, [&](const Run* run) { return run->text(key) != runs.front()->text(key); });
    if (differs) shown.push_back({key, name});
  };
  if (family == Family::frames) add_differing("scene", "scene");
  if (family == Family::operations) shown.push_back({"scenario", "scenario"});
  for (const Choice& choice : choices(family)) {
    if (choice.key == "threads") {
      shown.push_back({choice.key, choice.title});
    } else {
      add_differing(choice.key, choice.title);
    }
  }
  for (const Column& column : columns_of(family)) shown.push_back(column);
  add_differing("machine", "machine");

  Json columns = Json::array({family == Family::micro ? "benchmark" : "queue"});
  for (const Column& column : shown) columns.push_back(column.title);
  for (const char* name : {"source", "environment", "status"}) columns.push_back(name);
  Json rows = Json::array();
  for (const Run* run : runs) {
    Json row = Json::array({run->subject()});
    for (const Column& column : shown) row.push_back(cell(*run, column.key));
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

}  // namespace irt
