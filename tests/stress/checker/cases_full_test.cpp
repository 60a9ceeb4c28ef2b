// Healthy cases are not accused by default settings, whatever `irt check` finds to do in its time.

#include <algorithm>

#include "tests/stress/checker/cases.hpp"

namespace irt::checker {
namespace {

class Healthy : public Cases, public testing::WithParamInterface<std::string_view> {};

TEST_P(Healthy, is_not_accused_by_default_settings) {
  const QueueResult result = check(GetParam(), CheckSettings{}.seconds);
  EXPECT_FALSE(result.found) << finding_of(result);
}

std::vector<std::string_view> healthy() {
  std::vector<std::string_view> names;
  for (const Case& c : cases)
    if (c.right.empty()) names.push_back(c.queue);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Cases, Healthy, testing::ValuesIn(healthy()), [](const auto& test) {
  std::string name(test.param);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace irt::checker
