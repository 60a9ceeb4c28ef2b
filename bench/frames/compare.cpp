#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <optional>

#include "bench/conditions/conditions.hpp"
#include "bench/frames/commands.hpp"
#include "bench/frames/files.hpp"
#include "bench/frames/interrupt.hpp"
#include "bench/frames/journal.hpp"
#include "bench/frames/progress.hpp"
#include "bench/frames/sample.hpp"
#include "bench/frames/summary.hpp"
#include "bench/frames/usage_error.hpp"

namespace irt {
namespace {

using Clock = std::chrono::steady_clock;

// What is measured, settled to the last choice; stands at the head of the journal.
struct Plan {
  WorkloadOptions workload;
  std::vector<std::string> queues;
  std::vector<unsigned> threads;
  std::vector<std::string> plugins;
  unsigned frames = 0, repetitions = 0, warmup = 0;

  unsigned samples() const {
    return static_cast<unsigned>(queues.size() * threads.size()) * repetitions;
  }
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Plan, workload, queues, threads, plugins, frames, repetitions,
                                   warmup)

// What the first frame told.
struct Reference {
  std::string image_hash;
  std::size_t triangles = 0;
  double traverse_share = 0;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Reference, image_hash, triangles, traverse_share)

// 1, 2, 4 ... and the number of hardware threads itself; each number where there are few.
std::vector<unsigned> default_threads() {
  const unsigned most = settle_threads(0);
  std::vector<unsigned> threads;
  for (unsigned n = 1; n < most; n += most <= 4 ? 1 : n) threads.push_back(n);
  threads.push_back(most);
  return threads;
}

Plan plan_of(const CompareOptions& options, const QueueRegistry& queues) {
  Plan plan{.workload = options.workload,
            .queues = options.queues,
            .threads = options.threads,
            .plugins = options.plugins,
            .frames = options.frames,
            .repetitions = options.repetitions,
            .warmup = options.warmup};
  check(plan.workload);
  if (plan.queues.empty()) {
    for (const QueueEntry& queue : queues.entries()) plan.queues.emplace_back(queue.name);
  }
  for (const std::string& name : plan.queues) queues.at(name);
  if (plan.threads.empty()) plan.threads = default_threads();
  for (const unsigned threads : plan.threads) settle_threads(threads);
  return plan;
}

// The plan of a journal. What the user set on the command line must be what it says.
Plan plan_of(const Journal& journal, const CompareOptions& options, QueueRegistry& queues) {
  auto stored = journal.header().at("plan").get<Plan>();
  for (const std::string& plugin : stored.plugins) {
    if (std::ranges::find(options.plugins, plugin) == options.plugins.end()) queues.open(plugin);
  }
  const nlohmann::json before = stored, now = plan_of(options, queues);
  for (const std::string& name : options.given) {
    std::vector<std::string> keys{name};
    if (name == "size") keys = {"width", "height"};
    for (const std::string& key : keys) {
      const bool of_workload = before["workload"].contains(key);
      const nlohmann::json& old = of_workload ? before["workload"] : before;
      const nlohmann::json& wanted = of_workload ? now["workload"] : now;
      if (!old.contains(key)) continue;
      const std::string difference =
          first_difference({{key, old.at(key)}}, {{key, wanted.at(key)}});
      if (!difference.empty()) {
        throw UsageError(
            fmt::format("--resume: {}; start without --resume, or with the options "
                        "of before",
                        difference));
      }
    }
  }
  return stored;
}

// Of all conditions, those that make figures incomparable when they change.
nlohmann::json lasting(const nlohmann::json& conditions) {
  nlohmann::json kept;
  for (const char* name :
       {"cpu", "packages", "numa_nodes", "cores", "hardware_threads", "governor", "turbo",
        "cpu_limit", "kernel", "compiler", "flags", "build_type", "commit", "pinning"}) {
    if (conditions.contains(name)) kept[name] = conditions[name];
  }
  return kept;
}

// Frames per repetition such that everything takes about `seconds`. `work` is what one frame takes
// a single thread.
void settle_length(Plan& plan, double work, double seconds) {
  double sweep = 0;  // one frame of every queue and number of threads
  const double most = settle_threads(0);
  for (const unsigned threads : plan.threads) {
    sweep += static_cast<double>(plan.queues.size()) * work / std::min<double>(threads, most);
  }
  if (plan.frames == 0) {
    const double fit = seconds / (sweep * plan.repetitions) - plan.warmup;
    plan.frames = static_cast<unsigned>(std::clamp(fit, 1.0, 100.0));
  }
}

class Comparison {
 public:
  Comparison(const CompareOptions& options, QueueRegistry& queues)
      : options_(options), queues_(queues) {}

  int run() {
    const auto file = options_.out / "runs.jsonl";
    if (options_.resume) {
      journal_ = Journal::resume(file);
      plan_ = plan_of(*journal_, options_, queues_);
    } else {
      plan_ = plan_of(options_, queues_);
    }
    for (const char* name : {"runs.jsonl", "compare.json", "compare.csv", "frame.png"}) {
      require_writable(options_.out / name);
    }
    if (!options_.json.empty()) require_writable(options_.json);
    conditions_ = conditions(plan_.workload.pin ? "one thread per core" : "none");
    if (journal_) {
      const std::string difference =
          first_difference(lasting(journal_->header().at("conditions")), lasting(conditions_));
      if (!difference.empty()) {
        throw UsageError(
            fmt::format("--resume: {}; figures taken under other conditions do not "
                        "mix, start without --resume",
                        difference));
      }
    }

    Workload workload(plan_.workload);
    first_frame(workload, file);
    if (!journal_) {
      fmt::print(stderr, "irt: interrupted before anything was measured\n");
      return exit_interrupted;
    }
    sweep(workload);
    return report();
  }

 private:
  // Renders the picture, and with a new plan settles what is still open and begins the journal.
  void first_frame(Workload& workload, const std::filesystem::path& file) {
    const QueueEntry& queue = queues_.at(plan_.queues.front());
    const unsigned threads = *std::ranges::max_element(plan_.threads);
    const Sample first = take_sample(workload, queue, {.threads = threads, .warmup = 0}, cancel_);
    if (first.seconds.empty()) return;
    write_png(options_.out / "frame.png", workload.application().image());
    fmt::print(stderr, "{}, {} triangles: first frame after {:.1f} s, {}\n",
               workload.options().scene, workload.scene().mesh.triangles.size(),
               std::chrono::duration<double>(Clock::now() - begin_).count(),
               (options_.out / "frame.png").string());
    if (journal_) {
      journal_->header().at("reference").get_to(reference_);
      if (exact() && reference_.image_hash != first.image_hash) {
        throw UsageError(
            "--resume: the scene gives another picture than before; start without "
            "--resume");
      }
      return;
    }
    reference_ = {.image_hash = first.image_hash,
                  .triangles = workload.scene().mesh.triangles.size(),
                  .traverse_share = traverse_share(workload, queue, threads, cancel_)};
    if (cancel_) return;
    const double cores = std::min<double>(threads, settle_threads(0));
    settle_length(plan_, first.seconds.front() * cores, options_.seconds);
    journal_ = Journal::begin(file, {{"format", "irt-frames 1"},
                                     {"plan", plan_},
                                     {"reference", reference_},
                                     {"conditions", conditions_}});
  }

  // Every queue with every number of threads, then all again: a machine that changes its pace does
  // so to all alike. Each round begins elsewhere, so that nobody is always first.
  void sweep(Workload& workload) {
    const auto queues = static_cast<unsigned>(plan_.queues.size());
    const unsigned round = queues * static_cast<unsigned>(plan_.threads.size());
    ProgressBar progress(plan_.samples(), static_cast<unsigned>(journal_->samples().size()));
    for (unsigned i = 0; i < plan_.samples() && !cancel_; ++i) {
      const unsigned repetition = i / round, at = (i + repetition) % round;
      const std::string& queue = plan_.queues[at % queues];
      const unsigned threads = plan_.threads[at / queues];
      if (journal_->has(queue, threads, repetition)) continue;
      progress.show(fmt::format("{}, {} threads", queue, threads));
      Sample sample = take_sample(
          workload, queues_.at(queue),
          {.threads = threads, .warmup = plan_.warmup, .frames = plan_.frames}, cancel_);
      if (sample.seconds.size() < plan_.frames) break;
      sample.repetition = repetition;
      journal_->add(sample);
      progress.step();
    }
  }

  int report() {
    const Background background{.workload = plan_.workload,
                                .triangles = reference_.triangles,
                                .warmup = plan_.warmup,
                                .traverse_share = reference_.traverse_share,
                                .conditions = conditions_};
    std::vector<Sample> samples = journal_->samples();
    std::ranges::stable_sort(samples, {}, [&](const Sample& sample) {
      return std::pair(std::ranges::find(plan_.queues, sample.queue), sample.threads);
    });
    const auto runs = summarise(samples, background);
    const std::size_t done = samples.size();
    fmt::print("{}, {} triangles, {}x{}, {}, {}: {} frames per line in {} rounds\n\n{}\n",
               plan_.workload.scene, reference_.triangles, plan_.workload.width,
               plan_.workload.height, plan_.workload.bvh, plan_.workload.frame_buffer,
               plan_.frames * plan_.repetitions, plan_.repetitions, table(runs));
    std::fflush(stdout);
    write_text(options_.out / "compare.json", runs.dump(2) + '\n');
    write_text(options_.out / "compare.csv", csv(runs));
    if (!options_.json.empty()) write_text(options_.json, runs.dump(2) + '\n');
    fmt::print(stderr, "figures: {0}/compare.json and .csv, picture: {0}/frame.png\n",
               options_.out.string());

    bool broken = false;
    for (const Sample& sample : samples) broken |= is_broken(sample);
    if (broken) return 1;
    if (done == plan_.samples()) return 0;
    fmt::print(stderr,
               "irt: interrupted after {} of {} measurements; go on with: irt compare --resume "
               "--out {}\n",
               done, plan_.samples(), options_.out.string());
    return exit_interrupted;
  }

  // Says so where a queue has lost or doubled tasks, by its own count or by the picture.
  bool is_broken(const Sample& sample) const {
    const bool same = !exact() || (sample.same_image && sample.image_hash == reference_.image_hash);
    if (same && sample.lost + sample.doubled == 0) return false;
    fmt::print(stderr,
               "irt: queue {} with {} threads is broken: {} tasks lost, {} handed out twice, the "
               "picture {}\n",
               sample.queue, sample.threads, sample.lost, sample.doubled,
               same ? "is right" : "differs");
    return true;
  }

  bool exact() const { return plan_.workload.frame_buffer == "fixed-point"; }

  const CompareOptions& options_;
  QueueRegistry& queues_;
  const std::atomic<bool>& cancel_ = watch_for_interrupt();
  Clock::time_point begin_ = Clock::now();
  Plan plan_;
  Reference reference_;
  nlohmann::json conditions_;
  std::optional<Journal> journal_;
};

}  // namespace

int compare(const CompareOptions& options, QueueRegistry& queues) {
  return Comparison(options, queues).run();
}

}  // namespace irt
