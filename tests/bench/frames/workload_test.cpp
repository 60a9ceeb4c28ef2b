#include "bench/frames/workload.hpp"

#include <gtest/gtest.h>
#include <map>

#include "queues/registry.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::frames {
namespace {

// A small picture in which every choice has something to do.
nlohmann::json usual() {
  WorkloadOptions options;
  options.scene = "office";
  options.animate = "wave";
  options.width = options.height = 24;
  check(options);
  return options;
}

std::string hash_of(const WorkloadOptions& options) {
  Workload workload(options);
  const auto engine = workload.start_engine(workload.engine_options(2), built_in_queues().front());
  engine->run(workload.application());
  return workload.image_hash();
}

std::uint64_t rays_of(std::uint32_t lights) {
  auto options = usual().get<WorkloadOptions>();
  options.lights = lights;
  Workload workload(options);
  const auto engine = workload.start_engine(workload.engine_options(2), built_in_queues().front());
  return engine->run(workload.application()).rays();
}

TEST(Lights, FewerMeanFewerRays) {
  EXPECT_LT(rays_of(1), rays_of(3));
  EXPECT_EQ(rays_of(4), rays_of(0)) << "the office has four";
  EXPECT_THROW(rays_of(5), UsageError);
}

// Another value for every choice; where the build has no other there is nothing to compare.
const std::map<std::string, nlohmann::json> others{{"scene", "bunny"},
                                                   {"bvh", "wald"},
                                                   {"kernel", "watertight"},
                                                   {"packet_width", 8},
                                                   {"isa", "sse4"},
                                                   {"task_system", task_systems().back().name},
                                                   {"frame_buffer", "fixed-point"},
                                                   {"termination", "leave-when-empty"},
                                                   {"shader", "path"},
                                                   {"secondary", "thesis"},
                                                   {"animate", ""},
                                                   {"update", "rebuild"},
                                                   {"task_size", 3},
                                                   {"width", 25},
                                                   {"height", 25},
                                                   {"depth", 1},
                                                   {"samples_per_pixel", 2},
                                                   {"lights", 1}};

TEST(SamePicture, ChoicesThatDoNotShowGiveItToTheLastBit) {
  const auto options = usual().get<WorkloadOptions>();
  EXPECT_TRUE(same_picture(options, options));
  const std::string hash = hash_of(options);
  std::size_t choices = 0;
  visit_choices([&](const Choice& choice, auto) {
    const std::string name(choice.key.name);
    ++choices;
    SCOPED_TRACE(name);
    nlohmann::json changed = usual();
    ASSERT_TRUE(others.contains(name)) << "a new choice needs another value here";
    changed[name] = others.at(name);
    if (changed == usual()) return;
    const auto other = changed.get<WorkloadOptions>();
    EXPECT_EQ(same_picture(options, other), !results::find(name)->seen);
    if (!results::find(name)->seen) {
      EXPECT_EQ(hash_of(other), hash);
    }
  });
  EXPECT_EQ(choices, others.size());
}

}  // namespace
}  // namespace irt::frames
