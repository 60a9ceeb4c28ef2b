// The whole matrix: every mutant exhaustively, and by default settings and every random search
// whatever the seed; every twin for as long as the default settings take.

#include <gtest/gtest.h>

#include "stress/checker/mutants_check.hpp"

namespace irt::checker {
namespace {

constexpr double most_seconds = 60;

/// Choices without any bias do not get to its use after free: with none of 20 seeds in 8 s each.
/// The default settings do not use them, and the other searches find it whatever the seed.
constexpr std::string_view beyond_random = "m12";

class AllMutants : public testing::Test {
 protected:
  void each(std::optional<Search> search, std::uint64_t seed) {
    for (const stress::Mutant& mutant : mutants_of(module_)) {
      if (search == Search::random && mutant.id == beyond_random) continue;
      const Trial trial =
          try_queue(mutant.queue, shapes_for(mutant, search), module_, search, seed, most_seconds);
      EXPECT_TRUE(trial.found) << mutant.id << " with seed " << seed;
    }
  }

  virtual_cores::Module module_{IRT_MUTANTS_MODULE};
};

TEST_F(AllMutants, are_found_by_default_settings_whatever_the_seed) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) each({}, seed);
}

TEST_F(AllMutants, are_found_exhaustively) {
  each(Search::exhaustive, 1);
}

class Sampled : public AllMutants, public testing::WithParamInterface<Search> {};

TEST_P(Sampled, whatever_the_seed) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) each(GetParam(), seed);
}

INSTANTIATE_TEST_SUITE_P(Mutants, Sampled,
                         testing::Values(Search::pos, Search::pct, Search::random));

TEST_F(AllMutants, have_twins_that_pass) {
  for (const stress::Mutant& mutant : mutants_of(module_)) {
    const Trial trial =
        try_queue(mutant.twin, shapes_for(mutant, {}), module_, {}, 1, most_seconds / 2);
    EXPECT_FALSE(trial.found) << mutant.id << ": " << name_of(*trial.found) << " on "
                              << trial.shape;
  }
}

}  // namespace
}  // namespace irt::checker
