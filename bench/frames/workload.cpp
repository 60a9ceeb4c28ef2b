#include "bench/frames/workload.hpp"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <string_view>
#include <system_error>
#include <vector>

#include "bench/conditions/system.hpp"
#include "queues/nearest.hpp"
#include "renderer/scene/scenes.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::frames {
namespace {

// The entry called `name`; the first one if `name` is empty, which is then filled in.
template <class Entry>
const Entry& entry_of(std::span<const Entry> entries, std::string& name, std::string_view kind) {
  if (name.empty()) name = entries.front().name;
  const auto found = std::ranges::find(entries, name, &Entry::name);
  if (found != entries.end()) return *found;
  std::vector<std::string_view> names;
  for (const Entry& entry : entries) names.push_back(entry.name);
  throw UsageError(unknown_name(kind, name, names));
}

/// Refuses what is neither the name of a scene nor, by its dot or slash, that of a file.
void check_scene(std::string_view scene) {
  if (scene.find_first_of("./") != std::string_view::npos) return;
  std::vector<std::string_view> names;
  for (const SceneEntry& entry : built_in_scenes()) names.push_back(entry.name);
  for (const SceneEntry& entry : real_scenes()) names.push_back(entry.name);
  if (std::ranges::find(names, scene) == names.end()) {
    throw UsageError(unknown_name("scene", scene, names) + "; or give a .json, .ply or .obj file");
  }
}

void check_range(std::string_view option, std::uint64_t value, std::uint64_t least,
                 std::uint64_t most) {
  if (value >= least && value <= most) return;
  throw UsageError(fmt::format("{} {}: must be from {} to {}", option, value, least, most));
}

// Breadth first, as a fair queue goes about it, a frame may hold what all primary rays send on at
// once.
double bytes_needed(const WorkloadOptions& options, std::uint64_t rays_per_hit) {
  const double tasks_at_once = 1 + static_cast<double>(rays_per_hit);
  constexpr double arrays = 11, overhead_per_task = 512;
  const double pixels = static_cast<double>(options.width) * options.height;
  const double lanes = std::max(options.task_size, 16u);
  const double task = lanes * arrays * 4 + overhead_per_task;
  return pixels / options.task_size * task * tasks_at_once + pixels * 32;
}

void check_memory(const WorkloadOptions& options, std::uint64_t rays_per_hit) {
  const double needed = bytes_needed(options, rays_per_hit);
  const auto memory = static_cast<double>(survey_system().memory_bytes);
  if (needed <= memory / 2) return;
  throw UsageError(fmt::format(
      "--size {}x{} with --task-size {}: needs about {:.1f} GB, more than half of the {:.1f} GB "
      "of this machine; use a smaller picture or larger tasks",
      options.width, options.height, options.task_size, needed / 1e9, memory / 1e9));
}

// What a work queue's render threads can do and others' task systems cannot.
void check_task_system(const WorkloadOptions& options) {
  if (uses_queue(options)) return;
  const std::string_view system = options.task_system;
  if (options.pin) {
    throw UsageError(fmt::format(
        "--pin: the task system {} places its threads itself; --task-system queue binds them",
        system));
  }
  if (options.termination != terminations().front().name) {
    throw UsageError(
        fmt::format("--termination {}: the task system {} ends a frame when all tasks are done; "
                    "--task-system queue has the choice",
                    options.termination, system));
  }
}

// Refuses an option that the shader does nothing with. `what` is what it lacks.
void require_shader(const WorkloadOptions& options, bool ShaderEntry::*taking,
                    std::string_view given, std::string_view what) {
  std::string name = options.shader;
  if (entry_of(shaders(), name, "shader").*taking) return;
  throw UsageError(fmt::format("{}: the shader {} has {}; --shader {} has", given, name, what,
                               std::ranges::find_if(shaders(), taking)->name));
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

void check(WorkloadOptions& options) {
  check_range("--task-size", options.task_size, 1, 65'536);
  check_range("--depth", options.depth, 0, 64);
  check_range("--samples-per-pixel", options.samples_per_pixel, 1, 65'535);
  check_range("--size: a width of", options.width, 1, 65'535);
  check_range("--size: a height of", options.height, 1, 65'535);
  entry_of(accelerators(), options.bvh, "BVH");
  entry_of(triangle_kernels(), options.kernel, "kernel");
  entry_of(frame_buffers(), options.frame_buffer, "frame buffer");
  entry_of(task_systems(), options.task_system, "task system");
  entry_of(terminations(), options.termination, "termination");
  entry_of(shaders(), options.shader, "shader");
  entry_of(secondary_ways(), options.secondary, "way of secondary rays");
  if (options.scene.empty()) options.scene = built_in_scenes().front().name;
  check_scene(options.scene);
  if (!options.animate.empty()) {
    entry_of(animations(), options.animate, "animation");
    entry_of(updates(), options.update, "update");
  } else if (!options.update.empty()) {
    throw UsageError(
        fmt::format("--update {}: nothing moves; --animate says what should", options.update));
  }
  check_task_system(options);
  if (options.secondary != secondary_ways().front().name) {
    require_shader(options, &ShaderEntry::takes_secondary, "--secondary " + options.secondary,
                   "no choice of ways");
  }
}

void require_bounces(const WorkloadOptions& options) {
  require_shader(options, &ShaderEntry::takes_depth, fmt::format("--depth {}", options.depth),
                 "no bounces");
}

void to_json(nlohmann::json& json, const WorkloadOptions& options) {
  visit_choices([&](const Choice& choice, auto member) {
    json[std::string(choice.key.name)] = options.*member;
  });
  json["pin"] = options.pin;
}

void from_json(const nlohmann::json& json, WorkloadOptions& options) {
  // What an older file does not have was then as it is by default now.
  visit_choices([&](const Choice& choice, auto member) {
    const auto found = json.find(std::string(choice.key.name));
    if (found != json.end()) found->get_to(options.*member);
  });
  json.at("pin").get_to(options.pin);
}

void add_choices(nlohmann::ordered_json& run, const WorkloadOptions& options, results::Tools tool) {
  visit_choices([&]<class T>(const Choice& choice, T WorkloadOptions::*member) {
    if ((results::find(choice.key.name)->by & tool) == 0) return;
    const T& value = options.*member;
    run[std::string(choice.key.name)] =
        choice.open && value == T() ? nlohmann::ordered_json() : nlohmann::ordered_json(value);
  });
}

bool same_picture(const WorkloadOptions& a, const WorkloadOptions& b) {
  const nlohmann::json one = a, other = b;
  return std::ranges::all_of(results::fields, [&](const results::Field& field) {
    const std::string key(field.key);
    return !field.seen || one.at(key) == other.at(key);
  });
}

bool uses_queue(const WorkloadOptions& options) {
  std::string name = options.task_system;
  return entry_of(task_systems(), name, "task system").uses_queue;
}

bool has_exact_sums(const WorkloadOptions& options) {
  std::string name = options.frame_buffer;
  return entry_of(frame_buffers(), name, "frame buffer").exact;
}

Workload::Workload(const WorkloadOptions& options) : options_(options) {
  const auto begin = std::chrono::steady_clock::now();
  scene_ = load_scene(options_.scene);
  load_s_ = seconds_since(begin);
  if (options_.lights != 0) {
    check_range("--lights", options_.lights, 1, scene_.lights.size());
    scene_.lights.resize(options_.lights);
  }
  const ShaderEntry& shader = entry_of(shaders(), options_.shader, "shader");
  check_memory(options_, shader.rays_per_hit(scene_));
  const auto loaded = std::chrono::steady_clock::now();
  try {
    build();
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("--bvh {}: {}", options_.bvh, error.what()));
  }
  build_s_ = seconds_since(loaded);
  frame_ = entry_of(frame_buffers(), options_.frame_buffer, "frame buffer")
               .make(options_.width, options_.height);
  shader_ = make_shader(*frame_);
  try {
    application_ = std::make_unique<ImageRendering>(scene_.camera, *frame_, *shader_,
                                                    options_.task_size, options_.samples_per_pixel);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

void Workload::build() {
  const AcceleratorEntry& structure = entry_of(accelerators(), options_.bvh, "BVH");
  const AcceleratorOptions tracing{
      .kernel = entry_of(triangle_kernels(), options_.kernel, "kernel").kernel,
      .width = options_.packet_width,
      .isa = options_.isa};
  if (options_.animate.empty()) {
    accelerator_ = structure.build(scene_.mesh, tracing);
    return;
  }
  animation_ = entry_of(animations(), options_.animate, "animation").make(scene_.mesh);
  animation_->pose(0, scene_.mesh);
  ThreadExecutor executor;
  auto dynamic = std::make_unique<DynamicAccelerator>(
      structure, scene_.mesh, tracing, entry_of(updates(), options_.update, "update").update,
      executor);
  dynamic_ = dynamic.get();
  accelerator_ = std::move(dynamic);
}

void Workload::rewind(Executor& executor) {
  animation_->pose(0, scene_.mesh);
  dynamic_->rebuild(executor);
}

Motion Workload::advance(std::uint32_t frame, Executor& executor, double render_s) {
  Motion motion;
  const auto begin = std::chrono::steady_clock::now();
  animation_->pose(frame, scene_.mesh);
  motion.pose_s = seconds_since(begin);
  const auto posed = std::chrono::steady_clock::now();
  motion.rebuilt = dynamic_->update(executor, render_s);
  motion.update_s = seconds_since(posed);
  return motion;
}

std::unique_ptr<Engine> Workload::start_engine(const EngineOptions& options,
                                               const QueueEntry& queue) const {
  std::string name = options_.task_system;
  try {
    return entry_of(task_systems(), name, "task system").make(options, queue, *accelerator_);
  } catch (const std::system_error& error) {
    throw UsageError(fmt::format("--threads {}: the system does not start that many ({})",
                                 options.threads, error.code().message()));
  }
}

std::unique_ptr<Shader> Workload::make_shader(FrameBuffer& frame) const {
  std::string shader = options_.shader, way = options_.secondary;
  const ShaderOptions shading{
      .max_depth = options_.depth,
      .secondary = entry_of(secondary_ways(), way, "way of secondary rays").how};
  return entry_of(shaders(), shader, "shader").make(scene_, frame, shading);
}

EngineOptions Workload::engine_options(unsigned threads) const {
  std::string name = options_.termination;
  return {.threads = threads,
          .rays_per_task = options_.task_size,
          .termination = entry_of(terminations(), name, "termination").policy,
          .pin = options_.pin};
}

std::string Workload::image_hash() const {
  return fmt::format("{:016x}", frame_->hash());
}

}  // namespace irt::frames
