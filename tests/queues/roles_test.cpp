#include "queues/roles.hpp"

#include <gtest/gtest.h>

namespace irt {
namespace {

constexpr Claims one_to_one{.producers = Callers::one, .consumers = Callers::one};
constexpr Claims own{.producers = Callers::own_worker, .consumers = Callers::own_worker};

TEST(Roles, ARoleForOneIsTheFirstsOrTheLasts) {
  constexpr Roles roles = most_roles(one_to_one, 3);
  EXPECT_TRUE(roles.pushes(0) && !roles.pops(0));
  EXPECT_FALSE(roles.pushes(1) || roles.pops(1));
  EXPECT_TRUE(!roles.pushes(2) && roles.pops(2));
  EXPECT_TRUE(most_roles(own, 3).together());
}

TEST(Roles, ThoseWithinTheClaimsMeetNoObstacle) {
  constexpr Claims one_to_many{.producers = Callers::one};
  constexpr Claims many_to_one{.consumers = Callers::one};
  for (Claims claims : {Claims{}, one_to_one, one_to_many, many_to_one, own})
    for (const unsigned most : {0U, 1U, 2U, 5U})
      for (const Roles& wanted : {all_do_both(1), all_do_both(4), apart(1, 1), apart(3, 4)}) {
        claims.max_workers = most;
        const Roles roles = roles_within(claims, wanted);
        EXPECT_EQ(obstacle(claims, roles), "");
        EXPECT_GE(roles.producers, 1U);
        EXPECT_GE(roles.consumers, 1U);
      }
  EXPECT_EQ(roles_within({}, apart(3, 4)).workers, 7U);
  EXPECT_EQ(roles_within({.max_workers = 4}, apart(3, 4)).consumers, 2U);
}

TEST(Roles, WhatTheClaimsForbidHasAReason) {
  EXPECT_EQ(obstacle(one_to_one, apart(1, 1)), "");
  EXPECT_EQ(obstacle(one_to_one, apart(2, 1)), "it allows one producer");
  EXPECT_EQ(obstacle(one_to_one, apart(1, 2)), "it allows one consumer");
  EXPECT_EQ(obstacle(own, apart(1, 1)), "a worker pops only what it pushed itself");
  EXPECT_EQ(obstacle({.max_workers = 2}, all_do_both(3)), "it is for at most 2 workers");
}

}  // namespace
}  // namespace irt
