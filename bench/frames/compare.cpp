#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <memory>
#include <optional>

#include "bench/conditions/conditions.hpp"
#include "bench/frames/commands.hpp"
#include "bench/frames/files.hpp"
#include "bench/frames/sample.hpp"
#include "bench/frames/summary.hpp"
#include "bench/running/interrupt.hpp"
#include "bench/running/journal.hpp"
#include "bench/running/progress.hpp"
#include "bench/running/text_files.hpp"
#include "bench/statistics/averages.hpp"
#include "stress/running/child_process.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::frames {
namespace {

using Clock = std::chrono::steady_clock;

// What becomes one line of the table.
struct Row {
  unsigned workload;
  std::string queue;  // "-" where the task system needs none
  unsigned threads;
};

// What is measured, settled to the last choice; stands at the head of the journal.
struct Plan {
  std::vector<WorkloadOptions> workloads;
  std::vector<std::string> queues;
  std::vector<unsigned> threads;
  std::vector<std::string> plugins;
  unsigned frames = 0, repetitions = 0, warmup = 0;
  Shard shard;

  // Those of the shard.
  [[nodiscard]] std::vector<Row> rows() const {
    std::vector<Row> all;
    for (unsigned workload = 0; workload < workloads.size(); ++workload) {
      const std::vector<std::string> none{"-"};
      for (const std::string& queue : uses_queue(workloads[workload]) ? queues : none) {
        for (unsigned i = 0; i < threads.size(); ++i) {
          const auto number = workload * static_cast<unsigned>(threads.size()) + i;
          if (number % shard.count == shard.index) all.push_back({workload, queue, threads[i]});
        }
      }
    }
    return all;
  }
  [[nodiscard]] unsigned samples() const {
    return static_cast<unsigned>(rows().size()) * repetitions;
  }
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(Plan, workloads, queues, threads, plugins, frames,
                                                repetitions, warmup, shard)

// What the first frame of a workload told.
struct Reference {
  std::string image_hash;
  std::size_t triangles = 0;
  double traverse_share = 0;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Reference, image_hash, triangles, traverse_share)

struct FirstFrame {
  double seconds = 0;
  std::vector<double> later;  // what later ones take with each number of threads
  Reference reference;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FirstFrame, seconds, later, reference)

// 1, 2, 4 ... and the number of hardware threads itself; each number where there are few.
std::vector<unsigned> default_threads() {
  const unsigned most = settle_threads(0);
  std::vector<unsigned> threads;
  for (unsigned n = 1; n < most; n += most <= 4 ? 1 : n) threads.push_back(n);
  threads.push_back(most);
  return threads;
}

// The queues of the thesis, the null hypothesis and one queue of each library that everyone has;
// and the user's own.
std::vector<std::string> default_queues(const QueueRegistry& queues) {
  std::vector<std::string> names;
  for (const char* name : {"lock", "lfree", "local", "mutex", "tbb", "boost-lockfree"}) {
    if (queues.has(name, ModuleKind::plugin)) names.emplace_back(name);
  }
  for (std::string& plugin : queues.plugins()) names.push_back(std::move(plugin));
  return names;
}

Plan plan_of(const CompareOptions& options, const QueueRegistry& queues) {
  Plan plan{.workloads = options.workloads,
            .queues = options.queues,
            .threads = options.threads,
            .plugins = options.plugins,
            .frames = options.frames,
            .repetitions = options.repetitions,
            .warmup = options.warmup,
            .shard = options.shard};
  for (WorkloadOptions& workload : plan.workloads) check(workload);
  if (plan.queues.empty()) plan.queues = default_queues(queues);
  queues.prepare(plan.queues);
  for (const std::string& name : plan.queues) queues.at(name);
  if (!options.queues.empty() && std::ranges::none_of(plan.workloads, uses_queue)) {
    check_queue(options.queues.front(), plan.workloads.front());
  }
  if (plan.threads.empty()) plan.threads = default_threads();
  for (const unsigned threads : plan.threads) settle_threads(threads);
  if (plan.rows().empty()) {
    throw UsageError(fmt::format(
        "--shard {}/{}: nothing is left for it; there are {} workloads with {} numbers of threads",
        plan.shard.index, plan.shard.count, plan.workloads.size(), plan.threads.size()));
  }
  return plan;
}

// What `plan` has for `key`: of workloads every value once, or the only one.
nlohmann::json value_of(const nlohmann::json& plan, const std::string& key) {
  if (plan.contains(key)) return plan.at(key);
  auto values = nlohmann::json::array();
  for (const nlohmann::json& workload : plan.at("workloads")) {
    if (!workload.contains(key)) return nullptr;
    const nlohmann::json& value = workload.at(key);
    if (std::ranges::find(values, value) == values.end()) values.push_back(value);
  }
  return values.size() == 1 ? values.front() : values;
}

// The plan of a journal. What the user set on the command line must be what it says.
Plan plan_of(const Journal<Sample>& journal, const CompareOptions& options, QueueRegistry& queues) {
  auto stored = journal.header().at("plan").get<Plan>();
  for (const std::string& plugin : stored.plugins) {
    if (std::ranges::find(options.plugins, plugin) == options.plugins.end()) queues.open(plugin);
  }
  const nlohmann::json before = stored, now = plan_of(options, queues);
  for (const std::string& name : options.given) {
    std::vector<std::string> keys{name};
    if (name == "size") keys = {"width", "height"};
    for (const std::string& key : keys) {
      require_same_option(key, value_of(before, key), value_of(now, key));
    }
  }
  return stored;
}

// Frames per repetition such that everything takes about `seconds`. `frames` says what one of each
// workload takes with each number of threads.
void settle_length(Plan& plan, const std::vector<std::vector<double>>& frames, double seconds) {
  double sweep = 0;  // one frame of every row
  for (const Row& row : plan.rows()) {
    const auto threads = std::ranges::find(plan.threads, row.threads) - plan.threads.begin();
    sweep += frames[row.workload][static_cast<std::size_t>(threads)];
  }
  if (plan.frames == 0) {
    const double fit = seconds / (sweep * plan.repetitions) - plan.warmup;
    plan.frames = static_cast<unsigned>(std::clamp(fit, 1.0, 1e6));
  }
}

class Comparison {
 public:
  Comparison(const CompareOptions& options, QueueRegistry& queues)
      : options_(options), queues_(queues) {}

  int run() {
    const auto file = options_.out / "runs.jsonl";
    if (options_.resume) {
      journal_ = Journal<Sample>::resume(file, journal_format);
      plan_ = plan_of(*journal_, options_, queues_);
    } else {
      plan_ = plan_of(options_, queues_);
    }
    for (const char* name : {"runs.jsonl", "compare.json", "compare.csv", "frame.png"}) {
      require_writable(options_.out / name);
    }
    if (!options_.json.empty()) require_writable(options_.json);
    conditions_ = conditions(plan_.workloads.front().pin ? "one thread per core" : "none");
    if (journal_) require_same_conditions(journal_->header().at("conditions"), conditions_);

    for (const WorkloadOptions& workload : plan_.workloads) {
      workloads_.push_back(std::make_unique<Workload>(workload));
    }
    first_frames(file);
    if (journal_) sweep();
    if (!journal_ || journal_->results().empty()) {
      fmt::print(stderr, "irt: interrupted before anything was measured\n");
      return exit_interrupted;
    }
    return report();
  }

 private:
  [[nodiscard]] const QueueEntry& queue_of(const Row& row) const {
    return queues_.at(row.queue == "-" ? plan_.queues.front() : row.queue);
  }

  // Renders every workload once, and with a new plan settles what is still open and begins the
  // journal.
  void first_frames(const std::filesystem::path& file) {
    const unsigned threads = *std::ranges::max_element(plan_.threads);
    const double cores = std::min<double>(threads, settle_threads(0));
    std::vector<Reference> references;
    std::vector<std::vector<double>> later;
    for (const auto& workload : workloads_) {
      const std::optional<FirstFrame> first = first_frame(*workload, threads, references.empty());
      if (!first) return;
      references.push_back(first->reference);
      work_.push_back(first->seconds * cores);
      later.push_back(first->later);
    }
    if (journal_) {
      journal_->header().at("references").get_to(references_);
      for (std::size_t i = 0; i < references.size(); ++i) {
        if (!exact(i) || references_[i].image_hash == references[i].image_hash) continue;
        throw UsageError(
            "--resume: the scene gives another picture than before; start without "
            "--resume");
      }
      return;
    }
    if (cancel_) return;
    references_ = std::move(references);
    settle_length(plan_, later, options_.seconds);
    journal_ = Journal<Sample>::begin(file, {{"format", journal_format},
                                             {"plan", plan_},
                                             {"references", references_},
                                             {"conditions", conditions_}});
  }

  // Rendered with a queue of ours, not with one that is to be tried, and like all frames in a
  // process of its own; nothing if interrupted.
  std::optional<FirstFrame> first_frame(Workload& workload, unsigned threads, bool keep_picture) {
    constexpr double a_day = 86'400;
    const QueueEntry& queue = queues_.first();
    const Ending ending = in_child(a_day, cancel_, [&] {
      const Sample first = take_sample(workload, queue, {.threads = threads, .warmup = 0}, cancel_);
      if (keep_picture) write_png(options_.out / "frame.png", workload.application().image());
      const double work = first.seconds.at(0) * std::min<double>(threads, settle_threads(0));
      const FirstFrame answer{
          .seconds = first.seconds.at(0),
          .later = later_frames(workload, work),
          .reference = {
              .image_hash = first.image_hash,
              .triangles = workload.scene().mesh.triangles.size(),
              .traverse_share = traverse_share(workload, queue, threads, cancel_).value_or(0)}};
      return nlohmann::json(answer).dump();
    });
    if (cancel_) return std::nullopt;
    if (ending.status != "ok") {
      throw UsageError(fmt::format("the first frame {}: {}; try fewer threads or a smaller scene",
                                   ending.status, ending.message));
    }
    if (keep_picture) show_first_frame(workload);
    return nlohmann::json::parse(ending.answer).get<FirstFrame>();
  }

  // What a frame of a repetition takes with each number of threads, by the wall clock, hash and
  // all. The first frame finds nothing in the caches and may be disturbed, so of a small scene it
  // says many times that; only of a long one it tells enough.
  std::vector<double> later_frames(Workload& workload, double first) {
    const auto parts = static_cast<double>(plan_.workloads.size() * plan_.threads.size());
    const double enough = std::clamp(0.05 * options_.seconds / parts, 0.02, 0.5);
    std::vector<double> seconds;
    for (const unsigned threads : plan_.threads) {
      const double expected = first / std::min<double>(threads, settle_threads(0));
      const bool known = plan_.frames != 0 || expected >= std::max(2 * enough, 0.25);
      seconds.push_back(known ? expected : frame_seconds(workload, threads, expected, enough));
    }
    return seconds;
  }

  // The median of as many frames as fit into `enough` seconds if each takes `expected`, of three at
  // least; `expected` if interrupted.
  double frame_seconds(Workload& workload, unsigned threads, double expected, double enough) {
    const auto frames = static_cast<unsigned>(std::clamp(enough / expected, 3.0, 1000.0));
    std::vector<double> seconds;
    Clock::time_point begin = Clock::now();
    take_sample(workload, queues_.first(), {.threads = threads, .warmup = 1, .frames = frames},
                cancel_, [&](bool counted) {
                  const Clock::time_point now = Clock::now();
                  if (counted)
                    seconds.push_back(std::chrono::duration<double>(now - begin).count());
                  begin = now;
                });
    return seconds.empty() ? expected : statistics::median(std::move(seconds));
  }

  void show_first_frame(const Workload& workload) const {
    fmt::print(stderr, "{}, {} triangles: first frame after {:.1f} s, {}\n",
               workload.options().scene, workload.scene().mesh.triangles.size(),
               std::chrono::duration<double>(Clock::now() - begin_).count(),
               (options_.out / "frame.png").string());
  }

  // Every row, then all again: a machine that changes its pace does so to all alike. Each round
  // begins elsewhere, so that nobody is always first.
  void sweep() {
    const std::vector<Row> rows = plan_.rows();
    ProgressBar progress(plan_.samples(), static_cast<unsigned>(journal_->results().size()));
    for (unsigned i = 0; i < plan_.samples() && !cancel_; ++i) {
      const auto round = static_cast<unsigned>(rows.size());
      const unsigned repetition = i / round;
      const Row& row = rows[(i + repetition) % round];
      if (has(row, repetition)) continue;
      progress.show(fmt::format("{}, {} threads", row.queue, row.threads));
      if (!hopeless(row)) {
        Sample sample = sample_of(row);
        if (cancel_) break;
        sample.repetition = repetition;
        journal_->add(sample);
      }
      progress.step();
    }
  }

  // Measured in a process of its own, so that a queue that hangs or crashes is a result.
  Sample sample_of(const Row& row) {
    const double expected = work_[row.workload] * (plan_.warmup + plan_.frames);
    const Ending ending = in_child(options_.patience + 10 * expected, cancel_, [&] {
      const Sample answer = take_sample(
          *workloads_[row.workload], queue_of(row),
          {.threads = row.threads, .warmup = plan_.warmup, .frames = plan_.frames}, cancel_);
      return nlohmann::json(answer).dump();
    });
    Sample sample;
    if (ending.status == "ok") nlohmann::json::parse(ending.answer).get_to(sample);
    sample.workload = row.workload;
    sample.queue = row.queue;
    sample.threads = row.threads;
    sample.status = ending.status;
    sample.message = ending.message;
    return sample;
  }

  static bool is_of(const Sample& sample, const Row& row) {
    return sample.workload == row.workload && sample.queue == row.queue &&
           sample.threads == row.threads;
  }
  [[nodiscard]] bool has(const Row& row, unsigned repetition) const {
    return std::ranges::any_of(journal_->results(), [&](const Sample& sample) {
      return is_of(sample, row) && sample.repetition == repetition;
    });
  }
  // What hung once would cost its patience again and again.
  [[nodiscard]] bool hopeless(const Row& row) const {
    return std::ranges::any_of(journal_->results(), [&](const Sample& sample) {
      return is_of(sample, row) && sample.status == "hung";
    });
  }

  int report() {
    std::vector<Background> backgrounds;
    for (std::size_t i = 0; i < plan_.workloads.size(); ++i) {
      backgrounds.push_back({.workload = plan_.workloads[i],
                             .triangles = references_[i].triangles,
                             .warmup = plan_.warmup,
                             .traverse_share = references_[i].traverse_share,
                             .conditions = conditions_});
    }
    std::vector<Sample> samples = journal_->results();
    std::ranges::stable_sort(samples, {}, [&](const Sample& sample) {
      return std::tuple(sample.workload, std::ranges::find(plan_.queues, sample.queue),
                        sample.threads);
    });
    const auto runs = summarise(samples, backgrounds);
    const std::size_t done = samples.size();
    fmt::print(beside(options_.json), "{}: {} frames per line in {} rounds\n\n{}\n", subject(),
               plan_.frames * plan_.repetitions, plan_.repetitions, table(runs));
    for (const std::string& name : plan_.queues) {
      const QueueEntry& queue = queues_.at(name);
      if (takes_turns(queue.claims, std::ranges::max(plan_.threads)))
        fmt::print(beside(options_.json), "{}\n", note_on_turns(queue));
    }
    std::fflush(stdout);
    write_text(options_.out / "compare.json", runs.dump(2) + '\n');
    write_text(options_.out / "compare.csv", csv(runs));
    if (!options_.json.empty()) write_text(options_.json, runs.dump(2) + '\n');
    fmt::print(stderr, "figures: {0}/compare.json and .csv, picture: {0}/frame.png\n",
               options_.out.string());

    bool broken = false;
    for (const Sample& sample : samples) broken |= is_broken(sample);
    if (broken) return 1;
    if (!cancel_) return 0;
    fmt::print(stderr,
               "irt: interrupted after {} of {} measurements; go on with: irt compare --resume "
               "--out {}\n",
               done, plan_.samples(), options_.out.string());
    return exit_interrupted;
  }

  // What is rendered, as far as all workloads agree.
  [[nodiscard]] std::string subject() const {
    const WorkloadOptions& first = plan_.workloads.front();
    std::string text = fmt::format("{}x{}", first.width, first.height);
    for (std::string WorkloadOptions::*name :
         {&WorkloadOptions::frame_buffer, &WorkloadOptions::bvh, &WorkloadOptions::scene}) {
      const bool agreed = std::ranges::all_of(
          plan_.workloads, [&](const WorkloadOptions& one) { return one.*name == first.*name; });
      if (agreed) text = fmt::format("{}, {}", first.*name, text);
    }
    return text;
  }

  // Says so where a queue has hung or crashed, and where it has lost or doubled tasks, by its own
  // count or by the picture.
  [[nodiscard]] bool is_broken(const Sample& sample) const {
    if (sample.status != "ok") {
      fmt::print(stderr, "irt: queue {} with {} threads {}: {}\n", sample.queue, sample.threads,
                 sample.status, sample.message);
      return true;
    }
    const bool same = !exact(sample.workload) ||
                      (sample.same_image && sample.image_hash == expected_hash(sample.workload));
    if (same && sample.lost + sample.doubled == 0) return false;
    fmt::print(stderr,
               "irt: queue {} with {} threads is broken: {} tasks lost, {} handed out twice, the "
               "picture {}\n",
               sample.queue, sample.threads, sample.lost, sample.doubled,
               same ? "is right" : "differs");
    return true;
  }

  // The hash of the first workload that must give the same picture. Of one that moves, the first
  // sample has it: one frame is not enough.
  [[nodiscard]] const std::string& expected_hash(std::size_t workload) const {
    const WorkloadOptions& wanted = plan_.workloads[workload];
    if (!wanted.animate.empty()) {
      return std::ranges::find_if(journal_->results(),
                                  [&](const Sample& sample) {
                                    return sample.status == "ok" &&
                                           same_picture(plan_.workloads[sample.workload], wanted);
                                  })
          ->image_hash;
    }
    std::size_t first = 0;
    while (!same_picture(plan_.workloads[first], wanted)) ++first;
    return references_[first].image_hash;
  }

  [[nodiscard]] bool exact(std::size_t workload) const {
    return has_exact_sums(plan_.workloads[workload]);
  }

  const CompareOptions& options_;
  QueueRegistry& queues_;
  const std::atomic<bool>& cancel_ = watch_for_interrupt();
  Clock::time_point begin_ = Clock::now();
  Plan plan_;
  std::vector<std::unique_ptr<Workload>> workloads_;  // as in the plan, and so are
  std::vector<Reference> references_;                 // these, and
  std::vector<double> work_;                          // what a frame takes one thread, seconds
  nlohmann::json conditions_;
  std::optional<Journal<Sample>> journal_;
};

}  // namespace

int compare(const CompareOptions& options, QueueRegistry& queues) {
  return Comparison(options, queues).run();
}

}  // namespace irt::frames
