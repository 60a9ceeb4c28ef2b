#include "bench/many_core/machine/placement.hpp"

#include <gtest/gtest.h>
#include <string>

namespace irt::many_core {
namespace {

TEST(Placement, levels_are_where_threads_first_leave_a_group) {
  const auto of = [](const char* machine, Placement placement) {
    std::string text;
    for (const Level& level : levels(load_profile(machine), placement))
      text += std::to_string(level.threads) + ' ' + std::string(level.name) + "; ";
    return text;
  };
  EXPECT_EQ(of("granite-rapids-96", Placement::close),
            "32 one node; 96 a core each; 192 all hardware threads; ");
  EXPECT_EQ(of("epyc-milan-2x64", Placement::close),
            "8 one cache; 64 one socket; 128 a core each; 256 all hardware threads; ");
  EXPECT_EQ(of("xeon-6132", Placement::siblings), "14 one socket; 28 all hardware threads; ");
  EXPECT_EQ(of("xeon-7400", Placement::spread), "24 all hardware threads; ");
}

}  // namespace
}  // namespace irt::many_core
