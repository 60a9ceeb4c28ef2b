#include <gtest/gtest.h>

#include "stress/checker/checker.hpp"
#include "stress/virtual_cores/symbols/symbols.hpp"
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
    Program checked;
    checked.module = &module_;
    for (const auto thread : programs[i].threads)
      if (thread != nullptr) checked.threads.emplace_back(thread);
    const Result result = check(checked, {.seconds = 10});
    EXPECT_EQ(result.finding ? std::string(name_of(result.finding->kind)) : "", programs[i].finding)
        << programs[i].name;
  }
}

// What assembly does, and a function that is left out on purpose, is named; nothing else is.
TEST_F(Forms, what_is_not_announced_is_named_by_its_line) {
  std::vector<std::string> names;
  for (const std::string& unseen : symbols::Symbols(module_).unseen_instructions().places) {
    const std::size_t at = unseen.find(" at forms_probe.cpp:");
    ASSERT_NE(at, std::string::npos) << unseen;
    names.push_back(unseen.substr(0, at));
  }
#if defined(IRT_ANNOUNCER)
  EXPECT_EQ(names, (std::vector<std::string>{"addq", "mov", "movq", "movq"}));
#else
  EXPECT_GT(names.size(), 15U) << "results and arguments of calls, copies in place";
#endif
}

}  // namespace
}  // namespace irt::checker
