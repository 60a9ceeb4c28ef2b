#include "queues/nearest.hpp"

#include <array>
#include <gtest/gtest.h>

namespace irt {
namespace {

constexpr std::array<std::string_view, 5> known{"lock", "lfree", "local", "mutex",
                                                "boost-lockfree"};

TEST(Nearest, finds_the_name_one_slip_away) {
  EXPECT_EQ(nearest("lfre", known), "lfree");
  EXPECT_EQ(nearest("lfreee", known), "lfree");
  EXPECT_EQ(nearest("lfrae", known), "lfree");
  EXPECT_EQ(nearest("mutxe", known), "mutex");
  EXPECT_EQ(nearest("boost-lokfree", known), "boost-lockfree");
}

TEST(Nearest, takes_the_first_of_equals) {
  EXPECT_EQ(nearest("loc", known), "lock");
}

TEST(Nearest, stays_silent_where_nothing_is_near) {
  EXPECT_EQ(nearest("embree", known), "");
  EXPECT_EQ(nearest("", known), "");
  EXPECT_EQ(nearest("x", known), "");
  EXPECT_EQ(nearest(std::string(100'000, 'l'), known), "");
  EXPECT_EQ(nearest("lock", {}), "");
}

TEST(Nearest, writes_one_line) {
  EXPECT_EQ(unknown_name("queue", "lfre", known),
            "unknown queue 'lfre': did you mean 'lfree'? (known: lock lfree local mutex "
            "boost-lockfree)");
  EXPECT_EQ(unknown_name("queue", "embree", known),
            "unknown queue 'embree' (known: lock lfree local mutex boost-lockfree)");
}

}  // namespace
}  // namespace irt
