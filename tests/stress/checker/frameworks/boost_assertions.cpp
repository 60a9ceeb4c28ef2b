// The same as in assertions.cpp, in Boost.Test, whose cases have other names.
#define BOOST_TEST_MODULE assertions
#include <boost/test/included/unit_test.hpp>
// In this order.
#include <irt/explore.hpp>

#include "additions.hpp"

BOOST_AUTO_TEST_CASE(right_assertions) {
  int runs = 0;
  const irt::Explored explored = irt::explore([&] {
    const int sum = additions_made(true);
    BOOST_REQUIRE(sum == 2);
    BOOST_TEST(++runs == 1);
  });
  BOOST_REQUIRE(explored.whole);
  BOOST_TEST(runs == 0);
}
BOOST_AUTO_TEST_CASE(wrong_where_it_must_hold) {
  irt::explore([] { BOOST_REQUIRE(additions_made(false) == 2); });
}
BOOST_AUTO_TEST_CASE(wrong_and_goes_on) {
  irt::explore([] {
    BOOST_CHECK(additions_made(false) == 2);
    BOOST_CHECK(true);
  });
}
BOOST_AUTO_TEST_CASE(wrong_again_where_another_one_has_failed) {
  irt::explore([] { BOOST_TEST(additions_made(false) == 2); });
}
