#include "bench/report/results.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "bench/conditions/claims.hpp"
#include "bench/report/formats.hpp"
#include "queues/nearest.hpp"
#include "queues/registry.hpp"

namespace irt::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// What changes from moment to moment and makes no other environment.
constexpr std::array passing{"time", "load_average", "mhz_per_cpu"};

Family family_of(const Json& run, const std::string& where) {
  const auto wrong = [&](const std::string& what) { return ResultError(where + ": " + what); };
  if (!run.is_object()) throw wrong("no object; a run is one");
  const bool renders = run.contains("scene") && run.contains("fps");
  if (!run.contains("kind")) {
    if (renders) return Family::frames;
    throw wrong("neither 'kind' nor 'scene' and 'fps'; no tool of irt writes such");
  }
  if (!run["kind"].is_string()) throw wrong("'kind' is no string");
  constexpr std::array<std::string_view, 3> known{"contention", "simulated", "micro"};
  const auto kind = run["kind"].get<std::string>();
  if (std::ranges::find(known, kind) == known.end()) {
    throw wrong(unknown_name("kind of results", kind, known));
  }
  if (kind == "micro") return Family::micro;
  return renders ? Family::frames : Family::operations;
}

class Collector {
 public:
  void read(const fs::path& place, bool named) {
    try {
      add(place, read_result_file(place));
    } catch (const ResultError& error) {
      if (named) throw;
      results_.notes.push_back(fmt::format("left out: {}", error.what()));
    }
  }

  void read_directory(const fs::path& directory) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::recursive_directory_iterator(directory, error)) {
      const fs::path extension = entry.path().extension();
      if (extension == ".json" || extension == ".jsonl") files.push_back(entry.path());
    }
    if (error) {
      throw ResultError(
          fmt::format("{}: cannot be read ({})", directory.string(), error.message()));
    }
    std::ranges::sort(files);
    for (const fs::path& file : files) {
      if (!superseded(file, files)) read(file, false);
    }
  }

  Results finish() {
    drop_duplicates();
    complete_speed_ups();
    complete_claims();
    note_environments();
    note_failures();
    return std::move(results_);
  }

 private:
  // A sweep that came to its end has summed its journal up in another file of the directory.
  static bool superseded(const fs::path& file, const std::vector<fs::path>& beside) {
    if (file.extension() != ".jsonl") return false;
    std::error_code error;
    // Copies of both are written in any order, a moment apart.
    const auto written = fs::last_write_time(file, error) - std::chrono::seconds(2);
    return std::ranges::any_of(beside, [&](const fs::path& other) {
      return other.extension() == ".json" && other.parent_path() == file.parent_path() &&
             fs::last_write_time(other, error) >= written;
    });
  }

  void add(const fs::path& file, FileContents contents) {
    std::size_t number = 0;
    std::vector<Run> runs;
    for (Json& fields : contents.runs) {
      const std::string where = fmt::format("{}: run {}", file.string(), ++number);
      const Family family = family_of(fields, where);
      Run run{.family = family, .fields = std::move(fields), .environment = 0, .time = {}};
      Json conditions = Json::object();
      if (run.fields.contains("conditions") && run.fields["conditions"].is_object()) {
        conditions = run.fields["conditions"];
      }
      run.fields.erase("conditions");
      if (run.number("packet_width") == 0) run.fields["packet_width"] = nullptr;  // the default
      if (conditions.contains("time") && conditions["time"].is_string()) {
        run.time = conditions["time"].get<std::string>();
      }
      for (const char* name : passing) conditions.erase(name);
      // Where threads run is a choice of a run, not of its environment.
      if (!run.fields.contains("placement") && conditions.contains("pinning")) {
        run.fields["placement"] = conditions["pinning"];
      }
      conditions.erase("pinning");
      run.environment = environment(std::move(conditions));
      runs.push_back(std::move(run));
    }
    results_.files.push_back({file.string(), runs.size()});
    if (!contents.note.empty()) {
      results_.notes.push_back(fmt::format("{}: {}", file.string(), contents.note));
    }
    std::ranges::move(runs, std::back_inserter(results_.runs));
  }

  // Objects are equal here whatever the order of their fields.
  std::size_t environment(Json conditions) {
    const nlohmann::json sorted = conditions;
    const auto [found, is_new] = environments_.try_emplace(sorted.dump(), environments_.size());
    if (is_new) results_.environments.push_back(std::move(conditions));
    return found->second;
  }

  // Everything but what was measured: two runs that agree in it answer the same question.
  static std::string question(const Run& run, const std::set<std::string_view>& but = {}) {
    nlohmann::json key{{"family", run.family}, {"environment", run.environment}};
    for (const Field& field : results::fields) {
      if (!field.tells_apart || but.contains(field.key)) continue;
      const auto found = run.fields.find(field.key);
      if (found == run.fields.end()) continue;
      // What was calculated may differ in its last bits.
      key[std::string(field.key)] = found->is_number_float() ? Json(run.text(field)) : *found;
    }
    return key.dump();
  }

  // Of several answers to one question the newest is kept.
  void drop_duplicates() {
    std::map<std::string, std::size_t> kept;
    std::set<std::size_t> dropped;
    std::size_t same = 0, other = 0;
    for (std::size_t i = 0; i < results_.runs.size(); ++i) {
      const auto [found, is_new] = kept.try_emplace(question(results_.runs[i]), i);
      if (is_new) continue;
      Run& first = results_.runs[found->second];
      ++(first.fields == results_.runs[i].fields ? same : other);
      const bool newer = results_.runs[i].time >= first.time;
      dropped.insert(newer ? std::exchange(found->second, i) : i);
    }
    if (same > 0) {
      results_.notes.push_back(
          fmt::format("{} runs are in the files more than once; each counts once", same));
    }
    if (other > 0) {
      results_.notes.push_back(
          fmt::format("{} runs were measured again under the same conditions; the newest of each "
                      "is shown, the others are left out",
                      other));
    }
    std::vector<Run> runs;
    for (std::size_t i = 0; i < results_.runs.size(); ++i) {
      if (!dropped.contains(i)) runs.push_back(std::move(results_.runs[i]));
    }
    results_.runs = std::move(runs);
  }

  // Says in which conditions the environments differ. What one of them does not tell is no
  // difference.
  void note_environments() {
    std::set<std::string> differing;
    for (const Json& one : results_.environments) {
      for (const Json& other : results_.environments) {
        for (const auto& [name, value] : one.items()) {
          if (other.contains(name) && other[name] != value) differing.insert(name);
        }
      }
    }
    if (differing.empty()) return;
    results_.notes.push_back(fmt::format(
        "the runs were taken under {} different conditions, which do not mix: they are separate "
        "series, by the letters of the environments; these differ in {}",
        results_.environments.size(), fmt::join(differing, ", ")));
  }

  // The speed-up of shards: the run with one thread may be in another file than the others.
  void complete_speed_ups() {
    std::map<std::string, double> one_thread;
    const auto key = [](const Run& run) { return question(run, {"queue", "threads"}); };
    for (const Run& run : results_.runs) {
      if (run.family != Family::frames || run.number("threads") != 1) continue;
      double& fps = one_thread[key(run)];
      fps = std::max(fps, run.number("fps").value_or(0));
    }
    for (Run& run : results_.runs) {
      if (run.family != Family::frames || run.number("speed_up")) continue;
      const auto base = one_thread.find(key(run));
      const auto fps = run.number("fps");
      if (base != one_thread.end() && base->second > 0 && fps) {
        run.fields["speed_up"] = *fps / base->second;
      }
    }
  }

  // Not every tool writes what a queue claims. It stands in the queue's source.
  void complete_claims() {
    const QueueRegistry queues;
    for (Run& run : results_.runs) {
      const QueueEntry* queue = queues.find(run.text("queue"));
      if (queue == nullptr || (run.fields.contains("claims") && run.fields["claims"].is_object())) {
        continue;
      }
      run.fields["claims"] = claims_in_words(queue->claims);
    }
  }

  void note_failures() {
    std::map<std::string, std::set<std::string>> by_status;
    std::size_t count = 0;
    for (const Run& run : results_.runs) {
      const std::string status = run.status();
      if (status == "ok") continue;
      ++count;
      by_status[status].insert(run.subject());
    }
    for (const auto& [status, subjects] : by_status) {
      results_.notes.push_back(fmt::format("{}: {} ({} of {} runs did not end well)", status,
                                           fmt::join(subjects, ", "), count, results_.runs.size()));
    }
  }

  Results results_;
  std::map<std::string, std::size_t> environments_;
};

}  // namespace

std::optional<double> Run::number(Key key) const {
  const auto found = fields.find(key.name);
  if (found == fields.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

std::string Run::text(Key key) const {
  const auto found = fields.find(key.name);
  if (found == fields.end() || found->is_null()) return {};
  if (found->is_string()) return found->get<std::string>();
  if (found->is_number_float()) return fmt::format("{:.6g}", found->get<double>());
  return found->dump();
}

std::string Run::subject() const {
  if (family == Family::micro) return text("benchmark");
  const std::string queue = text("queue");
  return queue.empty() ? text("task_system") : queue;
}

std::string Run::status() const {
  if (number("lost_tasks").value_or(0) > 0 || number("doubled_tasks").value_or(0) > 0 ||
      text("same_image") == "false") {
    return "broken";
  }
  const std::string status = text("status");
  return status.empty() ? "ok" : status;
}

std::string with_unit(const Field& field) {
  return field.unit.empty() ? std::string(field.title)
                            : fmt::format("{} [{}]", field.title, field.unit);
}

std::string environment_name(std::size_t index) {
  std::string name;
  for (++index; index > 0; index = (index - 1) / 26) {
    name.insert(name.begin(), static_cast<char>('A' + (index - 1) % 26));
  }
  return name;
}

Results read_results(std::span<const std::filesystem::path> places) {
  Collector collector;
  for (const fs::path& place : places) {
    std::error_code error;
    if (!fs::exists(place, error)) {
      throw ResultError(fmt::format(
          "{}: there is no such file; name result files, or directories of them", place.string()));
    }
    if (fs::is_directory(place, error)) {
      collector.read_directory(place);
    } else {
      collector.read(place, true);
    }
  }
  Results results = collector.finish();
  if (results.runs.empty()) {
    throw ResultError(
        fmt::format("{}: holds no results; 'irt compare' and 'irt bench contention' "
                    "write such",
                    places.empty() ? "" : places.front().string()));
  }
  return results;
}

}  // namespace irt::report
