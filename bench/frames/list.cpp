#include <fmt/format.h>

#include "bench/frames/commands.hpp"
#include "renderer/bvh/dynamic.hpp"
#include "renderer/engine/task_systems.hpp"
#include "renderer/scene/animation.hpp"
#include "renderer/scene/scenes.hpp"

namespace irt::frames {
namespace {

template <class Entries>
void section(std::string_view title, std::string_view option, const Entries& entries) {
  fmt::print("{} ({})\n", title, option);
  for (const auto& entry : entries) fmt::print("  {:<25}{}\n", entry.name, entry.summary);
  fmt::print("\n");
}

}  // namespace

int list(const QueueRegistry& queues) {
  section("Queues", "--queue", queues.entries());
  section("Scenes", "--scene, or a file", built_in_scenes());
  section("BVHs", "--bvh", accelerators());
  section("Kernels", "--kernel", triangle_kernels());
  section("Frame buffers", "--frame-buffer", frame_buffers());
  section("Terminations", "--termination", terminations());
  section("Shaders", "--shader", shaders());
  section("Secondary rays", "--secondary, of whitted", secondary_ways());
  section("Task systems", "--task-system", task_systems());
  section("Animations", "--animate, none by default", animations());
  section("Updates", "--update, with an animation", updates());
  fmt::print("The first of each is the default. With their files (docs/scenes.md) there are also");
  for (const SceneEntry& entry : real_scenes()) fmt::print(" {}", entry.name);
  fmt::print(".\n");
  return 0;
}

}  // namespace irt::frames
