/// The commands of the tool. Each returns the exit code of the process, or throws UsageError,
/// SceneError or RegistryError.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/frames/workload.hpp"
#include "queues/registry.hpp"
#include "stress/running/shard.hpp"

namespace irt {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Shard, index, count)

}  // namespace irt

namespace irt::frames {

inline constexpr unsigned max_threads = 1024;

/// `irt render`: one queue, so many threads.
struct RenderOptions {
  WorkloadOptions workload;
  std::string queue;     ///< empty: the first
  unsigned threads = 0;  ///< 0: as many as the machine has
  unsigned frames = 10, warmup = 1;
  bool plain = false;                      ///< leave the clocks out of the render loop
  std::filesystem::path image, json, csv;  ///< empty: not written
  std::filesystem::path trace;             ///< what each thread did when; empty: not recorded
};
int render(RenderOptions options, const QueueRegistry& queues);

/// `irt compare`: several queues, several numbers of threads, several workloads, interleaved.
struct CompareOptions {
  std::vector<WorkloadOptions> workloads{{}};
  std::vector<std::string> queues;  ///< empty: all
  std::vector<unsigned> threads;    ///< empty: 1, 2, 4 ... up to what the machine has
  unsigned frames = 0;              ///< per repetition; 0: as many as fit into `seconds`
  unsigned repetitions = 5, warmup = 1;
  double seconds = 60;   ///< what all measurements together should take
  double patience = 30;  ///< seconds that a queue may take beyond ten times what is expected
  std::vector<std::string> plugins;
  bool resume = false;
  /// All queues of one workload and number of threads are in the same part, for only there are they
  /// interleaved.
  Shard shard;
  std::filesystem::path out = "irt-out", json;
  std::vector<std::string> given;  ///< the options that the user did set, by their long names
};
int compare(const CompareOptions& options, QueueRegistry& queues);

/// `irt list`: every choice there is, a line each.
int list(const QueueRegistry& queues);

/// `irt overhead`: what measuring costs, and what the type-erased face of a queue costs. In
/// processor time, from pairs of frames rendered one after the other.
struct OverheadOptions {
  WorkloadOptions workload;
  unsigned threads = 1;
  unsigned frames = 100;
  std::filesystem::path json;
};
int overhead(OverheadOptions options);

/// `irt collide`: the engine's other application, a cloud of particles in a scene.
struct CollideOptions {
  WorkloadOptions workload;
  std::string queue;     ///< empty: the first
  unsigned threads = 0;  ///< 0: as many as the machine has
  unsigned frames = 10;
  std::uint32_t particles = 100'000;
  std::filesystem::path json;
};
int collide(CollideOptions options, const QueueRegistry& queues);

/// Throws UsageError where a queue is named and none is used. `workload` was checked.
void check_queue(const std::string& queue, const WorkloadOptions& workload);

/// `threads`, or as many as the machine has where it is 0. Throws UsageError above `max_threads`.
unsigned settle_threads(unsigned threads);

}  // namespace irt::frames
