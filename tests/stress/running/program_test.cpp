// How programs begin and end: what they are told, what they say, their exit codes.
#include "stress/running/program.hpp"

#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <new>
#include <string>
#include <vector>

#include "stress/running/arguments.hpp"
#include "stress/running/shard.hpp"
#include "stress/running/usage_error.hpp"

namespace irt {
namespace {

struct Ended {
  int code;
  std::string said;
};

Ended ended(const std::function<int()>& work, std::string_view smaller = {}) {
  testing::internal::CaptureStderr();
  const int code = run_program("irt test", work, smaller);
  return {code, testing::internal::GetCapturedStderr()};
}

TEST(Program, SaysInOneLineWhatWentWrong) {
  EXPECT_EQ(ended([] { return 130; }).code, 130);
  const Ended refused = ended([]() -> int { throw UsageError("--size 3: too small"); });
  EXPECT_EQ(refused.code, 2);
  EXPECT_EQ(refused.said, "irt test: --size 3: too small\n");
}

TEST(Program, SaysWhatNeedsLessMemory) {
  const auto starve = []() -> int { throw std::bad_alloc(); };
  EXPECT_EQ(ended(starve, "a smaller picture").said,
            "irt test: out of memory; use a smaller picture\n");
  EXPECT_EQ(ended(starve).said, "irt test: out of memory\n");
}

TEST(Arguments, AMistakeIsToldAndEndsInTwo) {
  for (const bool one_line : {false, true}) {
    CLI::App app("", "irt test");
    std::string value;
    app.add_option("--value", value);
    if (one_line) tell_in_one_line(app, "irt test");
    EXPECT_EQ(parse(app, {"--value", "x"}), std::nullopt);
    EXPECT_EQ(value, "x");
    testing::internal::CaptureStderr();
    EXPECT_EQ(parse(app, {"--value", ""}), 2);
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find("nothing is given"), std::string::npos) << said;
    EXPECT_EQ(said.starts_with("irt test: --value"), one_line) << said;
    EXPECT_EQ(std::ranges::count(said, '\n') == 1, one_line) << said;
  }
}

// What is said of a command line with a list and a number, and a list in a command of its own.
std::string said_of(const std::vector<std::string>& arguments, int code) {
  CLI::App app("", "irt test");
  std::vector<std::string> names, inner;
  std::vector<unsigned> numbers;
  app.add_option("-q,--queue,--queues", names)->delimiter(',');
  app.add_option("--threads", numbers)->delimiter(',');
  app.add_subcommand("compare", "")->add_option("--scene", inner)->delimiter(',');
  tell_in_one_line(app, "irt test");
  testing::internal::CaptureStderr();
  EXPECT_EQ(parse(app, arguments).value_or(0), code) << testing::PrintToString(arguments);
  return testing::internal::GetCapturedStderr();
}

TEST(Arguments, AListHasNoElementOfNothing) {
  EXPECT_EQ(said_of({"--queue", "lock,"}, 2),
            "irt test: --queue lock,: number 2 of the list is empty; write --queue lock\n");
  EXPECT_EQ(said_of({"--queues=,lock,,lfree"}, 2),
            "irt test: --queues ,lock,,lfree: number 1 of the list is empty; write --queues "
            "lock,lfree\n");
  EXPECT_EQ(said_of({"-qlock,,lfree"}, 2),
            "irt test: -q lock,,lfree: number 2 of the list is empty; write -q lock,lfree\n");
  EXPECT_EQ(said_of({"--threads", ","}, 2),
            "irt test: --threads ,: number 1 of the list is empty; name a value, or leave the "
            "option out\n");
  EXPECT_EQ(said_of({"--queue", "lock", "--threads", "1", "2,"}, 2),
            "irt test: --threads 2,: number 2 of the list is empty; write --threads 2\n");
  EXPECT_EQ(said_of({"--threads", "1", "compare", "--scene", "office,"}, 2),
            "irt test: --scene office,: number 2 of the list is empty; write --scene office\n");
  EXPECT_EQ(said_of({"-q", "lock,lfree", "--threads=1,2", "compare", "--scene", "a,b"}, 0), "");
}

TEST(Shard, IsWrittenAsAFraction) {
  const Shard third = parse_shard("2/4");
  EXPECT_EQ(third.index, 2u);
  EXPECT_EQ(third.count, 4u);
  for (const char* text : {"", "1", "4/4", "1/0", "1/2/3", "0/2x", "half"}) {
    EXPECT_THROW(parse_shard(text), UsageError) << text;
  }
}

}  // namespace
}  // namespace irt
