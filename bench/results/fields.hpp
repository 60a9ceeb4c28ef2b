/// Every field of a run, a line each, in the order in which readers show them. What writes,
/// compares, merges, tabulates and plots runs reads this table, and no list of its own.
///
/// A field that is written and not listed does not compile (bench/results/record.hpp); one that is
/// listed and not written fails a test of the tool that should.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "bench/results/field.hpp"

namespace irt::results {

inline constexpr Tools by_frames = by_render | by_collide | by_replay;
inline constexpr Tools by_pictures = by_render | by_replay;
inline constexpr Tools by_operations = by_contention | by_simulate;
inline constexpr Tools by_simulator = by_simulate | by_replay;

inline constexpr std::array fields{
    // Whose runs these are.
    choice("kind", by_operations | by_replay | by_micro, "kind").at(Place::origin),
    choice("source", by_operations | by_replay | by_micro, "source").at(Place::origin),
    choice("machine", by_simulator, "machine").at(Place::origin),
    choice("benchmark", by_micro, "benchmark").at(Place::subject),
    choice("scene", by_frames, "scene").in_picture().at(Place::topic),
    choice("scenario", by_operations | by_replay, "scenario").at(Place::topic),
    choice("queue", by_frames | by_operations, "queue").at(Place::subject),

    // Choices.
    choice("threads", by_all, "threads").over(),
    choice("work_ns", by_operations, "work between operations", "ns").over(),
    choice("work_spread", by_contention, "spread of the work").over(),
    choice("capacity", by_operations, "capacity", "elements").over().following(),
    choice("task_size", by_frames, "task size", "packets").over(),
    choice("mean_task_us", by_replay, "mean task", "us").over().following(),
    choice("packet_width", by_frames, "packet width", "rays").over().column("packet"),
    choice("samples_per_pixel", by_pictures, "samples per pixel").in_picture().over(),
    choice("width", by_pictures, "width", "pixels").in_picture().over(),
    choice("height", by_pictures, "height", "pixels").in_picture().following(),
    choice("depth", by_pictures, "depth").in_picture().over(),
    choice("lights", by_pictures, "lights").in_picture().over(),
    choice("particles", by_collide, "particles").over(),
    choice("bvh", by_frames, "BVH"),
    choice("kernel", by_frames, "kernel").in_picture(),
    choice("isa", by_frames, "instruction set"),
    choice("task_system", by_frames, "task system").following(),
    choice("frame_buffer", by_pictures, "frame buffer").in_picture(),
    choice("termination", by_frames, "termination"),
    choice("shader", by_pictures, "shader").in_picture(),
    choice("secondary", by_pictures, "secondary rays"),
    choice("animate", by_pictures, "animation").in_picture(),
    choice("update", by_pictures, "update"),
    // Of measured frames and micro benchmarks it is read from the conditions.
    choice("placement", by_operations | by_replay, "placement"),
    condition("allocator", by_render | by_operations).apart("allocator"),
    choice("producers", by_operations, "producers").following(),
    choice("consumers", by_operations, "consumers").following(),
    condition("operation_mix", by_operations).apart("operation mix").following(),
    condition("interface", by_contention).apart("interface").following(),

    // What became of the run.
    condition("status", by_all & ~by_collide),
    condition("message", by_all & ~by_collide),

    // Figures of operations.
    figure("operations_per_second", by_operations)
        .plot("operations", "1/s")
        .column("operations/s")
        .with_samples("samples")
        .within("operations_per_second_low", "operations_per_second_high"),
    figure("operations_per_second_low", by_operations).column("from"),
    figure("operations_per_second_high", by_operations).column("to"),
    figure("samples", by_operations | by_replay | by_micro),
    figure("operations_per_cpu_second", by_contention)
        .plot("operations per second of processor time", "1/s")
        .with_samples("samples_per_cpu_second"),
    figure("samples_per_cpu_second", by_contention),
    figure("failed_pops_per_second", by_operations)
        .plot("failed pops", "1/s")
        .unless_zero()
        .column("failed pops/s"),
    figure("failed_pushes_per_second", by_operations)
        .plot("failed pushes", "1/s")
        .unless_zero()
        .column("failed pushes/s"),
    figure("held_back_per_second", by_contention),
    figure("fairness", by_operations)
        .plot("fairness, slowest over fastest thread")
        .column("fairness"),
    figure("latency_ns", by_operations),
    // Of every operation, written down.
    figure("rank_error_mean", by_operations)
        .plot("rank error, mean", "elements")
        .column("rank error"),
    figure("rank_error_p99", by_operations).column("rank error p99"),
    figure("rank_error_max", by_operations).column("rank error max"),
    figure("pushes_overtaken", by_operations)
        .plot("share of pushes overtaken")
        .column("pushes overtaken"),
    figure("pops_overtaken", by_operations)
        .plot("share of pops overtaken")
        .column("pops overtaken"),
    figure("order_operations", by_operations),
    figure("retries_per_operation", by_operations)
        .plot("retries per operation, by the build that counts")
        .column("retries/operation"),

    // Figures of frames.
    figure("fps", by_frames)
        .plot("frames per second", "1/s")
        .column("frames/s")
        .with_samples("fps_samples")
        .within("fps_low", "fps_high"),
    figure("fps_low", by_pictures).column("from"),
    figure("fps_high", by_pictures).column("to"),
    figure("fps_samples", by_render),
    figure("fps_lower_quartile", by_render | by_collide),
    figure("fps_upper_quartile", by_render | by_collide),
    figure("seconds_per_frame", by_render),
    figure("frame_ms_p99", by_render)
        .plot("the longest frame of a hundred", "ms")
        .column("frame p99 [ms]"),
    figure("speed_up", by_pictures).plot("speed-up over one thread").column("speed-up"),
    figure("loop_speed_up", by_replay),
    figure("rays_per_frame", by_pictures),
    figure("rays_per_second", by_render | by_collide).column("rays/s"),
    figure("tasks_per_frame", by_pictures),
    figure("get_ns", by_pictures).column("get median [ns]"),
    figure("get_ns_p99", by_render).column("get p99 [ns]"),
    figure("get_ns_mean", by_render)
        .plot("time per task in the queue, get and add", "ns")
        .plus("add_ns_mean")
        .unless_zero()
        .column("get mean [ns]"),
    figure("add_ns", by_pictures).column("add median [ns]"),
    figure("add_ns_p99", by_render).column("add p99 [ns]"),
    figure("add_ns_mean", by_render).column("add mean [ns]"),
    figure("failed_gets_per_frame", by_render)
        .plot("pops that found nothing", "1/frame")
        .unless_zero()
        .column("failed pops/frame"),
    figure("overflowed_per_frame", by_render).column("failed pushes/frame"),
    figure("idle_ms", by_render)
        .plot("without work", "ms/frame and thread")
        .unless_zero()
        .column("idle [ms]"),
    figure("barrier_wait_ms", by_render)
        .plot("at the barrier", "ms/frame and thread")
        .unless_zero()
        .column("barrier [ms]"),
    figure("imbalance", by_render).plot("busiest thread over the mean").column("imbalance"),
    figure("work_per_task_ns", by_render).column("work per task [ns]"),
    figure("pose_ms", by_render),
    figure("update_ms", by_render),
    figure("share_rebuilt", by_render),
    figure("share_generate", by_render),
    figure("share_render_loop", by_render),
    figure("share_output", by_render),
    figure("share_traverse", by_render),
    figure("share_intersect", by_render),
    figure("share_shade", by_pictures),
    figure("share_queue", by_render),
    figure("share_waiting", by_render),
    figure("share_get", by_replay),
    figure("share_add", by_replay),
    figure("share_idle", by_replay),
    figure("share_trace", by_replay),
    figure("share_barrier", by_replay),
    figure("share_serial", by_replay),
    figure("lost_tasks", by_render),
    figure("doubled_tasks", by_render),
    figure("image_hash", by_render),
    figure("same_image", by_render),
    figure("collisions", by_collide),
    figure("contacts_hash", by_collide),

    // Figures of the simulator.
    figure("cas_failures_per_success", by_simulator)
        .plot("failed CAS per success")
        .column("failed CAS per success"),
    figure("transfers_per_operation", by_simulate)
        .plot("cache lines moved per operation")
        .column("line transfers/operation"),
    figure("sleeps_per_operation", by_simulate),
    figure("transfers_per_task", by_replay),
    figure("sleeps_per_task", by_replay),
    figure("waiting", by_simulator).column("waiting, by cause"),
    figure("hot_lines", by_simulate),
    figure("accesses_per_cpu_second", by_simulate),

    // Figures of micro benchmarks.
    figure("ns_per_operation", by_micro)
        .plot("time per iteration", "ns")
        .column("ns/iteration")
        .with_samples("samples")
        .within("ns_per_operation_low", "ns_per_operation_high"),
    figure("ns_per_operation_low", by_micro).column("from"),
    figure("ns_per_operation_high", by_micro).column("to"),

    // Figures of the system.
    figure("context_switches_per_second", by_operations)
        .plot("context switches", "1/s")
        .unless_zero()
        .column("context switches/s"),
    figure("memory_peak_bytes", by_operations)
        .plot("most memory", "bytes")
        .column("most memory [bytes]"),
    figure("memory_held_bytes", by_contention).plot("memory held at the end", "bytes"),
    figure("energy_joules", by_operations).plot("energy", "J").column("energy [J]"),
    figure("counters", by_operations),
    figure("counted", by_contention),
    figure("cpu_seconds", by_contention),

    // How the figures came about.
    condition("repetitions", by_render | by_operations | by_micro).column("repetitions"),
    condition("frames", by_render | by_collide),
    condition("warmup", by_render),
    condition("triangles", by_render | by_collide),
    condition("pinned", by_render),
    condition("clock_ns", by_render | by_operations),
    condition("harness_ns", by_contention),
    condition("not_counted", by_contention),
    condition("oversubscribed", by_contention),
    condition("processors", by_contention),
    condition("rounds", by_contention),
    condition("seconds", by_contention),
    condition("steady_repetitions", by_contention),
    condition("work_ns_measured", by_contention),
    condition("seed", by_contention),
    condition("seeds", by_simulator),
    condition("levels", by_simulator),
    condition("band", by_simulator),
    condition("work_scale", by_replay),
    condition("recorded_frame_ms", by_replay),
    condition("recorded_spread", by_replay),
    condition("claims", by_operations),
    condition("conditions", by_all),
};

/// Runs of one family have figures in common and stand in one table.
enum class Family : std::uint8_t {
  frames,      ///< `irt compare`, `render`, `collide`, simulated frames: fields `scene`, `fps`
  operations,  ///< `irt bench contention` and the simulator: field `kind`
  micro,       ///< Google Benchmark's JSON
};
constexpr Tools tools_of(Family family) {
  switch (family) {
    case Family::frames:
      return by_frames;
    case Family::operations:
      return by_operations;
    case Family::micro:
      break;
  }
  return by_micro;
}

constexpr const Field* find(std::string_view key) {
  const auto found = std::ranges::find(fields, key, &Field::key);
  return found == fields.end() ? nullptr : &*found;
}

/// The key of a field of the table. Another does not compile.
struct Key {
  // NOLINTNEXTLINE(google-explicit-constructor): a key is written as its name
  consteval Key(const char* text) : name(text) {
    // GCC with -fsanitize=undefined takes no comparison of `find`'s answer for constant.
    if (std::ranges::find(fields, std::string_view(text), &Field::key) == fields.end())
      throw "no field of bench/results/fields.hpp has this key";
  }
  // NOLINTNEXTLINE(google-explicit-constructor)
  constexpr Key(const Field& field) : name(field.key) {}
  std::string_view name;
};

}  // namespace irt::results
