/// The rules of coherence one by one, on a line by itself.
#include "bench/many_core/coherence/mesi.hpp"

#include <gtest/gtest.h>

namespace irt::many_core {
namespace {

constexpr Time transfer = 50 * nanosecond, answer = 50 * nanosecond, per_sharer = 3 * nanosecond;
constexpr Time occupancy = 10 * nanosecond, write_back = 40 * nanosecond;
constexpr Time far = 20 * nanosecond, hit = 5 * nanosecond;
constexpr Time tenth = 5 * nanosecond;  // by which legs vary

// Four cores around one cache; a request takes no time to get to the line.
Profile four_cores() {
  Profile profile;
  profile.cores_per_cache = 4;
  profile.transfer.fill(50);
  profile.shared_fetch = 1;
  profile.dram = 100;
  profile.read_occupancy = 10;
  profile.write_back = 40;
  profile.invalidate_per_sharer = 3;
  profile.far_atomic = 20;
  return profile;
}

class MesiTest : public testing::Test {
 protected:
  // Serves a request of `core` at time 0; returns when it is through.
  Time serve(unsigned core, Want want) {
    const Request request{.takes = hit, .core = core, .want = want};
    Time done = 0;
    if (Mesi::moves(line_, request)) {
      done = mesi_.transfer(line_, request, 0, false);
      line_.note_user(core);
    }
    return mesi_.transition(line_, request, 0, done);
  }

  Mesi mesi_{four_cores(), 1};
  Line line_;
};

TEST_F(MesiTest, the_only_reader_is_exclusive) {
  EXPECT_NEAR(static_cast<double>(serve(0, Want::copy)), 2 * transfer, 2 * tenth);
  EXPECT_EQ(line_.owner, 0U);
  EXPECT_EQ(line_.sharer_count, 0U);
}

TEST_F(MesiTest, a_read_leaves_the_owner_a_copy) {
  serve(0, Want::ownership);
  const Time done = serve(1, Want::copy);
  EXPECT_NEAR(static_cast<double>(done), transfer, tenth);
  EXPECT_EQ(line_.owner, nobody);
  EXPECT_TRUE(line_.held_by(0) && line_.held_by(1));
  EXPECT_EQ(line_.available, done);
}

TEST_F(MesiTest, what_a_read_finds_modified_is_written_back_first) {
  serve(0, Want::ownership);
  line_.written = 1;
  const Time done = serve(1, Want::copy);
  EXPECT_NEAR(static_cast<double>(done), transfer, tenth) << "the reader does not wait for that";
  EXPECT_EQ(line_.available, done + write_back);
}

TEST_F(MesiTest, reads_of_a_clean_line_keep_it_busy_only_for_a_while) {
  serve(0, Want::ownership);
  serve(1, Want::copy);
  EXPECT_NEAR(static_cast<double>(serve(2, Want::copy)), transfer, tenth);
  EXPECT_EQ(line_.available, occupancy);
  EXPECT_EQ(line_.sharer_count, 3U);
}

TEST_F(MesiTest, a_write_waits_for_every_copy_to_be_given_up) {
  serve(0, Want::ownership);
  serve(1, Want::copy);
  serve(2, Want::copy);
  line_.read_done = 0;
  // It has a copy itself: no transfer, but the farthest answer, and one more.
  const Time done = serve(1, Want::ownership);
  EXPECT_NEAR(static_cast<double>(done), answer + per_sharer, tenth);
  EXPECT_EQ(line_.owner, 1U);
  EXPECT_FALSE(line_.held_by(0) || line_.held_by(2));
  EXPECT_EQ(line_.available, done + hit);
}

TEST_F(MesiTest, a_write_waits_for_the_last_reader_to_have_its_copy) {
  serve(0, Want::ownership);
  serve(1, Want::copy);
  line_.read_done = 10 * transfer;
  EXPECT_EQ(serve(2, Want::ownership), 10 * transfer);
}

TEST_F(MesiTest, a_far_operation_leaves_the_line_to_nobody) {
  serve(0, Want::ownership);
  const Time done = serve(1, Want::far);
  EXPECT_NEAR(static_cast<double>(done), transfer, tenth);
  EXPECT_TRUE(line_.is_invalid());
  EXPECT_EQ(line_.available, done + far);
  // The next one need not wait for an owner.
  serve(2, Want::far);
  EXPECT_EQ(line_.available, far);
}

TEST_F(MesiTest, what_a_core_holds_does_not_move) {
  serve(0, Want::ownership);
  EXPECT_FALSE(Mesi::moves(line_, {.core = 0, .want = Want::copy}));
  EXPECT_FALSE(Mesi::moves(line_, {.core = 0, .want = Want::ownership}));
  serve(1, Want::copy);
  EXPECT_FALSE(Mesi::moves(line_, {.core = 0, .want = Want::copy}));
  EXPECT_TRUE(Mesi::moves(line_, {.core = 0, .want = Want::ownership}));
}

}  // namespace
}  // namespace irt::many_core
