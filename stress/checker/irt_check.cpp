// `irt check`: explores what a program or a queue can do, and answers with a proof for the bound or
// with the few steps that break it. Exit code 0: nothing found; 1: a finding; 2: a wrong command
// line, or code that cannot be looked at; 3: a crash of the checker.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "stress/checker/all_clients.hpp"
#include "stress/checker/batteries.hpp"
#include "stress/checker/mutants_check.hpp"
#include "stress/checker/parts.hpp"
#include "stress/checker/program_command.hpp"
#include "stress/checker/queue_check.hpp"
#include "stress/checker/scenario_search.hpp"
#include "stress/checker/test_host.hpp"
#include "stress/checker/verdict.hpp"
#include "stress/running/arguments.hpp"
#include "stress/running/program.hpp"
#include "stress/running/queue_options.hpp"
#include "stress/running/shard.hpp"
#include "stress/running/usage_error.hpp"
#include "stress/virtual_cores/queue_modules.hpp"

namespace {

namespace checker = irt::checker;
using nlohmann::json;

/// --seconds where queues are aged by 2^32 pairs and nothing else is said.
constexpr double seconds_for_old = 1200;

struct CommandLine {
  std::string queue;
  std::vector<std::string> plugins;
  std::string module;
  std::string program;  ///< as the user gave it, of which `module` was built; empty: a queue
  std::string tests;    ///< a module of tests, which explore
  std::vector<std::string> arguments;
  bool unfreed = false;
  std::string scenario;
  std::string element;  ///< the kind of elements; empty: words
  unsigned threads = 0;
  unsigned operations = 1;
  std::string strategy = "auto";
  std::string replay;
  std::string shard;
  std::string json_file;
  std::string sarif_file;
  std::string dot_file;
  std::vector<std::string> merge;
  bool mutate_orders = false;
  bool mutants = false;
  bool real_time = false;
  checker::KillSettings kill;
  checker::CheckSettings settings;
};

/// The directory of this program, where the checked queues lie beside it.
std::filesystem::path own_directory() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

/// The module that the line asks for: a file, a queue of the tree or of a plug-in.
std::string module_of(CommandLine& line) {
  if (!line.module.empty()) return line.module;
  irt::virtual_cores::QueueModules modules;
  for (const std::string& plugin : line.plugins) {
    const std::string name = modules.add(plugin);
    if (line.queue.empty() && line.plugins.size() == 1) line.queue = name;
  }
  if (line.queue.empty())
    throw irt::UsageError(
        fmt::format("which queue? --queue takes one of {}", fmt::join(modules.names(), ", ")));
  return modules.at(line.queue);
}

json to_json(const checker::ShapeResult& s) {
  const checker::Result& r = s.result;
  json j{{"origin", name_of(s.origin)},  {"shape", s.shape},
         {"search", s.search},           {"executions", r.executions},
         {"complete", r.complete},       {"blocked", r.blocked},
         {"inconsistent", r.cut},        {"seconds", r.seconds},
         {"finished", r.finished},       {"proved", s.proved},
         {"incomplete", r.incomplete},   {"explored", r.explored},
         {"histories", s.histories},     {"assumed_waits", r.assumed_waits},
         {"orders", r.exchanged.orders}, {"uneven", r.uneven}};
  if (r.finding) {
    j["finding"] = {{"kind", name_of(r.finding->kind)}, {"report", s.report}};
    j["schedule"] = to_string(r.schedule);
  }
  return j;
}

/// Adds up what the shards of one run wrote.
int merge(const std::vector<std::string>& files) {
  std::map<std::pair<std::string, std::string>, json> sums;
  bool found = false;
  for (const std::string& file : files) {
    std::ifstream in(file);
    const json part = json::parse(in, nullptr, false);
    if (part.is_discarded() || !part.is_object() || !part.contains("shapes"))
      throw irt::UsageError("--merge \"" + file +
                            "\": it is not what a run with --shard and --json wrote");
    for (const json& shape : part.at("shapes")) {
      json& sum = sums[{shape.at("shape"), shape.at("search")}];
      if (sum.is_null()) {
        sum = shape;
      } else {
        for (const char* key : {"executions", "complete", "blocked", "inconsistent"})
          sum[key] = sum[key].get<std::uint64_t>() + shape[key].get<std::uint64_t>();
        sum["seconds"] = std::max(sum["seconds"].get<double>(), shape["seconds"].get<double>());
        sum["finished"] = sum["finished"].get<bool>() && shape["finished"].get<bool>();
        if (shape.contains("finding")) sum["finding"] = shape["finding"];
      }
      found = found || shape.contains("finding");
    }
  }
  for (const auto& [key, sum] : sums)
    fmt::print("  {:<12} {:<11} {:>10} executions  {}\n", key.first, key.second,
               sum["executions"].get<std::uint64_t>(),
               sum.contains("finding")       ? sum["finding"]["kind"].get<std::string>()
               : sum["finished"].get<bool>() ? "finished"
                                             : "not finished");
  for (const auto& [key, sum] : sums)
    if (sum.contains("finding")) std::cout << '\n' << sum["finding"]["report"].get<std::string>();
  return found ? 1 : 0;
}

void prepare(CommandLine& line) {
  checker::CheckSettings& settings = line.settings;
  if (line.real_time) settings.real_time = true;
  if (line.strategy != "auto") settings.search = checker::search_named(line.strategy);
  if (!line.scenario.empty() && (settings.search == checker::Search::exhaustive ||
                                 settings.search == checker::Search::bounded))
    throw irt::UsageError(fmt::format(
        "--strategy {}: scenarios are too large for it; they are sampled by pos, pct or "
        "random",
        line.strategy));
  for (const std::string& shape : settings.shapes) checker::parse_shape(shape);
  if (!line.shard.empty()) {
    checker::Options& options = settings.options;
    const irt::Shard part = irt::parse_shard(line.shard);
    options.shard = part.index;
    options.shards = part.count;
    settings.progress = settings.progress && options.shard == 0;
    // One part might find that equal threads are not, and the others, elsewhere, rely on it.
    options.symmetry = false;
  }
  if (line.program.empty()) line.module = module_of(line);
}

int run_mutants(CommandLine& line) {
  irt::virtual_cores::Module module(own_directory() / "irt_mutants_module.so");
  line.kill.seconds = line.settings.seconds;
  if (!line.json_file.empty() && !line.kill.default_only)
    throw irt::UsageError("--json with --mutants needs --default-search, whose results it keeps");
  line.kill.json = line.json_file;
  return kill_matrix(module, line.kill) ? 0 : 1;
}

int run_scenario(const CommandLine& line, const irt::QueueEntry& entry,
                 irt::virtual_cores::Module& module, const std::string& command) {
  const checker::CheckSettings& settings = line.settings;
  if (!irt::stress::has_elements(entry.claims))
    throw irt::UsageError(fmt::format(
        "queue {} leaves too many bits of its elements unused for a scenario", entry.name));
  const irt::stress::Scenario& scenario = checker::scenario_at(line.scenario, entry);
  if (!line.replay.empty()) {
    const std::string report =
        checker::replay(entry, module, scenario, settings, line.replay, line.dot_file);
    std::cout << (report.empty() ? std::string(checker::stale_schedule) : report);
    return report.empty() ? 0 : 1;
  }
  if (!settings.quiet)
    fmt::print("{}: {}\nscenario {}: {}\n", entry.name, entry.summary, scenario.name,
               scenario.summary);
  const checker::ShapeResult result =
      checker::sample_scenario(entry, module, scenario, settings, command);
  if (result.result.finding) std::cout << '\n' << result.report;
  if (!settings.quiet)
    fmt::print("\n{}: {} in {} executions of scenario {}{}.\n", entry.name,
               result.result.finding ? "a finding" : "nothing found", result.result.executions,
               scenario.name, result.result.finding ? "" : "; samples prove nothing");
  if (!line.json_file.empty())
    std::ofstream(line.json_file) << json{{"queue", entry.name},
                                          {"found", result.result.finding.has_value()},
                                          {"seed", settings.options.seed},
                                          {"capacity", settings.capacity},
                                          {"shapes", json::array({to_json(result)})}}
                                         .dump(2)
                                  << '\n';
  return result.result.finding ? 1 : 0;
}

/// `entry` as a queue of elements of the kind `name`; as it is where that is empty.
irt::QueueEntry with_elements(const irt::QueueEntry& entry, const std::string& name) {
  if (name.empty()) return entry;
  for (const irt::ElementKind& kind : irt::element_kinds(entry)) {
    if (kind.name != name) continue;
    if (kind.make_queue != nullptr) return irt::through_elements(entry, kind);
    throw irt::UsageError(fmt::format(
        "--element {}: queue {} does not claim to take elements {}; its claims would say "
        ".elements = {{.{} = true}}",
        name, entry.name, kind.words, name));
  }
  throw irt::UsageError("--element " + name + ": there are large, owner and copied");
}

/// How the user calls this again for the same program, but for what is to be found.
std::string program_command(const CommandLine& line) {
  const checker::Limits& limits = line.settings.options.limits;
  std::string command = "irt check " + line.program;
  if (const char* given = std::getenv("IRT_PROGRAM_GIVEN"))  // NOLINT(concurrency-mt-unsafe)
    command = std::string("irt check ") + given;
  if (line.threads != 0) command += fmt::format(" --threads {}", line.threads);
  if (!limits.races) command += " --allow-races";
  if (limits.reuse_memory) command += " --reuse";
  if (limits.spurious_wakeups) command += " --spurious";
  if (limits.weak_may_fail) command += " --weak";
  if (!limits.leaks) command += " --no-leaks";
  if (limits.failing_allocations != 0)
    command += fmt::format(" --failing-allocations {}", limits.failing_allocations);
  return command;
}

int run_program(const CommandLine& line) {
  const checker::CheckSettings& settings = line.settings;
  if (settings.search == checker::Search::exhaustive || !settings.search) {
    // Both are about shapes of queues.
    if (settings.all_clients != 0 || !settings.shapes.empty() || !line.scenario.empty())
      throw irt::UsageError("a program has no shapes, scenarios or clients; --queue takes a queue");
  }
  checker::ProgramCommand command{.module = line.module,
                                  .command = program_command(line),
                                  .replay = line.replay,
                                  .dot_file = line.dot_file,
                                  .json_file = line.json_file,
                                  .sarif_file = line.sarif_file,
                                  .settings = {.name = line.program,
                                               .arguments = line.arguments,
                                               .search = settings.search,
                                               .seconds = settings.seconds,
                                               .unfreed = line.unfreed,
                                               .conduct = {.jobs = settings.jobs,
                                                           .keep_going = settings.keep_going,
                                                           .quiet = settings.quiet,
                                                           .reports = true},
                                               .options = settings.options}};
  if (line.threads != 0) command.settings.threads = line.threads;
  if (command.settings.threads > checker::most_program_threads)
    throw irt::UsageError(fmt::format("--threads {}: a program has at most {}", line.threads,
                                      checker::most_program_threads));
  for (const std::string& argument : line.arguments)
    command.command += (&argument == line.arguments.data() ? " -- " : " ") + argument;
  return checker::run_program_command(command);
}

int run(const CommandLine& line) {
  irt::virtual_cores::Module module(line.module);
  const irt::QueueEntry entry = with_elements(irt::virtual_cores::queue_of(module), line.element);
  if (!entry.claims.carries_elements)
    throw irt::UsageError(fmt::format(
        "queue {} only counts and carries nothing; irt bench alone can use it", entry.name));
  checker::CheckSettings settings = line.settings;
  if (line.threads != 0) {
    const std::string shape = checker::even_shape(entry.claims, line.threads, line.operations);
    if (shape.empty())
      throw irt::UsageError(
          fmt::format("--threads {}: queue {} is for one producer and one consumer, so that "
                      "a third thread would have nothing to do; --threads 2, or a --shape",
                      line.threads, entry.name));
    settings.shapes.push_back(shape);
  }
  for (const std::string& text : settings.shapes) {
    const checker::Shape shape = checker::parse_shape(text);
    if (const std::string why = checker::obstacle(entry.methods, shape); !why.empty())
      throw irt::UsageError(fmt::format("shape \"{}\", queue {}: {}", text, entry.name, why));
    if (checker::may_starve(shape, entry.claims, settings.capacity))
      throw irt::UsageError(fmt::format(
          "shape \"{}\": a waiting pop (P) may be left without an element whatever the queue does; "
          "a shape pushes as many as are popped, for certain and with room for them, or closes the "
          "queue (C) before anybody waits",
          text));
  }
  std::string command = "irt check" + irt::queue_options(entry.name, line.plugins);
  if (line.queue.empty()) command = "irt check --module " + line.module;
  if (settings.capacity != checker::CheckSettings{}.capacity)
    command += fmt::format(" --capacity {}", settings.capacity);
  if (!settings.options.limits.races) command += " --allow-races";
  if (settings.options.limits.reuse_memory) command += " --reuse";
  if (settings.options.limits.spurious_wakeups) command += " --spurious";
  if (settings.options.limits.weak_may_fail) command += " --weak";
  if (line.real_time) command += " --real-time";
  if (!line.element.empty()) command += " --element " + line.element;
  if (settings.options.limits.failing_allocations != 0)
    command +=
        fmt::format(" --failing-allocations {}", settings.options.limits.failing_allocations);

  if (!line.scenario.empty())
    return run_scenario(line, entry, module, command + " --scenario " + line.scenario);
  if (!line.replay.empty()) {
    if (settings.shapes.size() != 1)
      throw irt::UsageError("--replay needs the --shape it was found with");
    const std::string report = checker::replay(entry, module, settings, settings.shapes.front(),
                                               line.replay, line.dot_file);
    if (report.empty()) {
      std::cout << checker::stale_schedule;
      return 0;
    }
    std::cout << report;
    return 1;
  }
  if (!settings.quiet) fmt::print("{}: {}\n", entry.name, entry.summary);
  if (line.mutate_orders) {
    const std::size_t unneeded = checker::mutate_orders(entry, module, settings);
    fmt::print("{} orders are stronger than this battery needs.\n", unneeded);
    return 0;
  }
  const checker::QueueResult result = checker::check_queue(entry, module, settings, command);
  if (!result.unseen.refused.empty())
    throw irt::UsageError(
        fmt::format("queue {} cannot be checked: {}", entry.name, result.unseen.refused));
  for (const checker::ShapeResult& shape : result.shapes)
    if (!shape.report.empty()) std::cout << '\n' << shape.report;
  if (!settings.quiet) std::cout << words(result.unseen);
  const std::string verdict = checker::verdict(entry.name, result);
  if (!settings.quiet) fmt::print("\n{}\n", verdict);
  if (!line.json_file.empty()) {
    json j{{"verdict", verdict},
           {"queue", entry.name},
           {"found", result.found},
           {"seed", settings.options.seed},
           {"capacity", settings.capacity},
           {"unseen", result.unseen.calls},
           {"unseen_instructions", result.unseen.instructions},
           {"shapes", json::array()}};
    for (const checker::ShapeResult& shape : result.shapes) j["shapes"].push_back(to_json(shape));
    std::ofstream(line.json_file) << j.dump(2) << '\n';
  }
  return result.found ? 1 : 0;
}

int run(int argc, char** argv) {
  CommandLine line;
  checker::CheckSettings& settings = line.settings;
  settings.jobs = checker::processors();
  CLI::App app{
      "Explores every behaviour of a program, or of a queue within a bound; docs/checker.md says "
      "what a "
      "pass means."};
  app.name("irt check");
  auto* queue = app.add_option("--queue", line.queue, "a queue of `irt list`");
  auto* plugins = app.add_option("--plugin", line.plugins,
                                 "shared objects that irt_add_plugin() built, with further queues");
  app.add_option("--module", line.module, "or a shared object made by irt_virtual_module()")
      ->check(CLI::ExistingFile)
      ->excludes(queue)
      ->excludes(plugins);
  app.add_option("--program", line.program,
                 "what the module is of that --module names, if it is a program and no queue; "
                 "`irt check test.cpp` builds it and says so itself");
  app.add_option("--tests", line.tests,
                 "run a shared object that irt_add_check() built of tests that explore")
      ->check(CLI::ExistingFile);
  app.add_option("arguments", line.arguments, "of the program, or of the tests, after --");
  auto* shapes = app.add_option(
      "--shape", settings.shapes,
      "threads as letters, e.g. EE|D|DE; E push, D pop, R pop one and push two, S signal, "
      "W wait for it, ...; EE:D|D pushes two first (all letters: docs/checker.md; default: a "
      "battery by the queue's claims)");
  app.add_option("--scenario", line.scenario,
                 "instead of shapes a scenario of `irt stress`, sampled (docs/stress.md has them)")
      ->excludes(shapes);
  app.add_option(
      "--threads", line.threads,
      "of a program: at most, that of main included (default: 8); of a queue: a shape of "
      "that many threads instead ...");
  app.add_option("--ops", line.operations, "... each with that many pushes, then as many pops");
  app.add_option("--strategy", line.strategy,
                 "auto: exhaustive; where time runs out, bounded, pos and pct")
      ->check(CLI::IsMember({"auto", "exhaustive", "bounded", "random", "pct", "pos"}))
      ->capture_default_str();
  const auto* seconds =
      app.add_option("--seconds", settings.seconds, "for all shapes and searches together")
          ->capture_default_str();
  app.add_option("--executions", settings.options.executions, "at most, for each shape and search");
  app.add_option("--budget", settings.options.budget,
                 "deviations of the bounded search: preemptions, stale reads, ...")
      ->capture_default_str();
  app.add_option("--seed", settings.options.seed, "of the random searches")->capture_default_str();
  app.add_option("--capacity", settings.capacity,
                 "of the queue, in elements (default: 1, or what the prologue pushes)");
  app.add_option("--replay", line.replay, "a schedule of an earlier report");
  app.add_option("--dot", line.dot_file, "with --replay: write the execution graph for Graphviz");
  app.add_option("--json", line.json_file, "write the results to this file");
  app.add_option(
      "--sarif", line.sarif_file,
      "of a program: write its findings to this file as SARIF, for a CI to show at their "
      "lines");
  app.add_option("--jobs", settings.jobs,
                 "processes that share each search (default: all processors)")
      ->check(CLI::PositiveNumber);
  app.add_option("--shard", line.shard, "i/n: the i-th of n parts of the work");
  app.add_option("--merge", line.merge, "add up the JSON files of all shards");
  app.add_flag("--mutate-orders", line.mutate_orders,
               "weaken each memory order in turn and say what breaks");
  auto* mutants = app.add_flag("--mutants", line.mutants,
                               "queues with known bugs: which search finds which, and how soon");
  app.add_option("--mutant", line.kill.ids, "of --mutants: only these, by id")->needs(mutants);
  app.add_option("--seeds", line.kill.seeds, "of --mutants: runs of each random search")
      ->needs(mutants)
      ->capture_default_str();
  app.add_flag("--default-search", line.kill.default_only,
               "of --mutants: only what a check does by default, with as many seeds")
      ->needs(mutants);
  app.add_flag("!--no-progress", settings.progress, "do not stop threads to test progress claims");
  app.add_flag("!--allow-races", settings.options.limits.races,
               "data races are no findings (a formal fault of some libraries)");
  app.add_flag("!--no-symmetry", settings.options.symmetry,
               "explore equal threads in every order, not only in one of each");
  app.add_flag("!--no-leaks", settings.options.limits.leaks, "memory that is lost is no finding");
  app.add_flag("--unfreed", line.unfreed,
               "of a program: memory that is lost is a finding, too, where nothing of the kind is "
               "ever freed");
  app.add_flag("--reuse", settings.options.limits.reuse_memory,
               "a thread may get its freed memory back at once (ABA)");
  auto* failing =
      app.add_option("--failing-allocations", settings.options.limits.failing_allocations,
                     "so many allocations of an execution may fail (default: 1, in a "
                     "search of its own; 0: none)");
  app.add_flag("--keep-going", settings.keep_going,
               "do not stop at the first finding: report each kind and place once");
  app.add_option("--all-clients", settings.all_clients,
                 "instead of the battery, every client of at most so many calls")
      ->check(CLI::Range(1U, checker::most_calls));
  app.add_flag("--old", settings.old,
               fmt::format("age queues by nearly 2^32 pairs of a push and a pop, not 2^16, which "
                           "takes minutes: --seconds is {} then",
                           seconds_for_old));
  app.add_option("--element", line.element,
                 "large, owner or copied: with elements of 64 bytes, that own memory and move, or "
                 "that are copied and may throw, of queues that claim to take them");
  app.add_flag("--real-time", line.real_time,
               "order calls by a clock too (default: in a search of its own, if the queue claims "
               "fifo_real_time)");
  app.add_flag("--spurious", settings.options.limits.spurious_wakeups,
               "waits may end for no reason");
  app.add_flag("--weak", settings.options.limits.weak_may_fail,
               "compare_exchange_weak may fail for no reason");
  app.add_flag("--quiet", settings.quiet, "print findings only");
  if (const auto code = irt::parse(app, argc, argv)) return *code;
  settings.no_memory = failing->count() == 0;
  if (settings.old && seconds->count() == 0) settings.seconds = seconds_for_old;
  if (!line.tests.empty()) {
    std::vector<std::string> words{line.tests};
    words.insert(words.end(), line.arguments.begin(), line.arguments.end());
    return checker::run_tests(line.tests, words);
  }
  if (!line.merge.empty()) return merge(line.merge);
  if (line.mutants) return run_mutants(line);
  prepare(line);
  return line.program.empty() ? run(line) : run_program(line);
}

}  // namespace

int main(int argc, char** argv) {
  return irt::run_program("irt check", [&] { return run(argc, argv); });
}
