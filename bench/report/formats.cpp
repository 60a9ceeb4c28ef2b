#include "bench/report/formats.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <map>
#include <vector>

#include "bench/contention/summary.hpp"
#include "bench/frames/sample.hpp"
#include "bench/frames/summary.hpp"
#include "bench/report/results.hpp"
#include "bench/results/record.hpp"
#include "bench/statistics/averages.hpp"

namespace irt::report {
namespace {

using Json = nlohmann::ordered_json;

std::string contents_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in || std::filesystem::is_directory(file)) {
    throw ResultError(fmt::format("{}: cannot be read; name a result file", file.string()));
  }
  return text;
}

Json parse(const std::string& text, const std::filesystem::path& file) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    throw ResultError(fmt::format("{}: the file is empty", file.string()));
  }
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const bool ended = error.byte > text.find_last_not_of(" \t\r\n") + 1;
    throw ResultError(ended
                          ? fmt::format("{}: the JSON ends in the middle, after {} bytes; was the "
                                        "tool interrupted while writing it?",
                                        file.string(), text.size())
                          : fmt::format("{}: not JSON, at byte {}", file.string(), error.byte));
  } catch (const Json::exception&) {
    throw ResultError(fmt::format("{}: holds a number no computer can hold", file.string()));
  }
}

double nanoseconds_per(const std::string& unit) {
  if (unit == "us") return 1e3;
  if (unit == "ms") return 1e6;
  return unit == "s" ? 1e9 : 1;
}

// Of Google Benchmark's context what has the names of `conditions()`: a program adds such as texts.
Json conditions_of(const Json& context) {
  Json conditions = Json::object();
  for (const char* name :
       {"time", "cpu", "packages", "numa_nodes", "cores", "hardware_threads", "memory_bytes",
        "hypervisor", "governor", "turbo", "cpu_limit", "transparent_huge_pages", "kernel",
        "compiler", "flags", "build_type", "commit", "pinning"}) {
    const auto found = context.find(name);
    if (found == context.end()) continue;
    conditions[name] = *found;
    if (!found->is_string()) continue;
    const Json value = Json::parse(found->get<std::string>(), nullptr, false);
    // A commit may consist of digits alone and is no number for that.
    const bool counted = value.is_number() && std::string_view(name) != "commit";
    if (counted || value.is_null() || value.is_boolean()) conditions[name] = value;
  }
  if (!conditions.contains("time")) conditions["time"] = context.value("date", "");
  if (!conditions.contains("hardware_threads")) {
    conditions["hardware_threads"] = context.value("num_cpus", Json());
  }
  return conditions;
}

// The repetitions of one benchmark, made a run.
Json micro_run(const std::string& name, const std::vector<Json>& entries, const Json& conditions) {
  Json run = results::record(
      {{"kind", "micro"}, {"source", "measured"}, {"benchmark", name}, {"threads", 1}});
  std::vector<double> samples;
  std::string message;
  for (const Json& entry : entries) {
    results::add(run, {{"threads", entry.value("threads", 1)}});
    if (entry.value("error_occurred", false)) {
      message = entry.value("error_message", "failed");
    } else if (entry.value("run_type", "iteration") == "iteration") {
      samples.push_back(entry.at("real_time").get<double>() *
                        nanoseconds_per(entry.value("time_unit", "ns")));
    }
  }
  const auto aggregate = [&](std::string_view wanted) -> const Json* {
    const auto found = std::ranges::find_if(
        entries, [&](const Json& entry) { return entry.value("aggregate_name", "") == wanted; });
    return found == entries.end() ? nullptr : &*found;
  };
  double time = 0;
  std::optional<statistics::Interval> interval;
  auto repetitions = samples.size();
  if (!samples.empty()) {
    time = statistics::mean(samples);
    interval = statistics::student_interval(samples);
  } else if (const Json* mean = aggregate("mean")) {
    const double unit = nanoseconds_per(mean->value("time_unit", "ns"));
    time = mean->at("real_time").get<double>() * unit;
    repetitions = mean->value("repetitions", std::size_t{0});
    if (const Json* deviation = aggregate("stddev"); deviation != nullptr && repetitions > 1) {
      const double half =
          statistics::half_interval(deviation->at("real_time").get<double>() * unit, repetitions);
      interval = {time - half, time + half};
    }
  }
  const bool measured = repetitions > 0;
  results::add(run, {{"status", message.empty() ? "ok" : "failed"},
                     {"message", message},
                     {"repetitions", repetitions},
                     {"ns_per_operation", measured ? Json(time) : Json()},
                     {"ns_per_operation_low", interval ? Json(interval->low) : Json()},
                     {"ns_per_operation_high", interval ? Json(interval->high) : Json()},
                     {"samples", samples},
                     {"conditions", conditions}});
  return run;
}

Json micro_runs(const Json& document) {
  const Json conditions = conditions_of(document.at("context"));
  std::vector<std::string> order;
  std::map<std::string, std::vector<Json>> by_name;
  for (const Json& entry : document.at("benchmarks")) {
    const std::string whole = entry.at("name").get<std::string>();
    const std::string name = entry.value("run_name", whole);
    auto& entries = by_name[name];
    if (entries.empty()) order.push_back(name);
    entries.push_back(entry);
  }
  Json runs = Json::array();
  for (const std::string& name : order) runs.push_back(micro_run(name, by_name[name], conditions));
  return runs;
}

// What `compare` has measured, summed up as it would have been at the end.
Json compared_runs(const Json& header, const std::vector<frames::Sample>& samples) {
  std::vector<frames::Background> backgrounds;
  const Json& plan = header.at("plan");
  for (std::size_t i = 0; i < plan.at("workloads").size(); ++i) {
    const Json& reference = header.at("references").at(i);
    backgrounds.push_back({.workload = plan.at("workloads").at(i).get<frames::WorkloadOptions>(),
                           .triangles = reference.at("triangles").get<std::size_t>(),
                           .warmup = plan.at("warmup").get<unsigned>(),
                           .traverse_share = reference.at("traverse_share").get<double>(),
                           .conditions = header.at("conditions")});
  }
  for (const frames::Sample& sample : samples) {
    if (sample.workload >= backgrounds.size()) throw std::out_of_range("workload");
  }
  return frames::summarise(samples, backgrounds);
}

// A journal: a header, then a result a line. The last line may be torn.
FileContents read_lines(const std::string& text, const std::filesystem::path& file) {
  std::vector<Json> lines;
  bool torn = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    torn = end == std::string::npos;
    if (torn) break;
    try {
      lines.push_back(Json::parse(text.substr(at, end - at)));
    } catch (const Json::exception&) {
      throw ResultError(fmt::format("{}: line {} is not JSON", file.string(), lines.size() + 1));
    }
    at = end + 1;
  }
  if (lines.empty()) throw ResultError(fmt::format("{}: holds no whole line", file.string()));
  FileContents contents{Json::array(), {}};
  const Json header = lines.front();
  const std::string format = header.is_object() ? header.value("format", "") : "";
  std::size_t done = 0;
  if (format == frames::journal_format) {
    std::vector<frames::Sample> samples;
    for (std::size_t i = 1; i < lines.size(); ++i)
      samples.push_back(lines[i].get<frames::Sample>());
    done = samples.size();
    contents.runs = compared_runs(header, samples);
  } else if (format == contention::journal_format) {
    const std::vector<nlohmann::json> results(lines.begin() + 1, lines.end());
    done = results.size();
    contents.runs = contention::summarise_journal(header, results);
  } else {
    // Other tools write finished runs, perhaps under a header.
    if (!format.empty()) lines.erase(lines.begin());
    done = lines.size();
    if (!format.empty() && (lines.empty() || !lines.front().contains("kind"))) {
      throw ResultError(fmt::format(
          "{}: a journal of {}, whose results its tool alone can sum up; go on there with --resume",
          file.string(), format));
    }
    contents.runs = lines;
  }
  contents.note = fmt::format("a sweep that was not finished: {} results{}", done,
                              torn ? "; the last line is torn and left out" : "");
  return contents;
}

}  // namespace

FileContents read_result_file(const std::filesystem::path& file) {
  const std::string text = contents_of(file);
  try {
    if (file.extension() == ".jsonl") return read_lines(text, file);
    Json document = parse(text, file);
    if (document.is_object() && document.contains("benchmarks") && document.contains("context")) {
      return {micro_runs(document), {}};
    }
    if (!document.is_array()) {
      throw ResultError(
          fmt::format("{}: no result file; those hold an array of runs", file.string()));
    }
    if (document.empty()) throw ResultError(fmt::format("{}: holds no runs", file.string()));
    return {std::move(document), {}};
  } catch (const Json::exception&) {
    throw ResultError(fmt::format("{}: a field has the wrong type or is missing", file.string()));
  } catch (const std::out_of_range&) {
    throw ResultError(fmt::format("{}: a result of an unknown workload or row", file.string()));
  }
}

}  // namespace irt::report
