// Code whose executions differ where all choices are the same: nothing is proved, and nobody
// accused.

#include <gtest/gtest.h>
#include <string>

#include "stress/checker/queue_check.hpp"
#include "stress/checker/verdict.hpp"
#include "tests/stress/checker/probe_entries.hpp"

namespace irt::checker {
namespace {

class Differs : public testing::Test {
 protected:
  QueueResult check(std::vector<std::string> shapes) {
    CheckSettings settings;
    settings.quiet = true;
    settings.seconds = 2;
    settings.keep_going = keep_going_;
    settings.shapes = std::move(shapes);
    return check_queue(probe_entry(module_, "chance-elsewhere-bug"), module_, settings, "");
  }

  virtual_cores::Module module_{IRT_DIFFERS_PROBE};
  bool keep_going_ = false;
};

TEST_F(Differs, what_does_not_differ_is_accused) {
  const QueueResult result = check({"E|D"});
  EXPECT_TRUE(result.found);
  EXPECT_FALSE(result.differs);
}

// What one shape leaves in the C library may be why another one finds something.
TEST_F(Differs, nobody_is_accused_once_executions_differ) {
  const QueueResult result = check({"EE:D|D", "E|D"});
  EXPECT_TRUE(result.differs);
  EXPECT_FALSE(result.found);
  const std::string said = verdict("q", result);
  EXPECT_NE(said.find("q: nothing found"), std::string::npos) << said;
  EXPECT_NE(said.find("the data race that was seen"), std::string::npos) << said;
}

TEST_F(Differs, what_was_found_before_that_is_taken_back) {
  keep_going_ = true;
  const QueueResult result = check({"E|D", "EE:D|D"});
  EXPECT_TRUE(result.differs);
  EXPECT_FALSE(result.found);
  for (const ShapeResult& shape : result.shapes) EXPECT_TRUE(shape.report.empty()) << shape.shape;
}

}  // namespace
}  // namespace irt::checker
