// Which of these pass and which do not is known to framework_test.sh.

#ifdef FRAMEWORK_catch2
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
#else
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>
#endif
#include <irt/explore.hpp>
#include <string>
#include <vector>

#include "additions.hpp"

TEST_CASE("right assertions") {
  const irt::Explored explored = irt::explore([] {
    const int sum = additions_made(true);
    REQUIRE(sum == 2);
    CHECK(sum > 1);
  });
  REQUIRE(explored.whole);
  REQUIRE(explored.executions > 1);
}

TEST_CASE("right variables of the test") {
  int runs = 0;
  std::string name = "one";
  std::vector<int> sums(1, 7);
  const irt::Explored explored = irt::explore([&] {
    sums.push_back(additions_made(true));
    name += " and a name too long for the place that a string has in itself";
    name.shrink_to_fit();
    REQUIRE(++runs == 1);
    REQUIRE(sums.size() == 2);
    REQUIRE(sums[0] == 7);
    sums = {1, 2, 3};
  });
  REQUIRE(explored.whole);
  REQUIRE(runs == 0);
  REQUIRE(name == "one");
  REQUIRE(sums == std::vector<int>(1, 7));
}

TEST_CASE("wrong where it must hold") {
  irt::explore([] { REQUIRE(additions_made(false) == 2); });
}

TEST_CASE("wrong and goes on") {
  irt::explore([] {
    CHECK(additions_made(false) == 2);
    CHECK(true);
  });
}

TEST_CASE("wrong again where another one has failed") {
  irt::explore([] { CHECK(additions_made(false) == 2); });
}

TEST_CASE("right after all that") {
  irt::explore([] { CHECK(additions_made(true) == 2); });
}
