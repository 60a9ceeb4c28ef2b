// `irt bench instructions`: what operations of a queue execute, function by function, counted by
// valgrind's callgrind: one thread, and the same figures every time.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "bench/conditions/conditions.hpp"
#include "bench/instructions/callgrind.hpp"
#include "bench/micro/second_thread.hpp"
#include "bench/running/text_files.hpp"
#include "queues/registry.hpp"
#include "stress/running/arguments.hpp"
#include "stress/running/child.hpp"
#include "stress/running/program.hpp"

static void push_and_pop(irt::AnyWorkQueue<std::uint64_t>& queue, unsigned bursts, unsigned burst,
                         std::uint64_t word) {
  std::uint64_t popped = 0;
  for (unsigned i = 0; i < bursts; ++i) {
    for (unsigned j = 0; j < burst; ++j) queue.push(0, word);
    for (unsigned j = 0; j < burst; ++j) queue.pop(0, popped);
  }
}

// Named in what callgrind is told to look at, so not inlined and with a plain name.
extern "C" __attribute__((noinline)) void irt_measured(irt::AnyWorkQueue<std::uint64_t>& queue,
                                                       unsigned bursts, unsigned burst,
                                                       std::uint64_t word) {
  push_and_pop(queue, bursts, burst, word);
}

namespace irt::instructions {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> queues;
  std::vector<std::string> plugins;
  unsigned burst = 1;
  unsigned operations = 20'000;
  std::string json_file;
  std::string measured;  ///< the queue that this process is to run under callgrind
};

QueueRegistry registry_with(const std::vector<std::string>& plugins) {
  QueueRegistry registry;
  for (const std::string& plugin : plugins) registry.open(plugin);
  return registry;
}

/// What runs under callgrind.
int be_measured(const Options& options) {
  const SecondThread second_thread;
  const QueueRegistry registry = registry_with(options.plugins);
  const QueueEntry& entry = registry.at_or_counter(options.measured);
  const auto queue = entry.make_word_queue(1, std::max(options.burst, 64U));
  const unsigned bursts = std::max(options.operations / 2 / options.burst, 1U);
  // A tenth as warm-up, of what allocators and free lists take once; callgrind is not yet looking.
  push_and_pop(*queue, bursts / 10 + 2, options.burst, entry.claims.some_word());
  irt_measured(*queue, bursts, options.burst, entry.claims.some_word());
  return 0;
}

bool has_valgrind() {
  return std::system("command -v valgrind >/dev/null") == 0;  // NOLINT(*-env33-c,concurrency-*)
}

/// A directory that goes with this object.
class Scratch {
 public:
  Scratch() {
    std::string name = fs::temp_directory_path() / "irt-XXXXXX";
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
    path_ = name;
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::vector<Function> profile(const std::string& queue, const Options& options) {
  const Scratch scratch;
  const fs::path out = scratch.path() / "profile";
  std::vector<std::string> words{"valgrind",
                                 "--tool=callgrind",
                                 "--quiet",
                                 "--cache-sim=yes",
                                 "--I1=32768,8,64",
                                 "--D1=32768,8,64",
                                 "--LL=8388608,16,64",
                                 "--collect-bus=yes",
                                 "--toggle-collect=irt_measured",
                                 "--compress-pos=no",
                                 "--compress-strings=no",
                                 "--callgrind-out-file=" + out.string(),
                                 fs::read_symlink("/proc/self/exe").string(),
                                 "--measured",
                                 queue,
                                 "--burst",
                                 std::to_string(options.burst),
                                 "--operations",
                                 std::to_string(options.operations)};
  for (const std::string& plugin : options.plugins) words.insert(words.end(), {"--plugin", plugin});
  if (Child([&](int) { become(words); }).wait() != 0)
    throw std::runtime_error("queue '" + queue +
                             "': valgrind did not finish; its message is above");
  std::ifstream file(out);
  return read_profile(file);
}

struct Row {
  double instructions, reads, writes, locked, first_level_misses, last_level_misses;
};

Row per_operation(const Events& events, double operations) {
  const auto each = [&](std::initializer_list<const char*> names) {
    double sum = 0;
    for (const char* name : names)
      if (const auto found = events.find(name); found != events.end())
        sum += static_cast<double>(found->second);
    return sum / operations;
  };
  return {each({"Ir"}), each({"Dr"}),           each({"Dw"}),
          each({"Ge"}), each({"D1mr", "D1mw"}), each({"DLmr", "DLmw"})};
}

json to_json(const std::string& name, const Row& row) {
  return {{"name", name},
          {"instructions_per_operation", row.instructions},
          {"reads_per_operation", row.reads},
          {"writes_per_operation", row.writes},
          {"locked_per_operation", row.locked},
          {"l1_misses_per_operation", row.first_level_misses},
          {"ll_misses_per_operation", row.last_level_misses}};
}

void print(std::FILE* out, const std::string& name, const Row& row) {
  fmt::print(out, "{:<52.52}{:>9.2f}{:>8.2f}{:>8.2f}{:>8.2f}{:>9.4f}{:>9.4f}\n", name,
             row.instructions, row.reads, row.writes, row.locked, row.first_level_misses,
             row.last_level_misses);
}

/// Without parameters and template arguments, which fill lines.
std::string short_name(const std::string& name) {
  std::string kept;
  int depth = 0;
  for (const char letter : name) {
    if (letter == '<' || letter == '(') ++depth;
    if (depth == 0) kept += letter;
    if (letter == '>' || letter == ')') --depth;
  }
  return kept.empty() ? name : kept;
}

json measure(const std::string& queue, const Options& options, const json& conditions) {
  std::FILE* const out = beside(options.json_file);
  const std::vector<Function> functions = profile(queue, options);
  const unsigned bursts = std::max(options.operations / 2 / options.burst, 1U);
  const double operations = 2.0 * bursts * options.burst;
  const Row all = per_operation(total(functions), operations);
  json run = to_json(queue, all);
  run.update({{"kind", "instructions"},
              {"source", "simulated"},
              {"queue", queue},
              {"scenario", "bursts"},
              {"burst", options.burst},
              {"threads", 1},
              {"operations", operations},
              {"status", "ok"},
              {"conditions", conditions},
              {"functions", json::array()}});
  run.erase("name");
  print(out, queue, all);
  for (const Function& function : functions) {
    const Row row = per_operation(function.own, operations);
    run["functions"].push_back(to_json(function.name, row));
    constexpr double shown = 0.02;
    if (row.instructions >= shown * all.instructions)
      print(out, "  " + short_name(function.name), row);
  }
  return run;
}

int run(int argc, char** argv) {
  CLI::App app(
      "Counts what a push or a pop executes, by function, under valgrind's callgrind: one thread,\n"
      "simulated caches of 32 KiB and 8 MiB, the same figures every time.",
      "irt bench instructions");
  Options options;
  app.add_option("--queue,--queues", options.queues, "queues by name (default: all)")
      ->delimiter(',');
  app.add_option("--plugin", options.plugins,
                 "shared objects that irt_add_plugin() built, with further queues");
  app.add_option("--burst", options.burst, "pushes in a row, then as many pops")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app.add_option("--operations", options.operations, "pushes and pops together")
      ->check(CLI::Range(2, 100'000'000))
      ->capture_default_str();
  app.add_option("--json", options.json_file,
                 "write all figures to this file; - for standard output");
  app.add_option("--measured", options.measured)->group("");
  if (const auto code = parse(app, argc, argv)) return *code;
  if (!options.measured.empty()) return be_measured(options);
  const QueueRegistry registry = registry_with(options.plugins);
  registry.prepare(options.queues);
  for (const std::string& name : options.queues) registry.at_or_counter(name);
  if (!has_valgrind())
    throw std::runtime_error("valgrind is missing; the package valgrind brings it");
  if (options.queues.empty())
    for (const QueueEntry& entry : registry.entries()) options.queues.emplace_back(entry.name);
  if (!options.json_file.empty()) require_writable(options.json_file);
  std::FILE* const out = beside(options.json_file);
  fmt::print(out,
             "For each operation, one thread, through the type-erased face:\n"
             "{:<52}{:>9}{:>8}{:>8}{:>8}{:>9}{:>9}\n",
             "queue, and its functions from 2 %", "instr.", "reads", "writes", "locked", "L1 miss",
             "LL miss");
  json runs = json::array();
  const json now = conditions();
  for (const std::string& queue : options.queues) {
    runs.push_back(measure(queue, options, now));
    std::fflush(out);
  }
  if (!options.json_file.empty()) write_text(options.json_file, runs.dump(2) + "\n");
  return 0;
}

}  // namespace
}  // namespace irt::instructions

int main(int argc, char** argv) {
  return irt::run_program("irt bench instructions",
                          [&] { return irt::instructions::run(argc, argv); });
}
