// Mutants that fall at once, one of each family, and every twin for a moment. All of them, with
// every search and many seeds: mutants_full_test.cpp.

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stress/checker/mutants_check.hpp"

namespace irt::checker {
namespace {

class Mutants : public testing::Test {
 protected:
  Trial check(const QueueEntry& queue, const stress::Mutant& mutant, double seconds) {
    return try_queue(queue, shapes_for(mutant, {}), module_, {}, 1, seconds);
  }

  virtual_cores::Module module_{IRT_MUTANTS_MODULE};
};

TEST_F(Mutants, of_each_family_one_is_found_by_default_settings) {
  for (const stress::Mutant& mutant : mutants_of(module_))
    for (const char* id : {"m02", "m07", "m13", "m20", "m23", "m26", "m27", "m28", "m31", "m35",
                           "m40", "m44", "m46", "thesis-7.1", "thesis-7.3"})
      if (mutant.id == id) {
        EXPECT_TRUE(check(mutant.queue, mutant, 20).found) << id;
      }
}

TEST_F(Mutants, no_twin_is_accused) {
  for (const stress::Mutant& mutant : mutants_of(module_)) {
    const Trial trial = try_queue(mutant.twin, shapes_for(mutant, Search::exhaustive), module_,
                                  Search::exhaustive, 1, 0.1);
    EXPECT_FALSE(trial.found) << mutant.id << ": " << name_of(*trial.found) << " on "
                              << trial.shape;
    EXPECT_GT(trial.executions, 0U);
  }
}

TEST_F(Mutants, the_default_search_with_each_seed_is_kept_for_the_kill_matrix) {
  const std::string file = testing::TempDir() + "irt_checker_column.json";
  KillSettings settings;
  settings.ids = {"m13"};
  settings.seeds = 2;
  settings.default_only = true;
  settings.json = file;
  EXPECT_TRUE(kill_matrix(module_, settings));
  const auto cell = nlohmann::json::parse(std::ifstream(file)).at("m13").at("checker");
  EXPECT_EQ(cell.at("runs"), 2);
  EXPECT_EQ(cell.at("kills"), 2);
  EXPECT_EQ(cell.at("times").size(), 2U);
  EXPECT_EQ(cell.at("twin_accused"), "");
  std::filesystem::remove(file);
}

TEST_F(Mutants, a_wrong_id_is_refused) {
  EXPECT_THROW(kill_matrix(module_, {.ids = {"m99"}}), std::invalid_argument);
}

}  // namespace
}  // namespace irt::checker
