#include "queues/registry.hpp"

#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <regex>
#include <set>
#include <string>

namespace irt {
namespace {

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const RegistryError& error) {
    return error.what();
  }
  return {};
}

TEST(Registry, has_the_queues_of_the_thesis_in_front) {
  const auto queues = built_in_queues();
  ASSERT_GE(queues.size(), 4U);
  EXPECT_EQ(queues[0].name, "lock");
  EXPECT_EQ(queues[1].name, "lfree");
  EXPECT_EQ(queues[2].name, "local");
  EXPECT_EQ(queues[3].name, "mutex");
}

TEST(Registry, names_are_unique_and_easy_to_type) {
  std::set<std::string_view> names;
  for (const QueueEntry& queue : built_in_queues()) {
    EXPECT_TRUE(names.insert(queue.name).second) << queue.name;
    EXPECT_TRUE(
        std::regex_match(std::string(queue.name), std::regex("[a-z][a-z0-9]*(-[a-z0-9]+)*")))
        << queue.name;
  }
}

TEST(Registry, finds_by_name_and_guesses_what_was_meant) {
  const QueueRegistry registry;
  ASSERT_NE(registry.find("lfree"), nullptr);
  EXPECT_EQ(registry.find("lfree")->name, "lfree");
  EXPECT_EQ(registry.at("lock").name, "lock");
  EXPECT_EQ(registry.find("lfre"), nullptr);
  EXPECT_NE(message_of([&] { registry.at("lfre"); }).find("did you mean 'lfree'?"),
            std::string::npos);
}

template <class T>
struct ForTwo {
  static constexpr std::string_view summary = "for two";
  static constexpr Claims claims{.max_workers = 2};
  ForTwo(unsigned /*workers*/, std::size_t /*capacity*/) {}
  bool push(unsigned /*worker*/, T /*task*/) { return true; }
  bool pop(unsigned /*worker*/, T& /*task*/) { return false; }
};

TEST(Registry, makes_no_queue_for_more_workers_than_it_is_for) {
  constexpr QueueEntry entry = queue_entry<ForTwo>("for-two");
  EXPECT_NE(entry.make_word_queue(2, 1), nullptr);
  try {
    entry.make_task_queue(3, 1);
    ADD_FAILURE() << "three workers";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "this queue (for two) is for at most 2 workers, and 3 were asked for; use fewer "
                 "threads");
  }
}

TEST(Registry, keeps_counters_for_who_asks_for_them) {
  const QueueRegistry registry;
  ASSERT_FALSE(built_in_counters().empty());
  for (const QueueEntry& counter : built_in_counters()) {
    EXPECT_FALSE(counter.claims.carries_elements);
    EXPECT_EQ(registry.find(counter.name), nullptr);
    EXPECT_EQ(registry.at_or_counter(counter.name).name, counter.name);
  }
  EXPECT_EQ(registry.at_or_counter("lfree").name, "lfree");
  EXPECT_NE(message_of([&] { registry.at("faa"); }).find("only counts"), std::string::npos);
  for (const QueueEntry& queue : built_in_queues()) EXPECT_TRUE(queue.claims.carries_elements);
}

class BadPlugin : public testing::Test {
 protected:
  /// The line that opening `file` answers with; one line that names the file, or the test fails.
  static std::string refusal(const std::filesystem::path& file) {
    QueueRegistry registry;
    const std::size_t before = registry.entries().size();
    std::string line = message_of([&] { registry.open(file); });
    EXPECT_FALSE(line.empty()) << "was accepted";
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    EXPECT_NE(line.find("plug-in '" + file.string() + "'"), std::string::npos) << line;
    EXPECT_EQ(registry.entries().size(), before);
    return line;
  }

  static std::string refusal_of_content(const std::string& content) {
    const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "content.so";
    std::ofstream(file, std::ios::binary) << content;
    std::string line = refusal(file);
    std::filesystem::remove(file);
    return line;
  }
};

TEST_F(BadPlugin, is_missing) {
  EXPECT_NE(refusal("no/such/file.so").find("no such file"), std::string::npos);
  EXPECT_NE(refusal("").find("no such file"), std::string::npos);
  // A bare name is a file of this folder, not a library of the system.
  EXPECT_NE(refusal("libc.so.6").find("no such file"), std::string::npos);
}

TEST_F(BadPlugin, is_a_directory) {
  EXPECT_NE(refusal(testing::TempDir()).find("is a directory"), std::string::npos);
}

TEST_F(BadPlugin, is_no_shared_object) {
  refusal_of_content("");
  refusal_of_content("just some words\n");
  refusal_of_content(
      "\x7f"
      "ELF but then nothing more");
}

TEST_F(BadPlugin, is_a_shared_object_of_something_else) {
  EXPECT_NE(refusal(IRT_PLUGIN_WITHOUT_SYMBOL).find("has no symbol 'irt_plugin'"),
            std::string::npos);
  EXPECT_NE(refusal(IRT_PLUGIN_OTHER_MAGIC).find("no iRT descriptor"), std::string::npos);
}

TEST_F(BadPlugin, has_another_abi) {
  EXPECT_NE(refusal(IRT_PLUGIN_OTHER_ABI).find("built for plug-in ABI 999"), std::string::npos);
  EXPECT_NE(refusal(IRT_PLUGIN_OTHER_SIZES).find("other sizes"), std::string::npos);
  EXPECT_NE(refusal(IRT_PLUGIN_OTHER_LIBRARY).find("another C++ standard library"),
            std::string::npos);
}

TEST_F(BadPlugin, has_no_factory) {
  EXPECT_NE(refusal(IRT_PLUGIN_NO_FACTORY).find("no factory"), std::string::npos);
}

TEST_F(BadPlugin, takes_a_name_that_is_taken) {
  EXPECT_NE(refusal(IRT_PLUGIN_NAME_TAKEN).find("a queue named 'mutex' is there already"),
            std::string::npos);
}

}  // namespace
}  // namespace irt
