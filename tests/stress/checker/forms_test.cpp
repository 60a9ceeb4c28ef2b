#include <gtest/gtest.h>

#include "stress/checker/checker.hpp"
#include "stress/checker/symbols.hpp"
#include "tests/stress/checker/findings.hpp"

namespace irt::checker {
namespace {

class Forms : public testing::Test {
 protected:
  virtual_cores::Module module_{IRT_FORMS_PROBE};
};

TEST_F(Forms, accesses_of_every_form_are_announced) {
#if !defined(IRT_ANNOUNCER)
  GTEST_SKIP() << "the headers of GCC's plug-ins are not installed";
#endif
  unsigned count = 0;
  const auto* programs =
      module_.function<const findings::Program*(unsigned*)>("irt_forms_programs")(&count);
  for (unsigned i = 0; i < count; ++i) {
    Scenario scenario;
    scenario.module = &module_;
    for (const auto thread : programs[i].threads)
      if (thread != nullptr) scenario.threads.emplace_back(thread);
    const Result result = check(scenario, {.seconds = 10});
    EXPECT_EQ(result.finding ? std::string(name_of(result.finding->kind)) : "", programs[i].finding)
        << programs[i].name;
  }
}

}  // namespace
}  // namespace irt::checker
