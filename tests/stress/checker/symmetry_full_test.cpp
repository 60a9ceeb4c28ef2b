// The search that exchanges equal threads against the one that does not, on many programs.

#include "tests/stress/checker/twin_programs.hpp"

using irt::twins::Tally;
using irt::twins::TwinPrograms;

TEST_F(TwinPrograms, have_one_graph_of_each_orbit_explored) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Tally tally = compare_random(2'500, 0, seed);
    EXPECT_GT(tally.compared, 1'500U);
  }
}

TEST_F(TwinPrograms, are_not_taken_for_even_where_they_are_not) {
  for (unsigned seed = 5; seed <= 8; ++seed) {
    const Tally tally = compare_random(2'500, 4, seed);
    EXPECT_GT(tally.refused, 500U);
  }
}
