/// What is rendered and how: everything of a measurement but the queue and the threads.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/results/fields.hpp"
#include "renderer/bvh/dynamic.hpp"
#include "renderer/engine/task_systems.hpp"
#include "renderer/frame_buffer/frame_buffer.hpp"
#include "renderer/scene/animation.hpp"
#include "renderer/scene/scene.hpp"
#include "renderer/shading/image.hpp"
#include "renderer/shading/shader.hpp"

namespace irt::frames {

/// As given on the command line; the defaults are the thesis' (chapter 4).
struct WorkloadOptions {
  /// Names; empty: the default.
  std::string scene, bvh, kernel, frame_buffer, task_system, termination, shader, secondary;
  unsigned packet_width = 0;                ///< rays per packet; 0: what the structure does best
  std::string isa;                          ///< instruction set; empty: the machine's best
  std::string animate;                      ///< animation; empty: nothing moves
  std::string update;                       ///< of the structure; empty: the default, if at all
  std::uint32_t task_size = 256;            ///< packets per task
  std::uint32_t width = 300, height = 300;  ///< pixels
  std::uint32_t depth = 4;                  ///< bounces
  std::uint32_t samples_per_pixel = 1;
  std::uint32_t lights = 0;  ///< the scene's first so many shine; 0: all
  bool pin = false;
};

/// A choice of a workload, to results and to the command line.
struct Choice {
  results::Key key;
  const char* option = nullptr;  ///< null: what asks for it asks for more
  const char* description = nullptr;
  bool open = false;  ///< its default leaves it to others: null in results
};

/// Calls `visit(choice, member)` for every choice. A tool asks for those that the table of fields
/// says it writes.
template <class Visitor>
void visit_choices(const Visitor& visit) {
  using W = WorkloadOptions;
  visit(Choice{"scene", "--scene", "a scene of 'irt list', or a file"}, &W::scene);
  visit(Choice{"bvh", "--bvh", "acceleration structure"}, &W::bvh);
  visit(Choice{"kernel", "--kernel", "how a ray is tested against a triangle"}, &W::kernel);
  visit(Choice{"packet_width", "--width",
               "rays per packet: 1, 4, 8 or 16 (default: what the BVH does best)", true},
        &W::packet_width);
  visit(Choice{"isa", "--isa", "instruction set: sse4, avx2 or avx512 (default: the best)", true},
        &W::isa);
  visit(Choice{"task_system", "--task-system", "who runs the tasks"}, &W::task_system);
  visit(Choice{"frame_buffer", "--frame-buffer", "where contributions meet"}, &W::frame_buffer);
  visit(Choice{"termination", "--termination", "when a thread leaves a frame"}, &W::termination);
  visit(Choice{"shader", "--shader", "what light does"}, &W::shader);
  visit(Choice{"secondary", "--secondary", "how whitted's secondary rays travel"}, &W::secondary);
  visit(Choice{"animate", "--animate", "what moves, frame by frame (default: nothing)", true},
        &W::animate);
  visit(Choice{"update", "--update", "how the BVH follows (default: auto)", true}, &W::update);
  visit(Choice{"task_size", "--task-size", "packets of rays per task"}, &W::task_size);
  visit(Choice{"width"}, &W::width);
  visit(Choice{"height"}, &W::height);
  visit(Choice{"depth", "--depth", "bounces after which a path ends"}, &W::depth);
  visit(Choice{"samples_per_pixel", "--samples-per-pixel", "primary rays per pixel"},
        &W::samples_per_pixel);
  visit(Choice{"lights", "--lights", "the scene's first so many lights shine (default: all)", true},
        &W::lights);
}

/// For journals.
void to_json(nlohmann::json& json, const WorkloadOptions& options);
void from_json(const nlohmann::json& json, WorkloadOptions& options);

/// Puts the choices that the tool writes into a run; those left to the structure are null.
void add_choices(nlohmann::ordered_json& run, const WorkloadOptions& options, results::Tools tool);

/// Puts the names of the defaults where nothing was given. Throws UsageError where a name is
/// unknown or a number is out of range.
void check(WorkloadOptions& options);

/// Refuses a shader that never bounces where a depth was asked for. Throws UsageError.
void require_bounces(const WorkloadOptions& options);

/// Whether two workloads, whose options were checked, must give the same picture to the last bit:
/// they differ at most in how it is made.
bool same_picture(const WorkloadOptions& a, const WorkloadOptions& b);

/// Whether a frame with these options, which were checked, goes through a work queue.
bool uses_queue(const WorkloadOptions& options);

/// Whether a frame with these options, which were checked, has the same sums on every run.
bool has_exact_sums(const WorkloadOptions& options);

/// What it took to get from one frame to the next. Times in seconds.
struct Motion {
  double pose_s = 0;    ///< to move the vertices
  double update_s = 0;  ///< to refit or rebuild the structure
  bool rebuilt = false;

  [[nodiscard]] double seconds() const { return pose_s + update_s; }
};

/// A scene with its structure, ready to be rendered by any engine.
class Workload {
 public:
  /// Loads and builds. `options` were checked. Throws SceneError, and UsageError where the frame
  /// would need more memory than half of what this machine has.
  explicit Workload(const WorkloadOptions& options);

  /// An engine that renders this workload. `queue` is ignored where the task system needs none.
  /// Throws UsageError if the threads cannot be started.
  [[nodiscard]] std::unique_ptr<Engine> start_engine(const EngineOptions& options,
                                                     const QueueEntry& queue) const;

  /// A shader as the options say, which adds to `frame`. Both outlive it.
  std::unique_ptr<Shader> make_shader(FrameBuffer& frame) const;

  /// Options of an engine for this workload, but for its threads.
  [[nodiscard]] EngineOptions engine_options(unsigned threads) const;

  /// Whether the scene moves from frame to frame. `rewind` and `advance` are for such alone.
  [[nodiscard]] bool animated() const { return animation_ != nullptr; }

  /// Goes back to the first frame, with a new structure, built by `executor`.
  void rewind(Executor& executor);

  /// Goes on to frame number `frame`. `render_s` is what rendering took since the last call.
  Motion advance(std::uint32_t frame, Executor& executor, double render_s);

  [[nodiscard]] const WorkloadOptions& options() const { return options_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const Accelerator& accelerator() const { return *accelerator_; }
  [[nodiscard]] const FrameBuffer& frame() const { return *frame_; }
  ImageRendering& application() { return *application_; }
  [[nodiscard]] double load_s() const { return load_s_; }    ///< to read or make the scene
  [[nodiscard]] double build_s() const { return build_s_; }  ///< to build the structure

  /// The hash of the last frame, as 16 hexadecimal digits.
  [[nodiscard]] std::string image_hash() const;

 private:
  void build();

  WorkloadOptions options_;
  double load_s_ = 0, build_s_ = 0;
  Scene scene_;
  std::unique_ptr<Animation> animation_;
  std::unique_ptr<Accelerator> accelerator_;
  DynamicAccelerator* dynamic_ = nullptr;  ///< the same, where the scene moves
  std::unique_ptr<FrameBuffer> frame_;
  std::unique_ptr<Shader> shader_;
  std::unique_ptr<ImageRendering> application_;
};

}  // namespace irt::frames
