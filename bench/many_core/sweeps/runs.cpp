#include "bench/many_core/sweeps/runs.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "bench/results/order_of_elements.hpp"
#include "bench/results/record.hpp"
#include "bench/statistics/averages.hpp"
#include "renderer/engine/time_histogram.hpp"

namespace irt::many_core {

namespace {

using Json = nlohmann::ordered_json;

std::vector<double> values(std::span<const nlohmann::json> results, const char* key) {
  std::vector<double> all;
  for (const nlohmann::json& result : results) all.push_back(result.value(key, 0.0));
  return all;
}

Json per(double sum, double count) {
  return count > 0 ? Json(sum / count) : Json();
}

Json latency(std::span<const nlohmann::json> results, const char* operation) {
  TimeHistogram all;
  double longest = 0;
  for (const nlohmann::json& result : results) {
    const nlohmann::json& one = result["latency"][operation];
    if (one.is_null()) continue;
    TimeHistogram histogram;
    histogram.counts = one["counts"].get<decltype(histogram.counts)>();
    all += histogram;
    longest = std::max(longest, one["max"].get<double>());
  }
  if (longest == 0) return nullptr;
  return {{"p50", all.quantile(0.5)},       {"p90", all.quantile(0.9)},
          {"p99", all.quantile(0.99)},      {"p99.9", all.quantile(0.999)},
          {"p99.99", all.quantile(0.9999)}, {"max", longest}};
}

}  // namespace

std::string band_of(const Point& point) {
  if (point.scenario == nullptr)
    return "a factor of 1.25 of published fetch-and-adds, of 2.1 of a counter under a mutex; "
           "compare-and-swap loops depend on residence and turns";
  return point.threads < 3
             ? "a factor of 4 and more: near-empty queues with two threads"
             : "a factor of 1.64 (geometric mean over published curves), 3 for mutexes and lists, "
               "more where a published client is not told; see docs/simulator.md";
}

Json levels_of(const Profile& profile, Placement placement) {
  Json all = Json::array();
  for (const Level& level : levels(profile, placement))
    all.push_back({{"threads", level.threads}, {"name", level.name}});
  return all;
}

Json summarise(const Profile& profile, const Point& point,
               std::span<const nlohmann::json> results) {
  std::string status = "ok", message;
  for (const nlohmann::json& result : results) {
    if (result["status"] == "ok") continue;
    status = result["status"];
    message = result.value("message", "");
  }
  const Roles roles = roles_of(point);
  Json run = results::record({
      {"kind", "simulated"},
      {"source", "simulated"},
      {"machine", profile.name},
      {"queue", point.subject},
      {"scenario", scenario_of(point)},
      {"producers", roles.producers},
      {"consumers", roles.consumers},
      {"threads", point.threads},
      {"work_ns", point.work_ns},
      {"capacity", point.capacity},
      {"placement", name_of(point.placement)},
      {"levels", levels_of(profile, point.placement)},
      {"operation_mix", scenario_of(point)},
      {"repetitions", results.size()},
      {"seeds", results.size()},
      {"band", band_of(point)},
      {"status", status},
      {"message", message},
  });
  const bool ok = status == "ok";
  const std::vector<double> samples = values(results, "operations_per_second");
  const double operations_per_second = ok ? statistics::mean(samples) : 0;
  const double half = ok ? statistics::half_interval(samples).value_or(0) : 0;
  const auto seconds = point.measured_ns * 1e-9;
  const auto n = static_cast<double>(results.size());
  double operations = 0;
  for (const double rate : samples) operations += rate * seconds;
  const auto sum = [&](const char* key) { return statistics::mean(values(results, key)) * n; };
  Json waiting;
  if (ok) {
    for (const auto& [cause, share] : results[0]["waiting"].items()) {
      double all = 0;
      for (const nlohmann::json& result : results) all += result["waiting"][cause].get<double>();
      waiting[cause] = all / n;
    }
  }
  std::vector<results::OrderOfElements> orders;
  for (const nlohmann::json& result : results)
    if (ok && !result["order"].is_null()) orders.push_back(result["order"]);
  const auto if_ok = [ok](const Json& figure) { return ok ? figure : Json(); };
  results::add(run,
               {
                   {"operations_per_second", if_ok(operations_per_second)},
                   {"operations_per_second_low", if_ok(operations_per_second - half)},
                   {"operations_per_second_high", if_ok(operations_per_second + half)},
                   {"samples", samples},
                   {"failed_pops_per_second", if_ok(sum("failed_pops") / n / seconds)},
                   {"failed_pushes_per_second", if_ok(sum("failed_pushes") / n / seconds)},
                   {"fairness", if_ok(statistics::mean(values(results, "fairness")))},
                   {"latency_ns",
                    ok ? Json{{"push", latency(results, "push")}, {"pop", latency(results, "pop")}}
                       : Json()},
                   {"transfers_per_operation", if_ok(per(sum("transfers"), operations))},
                   {"cas_failures_per_success", if_ok(per(sum("failed_swaps"), sum("swaps")))},
                   {"sleeps_per_operation", if_ok(per(sum("sleeps"), operations))},
                   {"waiting", waiting},
                   {"hot_lines", results[0].value("hot_lines", nlohmann::json())},
                   {"accesses_per_cpu_second", if_ok(per(sum("accesses"), sum("cpu_seconds")))},
                   {"memory_peak_bytes", if_ok(std::ranges::max(values(results, "memory_bytes")))},
                   {"clock_ns", nullptr},
                   {"retries_per_operation", nullptr},
                   {"context_switches_per_second", nullptr},
                   {"energy_joules", nullptr},
                   {"counters", nullptr},
                   {"claims", nullptr},
                   {"allocator", "glibc, modelled"},
               });
  results::add_order(run, orders);
  return run;
}

namespace {

std::string number(const Json& value, double scale, int width, int digits) {
  if (!value.is_number()) return fmt::format("{:>{}}", "-", width);
  return fmt::format("{:>{}.{}f}", value.get<double>() * scale, width, digits);
}

std::string share(const Json& value) {
  return value.is_number() ? number(value, 100, 6, 1) + '%' : number(value, 1, 7, 0);
}

Json of(const Json& run, const char* first, const char* second) {
  if (!run.contains(first) || !run[first].is_object()) return nullptr;
  return run[first].value(second, Json());
}

// Of pushes or of pops, whichever take longer.
Json slower_p99(const Json& run) {
  Json slower;
  for (const char* kind : {"push", "pop"}) {
    const Json latency = of(run, "latency_ns", kind);
    if (latency.is_object() && (slower.is_null() || latency["p99"] > slower))
      slower = latency["p99"];
  }
  return slower;
}

}  // namespace

std::string table(const Json& runs) {
  std::size_t width = 5;
  for (const Json& run : runs) width = std::max(width, run["queue"].get<std::string>().size());
  std::string text = fmt::format(
      "{:<{}}{:>8}{:>11}  {:<15}{:>9}{:>10}{:>8}{:>8}{:>7}{:>7}{:>7}{:>7}{:>7}{:>7}{:>7}\n",
      "queue", width, "threads", "Mops/s", "95 % interval", "fairness", "transf/op", "CASf/s",
      "p99 ns", "rank", "passed", "move", "queue", "store", "spin", "park");
  for (const Json& run : runs) {
    text += fmt::format("{:<{}}{:>8}", run["queue"].get<std::string>(), width,
                        run["threads"].get<unsigned>());
    if (run["status"] != "ok") {
      text += fmt::format("  {}: {}\n", run["status"].get<std::string>(),
                          run["message"].get<std::string>());
      continue;
    }
    text +=
        number(run["operations_per_second"], 1e-6, 11, 3) + "  " +
        fmt::format("{:<15}", fmt::format("{:.2f} to {:.2f}",
                                          run["operations_per_second_low"].get<double>() / 1e6,
                                          run["operations_per_second_high"].get<double>() / 1e6)) +
        number(run["fairness"], 1, 9, 2) + number(run["transfers_per_operation"], 1, 10, 2) +
        number(run["cas_failures_per_success"], 1, 8, 2) + number(slower_p99(run), 1, 8, 0) +
        number(run["rank_error_mean"], 1, 7, 1) + share(run["pushes_overtaken"]);
    for (const char* cause : {"transfer", "queueing", "stores", "spinning", "parked"}) {
      text += share(of(run, "waiting", cause));
    }
    text += '\n';
  }
  return text;
}

std::string csv(const Json& runs) {
  std::string names, lines;
  for (const Json& run : runs) {
    std::string line;
    names.clear();
    const Json flat = run.flatten();
    for (const auto& [name, value] : flat.items()) {
      const std::string key = name.substr(1);
      if (key.starts_with("conditions") || key.starts_with("hot_lines") ||
          key.starts_with("levels") || key.starts_with("samples"))
        continue;
      if (!names.empty()) line += ',';
      names += names.empty() ? key : "," + key;
      if (!value.is_null()) line += value.dump();
    }
    lines += line + '\n';
  }
  return names + '\n' + lines;
}

std::string hot_lines_text(const Json& run) {
  const Json lines = run.value("hot_lines", Json());
  if (!lines.is_array() || lines.empty()) return {};
  std::string text = fmt::format("hottest lines of {}, {} threads (simulated)\n",
                                 run["queue"].get<std::string>(), run["threads"].get<unsigned>());
  for (const Json& line : lines) {
    const double false_sharing = line["false_sharing"];
    text += fmt::format(
        "{:>5.1f}% of waiting, {} transfers: {}{}\n", 100 * line["share_of_waiting"].get<double>(),
        line["transfers"].get<std::uint64_t>(), line["what"].get<std::string>(),
        false_sharing < 0.25
            ? ""
            : fmt::format("; false sharing in {:.0f} % of the transfers", 100 * false_sharing));
    for (const Json& site : line["sites"])
      text += fmt::format("        {:>5.1f}%  {:<6} {:<30} {}\n",
                          100 * site["share_of_waiting"].get<double>(),
                          site["writes"].get<bool>() ? "writes" : "reads",
                          site["place"].get<std::string>(), site["source"].get<std::string>());
  }
  return text;
}

}  // namespace irt::many_core
