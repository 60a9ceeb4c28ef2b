#include <cstdlib>
#include <gtest/gtest.h>
#include <hwy/highway.h>
#include <string>
#include <vector>

#include "queues/registry.hpp"
#include "renderer/engine/task_systems.hpp"
#include "renderer/frame_buffer/fixed_point.hpp"
#include "renderer/scene/scenes.hpp"
#include "tests/renderer/engine/test_queues.hpp"
#include "tests/renderer/shading/render.hpp"

namespace irt {
namespace {

int repetitions() {
  const char* wanted = std::getenv("IRT_REPETITIONS");  // NOLINT(concurrency-mt-unsafe)
  return wanted == nullptr ? 2 : std::atoi(wanted);     // NOLINT(cert-err34-c)
}

// A scene with what renders it; built once.
struct Stage {
  explicit Stage(const SceneEntry& entry)
      : scene(entry.make()),
        structure(accelerators().front().build(scene.mesh, {})),
        frame(48, 48),
        shader(shaders().front().make(scene, frame, {})),
        application(scene.camera, frame, *shader, rays_per_task) {}

  static constexpr std::uint32_t rays_per_task = 32;  // many small tasks, for many interleavings

  Scene scene;
  std::unique_ptr<Accelerator> structure;
  FixedPointFrameBuffer frame;
  std::unique_ptr<Shader> shader;
  ImageRendering application;

  [[nodiscard]] EngineOptions options(unsigned threads, Termination termination) const {
    return {.threads = threads, .rays_per_task = rays_per_task, .termination = termination};
  }
  std::uint64_t hash(const EngineOptions& options, const QueueEntry& queue) {
    make_engine(options, queue, *structure)->run(application);
    return frame.hash();
  }
};

// The first six queues with every number of threads; of further ones, which are many and slow when
// threads outnumber cores, two.
std::vector<unsigned> thread_counts(const QueueEntry& queue) {
  if (&queue - built_in_queues().data() < 6) return {1, 2, 3, 5, 8, 16};
  return {2, 5};
}

std::unique_ptr<Accelerator> build_accelerator(std::string_view name, const Mesh& mesh) {
  for (const AcceleratorEntry& entry : accelerators()) {
    if (entry.name == name) return entry.build(mesh, {.width = 16});
  }
  return nullptr;
}

TEST(Determinism, TheHashIsTheSameForEveryQueueThreadCountAndPolicy) {
  for (const SceneEntry& entry : built_in_scenes()) {
    Stage stage(entry);
    const std::uint64_t expected =
        stage.hash(stage.options(1, Termination::leave_when_empty), built_in_queues().front());
    for (const QueueEntry& queue : built_in_queues()) {
      for (const TerminationEntry& termination : terminations()) {
        for (const unsigned threads : thread_counts(queue)) {
          SCOPED_TRACE(std::string(entry.name) + " " + std::string(queue.name) + " " +
                       std::string(termination.name) + " " + std::to_string(threads));
          auto engine =
              make_engine(stage.options(threads, termination.policy), queue, *stage.structure);
          for (int i = 0; i < repetitions(); ++i) {
            const FrameStats stats = engine->run(stage.application);
            ASSERT_EQ(stage.frame.hash(), expected);
            ASSERT_EQ(stats.lost + stats.doubled + engine->tasks_in_use(), 0u);
          }
        }
      }
    }
  }
}

TEST(Determinism, SoItIsForEveryWidthInstructionSetAndTaskSystem) {
  Scene scene = load_scene("office");
  scene.mesh.triangles.resize(2000);  // walls and desk; structures are built many times
  FixedPointFrameBuffer frame(48, 48);
  const auto shader = shaders().front().make(scene, frame, {});
  ImageRendering application(scene.camera, frame, *shader, 64);
  std::size_t combinations = 0;
  for (const AcceleratorEntry& structure : accelerators()) {
    if (structure.name == "none") continue;
    for (const TriangleKernelEntry& kernel : triangle_kernels()) {
      std::uint64_t expected = 0;
      for (const unsigned width : {1u, 4u, 8u, 16u}) {
        for (const char* isa : {"", "sse4", "avx2", "avx512"}) {
          std::unique_ptr<Accelerator> accelerator;
          try {
            accelerator =
                structure.build(scene.mesh, {.kernel = kernel.kernel, .width = width, .isa = isa});
          } catch (const std::invalid_argument&) {
            continue;  // the structure or this machine has not got it
          }
          const TaskSystemEntry& system = task_systems()[combinations++ % task_systems().size()];
          SCOPED_TRACE(std::string(structure.name) + " " + std::string(kernel.name) + " " +
                       std::to_string(width) + " " + isa + " " + std::string(system.name));
          system.make({.threads = 2, .rays_per_task = 64}, built_in_queues().front(), *accelerator)
              ->run(application);
          if (expected == 0) expected = frame.hash();
          ASSERT_EQ(frame.hash(), expected);
        }
      }
    }
  }
  EXPECT_GE(combinations, 16u);
}

TEST(Determinism, SoItIsForEveryShaderWithSeveralSamples) {
  const Scene scene = built_in_scenes().front().make();
  const auto structure = accelerators().front().build(scene.mesh, {});
  for (const ShaderEntry& entry : shaders()) {
    FixedPointFrameBuffer frame(32, 32);
    const auto shader = entry.make(scene, frame, {});
    ImageRendering application(scene.camera, frame, *shader, 32, 3);
    std::uint64_t expected = 0;
    for (const QueueEntry& queue : built_in_queues()) {
      for (const unsigned threads : {1u, 3u}) {
        SCOPED_TRACE(std::string(entry.name) + " " + std::string(queue.name));
        const EngineOptions options{.threads = threads, .rays_per_task = 32};
        const auto engine = make_engine(options, queue, *structure);
        for (int i = 0; i < repetitions(); ++i) {
          engine->run(application);
          if (expected == 0) expected = frame.hash();
          ASSERT_EQ(frame.hash(), expected);
        }
      }
    }
  }
}

TEST(Determinism, SoItIsForEveryWayOfSecondaryRaysAndInstructionSetOfShading) {
  Scene scene = load_scene("office");
  scene.mesh.triangles.resize(4000);
  const std::pair<const char*, std::unique_ptr<Accelerator>> structures[] = {
      {"wide", build_accelerator("wide", scene.mesh)},
      {"wald", build_accelerator("wald", scene.mesh)}};
  std::uint64_t expected = 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    for (const SecondaryEntry& way : secondary_ways()) {
      for (const auto& [bvh, structure] : structures) {
        for (const std::uint32_t rays_per_task : {64u, 100u, 256u}) {
          SCOPED_TRACE(::testing::Message() << hwy::TargetName(target) << ", " << way.name << ", "
                                            << bvh << ", " << rays_per_task);
          FixedPointFrameBuffer frame(50, 40);
          const auto shader = shaders().front().make(scene, frame, {.secondary = way.how});
          ImageRendering application(scene.camera, frame, *shader, rays_per_task);
          make_engine({.threads = 2, .rays_per_task = rays_per_task}, built_in_queues().front(),
                      *structure)
              ->run(application);
          if (expected == 0) expected = frame.hash();
          EXPECT_EQ(frame.hash(), expected);
        }
      }
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

TEST(Determinism, ALostOrDoubledTaskChangesTheHash) {
  for (const SceneEntry& entry : built_in_scenes()) {
    Stage stage(entry);
    const auto options = stage.options(2, Termination::leave_when_empty);
    const std::uint64_t expected = stage.hash(options, queue_entry<PlainQueue>("plain"));
    EXPECT_NE(stage.hash(options, queue_entry<LossyQueue>("lossy")), expected);
    EXPECT_NE(stage.hash(options, queue_entry<DoublingQueue>("doubling")), expected);
  }
}

TEST(Determinism, FrameBuffersAgreeWithEachOther) {
  const Scene scene = built_in_scenes().front().make();
  const auto exact = frame_buffers().front().make(48, 48);
  render(scene, *exact, built_in_queues().front(), {.threads = 3});
  for (const FrameBufferEntry& entry : frame_buffers().subspan(1)) {
    const auto frame = entry.make(48, 48);
    render(scene, *frame, built_in_queues().front(), {.threads = 3});
    for (std::uint32_t pixel = 0; pixel < frame->pixels(); ++pixel) {
      for (int channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(frame->sum(pixel)[channel], exact->sum(pixel)[channel], 1e-5) << entry.name;
      }
    }
  }
}

}  // namespace
}  // namespace irt
