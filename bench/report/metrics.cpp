#include "bench/report/metrics.hpp"

namespace irt {
namespace {

constexpr Metric frame_metrics[] = {
    {"fps", "frames per second [1/s]", "fps_samples"},
    {"speed_up", "speed-up over one thread"},
    {"get_ns_mean", "time per task in the queue, get and add [ns]", {}, true, "add_ns_mean"},
    {"failed_gets_per_frame", "pops that found nothing [1/frame]", {}, true},
    {"idle_ms", "without work [ms/frame and thread]", {}, true},
    {"barrier_wait_ms", "at the barrier [ms/frame and thread]", {}, true},
    {"imbalance", "busiest thread over the mean"},
};
constexpr Metric operation_metrics[] = {
    {"operations_per_second", "operations [1/s]", "samples"},
    {"operations_per_cpu_second", "operations per second of processor time [1/s]",
     "samples_per_cpu_second"},
    {"frames_per_second", "frames per second [1/s]"},
    {"fps", "frames per second [1/s]"},
    {"failed_pops_per_second", "failed pops [1/s]", {}, true},
    {"failed_pushes_per_second", "failed pushes [1/s]", {}, true},
    {"fairness", "fairness, slowest over fastest thread"},
    {"retries_per_operation", "retries per operation, by the build that counts"},
    {"cas_failures_per_success", "failed CAS per success"},
    {"transfers_per_operation", "cache lines moved per operation"},
    {"context_switches_per_second", "context switches [1/s]", {}, true},
    {"memory_peak_bytes", "most memory [bytes]"},
    {"memory_held_bytes", "memory held at the end [bytes]"},
    {"energy_joules", "energy [J]"},
};
constexpr Metric micro_metrics[] = {
    {"ns_per_operation", "time per iteration [ns]", "samples"},
};

constexpr Choice frame_choices[] = {
    {"threads", "threads", true},
    {"task_size", "task size [packets]", true},
    {"packet_width", "packet width [rays]", true},
    {"samples_per_pixel", "samples per pixel", true},
    {"width", "width [pixels]", true},
    {"depth", "depth", true},
    {"particles", "particles", true},
    {"bvh", "BVH"},
    {"kernel", "kernel"},
    {"isa", "instruction set"},
    {"task_system", "task system", false, true},
    {"frame_buffer", "frame buffer"},
    {"termination", "termination"},
    {"shader", "shader"},
    {"secondary", "secondary rays"},
    {"animate", "animation"},
    {"update", "update"},
    {"placement", "placement"},
};
constexpr Choice operation_choices[] = {
    {"threads", "threads", true},
    {"work_ns", "work between operations [ns]", true},
    {"capacity", "capacity [elements]", true, true},
    {"task_size", "task size [packets]", true},
    {"placement", "placement"},
    {"allocator", "allocator"},
    {"producers", "producers", false, true},
    {"consumers", "consumers", false, true},
    {"operation_mix", "operation mix", false, true},
    {"variant", "variant"},
};

}  // namespace

std::span<const Metric> metrics(Family family) {
  switch (family) {
    case Family::frames:
      return frame_metrics;
    case Family::operations:
      return operation_metrics;
    case Family::micro:
      break;
  }
  return micro_metrics;
}

std::optional<double> value_of(const Run& run, const Metric& metric) {
  auto value = run.number(metric.key);
  if (value && !metric.add.empty()) {
    const auto more = run.number(metric.add);
    if (!more) return std::nullopt;
    *value += *more;
  }
  return value;
}

std::span<const Choice> choices(Family family) {
  if (family == Family::frames) return frame_choices;
  if (family == Family::operations) return operation_choices;
  return {};
}

}  // namespace irt
