// Programs that are wrong are found to be so, and those that are right are proved.

#include "tests/stress/checker/programs.hpp"

#include <gtest/gtest.h>
#include <string>
#include <string_view>

#include "stress/checker/program_check.hpp"
#include "stress/checker/unseen.hpp"

namespace checker = irt::checker;

namespace {

irt::virtual_cores::Module& module() {
  static irt::virtual_cores::Module loaded(IRT_PROGRAMS_PROBE);
  return loaded;
}

std::vector<irt::programs::Entry> entries() {
  unsigned count = 0;
  const auto* first =
      module().function<const irt::programs::Entry*(unsigned*)>("irt_programs")(&count);
  return {first, first + count};
}

checker::ProgramSettings settings_of(const irt::programs::Entry& entry) {
  checker::ProgramSettings settings{.name = entry.name, .seconds = 20};
  settings.work = [entry] {
    irt::virtual_cores::run_program(reinterpret_cast<void (*)()>(entry.main), {entry.name});
  };
  settings.conduct = {.jobs = 1, .keep_going = false, .quiet = true, .reports = true};
  return settings;
}

std::string found(const checker::ProgramResult& result) {
  for (const checker::SearchResult& search : result.searches)
    if (search.result.finding) return std::string(name_of(search.result.finding->kind));
  // Whether all is seen is asked of the module: of all programs together.
  return result.proved ? "nothing" : "not proved";
}

class Programs : public testing::TestWithParam<irt::programs::Entry> {};

TEST_P(Programs, are_known_for_what_they_are) {
  const checker::ProgramSettings settings = settings_of(GetParam());
  const checker::ProgramResult result =
      check_program(module(), settings, [](const std::string& s) { return s; });
  EXPECT_NE((" | " + std::string(GetParam().finds) + " | ").find(" | " + found(result) + " | "),
            std::string::npos)
      << found(result) << ", for " << GetParam().finds << ": " << verdict(settings, result)
      << (result.found ? result.searches.back().report : "");
}

/// What is found in the program of that name when what fails by chance may fail.
std::string found_by_chance(std::string_view name) {
  for (const irt::programs::Entry& entry : entries()) {
    if (entry.name != name) continue;
    checker::ProgramSettings settings = settings_of(entry);
    settings.options.limits.spurious_wakeups = settings.options.limits.weak_may_fail = true;
    return found(check_program(module(), settings, [](const std::string& s) { return s; }));
  }
  return "no such program";
}

TEST(Chance, ends_waits_and_fails_exchanges) {
  EXPECT_EQ(found_by_chance("waits_without_a_loop"), "failure");
  EXPECT_EQ(found_by_chance("tries_an_exchange_once"), "failure");
}

TEST(Chance, leaves_loops_that_go_on_finite) {
  EXPECT_EQ(found_by_chance("waits_in_a_loop"), "nothing");
}

TEST(Main, and_its_unlikely_part_are_seen_as_one_function) {
  irt::virtual_cores::Module main(IRT_MAIN_PROBE);
  EXPECT_EQ(words(checker::unseen_of(main)), "");
}

TEST(Main, comes_after_the_constructors_of_globals_in_each_execution) {
  using irt::virtual_cores::Module;
  Module main(IRT_CONSTRUCTORS_PROBE, Module::Constructs::each_program);
  checker::ProgramSettings settings{.name = "constructors", .seconds = 20};
  settings.conduct = {.jobs = 1, .keep_going = false, .quiet = true, .reports = true};
  const auto same = [](const std::string& s) { return s; };
  const checker::ProgramResult right = check_program(main, settings, same);
  EXPECT_EQ(found(right), "nothing") << verdict(settings, right);
  settings.arguments = {"race"};
  EXPECT_EQ(found(check_program(main, settings, same)), "data race");
}

INSTANTIATE_TEST_SUITE_P(All, Programs, testing::ValuesIn(entries()),
                         [](const auto& i) { return std::string(i.param.name); });

}  // namespace
