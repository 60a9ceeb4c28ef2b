// irt bench tracer: this project's structures beside Embree, on the same rays in the same process.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include "bench/conditions/conditions.hpp"
#include "bench/tracer/contestant.hpp"
#include "bench/tracer/frame.hpp"
#include "bench/tracer/measurement.hpp"
#include "bench/tracer/scene_rays.hpp"
#include "renderer/scene/scenes.hpp"

namespace irt::bench {
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

/// Collects what is measured, prints it, and keeps count of findings.
class Report {
 public:
  explicit Report(const Options& options) : options_(options) {
    json_["conditions"] = conditions();
    json_["builds"] = nlohmann::json::array();
    json_["results"] = nlohmann::json::array();
  }

  void build(const Scene& scene, unsigned threads, const std::string& name, const Times& times,
             double sah_cost) {
    fmt::print("  build  {:<16} {} thread{}  {:8.1f} ms{}\n", name, threads,
               threads == 1 ? " " : "s", median(times.wall),
               sah_cost > 0 ? fmt::format("  SAH cost {:.2f}", sah_cost) : "");
    json_["builds"].push_back({{"scene", scene.name},
                               {"triangles", scene.mesh.triangles.size()},
                               {"threads", threads},
                               {"name", name},
                               {"wall_ms", times.wall},
                               {"cpu_ms", times.cpu},
                               {"sah_cost", sah_cost}});
  }

  void result(const Scene& scene, std::uint32_t side, unsigned threads, std::string_view kind,
              std::uint64_t rays, const Contestant& contestant, const Times& times) {
    json_["results"].push_back({{"scene", scene.name},
                                {"triangles", scene.mesh.triangles.size()},
                                {"side", side},
                                {"threads", threads},
                                {"kind", kind},
                                {"rays", rays},
                                {"contestant", contestant.name()},
                                {"wall_ms", times.wall},
                                {"cpu_ms", times.cpu}});
  }

  void disagreement(RayKind kind, const Contestant& contestant, const Disagreement& found) {
    const std::uint64_t wrong = contestant.is_ours() ? found.bits : found.missed + found.elsewhere;
    if (wrong == 0) return;
    const bool finding =
        contestant.is_ours() ||
        static_cast<double>(wrong) > most_disagreement * static_cast<double>(found.rays);
    fmt::print("  {} {}: {} of {} {} rays answered otherwise{}\n", finding ? "FINDING" : "note",
               contestant.name(), wrong, found.rays, name_of(kind),
               contestant.is_ours() ? "; ours must agree to the bit" : " (rays along edges)");
    findings_ += finding;
  }

  int finish() {
    if (!options_.json.empty()) {
      std::ofstream(options_.json) << json_.dump(1) << '\n';
      fmt::print("written: {}\n", options_.json);
    }
    return findings_ == 0 ? 0 : 1;
  }

 private:
  const Options& options_;
  nlohmann::json json_;
  int findings_ = 0;
};

/// What one contestant did with one picture: times by kind, the frame last.
struct Row {
  Times kind[3], frame;
};

double rate(std::uint64_t rays, const std::vector<double>& milliseconds) {
  return static_cast<double>(rays) / median(milliseconds) / 1e3;
}

/// Half the range of the middle half of the values, relative to the median, in per cent.
double spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double low = values[values.size() / 4],
               high = values[values.size() - 1 - values.size() / 4];
  return 50 * (high - low) / median(values);
}

void print_rows(const Contestants& contestants, const std::vector<Row>& rows,
                const std::uint64_t (&rays)[3]) {
  fmt::print("  {:<24}{:>14}{:>14}{:>14}{:>18}\n", "Mrays/s (spread %)", "primary", "shadow",
             "specular", "frame ms");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    fmt::print("  {:<24}", contestants[i]->name());
    for (int kind = 0; kind < 3; ++kind) {
      fmt::print("{:>8.1f} ({:>2.0f}) ", rate(rays[kind], rows[i].kind[kind].wall),
                 spread(rows[i].kind[kind].wall));
    }
    fmt::print("{:>10.1f} ({:>2.0f})\n", median(rows[i].frame.wall), spread(rows[i].frame.wall));
  }
  // Processor time is what other programs leave alone, so the comparison rests on it.
  const auto best = [&](bool ours, const auto& of) {
    double least = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (contestants[i]->is_ours() != ours) continue;
      const double taken = median(of(rows[i]).cpu);
      if (least == 0 || taken < least) least = taken;
    }
    return least;
  };
  std::string line;
  const auto add = [&](std::string_view name, const auto& of) {
    const double ours = best(true, of), theirs = best(false, of);
    if (ours > 0 && theirs > 0) line += fmt::format("  {} {:.2f}x", name, theirs / ours);
  };
  for (int kind = 0; kind < 3; ++kind) {
    add(name_of(static_cast<RayKind>(kind)), [kind](const Row& row) { return row.kind[kind]; });
  }
  add("frame", [](const Row& row) { return row.frame; });
  if (!line.empty()) fmt::print("  best of ours : best of Embree, by processor time:{}\n", line);
}

void measure_kind(const Scene& scene, std::uint32_t side, unsigned threads, RayKind kind,
                  const Contestants& contestants, const Options& options, Executor& executor,
                  std::vector<Row>& rows, std::uint64_t& rays, Report& report) {
  const Contestant& guide = *contestants.front();
  const std::vector<Rays> batches = rays_of(scene, side, kind, guide);
  rays = 0;
  std::vector<Answers> reference, answers;
  for (const Rays& batch : batches) {
    rays += batch.size;
    reference.emplace_back(tile_rays);
    answers.emplace_back(tile_rays);
  }
  trace_all(guide, kind, batches, reference, executor);
  for (const auto& contestant : contestants) {
    trace_all(*contestant, kind, batches, answers, executor);
    report.disagreement(kind, *contestant, compare(kind, batches, reference, answers));
  }
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    for (std::size_t i = 0; i < contestants.size(); ++i) {
      time(rows[i].kind[static_cast<int>(kind)],
           [&] { trace_all(*contestants[i], kind, batches, answers, executor); });
    }
  }
  for (std::size_t i = 0; i < contestants.size(); ++i) {
    report.result(scene, side, threads, name_of(kind), rays, *contestants[i],
                  rows[i].kind[static_cast<int>(kind)]);
  }
}

void measure_builds(const Scene& scene, const Options& options, Report& report) {
  for (const unsigned threads : options.threads) {
    std::vector<std::string> names;
    std::map<std::string, Times> times;
    std::map<std::string, double> costs;
    const auto note = [&](const TimedBuild& build, double cpu) {
      if (!times.contains(build.name)) names.push_back(build.name);
      times[build.name].wall.push_back(build.milliseconds);
      times[build.name].cpu.push_back(cpu);
      costs[build.name] = build.sah_cost;
    };
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
      const double start = cpu_ms();
      const TimedBuild ours = time_our_build(scene.mesh, threads);
      note(ours, cpu_ms() - start);
      for (const TimedBuild& build : time_embree_builds(scene.mesh, threads)) note(build, 0);
    }
    for (const std::string& name : names) {
      report.build(scene, threads, name, times[name], costs[name]);
    }
  }
}

void measure(const Scene& scene, const Options& options, Report& report) {
  fmt::print("\n{}: {} triangles\n", scene.name, scene.mesh.triangles.size());
  measure_builds(scene, options, report);
  Contestants contestants = our_contestants(scene.mesh, options.contestants);
  if (contestants.empty()) throw CLI::ValidationError("--contestants", "none of ours is named");
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
      for (int repeat = 0; repeat < options.repeats; ++repeat) {
        for (std::size_t i = 0; i < contestants.size(); ++i) {
          time(rows[i].frame, [&] { trace_frame(scene, side, *contestants[i], executor); });
        }
      }
      for (std::size_t i = 0; i < contestants.size(); ++i) {
        report.result(scene, side, threads, "frame", rays[0] + rays[1] + rays[2], *contestants[i],
                      rows[i].frame);
      }
      fmt::print("\n  {0} x {0} pixels, {1} thread{2}\n", side, threads, threads == 1 ? "" : "s");
      print_rows(contestants, rows, rays);
      std::fflush(stdout);
    }
  }
}

int run(int argc, char** argv) {
  CLI::App app(
      "Times this project's structures and Embree on the same rays in one process, in turn.\n"
      "Every hit makes a shadow ray to each light and a mirrored ray: more than a picture needs.",
      "irt bench tracer");
  Options options;
  app.add_option("--scene", options.scenes, "scenes by name or file; all built-in ones if none");
  app.add_option("--contestants", options.contestants,
                 "comma-separated names, or all; 'wide 16 groups' is what the renderer uses")
      ->delimiter(',');
  app.add_option("--side", options.sides, "pixels along a side of the picture")
      ->delimiter(',')
      ->check(CLI::Range(1, 4096));
  app.add_option("--threads", options.threads, "numbers of threads")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024));
  app.add_option("--repeats", options.repeats, "rounds; the median is shown")
      ->check(CLI::Range(1, 1000));
  app.add_option("--json", options.json, "write every single time to this file");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (options.contestants.empty()) {
    for (const std::string_view name : usual_contestants()) options.contestants.emplace_back(name);
  }
  if (options.scenes.empty()) {
    for (const SceneEntry& scene : built_in_scenes()) options.scenes.emplace_back(scene.name);
  }
  // Embree asks for this in every thread that traces; threads inherit it from the one that starts
  // them. Ours traces the same either way.
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);

  Report report(options);
  for (const std::string& name : options.scenes) measure(load_scene(name), options, report);
  return report.finish();
}

}  // namespace
}  // namespace irt::bench

int main(int argc, char** argv) {
  try {
    return irt::bench::run(argc, argv);
  } catch (const irt::SceneError& error) {
    std::fprintf(stderr, "irt bench tracer: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "irt bench tracer: %s\n", error.what());
    return 1;
  }
}
