#include "queues/nearest.hpp"

#include <array>
#include <gtest/gtest.h>

namespace irt {
namespace {

constexpr std::array<std::string_view, 5> names{"lock", "lfree", "local", "mutex",
                                                "boost-lockfree"};

TEST(Nearest, finds_the_name_one_slip_away) {
  EXPECT_EQ(nearest("lfre", names), "lfree");
  EXPECT_EQ(nearest("lfreee", names), "lfree");
  EXPECT_EQ(nearest("lfrae", names), "lfree");
  EXPECT_EQ(nearest("mutxe", names), "mutex");
  EXPECT_EQ(nearest("boost-lokfree", names), "boost-lockfree");
}

TEST(Nearest, takes_the_first_of_equals) {
  EXPECT_EQ(nearest("loc", names), "lock");
}

TEST(Nearest, stays_silent_where_nothing_is_near) {
  EXPECT_EQ(nearest("embree", names), "");
  EXPECT_EQ(nearest("", names), "");
  EXPECT_EQ(nearest("x", names), "");
  EXPECT_EQ(nearest(std::string(100'000, 'l'), names), "");
  EXPECT_EQ(nearest("lock", {}), "");
}

TEST(Nearest, writes_one_line) {
  EXPECT_EQ(unknown_name("queue", "lfre", names),
            "unknown queue 'lfre': did you mean 'lfree'? (known: lock lfree local mutex "
            "boost-lockfree)");
  EXPECT_EQ(unknown_name("queue", "embree", names),
            "unknown queue 'embree' (known: lock lfree local mutex boost-lockfree)");
}

}  // namespace
}  // namespace irt
