#include "bench/frames/journal.hpp"

#include <fstream>
#include <gtest/gtest.h>

#include "stress/running/usage_error.hpp"
#include "tests/bench/temporary.hpp"

namespace irt {
namespace {

Sample sample(const std::string& queue, unsigned repetition) {
  Sample one;
  one.queue = queue;
  one.threads = 2;
  one.repetition = repetition;
  one.seconds = {0.5, 0.25};
  one.rays = 0xffff'ffff'ffffu;
  one.image_hash = "0123456789abcdef";
  return one;
}

const nlohmann::json header{{"format", "irt-frames 3"}, {"plan", 7}};

TEST(Journal, GivesBackWhatWasWritten) {
  const TemporaryDirectory directory;
  {
    Journal journal = Journal::begin(directory / "runs.jsonl", header);
    journal.add(sample("lock", 0));
    journal.add(sample("lfree", 1));
  }
  const Journal journal = Journal::resume(directory / "runs.jsonl");
  EXPECT_EQ(journal.header(), header);
  ASSERT_EQ(journal.samples().size(), 2u);
  EXPECT_EQ(nlohmann::json(journal.samples()[0]), nlohmann::json(sample("lock", 0)));
  EXPECT_TRUE(journal.has(0, "lfree", 2, 1));
  EXPECT_FALSE(journal.has(0, "lfree", 2, 0));
  EXPECT_FALSE(journal.has(0, "lfree", 1, 1));
  EXPECT_FALSE(journal.has(1, "lfree", 2, 1));
}

TEST(Journal, ATornLastLineIsCutOffWhereverItWasTorn) {
  const TemporaryDirectory directory;
  const auto file = directory / "runs.jsonl";
  {
    Journal journal = Journal::begin(file, header);
    journal.add(sample("lock", 0));
    journal.add(sample("lock", 1));
  }
  const auto whole = std::filesystem::file_size(file);
  for (std::uintmax_t cut = 1; cut < 200; ++cut) {
    std::filesystem::resize_file(file, whole - cut);
    Journal journal = Journal::resume(file);
    ASSERT_EQ(journal.samples().size(), 1u);
    journal.add(sample("lock", 1));
    ASSERT_EQ(Journal::resume(file).samples().size(), 2u);
    ASSERT_EQ(std::filesystem::file_size(file), whole);
  }
}

TEST(Journal, RefusesWhatIsNoJournal) {
  const TemporaryDirectory directory;
  const auto file = directory / "runs.jsonl";
  EXPECT_THROW(Journal::resume(file), UsageError);
  for (const char* text : {"", "{\"format\":", "not json\n", "{\"format\":\"other\"}\n", "[1]\n",
                           "{\"format\":\"irt-frames 3\"}\n{\"queue\":3}\n"}) {
    std::ofstream(file) << text;
    EXPECT_THROW(Journal::resume(file), UsageError) << text;
  }
}

TEST(Journal, ANewOneKeepsTheOldOne) {
  const TemporaryDirectory directory;
  Journal::begin(directory / "runs.jsonl", header).add(sample("lock", 0));
  Journal::begin(directory / "runs.jsonl", header);
  EXPECT_EQ(Journal::resume(directory / "runs.jsonl.previous").samples().size(), 1u);
  EXPECT_THROW(Journal::begin(directory / "no/such/runs.jsonl", header), UsageError);
}

TEST(Journal, NamesTheFirstDifference) {
  EXPECT_EQ(first_difference({{"a", 1}, {"b", 2}}, {{"a", 1}}), "");
  EXPECT_EQ(first_difference({{"a", 1}, {"b", 2}}, {{"b", "x"}}), "b: 2 before, \"x\" now");
}

}  // namespace
}  // namespace irt
