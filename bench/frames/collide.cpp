#include <fmt/format.h>

#include "bench/conditions/conditions.hpp"
#include "bench/frames/commands.hpp"
#include "bench/frames/files.hpp"
#include "bench/frames/summary.hpp"
#include "bench/results/record.hpp"
#include "bench/running/interrupt.hpp"
#include "bench/running/text_files.hpp"
#include "bench/statistics/averages.hpp"
#include "renderer/engine/collision.hpp"

namespace irt::frames {
namespace {

// Of every particle's count, first triangle and time of contact.
std::string hash_of(const std::vector<Contacts>& contacts) {
  std::uint64_t state = fnv1a({});
  for (const Contacts& one : contacts) {
    const std::uint32_t words[] = {one.count, one.first, std::bit_cast<std::uint32_t>(one.time)};
    for (const std::uint32_t word : words) {
      for (int shift = 0; shift < 32; shift += 8) {
        const auto byte = static_cast<std::uint8_t>(word >> shift);
        state = fnv1a({&byte, 1}, state);
      }
    }
  }
  return fmt::format("{:016x}", state);
}

}  // namespace

int collide(CollideOptions options, const QueueRegistry& queues) {
  const QueueEntry& queue = options.queue.empty() ? queues.first() : queues.at(options.queue);
  check(options.workload);
  check_queue(options.queue, options.workload);
  if (!options.json.empty()) require_writable(options.json);
  const std::atomic<bool>& cancel = watch_for_interrupt();
  const Workload workload(options.workload);
  EngineOptions engine_options = workload.engine_options(settle_threads(options.threads));
  engine_options.cancel = &cancel;
  const auto engine = workload.start_engine(engine_options, queue);
  constexpr std::uint64_t seed = 1;
  CollisionQuery query(workload.scene().mesh,
                       particle_cloud(workload.scene().mesh, options.particles, seed),
                       engine_options.rays_per_task);

  std::vector<double> seconds;
  std::uint64_t rays = 0;
  for (unsigned frame = 0; frame <= options.frames; ++frame) {  // the first warms up
    const FrameStats stats = engine->run(query);
    if (cancel) return exit_interrupted;
    rays = stats.rays();
    if (frame > 0) seconds.push_back(stats.seconds());
  }
  const double median = statistics::median(seconds);
  const std::string hash = hash_of(query.contacts());
  fmt::print(
      beside(options.json),
      "{}: {} particles, {} collisions, {:.2f} ms per frame, {:.3f} million rays/s, hash {}\n",
      workload.options().scene, options.particles, query.total(), 1e3 * median,
      static_cast<double>(rays) / median / 1e6, hash);
  if (!options.json.empty()) {
    nlohmann::ordered_json run = results::record(
        {{"scene", workload.options().scene},
         {"triangles", workload.scene().mesh.triangles.size()},
         {"queue", uses_queue(workload.options()) ? nlohmann::ordered_json(queue.name) : nullptr},
         {"threads", engine_options.threads}});
    add_choices(run, workload.options(), results::by_collide);
    results::add(run,
                 {{"particles", options.particles},
                  {"collisions", query.total()},
                  {"frames", options.frames},
                  {"fps", 1 / median},
                  {"fps_lower_quartile", 1 / statistics::quantile(seconds, 0.75)},
                  {"fps_upper_quartile", 1 / statistics::quantile(seconds, 0.25)},
                  {"rays_per_second", static_cast<double>(rays) / median},
                  {"contacts_hash", hash},
                  {"conditions", conditions(engine->pinned() ? "one thread per core" : "none")}});
    const auto runs = nlohmann::ordered_json::array({run});
    write_text(options.json, runs.dump(2) + '\n');
  }
  return 0;
}

}  // namespace irt::frames
