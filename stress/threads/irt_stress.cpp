// irt-stress: tries to break the claims of queues on real threads.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

#include "queues/nearest.hpp"
#include "queues/registry.hpp"
#include "stress/running/arguments.hpp"
#include "stress/running/program.hpp"
#include "stress/running/queue_options.hpp"
#include "stress/running/usage_error.hpp"
#include "stress/threads/kill_matrix.hpp"
#include "stress/threads/sanitizer.hpp"
#include "stress/threads/suites.hpp"

namespace irt::stress {
namespace {

struct Options {
  std::vector<std::string> queues{"all"};
  std::vector<std::filesystem::path> plugins;
  std::vector<std::string> scenarios{"all"};
  std::vector<std::string> suites{"all"};
  double seconds = 30;
  std::uint64_t seed = 1;
  std::string sanitizer;
  std::string json;
  std::string junit;
  bool list = false;
  bool mutants = false;
  KillOptions kill;
};

/// Whether the queue is somebody else's behind our contract (queues/comparators).
bool is_third_party(std::string_view queue) {
  static constexpr std::string_view names = IRT_THIRD_PARTY_QUEUES;  // " name name "
  return names.find(fmt::format(" {} ", queue)) != std::string_view::npos;
}

constexpr std::array<std::string_view, 5> suite_names{"scenarios", "sustained", "progress",
                                                      "faults", "memory"};

bool named(const std::vector<std::string>& choice, std::string_view name) {
  return std::ranges::find(choice, name) != choice.end();
}

bool chosen(const std::vector<std::string>& choice, std::string_view name) {
  return named(choice, "all") || named(choice, name);
}

class Session {
 public:
  Session(const Options& options, const ClockQuality& clock) : options_(options), clock_(clock) {}

  void stress(const QueueEntry& queue) {
    if (!has_elements(queue.claims)) return tell_no_elements(queue);
    if (!pop_answers_on_empty(queue)) return tell_pop_waits(queue);
    const std::vector<Job> jobs = plan(queue);
    if (jobs.empty()) return tell_not_tried(queue, "it has no method that these scenarios call");
    double weight = 0;
    for (const Job& job : jobs) weight += job.weight;
    for (const Job& job : jobs) run(queue, job, options_.seconds * job.weight / weight);
  }

  [[nodiscard]] const std::vector<Result>& results() const { return results_; }

  /// Whether a claim of a queue of ours broke.
  [[nodiscard]] bool broken() const {
    return std::ranges::any_of(results_, [](const Result& result) {
      return !result.findings.empty() && !result.third_party;
    });
  }

 private:
  struct Job {
    std::string suite;
    const Scenario* scenario;
    double weight;
    std::function<void(const Assignment&, Messenger&)> run;
  };

  /// What is told without running a suite.
  [[nodiscard]] Result untried(const QueueEntry& queue) const {
    Result result;
    result.queue = queue.name;
    result.suite = "scenarios";
    result.seed = options_.seed;
    result.third_party = is_third_party(queue.name);
    return result;
  }

  void tell_not_tried(const QueueEntry& queue, const std::string& why) {
    Result result = untried(queue);
    result.limits.push_back("not tried: " + why);
    fmt::print("{}", to_text(result));
    results_.push_back(std::move(result));
  }

  void tell_no_elements(const QueueEntry& queue) {
    tell_not_tried(queue, fmt::format("an element here is a number of 40 bits and its worker's "
                                      "above it, and this queue leaves {:#x} of that unused",
                                      queue.claims.unused_bits & element_bits));
  }

  /// No suite could do more than hang.
  void tell_pop_waits(const QueueEntry& queue) {
    Result result = untried(queue);
    result.findings.push_back(
        {.claim = "pop answers on an empty queue",
         .evidence = "a pop on a new queue did not return for a second; the contract says that pop "
                     "answers false there, and calls a pop that waits pop_wait, which comes with "
                     "close() (queues/work_queue.hpp)",
         .repeat = "./irt stress" + queue_options(queue.name, options_.plugins)});
    fmt::print("{}", to_text(result));
    results_.push_back(std::move(result));
  }

  [[nodiscard]] std::vector<Job> plan(const QueueEntry& queue) const {
    std::vector<Job> jobs;
    if (chosen(options_.suites, "scenarios")) {
      for (const Scenario& scenario : scenarios())
        if (chosen(options_.scenarios, scenario.name) &&
            allows(queue.methods, queue.claims, scenario))
          jobs.push_back(scenario_job(scenario));
      for (const Scenario& scenario : contention_scenarios())
        if (named(options_.scenarios, scenario.name)) jobs.push_back(scenario_job(scenario));
    }
    // The others need signals that stop a thread at once and an allocator of our own.
    if (sanitizer != Sanitizer::none || !chosen(options_.scenarios, "all")) return jobs;
    const bool own = queue.claims.own_queues();
    if (chosen(options_.suites, "sustained")) {
      jobs.push_back({"sustained", nullptr, 6, run_sustained});
    }
    if (chosen(options_.suites, "progress")) {
      jobs.push_back({"progress", nullptr, own ? 0.1 : 4, run_progress});
    }
    if (chosen(options_.suites, "faults")) jobs.push_back({"faults", nullptr, 0.5, run_faults});
    if (chosen(options_.suites, "memory")) jobs.push_back({"memory", nullptr, 1.5, run_memory});
    return jobs;
  }

  static Job scenario_job(const Scenario& scenario) {
    return {"scenarios", &scenario, 1,
            [&scenario](const Assignment& a, Messenger& m) { run_scenario(a, scenario, m); }};
  }

  void run(const QueueEntry& queue, const Job& job, double seconds) {
    Result result;
    result.queue = queue.name;
    result.suite = job.suite;
    result.scenario = job.scenario != nullptr ? job.scenario->name : "";
    result.seed = options_.seed;
    result.third_party = is_third_party(queue.name);
    const std::string repeat = repeat_command(queue, job, seconds);
    const Assignment assignment{queue, clock_, seconds, options_.seed, repeat};
    const bool terminal = isatty(STDOUT_FILENO) != 0;
    const auto start = std::chrono::steady_clock::now();
    const auto progress = [&](std::uint64_t operations) {
      if (!terminal) return;
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
      fmt::print("\r{:<16} {:<30} {:>11} operations {:>9.0f}/s, {} findings\x1b[K", queue.name,
                 job.scenario != nullptr ? job.scenario->name : job.suite, operations,
                 static_cast<double>(operations) / passed.count(), found());
      std::fflush(stdout);
    };
    std::fflush(stdout);
    run_in_child(
        result, seconds, 30, [&](Messenger& m) { job.run(assignment, m); }, progress);
    for (BrokenClaim& finding : result.findings) finding.repeat = repeat;
    if (terminal) fmt::print("\r\x1b[K");
    fmt::print("{}", to_text(result));
    results_.push_back(std::move(result));
  }

  [[nodiscard]] std::size_t found() const {
    std::size_t sum = 0;
    for (const Result& result : results_) sum += result.findings.size();
    return sum;
  }

  [[nodiscard]] std::string repeat_command(const QueueEntry& queue, const Job& job,
                                           double seconds) const {
    std::string command = fmt::format("./irt stress{} --suite {}",
                                      queue_options(queue.name, options_.plugins), job.suite);
    if (job.scenario != nullptr) command += fmt::format(" --scenario {}", job.scenario->name);
    if (sanitizer != Sanitizer::none) command += fmt::format(" --sanitizer {}", sanitizer_name());
    return command +
           fmt::format(" --seed {} --seconds {:.0f}", options_.seed, std::max(1.0, 5 * seconds));
  }

  const Options& options_;
  const ClockQuality& clock_;
  std::vector<Result> results_;
};

void check_choice(const std::vector<std::string>& choice, std::string_view kind,
                  const std::vector<std::string_view>& known) {
  for (const std::string& name : choice) {
    if (std::ranges::find(known, name) == known.end())
      throw UsageError(unknown_name(kind, name, known));
  }
}

void check_names(const Options& options) {
  std::vector<std::string_view> known{"all"};
  for (const auto kind : {scenarios(), contention_scenarios()})
    for (const Scenario& scenario : kind) known.push_back(scenario.name);
  check_choice(options.scenarios, "scenario", known);
  known = {"all"};
  known.insert(known.end(), suite_names.begin(), suite_names.end());
  check_choice(options.suites, "suite", known);
  known.clear();
  for (const Mutant& mutant : mutants()) known.push_back(mutant.id);
  check_choice(options.kill.ids, "mutant", known);
  if (!options.sanitizer.empty() && options.sanitizer != sanitizer_name()) {
    throw UsageError(fmt::format(
        "--sanitizer {}: this program was built with '{}'; ./irt stress --sanitizer {} builds and "
        "runs the right one",
        options.sanitizer, sanitizer_name(), options.sanitizer));
  }
}

void list() {
  fmt::print("scenarios\n");
  for (const auto kind : {scenarios(), contention_scenarios()})
    for (const Scenario& s : kind) fmt::print("  {:<30} {}\n", s.name, s.summary);
  fmt::print("suites\n  {}\n", fmt::join(suite_names, ", "));
}

void tell_suppressions() {
  for (const Suppression& s : suppressions())
    fmt::print("  suppressed: {} ({}: {})\n", s.pattern, s.issue, s.reason);
}

void write(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  if (!file) throw UsageError(fmt::format("cannot write '{}'", path));
}

int stress_queues(const Options& options) {
  check_names(options);
  if (options.list) {
    list();
    return 0;
  }
  if (options.mutants) {
    KillOptions kill = options.kill;
    kill.seed = options.seed;
    kill.json = options.json;
    return kill_mutants(kill, calibrate()) ? 0 : 1;
  }
  QueueRegistry registry;
  for (const auto& plugin : options.plugins) registry.open(plugin);
  registry.prepare(options.queues);
  std::vector<const QueueEntry*> queues;
  for (const std::string& name : options.queues) {
    if (name == "all") {
      for (const QueueEntry& entry : registry.entries())
        queues.push_back(registry.find(entry.name));
    } else {
      queues.push_back(&registry.at(name));
    }
  }
  const ClockQuality clock = calibrate();
  fmt::print("{}\nsanitizer: {}, seed {}\n", clock.description, sanitizer_name(), options.seed);

  Session session(options, clock);
  // Ours first, the libraries' queues after them.
  std::stable_partition(queues.begin(), queues.end(),
                        [](const QueueEntry* queue) { return !is_third_party(queue->name); });
  bool third_party = false;
  for (const QueueEntry* queue : queues) {
    if (is_third_party(queue->name) && !std::exchange(third_party, true)) {
      fmt::print("third-party (findings are reported and do not fail the run)\n");
      if (sanitizer == Sanitizer::thread) tell_suppressions();
    }
    session.stress(*queue);
  }
  const nlohmann::json document{{"clock", clock.description},
                                {"sanitizer", sanitizer_name()},
                                {"seed", options.seed},
                                {"results", session.results()}};
  if (!options.json.empty()) write(options.json, document.dump(2) + "\n");
  if (!options.junit.empty()) write(options.junit, to_junit(session.results()));
  return session.broken() ? 1 : 0;
}

}  // namespace
}  // namespace irt::stress

namespace {

int parse_and_run(int argc, char** argv) {
  irt::stress::Options options;
  CLI::App app{"Tries to break what queues claim, on real threads. Exit code 1: a claim broke."};
  app.name("irt stress");
  app.add_option("-q,--queue", options.queues, "queues by name, or all")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--plugin", options.plugins, "shared objects with further queues");
  app.add_option("--scenario", options.scenarios, "scenarios by name, or all")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--suite", options.suites,
                 "scenarios, sustained, progress, faults, memory, or all")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--seconds", options.seconds, "for each queue")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--seed", options.seed, "of all random choices")->capture_default_str();
  app.add_option("--sanitizer", options.sanitizer, "none, tsan or asan: must be this build's");
  // ./irt stress --mutants runs the sanitizers' builds with a file of its own behind the user's.
  app.add_option("--json", options.json, "write the results to this file")->take_last();
  app.add_option("--junit", options.junit, "write JUnit XML to this file");
  app.add_flag("--mutants", options.mutants,
               "run queues with known bugs instead: which instrument finds which, and how soon");
  app.add_option("--mutant", options.kill.ids, "of --mutants: only these, by id");
  app.add_option("--runs", options.kill.runs, "of --mutants: how often each mutant runs")
      ->capture_default_str();
  app.add_option("--merge", options.kill.merge, "of --mutants: results of other builds (--json)");
  app.add_flag("--list", options.list, "show scenarios and suites, run nothing");
  if (const auto code = irt::parse(app, argc, argv)) return *code;
  return irt::stress::stress_queues(options);
}

}  // namespace

int main(int argc, char** argv) {
  return irt::run_program("irt stress", [&] { return parse_and_run(argc, argv); });
}
