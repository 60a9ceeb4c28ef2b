// irt bench tracer: this project's structures beside Embree, on the same rays in the same process.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>

#include "bench/conditions/conditions.hpp"
#include "bench/running/text_files.hpp"
#include "bench/statistics/averages.hpp"
#include "bench/tracer/contestant.hpp"
#include "bench/tracer/frame.hpp"
#include "bench/tracer/measurement.hpp"
#include "bench/tracer/scene_rays.hpp"
#include "queues/nearest.hpp"
#include "renderer/bvh/executor.hpp"
#include "renderer/scene/scenes.hpp"
#include "stress/running/arguments.hpp"
#include "stress/running/program.hpp"

namespace irt::tracer {
namespace {

struct Options {
  std::vector<std::string> scenes, contestants;
  std::vector<std::uint32_t> sides{300, 1024};
  std::vector<unsigned> threads{1, 2};
  int repeats = 5;
  std::string json;
};

/// The most rays of one kind in which contestants of one side may differ from ours: rays that pass
/// an edge within rounding. Embree's own packets and single rays differ in about as many.
constexpr double most_disagreement = 1e-4;

/// The share of a picture's pixels that a few rays otherwise answered may change visibly.
constexpr double most_differing_pixels = 1e-3;

/// Collects what is measured, prints it, and keeps count of findings.
class Report {
 public:
  explicit Report(const Options& options) : options_(options) {
    if (!options.json.empty()) require_writable(options.json);
    json_["conditions"] = conditions();
    json_["builds"] = nlohmann::json::array();
    json_["results"] = nlohmann::json::array();
  }

  /// Where people read.
  [[nodiscard]] std::FILE* out() const { return beside(options_.json); }

  void build(const Scene& scene, unsigned threads, const std::string& name,
             const std::vector<double>& wall_ms, double sah_cost) {
    fmt::print(out(), "  build  {:<16} {} thread{}  {:8.1f} ms{}\n", name, threads,
               threads == 1 ? " " : "s", statistics::median(wall_ms),
               sah_cost > 0 ? fmt::format("  SAH cost {:.2f}", sah_cost) : "");
    json_["builds"].push_back({{"scene", scene.name},
                               {"triangles", scene.mesh.triangles.size()},
                               {"threads", threads},
                               {"name", name},
                               {"wall_ms", wall_ms},
                               {"sah_cost", sah_cost}});
  }

  void result(const Scene& scene, std::uint32_t side, unsigned threads, std::string_view kind,
              std::uint64_t rays, const Contestant& contestant, const TaskTimes& times) {
    json_["results"].push_back({{"scene", scene.name},
                                {"triangles", scene.mesh.triangles.size()},
                                {"side", side},
                                {"threads", threads},
                                {"kind", kind},
                                {"rays", rays},
                                {"contestant", contestant.name},
                                {"busy_ms", times.busy_ms()},
                                {"rounds_ms", times.rounds_ms()}});
  }

  void disagreement(RayKind kind, const Contestant& contestant, const Disagreement& found) {
    const std::uint64_t wrong = contestant.same_bits ? found.bits : found.missed + found.elsewhere;
    if (wrong == 0) return;
    const bool finding =
        contestant.same_bits ||
        static_cast<double>(wrong) > most_disagreement * static_cast<double>(found.rays);
    fmt::print(out(), "  {} {}: {} of {} {} rays answered otherwise{}\n",
               finding ? "FINDING" : "note", contestant.name, wrong, found.rays, name_of(kind),
               contestant.same_bits ? "; ours must agree to the bit" : " (rays along edges)");
    findings_ += finding;
  }

  void frames(const Scene& scene, std::uint32_t side, unsigned threads,
              const Contestant& contestant, std::uint64_t rays, const std::vector<double>& ms) {
    json_["results"].push_back({{"scene", scene.name},
                                {"triangles", scene.mesh.triangles.size()},
                                {"side", side},
                                {"threads", threads},
                                {"kind", "frame"},
                                {"rays", rays},
                                {"contestant", contestant.name},
                                {"rounds_ms", ms}});
  }

  void pictures_differ(const Contestant& contestant, std::uint32_t differing,
                       std::uint32_t pixels) {
    const bool finding =
        contestant.same_bits || differing > most_differing_pixels * static_cast<double>(pixels);
    fmt::print(out(), "  {} {}: the picture differs in {} of {} pixels\n",
               finding ? "FINDING" : "note", contestant.name, differing, pixels);
    findings_ += finding;
  }

  int finish() {
    if (!options_.json.empty()) {
      write_text(options_.json, json_.dump(1) + "\n");
      if (options_.json != "-") fmt::print("written: {}\n", options_.json);
    }
    return findings_ == 0 ? 0 : 1;
  }

 private:
  const Options& options_;
  nlohmann::json json_;
  int findings_ = 0;
};

/// Small pictures take less time and are disturbed as often: they get more rounds.
int rounds(const Options& options, std::uint32_t side) {
  return options.repeats * static_cast<int>(std::clamp(1'000'000u / (side * side), 1u, 8u));
}

/// What one contestant did with one picture.
struct Row {
  TaskTimes kind[3];
  std::vector<double> frame_ms;
};

/// Adds "NAME RATIOx (QUARTILES)" of the best of the others to the best of ours.
void add_ratio(std::string& line, std::string_view name, const Contestants& contestants,
               const std::vector<std::vector<double>>& rounds) {
  std::size_t best[2] = {rounds.size(), rounds.size()};  // of the others, of ours
  for (std::size_t i = 0; i < rounds.size(); ++i) {
    std::size_t& least = best[contestants[i].ours];
    if (least == rounds.size() || statistics::median(rounds[i]) < statistics::median(rounds[least]))
      least = i;
  }
  if (best[0] == rounds.size() || best[1] == rounds.size()) return;
  // Of neighbours in time: what disturbs a round disturbs both.
  std::vector<double> ratios;
  for (std::size_t round = 0; round < rounds[best[0]].size(); ++round) {
    ratios.push_back(rounds[best[0]][round] / rounds[best[1]][round]);
  }
  line += fmt::format("  {} {:.2f}x (±{:.0f} %)", name, statistics::median(ratios), spread(ratios));
}

void print_rows(std::FILE* out, const Contestants& contestants, const std::vector<Row>& rows,
                const std::uint64_t (&rays)[3], unsigned threads) {
  fmt::print(out, "  {:<26}{:>13}{:>14}{:>14}{:>19}\n", "Mrays/s (spread %)", "primary", "shadow",
             "specular", "frame ms");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    fmt::print(out, "  {:<26}", contestants[i].name);
    for (int kind = 0; kind < 3; ++kind) {
      const TaskTimes& times = rows[i].kind[kind];
      fmt::print(out, "{:>8.1f} ({:>2.0f}) ",
                 static_cast<double>(rays[kind]) * threads / times.busy_ms() / 1e3,
                 spread(times.rounds_ms()));
    }
    fmt::print(out, "{:>11.2f} ({:>2.0f})\n", statistics::median(rows[i].frame_ms),
               spread(rows[i].frame_ms));
  }
  std::string line;
  for (int kind = 0; kind < 3; ++kind) {
    std::vector<std::vector<double>> rounds;
    rounds.reserve(rows.size());
    for (const Row& row : rows) rounds.push_back(row.kind[kind].rounds_ms());
    add_ratio(line, name_of(static_cast<RayKind>(kind)), contestants, rounds);
  }
  std::vector<std::vector<double>> frames;
  frames.reserve(rows.size());
  for (const Row& row : rows) frames.push_back(row.frame_ms);
  add_ratio(line, "frame", contestants, frames);
  if (!line.empty()) fmt::print(out, "  time of the best of Embree : the best of ours{}\n", line);
}

/// Renders frames with one contestant after the other, round by round.
void measure_frames(const Scene& scene, std::uint32_t side, unsigned threads,
                    const Contestants& contestants, int rounds, std::vector<Row>& rows,
                    Report& report) {
  std::vector<std::unique_ptr<FrameBench>> benches;
  for (std::size_t i = 0; i < contestants.size(); ++i) {
    benches.push_back(std::make_unique<FrameBench>(scene, side, threads, contestants[i]));
    benches[i]->run();  // allocates
    const FrameBuffer &expected = benches[0]->frame(), &frame = benches[i]->frame();
    if (contestants[i].same_bits && frame.hash() == expected.hash()) continue;
    const std::uint32_t differing = differing_pixels(expected, frame);
    if (contestants[i].same_bits || differing != 0) {
      report.pictures_differ(contestants[i], differing, side * side);
    }
  }
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < contestants.size(); ++i) {
      rows[i].frame_ms.push_back(benches[i]->run());
    }
  }
  for (std::size_t i = 0; i < contestants.size(); ++i) {
    report.frames(scene, side, threads, contestants[i], benches[i]->rays(), rows[i].frame_ms);
  }
}

void measure_kind(const Scene& scene, std::uint32_t side, unsigned threads, RayKind kind,
                  const Contestants& contestants, const Options& options, Executor& executor,
                  std::vector<Row>& rows, std::uint64_t& rays, Report& report) {
  const Contestant& guide = contestants.front();
  const std::vector<Rays> batches = rays_of(scene, side, kind, guide);
  rays = 0;
  std::vector<Answers> reference, answers;
  for (const Rays& batch : batches) {
    rays += batch.size;
    reference.emplace_back(tile_rays);
    answers.emplace_back(tile_rays);
  }
  trace_all(guide, kind, batches, reference, executor);
  for (const Contestant& contestant : contestants) {
    trace_all(contestant, kind, batches, answers, executor);
    report.disagreement(kind, contestant, compare(kind, batches, reference, answers));
  }
  for (int round = 0; round < rounds(options, side); ++round) {
    for (std::size_t i = 0; i < contestants.size(); ++i) {
      trace_timed(contestants[i], kind, batches, executor, rows[i].kind[static_cast<int>(kind)]);
    }
  }
  for (std::size_t i = 0; i < contestants.size(); ++i) {
    report.result(scene, side, threads, name_of(kind), rays, contestants[i],
                  rows[i].kind[static_cast<int>(kind)]);
  }
}

void measure_builds(const Scene& scene, const Options& options, Report& report) {
  for (const unsigned threads : options.threads) {
    std::vector<TimedBuild> first;
    std::map<std::string, std::vector<double>> wall_ms;
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
      std::vector<TimedBuild> builds = time_embree_builds(scene.mesh, threads);
      builds.insert(builds.begin(), time_our_build(scene.mesh, threads));
      for (const TimedBuild& build : builds) wall_ms[build.name].push_back(build.milliseconds);
      if (repeat == 0) first = std::move(builds);
    }
    for (const TimedBuild& build : first) {
      report.build(scene, threads, build.name, wall_ms[build.name], build.sah_cost);
    }
  }
}

void measure(const Scene& scene, const Options& options, Report& report) {
  fmt::print(report.out(), "\n{}: {} triangles\n", scene.name, scene.mesh.triangles.size());
  measure_builds(scene, options, report);
  Contestants contestants = our_contestants(scene.mesh, options.contestants);
  if (contestants.empty())
    throw std::invalid_argument(
        "--contestants: names none of this project's; one is needed to compare with, as 'wide 16'");
  for (auto& one : embree_contestants(scene.mesh, options.contestants)) {
    contestants.push_back(std::move(one));
  }
  for (const std::uint32_t side : options.sides) {
    for (const unsigned threads : options.threads) {
      ThreadExecutor executor(threads);
      std::vector<Row> rows(contestants.size());
      std::uint64_t rays[3] = {};
      for (const RayKind kind : {RayKind::primary, RayKind::shadow, RayKind::specular}) {
        measure_kind(scene, side, threads, kind, contestants, options, executor, rows,
                     rays[static_cast<int>(kind)], report);
      }
      measure_frames(scene, side, threads, contestants, rounds(options, side), rows, report);
      fmt::print(report.out(), "\n  {0} x {0} pixels, {1} thread{2}\n", side, threads,
                 threads == 1 ? "" : "s");
      print_rows(report.out(), contestants, rows, rays, threads);
      std::fflush(report.out());
    }
  }
}

/// Throws std::invalid_argument for a name that is nobody's.
void check_names(const std::vector<std::string>& wanted) {
  std::vector<std::string> names = our_names();
  for (std::string& name : embree_names()) names.push_back(std::move(name));
  std::vector<std::string_view> known(names.begin(), names.end());
  known.push_back("all");
  for (const std::string& name : wanted) {
    const bool usual = std::ranges::count(usual_contestants(), name) != 0;  // Embree may be missing
    if (!usual && std::ranges::count(known, name) == 0) {
      throw std::invalid_argument(unknown_name("contestant", name, known));
    }
  }
}

int run(int argc, char** argv) {
  CLI::App app(
      "Times this project's structures and Embree on the same rays in one process, in turn.\n"
      "Every hit makes a shadow ray to each light and a mirrored ray: more than a picture needs.\n"
      "Tasks of 256 rays are timed one by one; shown is the sum of each task's median over the\n"
      "rounds, divided by the threads. A frame goes through a work queue, as those of 'irt "
      "render':\n"
      "rays are made, queued and shaded by the same code whoever traces them.",
      "irt bench tracer");
  Options options;
  app.add_option("--scene", options.scenes, "scenes by name or file; all built-in ones if none");
  app.add_option("--contestants", options.contestants,
                 "comma-separated names, or all; 'wide 16' is a structure and its packets' width, "
                 "'wide 16 watertight' one with another kernel")
      ->delimiter(',');
  app.add_option("--side", options.sides, "pixels along a side of the picture")
      ->delimiter(',')
      ->check(CLI::Range(1, 4096));
  app.add_option("--threads", options.threads, "numbers of threads")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024));
  app.add_option("--repeats", options.repeats,
                 "rounds of a megapixel; small pictures get up to eight times as many")
      ->check(CLI::Range(1, 1000));
  app.add_option("--json", options.json,
                 "write every single time to this file; - for standard output");
  if (const auto code = parse(app, argc, argv)) return *code;
  if (options.contestants.empty()) {
    for (const std::string_view name : usual_contestants()) options.contestants.emplace_back(name);
  }
  if (options.scenes.empty()) {
    for (const SceneEntry& scene : built_in_scenes()) options.scenes.emplace_back(scene.name);
  }
  check_names(options.contestants);
  Report report(options);
  if (embree_names().empty()) {
    fmt::print(report.out(), "without Embree (libembree-dev): this project's structures only\n");
  }
  flush_denormals();

  for (const std::string& name : options.scenes) measure(load_scene(name), options, report);
  return report.finish();
}

}  // namespace
}  // namespace irt::tracer

int main(int argc, char** argv) {
  return irt::run_program("irt bench tracer", [&] { return irt::tracer::run(argc, argv); });
}
