#include "bench/contention/compare.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fstream>
#include <set>

#include "bench/conditions/conditions.hpp"
#include "bench/results/fields.hpp"
#include "bench/running/text_files.hpp"
#include "bench/statistics/rank_tests.hpp"
#include "queues/nearest.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::contention {
namespace {

using nlohmann::json;

/// In which runs must agree to be compared: every choice but the queue, which comes on top.
std::vector<const results::Field*> settings() {
  std::vector<const results::Field*> found;
  for (const results::Field& field : results::fields) {
    const bool chosen =
        (field.by & results::by_contention) != 0 && field.role == results::Role::choice &&
        (field.place == results::Place::topic || field.place == results::Place::series);
    if (chosen) found.push_back(&field);
  }
  return found;
}

json value_of(const json& run, const results::Field& field) {
  const auto found = run.find(field.key);
  return found == run.end() ? json() : *found;
}

bool same_settings(const json& a, const json& b) {
  return std::ranges::all_of(settings(), [&](const results::Field* field) {
    return value_of(a, *field) == value_of(b, *field);
  });
}

json read_runs(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) {
    throw UsageError(
        fmt::format("{}: cannot be read; name the contention.json of a sweep", file.string()));
  }
  json runs = json::parse(in, nullptr, false);
  if (!runs.is_array()) {
    throw UsageError(
        fmt::format("{}: is no list of runs; name the contention.json of a sweep", file.string()));
  }
  json kept = json::array();
  for (json& run : runs) {
    const bool measured = run.is_object() && run.value("kind", "") == "contention" &&
                          run.contains("samples") && run.value("queue", json()).is_string();
    if (measured) kept.push_back(std::move(run));
  }
  if (kept.empty()) {
    throw UsageError(fmt::format("{}: has no run of irt bench contention", file.string()));
  }
  return kept;
}

void require_queue(const std::string& name, const json& runs) {
  std::set<std::string> there;
  for (const json& run : runs) there.insert(run["queue"].get<std::string>());
  if (there.contains(name)) return;
  const std::vector<std::string_view> names(there.begin(), there.end());
  throw UsageError(unknown_name("queue", name, names));
}

std::vector<double> samples_of(const json& run) {
  try {
    return run["samples"].get<std::vector<double>>();
  } catch (const json::exception&) {
    throw UsageError(
        fmt::format("samples of queue {}: must be numbers, as irt bench contention "
                    "writes them",
                    run["queue"].dump()));
  }
}

/// Puts the rates per second of processor time in the place of the others.
void take_processor_time(json& runs) {
  for (json& run : runs) {
    if (!run.contains("samples_per_cpu_second")) {
      throw UsageError(fmt::format(
          "--per-cpu-second: queue {} has no such samples; measure again with this version",
          run["queue"].dump()));
    }
    run["samples"] = run["samples_per_cpu_second"];
  }
}

/// Rates that one sweep took in the same rounds, one after the other.
struct Pairs {
  std::vector<double> before, after;
};

/// Those of two runs of one sweep; none where the runs come from different ones.
Pairs pairs_of(const json& before, const json& after) {
  const auto sweep_of = [](const json& run) {
    return std::pair(run.value("conditions", json()), run.value("seed", json()));
  };
  const json rounds = before.value("rounds", json()), others = after.value("rounds", json());
  const std::vector<double> a = samples_of(before), b = samples_of(after);
  const bool comparable = rounds.is_array() && others.is_array() && rounds.size() == a.size() &&
                          others.size() == b.size() && before.contains("conditions") &&
                          sweep_of(before) == sweep_of(after);
  if (!comparable) return {};
  Pairs pairs;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto other = std::ranges::find(others, rounds[i]);
    if (other == others.end()) continue;
    const double beside = b[static_cast<std::size_t>(other - others.begin())];
    if (a[i] <= 0 || beside <= 0) return {};  // have no ratio
    pairs.before.push_back(a[i]);
    pairs.after.push_back(beside);
  }
  return pairs;
}

nlohmann::ordered_json compared(const json& before, const json& after) {
  const std::vector<double> a = samples_of(before), b = samples_of(after);
  nlohmann::ordered_json line;
  line["queue"] = before["queue"];
  if (after["queue"] != before["queue"]) line["against"] = after["queue"];
  for (const results::Field* field : settings()) {
    line[std::string(field->key)] = value_of(before, *field);
  }
  line["repetitions"] = {a.size(), b.size()};
  if (a.empty() || b.empty()) {
    line["verdict"] = statistics::words(statistics::Difference::too_few);
    return line;
  }
  line["median_before"] = statistics::median(a);
  line["median_after"] = statistics::median(b);
  const Pairs pairs = pairs_of(before, after);
  const bool paired = pairs.before.size() >= statistics::fewest_pairs;
  statistics::Paired found;
  if (paired) {
    found = statistics::judge_pairs(pairs.before, pairs.after);
  } else {
    const statistics::Ratio factor = statistics::ratio(a, b);
    found = {.ratio = factor.of_medians,
             .interval = factor.interval,
             .p = statistics::mann_whitney(a, b).p,
             .difference = statistics::judge(a, b)};
  }
  line["test"] = paired ? "signed-rank" : "mann-whitney";
  line["pairs"] = paired ? json(pairs.before.size()) : json();
  line["ratio"] = found.ratio;
  line["ratio_low"] = found.interval ? json(found.interval->low) : json();
  line["ratio_high"] = found.interval ? json(found.interval->high) : json();
  line["p"] = found.p;
  line["verdict"] = statistics::words(found.difference);
  return line;
}

/// The settings that no line shows and in which `lines` differ.
std::vector<const results::Field*> differing(const nlohmann::ordered_json& lines) {
  constexpr std::array shown{"scenario", "threads", "work_ns", "placement"};
  std::vector<const results::Field*> found;
  for (const results::Field* field : settings()) {
    const bool differs = std::ranges::any_of(lines, [&](const auto& line) {
      return line.at(std::string(field->key)) != lines[0].at(std::string(field->key));
    });
    if (differs && std::ranges::find(shown, field->key) == shown.end()) found.push_back(field);
  }
  return found;
}

std::string line_of(const nlohmann::ordered_json& one,
                    const std::vector<const results::Field*>& more) {
  const auto text = [&](const char* key) {
    return one[key].is_string() ? one[key].get<std::string>() : one[key].dump();
  };
  std::string line =
      fmt::format("{:<20} {:<20} {:>3} threads {:>5} ns  {:<24} ",
                  one.contains("against") ? text("queue") + " > " + text("against") : text("queue"),
                  text("scenario"), text("threads"), text("work_ns"), text("placement"));
  for (const results::Field* field : more) {
    line += fmt::format("{} {}  ", field->title, one.at(std::string(field->key)).dump());
  }
  if (one.contains("ratio")) {
    std::string interval = "no interval";
    if (!one["ratio_low"].is_null()) {
      interval = fmt::format("{:.3f} to {:.3f}", one["ratio_low"].get<double>(),
                             one["ratio_high"].get<double>());
    }
    line += fmt::format("{:.3f} ({})  p {:.4f}{}  ", one["ratio"].get<double>(), interval,
                        one["p"].get<double>(), one["pairs"].is_null() ? "" : " paired");
  }
  return line + text("verdict");
}

/// What has changed between the two beside what is compared.
std::vector<std::string> changed_conditions(const json& before, const json& after) {
  std::vector<std::string> lines;
  const json a = before[0].value("conditions", json::object()),
             b = after[0].value("conditions", json::object());
  const json lasting = lasting_conditions(a);
  for (const auto& [key, value] : lasting.items()) {
    if (key == "pinning") continue;  // part of the settings of each run
    const json now = b.value(key, json());
    if (now != value)
      lines.push_back(fmt::format("{}: {}, then {}", key, value.dump(), now.dump()));
  }
  return lines;
}

}  // namespace

nlohmann::ordered_json compare_runs(const json& before, const json& after,
                                    const std::vector<std::string>& queues) {
  auto lines = nlohmann::ordered_json::array();
  for (const json& one : before) {
    if (!queues.empty() && one["queue"] != queues[0]) continue;
    const auto other = std::ranges::find_if(after, [&](const json& candidate) {
      return candidate["queue"] == (queues.empty() ? one["queue"] : json(queues[1])) &&
             same_settings(one, candidate);
    });
    if (other != after.end()) lines.push_back(compared(one, *other));
  }
  return lines;
}

int compare(const CompareOptions& options) {
  const bool one_file = options.files.size() == 1;
  if (one_file && options.queues.empty()) {
    throw UsageError(
        fmt::format("{}: nothing to compare it with; name a second file, or two queues "
                    "of this one by --queues",
                    options.files[0].string()));
  }
  if (!options.queues.empty() && options.queues.size() != 2) {
    throw UsageError(
        fmt::format("--queues: {} given; it takes two, as lock,lfree", options.queues.size()));
  }
  json before = read_runs(options.files[0]);
  json after = one_file ? before : read_runs(options.files[1]);
  if (options.per_cpu_second) {
    take_processor_time(before);
    take_processor_time(after);
  }
  if (!options.queues.empty()) {
    require_queue(options.queues[0], before);
    require_queue(options.queues[1], after);
  }
  if (!options.json.empty()) require_writable(options.json);
  const auto lines = compare_runs(before, after, options.queues);
  if (lines.empty()) {
    std::vector<std::string_view> titles;
    for (const results::Field* field : settings()) titles.push_back(field->title);
    throw UsageError(
        fmt::format("no run of the first has a counterpart in the second: they differ in queue or "
                    "{}",
                    fmt::join(titles, ", ")));
  }
  const auto more = differing(lines);
  std::FILE* const people = beside(options.json);
  for (const auto& line : lines) fmt::print(people, "{}\n", line_of(line, more));
  fmt::print(
      people,
      "\n{} of {} and {} runs compared: the second's rate{} over the first's, with its 95% "
      "interval\n"
      "and p: of one sweep by the signed ranks of its rounds (paired), else by the ratio of\n"
      "medians and the Mann-Whitney test. At the level of 5%, one comparison of 20 between equals\n"
      "is called different by chance.\n",
      lines.size(), before.size(), after.size(),
      options.per_cpu_second ? " per second of processor time" : "");
  for (const std::string& line : changed_conditions(before, after)) {
    fmt::print(people, "note: {}\n", line);
  }
  if (!options.json.empty()) write_text(options.json, lines.dump(2) + '\n');
  return 0;
}

}  // namespace irt::contention
