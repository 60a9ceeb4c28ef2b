// The rules of closing, by hand: for the few calls of a checker and for long histories.
#include "stress/history/closing.hpp"

#include <gtest/gtest.h>
#include <string>

#include "stress/history/judge.hpp"
#include "tests/stress/history/hand_made.hpp"

namespace irt::stress {
namespace {

constexpr Claims timed{.ordering = Ordering::fifo_real_time};
constexpr Claims untimed{.ordering = Ordering::fifo_happens_before};
constexpr Claims loose{.ordering = Ordering::unordered};

Operation close(Stamp from, Stamp to) {
  return {from, to, 0, Kind::close};
}
Operation closed(Stamp from, Stamp to) {
  return {from, to, 0, Kind::closed};
}
Operation timed_out(Stamp from, Stamp to) {
  return {from, to, 0, Kind::timed_out};
}

std::string wrong(const History& history, const Claims& claims) {
  const Verdict verdict = judge(history, claims, 8);
  return verdict.violations.empty() ? "" : verdict.violations.front().text;
}

TEST(Closing, APushIsRefusedFromThenOn) {
  const Element e = element(0, 0);
  EXPECT_EQ(wrong(history({{close(1, 2), full(e, 3, 4)}}), timed), "");
  EXPECT_EQ(wrong(history({{full(e, 1, 4)}, {close(2, 3)}}), timed), "") << "while it is closed";
  EXPECT_NE(wrong(history({{full(e, 1, 2)}, {close(3, 4)}}), timed), "") << "before";
  EXPECT_NE(wrong(history({{close(1, 2), push(e, 3, 4)}}, {pop(e, 9, 10)}), untimed), "");
  const History apart = history({{push(e, 3, 4)}, {close(1, 2)}}, {pop(e, 9, 10)});
  EXPECT_NE(wrong(apart, timed), "");
  EXPECT_EQ(wrong(apart, untimed), "") << "nothing but the clock orders the two";
  EXPECT_NE(
      wrong(history({{meet(3), push(e, 4, 5)}, {close(1, 2), meet(3)}}, {pop(e, 9, 10)}), untimed),
      "")
      << "a barrier does";
}

TEST(Closing, ClosedIsTheEnd) {
  const Element e = element(0, 0);
  EXPECT_EQ(wrong(history({{close(1, 2)}, {closed(3, 4)}}), timed), "");
  EXPECT_EQ(wrong(history({{close(1, 4)}, {closed(2, 3)}}), timed), "");
  EXPECT_NE(wrong(history({{closed(1, 2)}}), timed), "") << "nobody closed it";
  EXPECT_NE(wrong(history({{close(3, 4)}, {closed(1, 2)}}), timed), "") << "nobody had";
  // A push that overlaps with the close may be accepted, if somebody still takes the element.
  const History left = history({{push(e, 1, 9)}, {close(2, 3)}, {closed(4, 5)}}, {pop(e, 20, 21)});
  EXPECT_NE(wrong(left, timed), "");
  EXPECT_NE(wrong(left, untimed), "");
  EXPECT_EQ(
      wrong(history({{push(e, 1, 9)}, {close(2, 3)}, {closed(4, 12)}, {pop(e, 10, 11)}}), timed),
      "");
  // Another pop in flight is an excuse where empty may stand for it.
  const Element f = element(0, 1);
  const History held = history({{push(e, 1, 2), push(f, 3, 4), close(5, 6)},
                                {pop(e, 7, 12), pop(f, 13, 14)},
                                {closed(8, 9)}});
  EXPECT_EQ(wrong(held, loose), "");
  EXPECT_NE(wrong(held, timed), "");
}

TEST(Closing, EndsWaitingWithADeadline) {
  EXPECT_EQ(wrong(history({{timed_out(1, 2)}, {close(3, 4)}}), timed), "");
  EXPECT_NE(wrong(history({{close(1, 2), timed_out(3, 4)}}), timed), "");
  const Element e = element(0, 0);
  EXPECT_NE(wrong(history({{push(e, 1, 2)}, {timed_out(3, 4), pop(e, 5, 6)}}), timed), "")
      << "an element was there";
}

std::optional<Pattern> breach(const std::vector<Call>& calls, const Claims& claims,
                              std::size_t after = 0) {
  Calls all(calls, 0, after);
  for (std::size_t b = 0; b < all.end(); ++b)
    for (std::size_t a = 0; a < b; ++a)
      if (calls[a].worker == calls[b].worker) all.order(a, b);
  const Judgement judgement = judge_in_every_order(all, Specification(claims, 8));
  return judgement.breach ? std::optional(judgement.breach->pattern) : std::nullopt;
}

TEST(Closing, OfFewCallsIsTheSame) {
  EXPECT_EQ(breach({{Kind::close, 0, 0}, {Kind::full, 0, 1}}, untimed), std::nullopt);
  EXPECT_EQ(breach({{Kind::full, 0, 1}, {Kind::close, 0, 0}}, untimed), Pattern::full);
  EXPECT_EQ(breach({{Kind::close, 0, 0}, {Kind::push, 0, 1}, {Kind::pop, 0, 1}}, untimed),
            Pattern::closed);
  EXPECT_EQ(breach({{Kind::close, 1, 0}, {Kind::push, 0, 1}, {Kind::pop, 0, 1}}, untimed),
            std::nullopt);
  EXPECT_EQ(breach({{Kind::closed, 0, 0}}, untimed), Pattern::closed);
  EXPECT_EQ(breach({{Kind::close, 0, 0}, {Kind::closed, 1, 0}}, untimed), std::nullopt);
  EXPECT_EQ(breach({{Kind::close, 0, 0}, {Kind::timed_out, 0, 0}}, untimed), Pattern::closed);
  EXPECT_EQ(breach({{Kind::close, 0, 0}, {Kind::timed_out, 1, 0}}, untimed), std::nullopt);
  // What the drain finds after somebody heard that nothing is left.
  EXPECT_EQ(
      breach({{Kind::push, 0, 1}, {Kind::close, 1, 0}, {Kind::closed, 2, 0}, {Kind::pop, 0, 1}},
             untimed, 1),
      Pattern::closed);
}

}  // namespace
}  // namespace irt::stress
