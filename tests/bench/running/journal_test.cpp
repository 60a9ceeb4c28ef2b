#include "bench/running/journal.hpp"

#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <numeric>

#include "bench/conditions/conditions.hpp"
#include "stress/running/usage_error.hpp"
#include "tests/bench/temporary.hpp"

namespace irt {
namespace {

// Results that are hundreds of characters long.
using Numbers = std::vector<unsigned>;
using Journal = irt::Journal<Numbers>;

Numbers numbers(unsigned first) {
  Numbers all(100);
  std::iota(all.begin(), all.end(), first);
  return all;
}

constexpr const char* format = "numbers 1";
const nlohmann::json header{{"format", format}, {"plan", 7}};

TEST(Journal, GivesBackWhatWasWritten) {
  const TemporaryDirectory directory;
  {
    Journal journal = Journal::begin(directory / "runs.jsonl", header);
    journal.add(numbers(0));
    journal.add(numbers(1));
  }
  const Journal journal = Journal::resume(directory / "runs.jsonl", format);
  EXPECT_EQ(journal.header(), header);
  ASSERT_EQ(journal.results().size(), 2u);
  EXPECT_EQ(journal.results()[0], numbers(0));
  EXPECT_EQ(journal.results()[1], numbers(1));
}

TEST(Journal, ATornLastLineIsCutOffWhereverItWasTorn) {
  const TemporaryDirectory directory;
  const auto file = directory / "runs.jsonl";
  {
    Journal journal = Journal::begin(file, header);
    journal.add(numbers(0));
    journal.add(numbers(1));
  }
  const auto whole = std::filesystem::file_size(file);
  for (std::uintmax_t cut = 1; cut < 200; ++cut) {
    std::filesystem::resize_file(file, whole - cut);
    Journal journal = Journal::resume(file, format);
    ASSERT_EQ(journal.results().size(), 1u);
    journal.add(numbers(1));
    ASSERT_EQ(Journal::resume(file, format).results().size(), 2u);
    ASSERT_EQ(std::filesystem::file_size(file), whole);
  }
}

TEST(Journal, RefusesWhatIsNoJournal) {
  const TemporaryDirectory directory;
  const auto file = directory / "runs.jsonl";
  EXPECT_THROW(Journal::resume(file, format), UsageError);
  for (const char* text : {"", "{\"format\":", "not json\n", "{\"format\":\"other\"}\n", "[1]\n",
                           "{\"format\":\"numbers 1\"}\n{\"queue\":3}\n"}) {
    std::ofstream(file) << text;
    EXPECT_THROW(Journal::resume(file, format), UsageError) << text;
  }
}

TEST(Journal, ANewOneKeepsTheOldOne) {
  const TemporaryDirectory directory;
  Journal::begin(directory / "runs.jsonl", header).add(numbers(0));
  Journal::begin(directory / "runs.jsonl", header);
  EXPECT_EQ(Journal::resume(directory / "runs.jsonl.previous", format).results().size(), 1u);
  EXPECT_THROW(Journal::begin(directory / "no/such/runs.jsonl", header), UsageError);
}

std::string message_of(const std::function<void()>& check) {
  try {
    check();
  } catch (const UsageError& error) {
    return error.what();
  }
  return {};
}

TEST(Journal, NamesWhatIsNotAsBefore) {
  EXPECT_EQ(message_of([] { require_same_option("b", 2, 2); }), "");
  EXPECT_NE(message_of([] { require_same_option("b", 2, "x"); }).find("b: 2 before, \"x\" now;"),
            std::string::npos);
  const nlohmann::json before = conditions();
  nlohmann::json now = before;
  EXPECT_EQ(message_of([&] { require_same_conditions(before, now); }), "");
  now["cpu"] = "another";
  EXPECT_NE(message_of([&] { require_same_conditions(before, now); }).find("\"another\" now;"),
            std::string::npos);
}

}  // namespace
}  // namespace irt
