#include "stress/threads/report.hpp"

#include <gtest/gtest.h>

namespace irt::stress {
namespace {

Result sample() {
  Result result;
  result.queue = "q";
  result.suite = "scenarios";
  result.scenario = "mpmc";
  result.operations = 10;
  result.seconds = 0.5;
  result.findings.push_back(
      {.claim = "a < b", .evidence = "x & \"y\"\x01", .repeat = "./irt stress", .seconds = 0.25});
  return result;
}

TEST(Report, TextNamesClaimEvidenceAndCommand) {
  const std::string text = to_text(sample());
  EXPECT_NE(text.find("FINDING q"), std::string::npos);
  EXPECT_NE(text.find("broken: a < b (after 0.25 s)"), std::string::npos);
  EXPECT_NE(text.find("repeat: ./irt stress"), std::string::npos);
}

TEST(Report, JunitEscapesAndCounts) {
  const std::string xml = to_junit({sample(), {}});
  EXPECT_NE(xml.find("<testsuite name=\"q\" tests=\"1\" failures=\"1\">"), std::string::npos)
      << xml;
  EXPECT_NE(xml.find("<failure message=\"a &lt; b\">x &amp; &quot;y&quot;\n"), std::string::npos)
      << xml;
}

TEST(Report, JsonSurvivesTheWayThroughTheChild) {
  const nlohmann::json json = sample();
  const auto back = json.get<Result>();
  EXPECT_EQ(back.findings.size(), 1U);
  EXPECT_EQ(back.findings[0].claim, "a < b");
  EXPECT_EQ(back.operations, 10U);
}

}  // namespace
}  // namespace irt::stress
