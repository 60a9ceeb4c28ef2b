#include "bench/contention/summary.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>
#include <optional>

#include "bench/conditions/conditions.hpp"
#include "bench/contention/histogram.hpp"
#include "bench/results/order_of_elements.hpp"
#include "bench/results/record.hpp"
#include "bench/statistics/averages.hpp"

namespace irt::contention {
namespace {

using Json = nlohmann::ordered_json;

/// All repetitions of one row.
struct Group {
  std::vector<Sample> plain, stamped;            ///< those that are ok
  std::vector<results::OrderOfElements> orders;  ///< of those that are logged
  std::vector<unsigned> rounds;                  ///< the repetitions of `plain`
  const Sample* worst = nullptr;                 ///< one that is not
  const Sample* counted = nullptr;               ///< of the counting build, whatever became of it
};

Json or_null(std::optional<double> value) {
  return value ? Json(*value) : Json();
}

/// The mean over the repetitions of what `figure` takes from one; null where there are none.
template <class Figure>
std::optional<double> mean_of(const std::vector<Sample>& samples, Figure figure) {
  if (samples.empty()) return std::nullopt;
  std::vector<double> values;
  values.reserve(samples.size());
  for (const Sample& sample : samples) values.push_back(figure(sample));
  return statistics::mean(values);
}

double per_second(std::uint64_t count, const Sample& sample) {
  return sample.seconds > 0 ? static_cast<double>(count) / sample.seconds : 0;
}

Json percentiles(const std::vector<Sample>& samples, Times Sample::*times) {
  Histogram all;
  for (const Sample& sample : samples) all.add((sample.*times).buckets, (sample.*times).max);
  if (all.count() == 0) return nullptr;
  Json figures;
  constexpr std::array<std::pair<const char*, double>, 5> shares{
      {{"p50", 0.5}, {"p90", 0.9}, {"p99", 0.99}, {"p99.9", 0.999}, {"p99.99", 0.9999}}};
  for (const auto& [name, share] : shares) {
    figures[name] = all.quantile(share);
  }
  figures["max"] = all.max();
  figures["count"] = all.count();
  return figures;
}

Json latency(const Group& group) {
  if (group.stamped.empty()) return nullptr;
  return {{"push", percentiles(group.stamped, &Sample::push_times)},
          {"pop", percentiles(group.stamped, &Sample::pop_times)}};
}

/// Events per operation, by name, over all repetitions.
Json counters(const std::vector<Sample>& samples) {
  std::map<std::string, double> sums;
  double operations = 0;
  for (const Sample& sample : samples) {
    if (sample.counters.is_null()) return nullptr;
    for (const auto& [name, count] : sample.counters.items()) sums[name] += count.get<double>();
    operations += static_cast<double>(sample.operations());
  }
  if (sums.empty() || operations == 0) return nullptr;
  Json figures;
  for (const auto& [name, sum] : sums) figures[name] = sum / operations;
  return figures;
}

/// The mean of a figure that cannot be read everywhere; null where one sample lacks it.
Json mean_if_read(const std::vector<Sample>& samples, nlohmann::json Sample::*figure) {
  const bool read = std::ranges::none_of(
      samples, [figure](const Sample& sample) { return (sample.*figure).is_null(); });
  if (!read) return nullptr;
  return or_null(mean_of(samples, [figure](const Sample& s) { return (s.*figure).get<double>(); }));
}

/// What the counting build did for each operation that succeeded; null where there is none.
Json events_of(const Sample* counted) {
  if (counted == nullptr || counted->status != "ok" || counted->all_operations == 0) return nullptr;
  const auto share = [counted](std::uint64_t events) {
    return static_cast<double>(events) / static_cast<double>(counted->all_operations);
  };
  const AtomicEvents& events = counted->events;
  return {{"operations_per_second", per_second(counted->operations(), *counted)},
          {"retries_per_operation", share(events.failed_compare_exchanges)},
          {"compare_exchanges_per_operation", share(events.compare_exchanges)},
          {"other_modifications_per_operation", share(events.other_modifications)},
          {"atomic_loads_per_operation", share(events.loads)},
          {"atomic_stores_per_operation", share(events.stores)}};
}

/// Why a run has no figures of the counting build; null where it has.
Json not_counted(const Row& row, const Group& group) {
  if (!row.not_countable.empty()) return row.not_countable;
  if (group.counted == nullptr) return "not yet measured";
  if (group.counted->status == "ok") return nullptr;
  return group.counted->status + ": " + group.counted->message;
}

std::string bound_text(const Row& row, const Group& group) {
  for (const Sample& sample : group.plain) {
    if (!sample.not_pinned.empty()) {
      return fmt::format("none ({} cannot be had: {})", row.placement.text, sample.not_pinned);
    }
  }
  return row.placement.text;
}

Json run_of(const Plan& plan, const Row& row, const Group& group, const Calibration& calibration,
            nlohmann::json conditions) {
  const auto& samples = group.plain;
  std::vector<double> rates, cpu_rates;
  rates.reserve(samples.size());
  cpu_rates.reserve(samples.size());
  for (const Sample& sample : samples) {
    rates.push_back(per_second(sample.operations(), sample));
    const auto operations = static_cast<double>(sample.operations());
    cpu_rates.push_back(sample.cpu_seconds > 0 ? operations / sample.cpu_seconds : 0);
  }
  const auto interval = statistics::student_interval(rates);
  const auto rate = [&](std::uint64_t Sample::*count) {
    return or_null(mean_of(samples, [&](const Sample& s) { return per_second(s.*count, s); }));
  };
  const auto mean_figure = [&](auto figure) { return or_null(mean_of(samples, figure)); };
  const auto steady = std::ranges::count_if(samples, [](const Sample& s) { return s.steady; });
  const std::string placement = bound_text(row, group);
  conditions["pinning"] = placement;
  const Json counted = events_of(group.counted);
  Json run = results::record({
      {"kind", "contention"},
      {"source", "measured"},
      {"queue", row.queue},
      {"scenario", row.scenario},
      {"operation_mix", scenario_at(row.scenario).scenario->operation_mix},
      {"producers", row.cast.producers},
      {"consumers", row.cast.consumers},
      {"threads", row.cast.workers},
      {"oversubscribed", row.oversubscribed},
      {"work_ns", row.work_ns},
      {"work_spread", plan.work_spread},
      {"work_ns_measured", mean_figure([](const Sample& s) { return s.work_ns_measured; })},
      {"capacity", row.capacity},
      {"placement", placement},
      {"processors", row.placement.processors},
      {"interface", row.type_erased ? "type-erased" : "concrete type"},
      {"status", group.worst == nullptr ? "ok" : group.worst->status},
      {"message", group.worst == nullptr ? "" : group.worst->message},
      {"repetitions", samples.size()},
      {"seconds", plan.seconds},
      {"steady_repetitions", steady},
      {"operations_per_second", rates.empty() ? Json() : Json(statistics::mean(rates))},
      {"operations_per_second_low", interval ? Json(interval->low) : Json()},
      {"operations_per_second_high", interval ? Json(interval->high) : Json()},
      {"samples", rates},
      {"rounds", group.rounds},
      {"operations_per_cpu_second", cpu_rates.empty() ? Json() : Json(statistics::mean(cpu_rates))},
      {"samples_per_cpu_second", cpu_rates},
      {"failed_pops_per_second", rate(&Sample::failed_pops)},
      {"failed_pushes_per_second", rate(&Sample::failed_pushes)},
      {"held_back_per_second", rate(&Sample::held_back)},
      {"fairness", mean_figure([](const Sample& s) { return s.fairness; })},
      {"cpu_seconds", mean_figure([](const Sample& s) { return s.cpu_seconds; })},
      {"latency_ns", latency(group)},
      {"clock_ns", or_null(mean_of(group.stamped, [](const Sample& s) { return s.clock_ns; }))},
      {"harness_ns", calibration.harness_ns},
      {"retries_per_operation", counted.is_null() ? Json() : counted["retries_per_operation"]},
      {"counted", counted},
      {"not_counted", not_counted(row, group)},
      {"context_switches_per_second", rate(&Sample::context_switches)},
      {"memory_peak_bytes",
       mean_figure([](const Sample& s) { return static_cast<double>(s.memory_peak_bytes); })},
      {"memory_held_bytes", mean_if_read(samples, &Sample::memory_held_bytes)},
      {"energy_joules", mean_if_read(samples, &Sample::energy_joules)},
      {"counters", counters(samples)},
      {"claims", row.claims},
      {"allocator", allocator()},
      {"seed", plan.seed},
      {"conditions", conditions},
  });
  results::add_order(run, group.orders);
  return run;
}

}  // namespace

nlohmann::ordered_json summarise(const Plan& plan, std::span<const Row> rows,
                                 std::span<const Result> results, const Calibration& calibration,
                                 const nlohmann::json& conditions) {
  std::vector<Group> groups(rows.size());
  for (const Result& result : results) {
    Group& group = groups.at(result.row);
    if (result.pass == Pass::counted) {
      group.counted = &result.sample;
    } else if (result.sample.status != "ok") {
      if (group.worst == nullptr) group.worst = &result.sample;
    } else if (result.pass == Pass::stamped) {
      group.stamped.push_back(result.sample);
    } else if (result.pass == Pass::logged) {
      group.orders.push_back(result.sample.order);
    } else {
      group.plain.push_back(result.sample);
      group.rounds.push_back(result.repetition);
    }
  }
  Json runs = Json::array();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Group& group = groups[i];
    if (group.plain.empty() && group.worst == nullptr) continue;
    runs.push_back(run_of(plan, rows[i], group, calibration, conditions));
  }
  return runs;
}

nlohmann::ordered_json summarise_journal(const nlohmann::json& header,
                                         std::span<const nlohmann::json> lines) {
  std::vector<Result> results;
  for (const nlohmann::json& line : lines) results.push_back(line.get<Result>());
  const auto rows = header.at("rows").get<std::vector<Row>>();
  return summarise(header.at("plan").get<Plan>(), rows, results,
                   header.at("calibration").get<Calibration>(), header.at("conditions"));
}

namespace {

std::string number(const Json& value, double scale, int digits) {
  return value.is_null() ? "-" : fmt::format("{:.{}f}", value.get<double>() * scale, digits);
}

// The mean, and half the width of its interval in per cent of it.
std::string spread(const Json& run) {
  if (run["operations_per_second_low"].is_null()) return "-";
  const double middle = run["operations_per_second"];
  return fmt::format("{:.1f}%",
                     (run["operations_per_second_high"].get<double>() - middle) / middle * 100);
}

std::string latency_text(const Json& latency, const char* method) {
  if (latency.is_null() || latency[method].is_null()) return "-";
  const Json& of = latency[method];
  return fmt::format("{}/{}/{}", of["p50"].get<std::uint64_t>(), of["p99"].get<std::uint64_t>(),
                     of["p99.99"].get<std::uint64_t>());
}

std::string remarks(const Json& run) {
  std::string text;
  const auto add = [&](const std::string& remark) {
    text += text.empty() ? remark : ", " + remark;
  };
  if (run["status"] != "ok") {
    add(run["status"].get<std::string>() + ": " + run["message"].get<std::string>());
  }
  if (run["oversubscribed"].get<bool>()) add("more threads than processors");
  const auto steady = run["steady_repetitions"].get<std::size_t>();
  const auto repetitions = run["repetitions"].get<std::size_t>();
  if (steady < repetitions) add(fmt::format("{} of {} warm-ups steady", steady, repetitions));
  if (run["interface"] == "type-erased") add("type-erased");
  return text;
}

using Cells = std::vector<std::string>;

std::string aligned(const std::vector<Cells>& lines, std::size_t left_columns) {
  std::vector<std::size_t> widths;
  for (const Cells& line : lines) {
    widths.resize(std::max(widths.size(), line.size()));
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
  }
  std::string text;
  for (const Cells& line : lines) {
    std::string row;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const bool left = i < left_columns || i + 1 == line.size();
      row += left ? fmt::format("{:<{}}  ", line[i], widths[i])
                  : fmt::format("{:>{}}  ", line[i], widths[i]);
    }
    row.erase(row.find_last_not_of(' ') + 1);
    text += row + '\n';
  }
  return text;
}

}  // namespace

std::string table(const nlohmann::ordered_json& runs) {
  const bool stamped =
      std::ranges::any_of(runs, [](const Json& run) { return !run["latency_ns"].is_null(); });
  const bool ordered =
      std::ranges::any_of(runs, [](const Json& run) { return !run["pushes_overtaken"].is_null(); });
  Cells head{"scenario", "placement", "queue",    "threads",     "work ns",    "Mops/s",
             "+-95%",    "failed/s",  "fairness", "lost CAS/op", "switches/s", "peak MB"};
  if (stamped) head.insert(head.end(), {"push p50/99/99.99 ns", "pop p50/99/99.99 ns"});
  if (ordered) head.insert(head.end(), {"rank error mean/p99/max", "overtaken pushes", "pops"});
  head.emplace_back();
  std::vector<Cells> lines{head};
  std::string last;
  for (const Json& run : runs) {
    const unsigned threads = run["threads"], producers = run["producers"],
                   consumers = run["consumers"];
    const std::string cell = fmt::format("{} {} {} {}", run["scenario"].dump(), threads,
                                         run["work_ns"].dump(), run["placement"].dump());
    if (!last.empty() && cell != last) lines.emplace_back();
    last = cell;
    const Json failed = run["failed_pops_per_second"].is_null()
                            ? Json()
                            : Json(run["failed_pops_per_second"].get<double>() +
                                   run["failed_pushes_per_second"].get<double>());
    Cells line{run["scenario"].get<std::string>(),
               run["placement"].get<std::string>(),
               run["queue"].get<std::string>(),
               producers + consumers > threads ? fmt::format("{}", threads)
                                               : fmt::format("{}+{}", producers, consumers),
               number(run["work_ns"], 1, 0),
               number(run["operations_per_second"], 1e-6, 3),
               spread(run),
               number(failed, 1, 0),
               number(run["fairness"], 1, 2),
               number(run["retries_per_operation"], 1, 4),
               number(run["context_switches_per_second"], 1, 0),
               number(run["memory_peak_bytes"], 1e-6, 1)};
    if (stamped) {
      line.push_back(latency_text(run["latency_ns"], "push"));
      line.push_back(latency_text(run["latency_ns"], "pop"));
    }
    if (ordered) {
      line.push_back(fmt::format("{}/{}/{}", number(run["rank_error_mean"], 1, 2),
                                 number(run["rank_error_p99"], 1, 0),
                                 number(run["rank_error_max"], 1, 0)));
      line.push_back(number(run["pushes_overtaken"], 100, 1) + "%");
      line.push_back(number(run["pops_overtaken"], 100, 1) + "%");
    }
    line.push_back(remarks(run));
    lines.push_back(std::move(line));
  }
  return aligned(lines, 3);
}

}  // namespace irt::contention
