#include "bench/contention/sweep.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <set>
#include <unistd.h>

#include "bench/conditions/conditions.hpp"
#include "bench/contention/busy_wait.hpp"
#include "bench/contention/subjects.hpp"
#include "bench/contention/summary.hpp"
#include "bench/contention/turns.hpp"
#include "bench/running/interrupt.hpp"
#include "bench/running/journal.hpp"
#include "bench/running/progress.hpp"
#include "bench/running/text_files.hpp"
#include "bench/statistics/averages.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::contention {
namespace {

class Sweep {
 public:
  Sweep(const SweepOptions& options, QueueRegistry& queues, std::filesystem::path program)
      : options_(options), queues_(queues), program_(std::move(program)) {}

  int run() {
    const auto file = options_.out / "contention.jsonl";
    plan_ = options_.plan;
    settle(plan_, queues_, machine_);
    if (options_.resume) go_on(file);
    if (!journal_) {
      Rows settled = rows_of(plan_, queues_, machine_);
      rows_ = std::move(settled.rows);
      left_out_ = std::move(settled.left_out);
    }
    if (rows_.empty()) {
      throw UsageError(left_out_.empty()
                           ? "nothing to measure: this shard is empty, or --threads are too few "
                             "for the scenario"
                           : "nothing to measure: " + left_out_.front());
    }
    for (const auto& path : {file, options_.out / "contention.json"}) require_writable(path);
    if (!options_.json.empty()) require_writable(options_.json);
    if (!journal_) begin(file);
    if (!journal_) {
      fmt::print(stderr, "irt: interrupted before anything was measured\n");
      return exit_interrupted;
    }
    build_subjects();
    announce();
    measure_all();
    return report();
  }

 private:
  // Here, since several are built side by side; children open what is there.
  void build_subjects() const {
    std::vector<std::string> measured, counted;
    for (const Row& row : rows_) {
      measured.push_back(row.queue);
      if (row.not_countable.empty()) counted.push_back(row.queue);
    }
    queues_.prepare(measured, ModuleKind::contention);
    queues_.prepare(counted, ModuleKind::counted);
  }

  // Takes plan and results from the journal. What the user set on the command line must be what it
  // says.
  void go_on(const std::filesystem::path& file) {
    journal_ = Journal<Result>::resume(file, journal_format);
    const auto stored = journal_->header().at("plan").get<Plan>();
    const nlohmann::json before = stored, now = plan_;
    for (const std::string& name : options_.given) {
      require_same_option(name, before.at(name), now.at(name));
    }
    conditions_ = journal_->header().at("conditions");
    require_same_conditions(conditions_, conditions());
    for (const std::string& plugin : stored.plugins) {
      const bool open = std::ranges::find(plan_.plugins, plugin) != plan_.plugins.end();
      if (!open) queues_.open(plugin);
    }
    plan_ = stored;
    journal_->header().at("rows").get_to(rows_);
    journal_->header().at("calibration").get_to(calibration_);
  }

  void begin(const std::filesystem::path& file) {
    conditions_ = conditions();
    calibration_.pace = measure_pace();
    calibration_.harness_ns = harness_ns();
    if (cancel_) return;
    journal_ = Journal<Result>::begin(file, {{"format", journal_format},
                                             {"plan", plan_},
                                             {"rows", rows_},
                                             {"calibration", calibration_},
                                             {"conditions", conditions_}});
  }

  // What a sweep adds to each operation: the processor time of the loop with a queue that does
  // nothing, by one thread without work.
  double harness_ns() {
    std::vector<double> costs;
    for (int i = 0; i < 5 && !cancel_; ++i) {
      Job job;
      job.queue = no_queue;
      job.scenario = "pairs";
      job.capacity = 1;
      job.pace = calibration_.pace;
      job.seconds = 0.03;
      job.warmup_seconds = 0.06;
      const auto add = [&](std::size_t, const Sample& sample) {
        if (sample.operations() == 0) return;
        costs.push_back(sample.cpu_seconds * 1e9 / static_cast<double>(sample.operations()));
      };
      measure_in_turns(program_, {&job, 1}, job.seed, add, cancel_);
    }
    return costs.empty() ? 0 : statistics::median(costs);
  }

  [[nodiscard]] unsigned total() const {
    std::size_t all = 0;
    for (const Row& row : rows_) {
      for (unsigned i = 0; i < plan_.repetitions; ++i) all += passes_of(plan_, row, i).size();
    }
    return static_cast<unsigned>(all);
  }

  void announce() const {
    for (const std::string& line : left_out_) fmt::print(stderr, "irt: {}\n", line);
    fmt::print(stderr,
               "{} lines of {} repetitions, about {:.0f} s; the loop itself takes {:.2f} ns per "
               "operation, a step of the busy wait {:.2f} ns\n",
               rows_.size(), plan_.repetitions, total() * (1.15 * plan_.seconds + 0.15),
               calibration_.harness_ns, calibration_.pace.step_ns);
    announce_groups();
  }

  void announce_groups() const {
    std::map<unsigned, std::size_t> groups, lines;  // by cell
    for (const auto& group : groups_of(order_of(rows_, 0, plan_.seed), rows_, memory_bytes_)) {
      ++groups[rows_[group.front()].cell];
      lines[rows_[group.front()].cell] += group.size();
    }
    const auto most =
        std::ranges::max_element(groups, {}, [](const auto& of_cell) { return of_cell.second; });
    if (most->second == 1) return;
    fmt::print(stderr,
               "irt: {} queues are too many to take turns side by side: they do in {} groups, "
               "others in each repetition\n",
               lines[most->first], most->second);
  }

  [[nodiscard]] bool has(unsigned row, unsigned repetition, Pass pass) const {
    return std::ranges::any_of(journal_->results(), [&](const Result& result) {
      return result.row == row && result.repetition == repetition && result.pass == pass;
    });
  }
  // A queue that hung once would cost its patience again and again.
  [[nodiscard]] bool hopeless(unsigned row) const {
    return std::ranges::any_of(journal_->results(), [&](const Result& result) {
      return result.row == row && result.pass != Pass::counted && result.sample.status == "hung";
    });
  }

  void measure_all() {
    ProgressBar progress(total(), static_cast<unsigned>(journal_->results().size()));
    for (unsigned repetition = 0; repetition < plan_.repetitions; ++repetition) {
      const auto order = order_of(rows_, repetition, plan_.seed);
      for (const auto& group : groups_of(order, rows_, memory_bytes_)) {
        measure_group(group, repetition, Pass::plain, progress);
        for (const unsigned row : group) {
          for (const Pass pass : passes_of(plan_, rows_[row], repetition)) {
            if (pass != Pass::plain) measure_group({row}, repetition, pass, progress);
          }
        }
      }
    }
  }

  // One pass of those lines of a group that lack it.
  void measure_group(std::vector<unsigned> group, unsigned repetition, Pass pass,
                     ProgressBar& progress) {
    std::erase_if(group, [&](unsigned row) { return has(row, repetition, pass); });
    if (group.empty() || cancel_) return;
    const Row& first = rows_[group.front()];
    progress.show(fmt::format(
        "{}, {}, {} threads", first.scenario,
        group.size() == 1 ? first.queue : fmt::format("{} queues in turns", group.size()),
        first.cast.workers));
    const auto skipped = std::erase_if(group, [&](unsigned row) { return hopeless(row); });
    for (std::size_t i = 0; i < skipped; ++i) progress.step();
    std::vector<Job> jobs;
    jobs.reserve(group.size());
    for (const unsigned row : group) {
      jobs.push_back(job_of(plan_, rows_[row], repetition, calibration_.pace, pass));
    }
    const auto keep = [&](std::size_t i, const Sample& sample) {
      journal_->add({.row = group[i], .repetition = repetition, .pass = pass, .sample = sample});
      progress.step();
    };
    if (!jobs.empty()) measure_in_turns(program_, jobs, jobs.front().seed, keep, cancel_);
  }

  int report() {
    const auto runs = summarise(plan_, rows_, journal_->results(), calibration_, conditions_);
    std::FILE* const people = beside(options_.json);
    fmt::print(people, "{}\n", table(runs));
    std::set<std::string> missing;
    for (const Result& result : journal_->results()) {
      missing.insert(result.sample.missing.begin(), result.sample.missing.end());
    }
    for (const std::string& line : missing) fmt::print(people, "{}\n", line);
    fmt::print(
        people,
        "{} s per repetition after the warm-up; Mops/s: successful pushes and pops of all threads, "
        "mean of {} repetitions; the loop's own share is {:.2f} ns per operation\n",
        plan_.seconds, plan_.repetitions, calibration_.harness_ns);
    std::fflush(stdout);
    const std::string text = runs.dump(2) + '\n';
    write_text(options_.out / "contention.json", text);
    if (!options_.json.empty()) write_text(options_.json, text);
    fmt::print(stderr, "figures: {}\n", (options_.out / "contention.json").string());
    if (cancel_) {
      fmt::print(stderr,
                 "irt: interrupted after {} of {} measurements; go on with: irt bench contention "
                 "--resume --out {}\n",
                 journal_->results().size(), total(), options_.out.string());
      return exit_interrupted;
    }
    const bool broken =
        std::ranges::any_of(runs, [](const auto& run) { return run["status"] != "ok"; });
    return broken ? 1 : 0;
  }

  const SweepOptions& options_;
  QueueRegistry& queues_;
  std::filesystem::path program_;
  const std::atomic<bool>& cancel_ = watch_for_interrupt();
  Machine machine_ = survey_machine();
  // Half of the machine's memory is for the queues that wait for their turns.
  double memory_bytes_ =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 2;
  Plan plan_;
  std::vector<Row> rows_;
  std::vector<std::string> left_out_;
  Calibration calibration_;
  nlohmann::json conditions_;
  std::optional<Journal<Result>> journal_;
};

}  // namespace

int sweep(const SweepOptions& options, QueueRegistry& queues,
          const std::filesystem::path& program) {
  return Sweep(options, queues, program).run();
}

}  // namespace irt::contention
