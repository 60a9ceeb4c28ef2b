#include "bench/report/facts.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <functional>

namespace irt::report {
namespace {

using Json = nlohmann::ordered_json;

std::string shown(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return not_recorded;
  if (found->is_string()) return found->get<std::string>();
  return found->is_number_float() ? fmt::format("{:.4g}", found->get<double>()) : found->dump();
}

std::string or_not_recorded(const std::string& text) {
  return text.empty() ? not_recorded : text;
}

std::string claim(const Run& run, const char* key) {
  const auto claims = run.fields.find("claims");
  if (claims == run.fields.end() || !claims->is_object()) return not_recorded;
  return shown(*claims, key);
}

std::string progress(const Run& run) {
  const std::string push = claim(run, "push"), pop = claim(run, "pop");
  return push == pop ? push : fmt::format("push {}, pop {}", push, pop);
}

std::string operation_mix(const Run& run) {
  if (run.family == Family::frames) return "per task one pop, and a push for each it makes";
  if (run.family == Family::micro) return "one thing over and over: the benchmark's name";
  return or_not_recorded(run.text("operation_mix"));
}

std::string work(const Run& run) {
  const auto ns = run.number("work_ns"), took = run.number("work_ns_measured");
  if (!ns) return not_recorded;
  return took ? fmt::format("{:.4g} ns asked, {:.4g} ns measured", *ns, *took)
              : fmt::format("{:.4g} ns", *ns);
}

std::string placement(const Run& run) {
  const std::string text = run.text("placement");
  return text == "none" ? "by the system, no pinning" : or_not_recorded(text);
}

std::string smt(const Json& environment) {
  const Json cores = environment.value("cores", Json()),
             threads = environment.value("hardware_threads", Json());
  if (!cores.is_number_unsigned() || !threads.is_number_unsigned()) return not_recorded;
  if (threads.get<unsigned>() <= cores.get<unsigned>()) return "one hardware thread per core";
  return fmt::format("{} hardware threads on {} cores", threads.get<unsigned>(),
                     cores.get<unsigned>());
}

std::string processor(const Run& run, const Json& environment) {
  if (run.simulated()) return fmt::format("simulated: {}", or_not_recorded(run.text("machine")));
  std::string text = shown(environment, "cpu");
  const std::string hypervisor = shown(environment, "hypervisor");
  if (hypervisor != not_recorded) text += fmt::format(", a virtual machine ({})", hypervisor);
  return text;
}

std::string interval(const Run& run) {
  if (run.simulated()) {
    const std::string band = run.text("band");
    return band.empty() ? "simulated, over seeds" : fmt::format("simulated: {}", band);
  }
  const bool quartiles = run.family == Family::frames && !run.number("fps_low");
  if (quartiles) return "of frames per second: the quartiles of all frames";
  return "95 % of the mean over the repetitions (Student's t)";
}

std::string source(const Run& run) {
  return run.simulated() ? "simulated" : "measured";
}

std::string repetitions(const Run& run) {
  if (run.simulated() && run.text("repetitions").empty()) {
    const auto seeds = run.fields.find("seeds");
    if (seeds == run.fields.end() || seeds->is_null()) return not_recorded;
    return fmt::format("{} seeds",
                       seeds->is_array() ? std::to_string(seeds->size()) : seeds->dump());
  }
  return or_not_recorded(run.text("repetitions"));
}

// All values in the order they come, each once; few of them.
std::string distinct(std::span<const std::size_t> runs,
                     const std::function<std::string(std::size_t)>& value_of) {
  std::vector<std::string> values;
  for (const std::size_t run : runs) {
    const std::string value = value_of(run);
    if (std::ranges::find(values, value) == values.end()) values.push_back(value);
  }
  constexpr std::size_t most = 6;
  const std::size_t more = values.size() > most ? values.size() - most : 0;
  values.resize(values.size() - more);
  std::string text = fmt::format("{}", fmt::join(values, "; "));
  if (more > 0) text += fmt::format("; and {} more", more);
  return text;
}

// What tasks of the renderer take, which is measured and so differs from run to run.
std::string work_in_tasks(const Results& results, std::span<const std::size_t> runs) {
  std::vector<double> times;
  for (const std::size_t run : runs) {
    if (const auto ns = results.runs[run].number("work_per_task_ns")) times.push_back(*ns / 1e3);
  }
  if (times.empty()) return not_recorded;
  const auto [least, most] = std::ranges::minmax(times);
  return fmt::format("{:.1f} to {:.1f} us of tracing and shading per task", least, most);
}

// The least and the most of the operations that failed.
std::string failed_operations(const Results& results, std::span<const std::size_t> runs) {
  struct Kind {
    Key key;
    const char* name;
  };
  std::vector<std::string> parts;
  for (const Kind& kind :
       {Kind{"failed_pops_per_second", "pops/s"}, Kind{"failed_pushes_per_second", "pushes/s"},
        Kind{"failed_gets_per_frame", "pops/frame"},
        Kind{"overflowed_per_frame", "pushes/frame"}}) {
    std::vector<double> counts;
    for (const std::size_t run : runs) {
      if (const auto count = results.runs[run].number(kind.key)) counts.push_back(*count);
    }
    if (counts.empty()) continue;
    const auto [least, most] = std::ranges::minmax(counts);
    parts.push_back(least == most ? fmt::format("{:.3g} {}", most, kind.name)
                                  : fmt::format("{:.3g} to {:.3g} {}", least, most, kind.name));
  }
  return parts.empty() ? not_measured : fmt::format("{}", fmt::join(parts, ", "));
}

std::string status(const Results& results, std::span<const std::size_t> runs) {
  std::vector<std::string> troubles;
  for (const std::size_t index : runs) {
    const Run& run = results.runs[index];
    const std::string status = run.status();
    if (status == "ok") continue;
    const std::string message = run.text("message");
    troubles.push_back(fmt::format("{} with {} threads{}", status, run.text("threads"),
                                   message.empty() ? "" : ": " + message));
  }
  return troubles.empty() ? "ok" : fmt::format("{}", fmt::join(troubles, "; "));
}

constexpr const char* work_title = "work between operations";

}  // namespace

std::vector<Fact> facts_of(const Results& results, std::span<const std::size_t> runs) {
  using Value = std::string (*)(const Run&, const Json&);
  struct Named {
    const char* name;
    Value value;
  };
  constexpr Named named[] = {
      {"source", [](const Run& run, const Json&) { return source(run); }},
      {"operation mix", [](const Run& run, const Json&) { return operation_mix(run); }},
      {work_title, [](const Run& run, const Json&) { return work(run); }},
      {"placement", [](const Run& run, const Json&) { return placement(run); }},
      // What the host of a simulation has says nothing of the machine that is simulated.
      {"SMT", [](const Run& run,
                 const Json& at) { return run.simulated() ? "simulated: as placed" : smt(at); }},
      {"governor",
       [](const Run& run, const Json& at) {
         return run.simulated() ? "simulated: none" : shown(at, "governor");
       }},
      {"interval", [](const Run& run, const Json&) { return interval(run); }},
      {"repetitions", [](const Run& run, const Json&) { return repetitions(run); }},
      {"processor", [](const Run& run, const Json& at) { return processor(run, at); }},
      {"compiler",
       [](const Run&, const Json& at) {
         return fmt::format("{}, {}", shown(at, "compiler"), shown(at, "flags"));
       }},
      {"commit", [](const Run&, const Json& at) { return shown(at, "commit"); }},
  };
  const bool frames = results.runs[runs.front()].family == Family::frames;
  std::vector<Fact> facts;
  for (const Named& one : named) {
    if (frames && one.name == work_title) {
      facts.push_back({work_title, work_in_tasks(results, runs)});
      continue;
    }
    facts.push_back({one.name, distinct(runs, [&](std::size_t index) {
                       const Run& run = results.runs[index];
                       return one.value(run, results.environments[run.environment]);
                     })});
  }
  return facts;
}

std::vector<std::string> series_columns() {
  return {"ordering",          "progress",    "bound",  "reclaimer",   "allocator",
          "failed operations", "repetitions", "source", "environment", "status"};
}

std::vector<std::string> series_facts(const Results& results, std::span<const std::size_t> runs) {
  const auto each = [&](const std::function<std::string(const Run&)>& value) {
    return distinct(runs, [&](std::size_t index) { return value(results.runs[index]); });
  };
  return {
      each([](const Run& run) { return claim(run, "ordering"); }),
      each(progress),
      each([](const Run& run) { return claim(run, "bound"); }),
      each([](const Run& run) { return claim(run, "reclamation"); }),
      each([](const Run& run) { return or_not_recorded(run.text("allocator")); }),
      failed_operations(results, runs),
      each(repetitions),
      each(source),
      each([](const Run& run) { return environment_name(run.environment); }),
      status(results, runs),
  };
}

}  // namespace irt::report
