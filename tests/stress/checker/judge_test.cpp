// What the judge says of each wrong "full" and "empty", and what the columns say beneath it.

#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "stress/checker/queue_calls.hpp"
#include "stress/checker/report.hpp"

namespace irt::checker {
namespace {

using Kind = QueueCall::Kind;
using Phase = QueueCall::Phase;

/// A finished call of `thread`, the `number`th of all.
QueueCall call(Kind kind, unsigned thread, std::size_t number, bool answered, std::uint64_t value,
               Phase phase = Phase::during) {
  QueueCall o{.kind = kind,
              .thread = thread,
              .worker = thread,
              .number = number,
              .phase = phase,
              .answered = answered,
              .finished = true,
              .value = value};
  o.called.count[thread] = static_cast<std::uint16_t>(10 * number);
  o.returned = static_cast<std::uint16_t>(10 * number + 5);
  return o;
}

std::string wrong(const std::vector<QueueCall>& operations, const Claims& claims) {
  return judge(operations, claims, 2).wrong.value_or("nothing");
}

constexpr Claims exact_ring{.ordering = Ordering::fifo_happens_before, .bounded = true};
constexpr Claims loose_ring{.bounded = true};

TEST(Judge, says_why_full_is_wrong) {
  const QueueCall full = call(Kind::push, 0, 1, false, 101);
  EXPECT_EQ(wrong({full}, {}),
            "thread 0's push (of 101) answered \"full\", and the queue claims no bound");
  EXPECT_EQ(wrong({full}, exact_ring),
            "thread 0's push (of 101) answered \"full\", and in no order of the operations that "
            "agrees with happens-before were all 2 places taken then");
  EXPECT_EQ(wrong({full}, loose_ring),
            "thread 0's push (of 101) answered \"full\" with fewer than 2 elements inside, and no "
            "call in flight explains it");
}

TEST(Judge, says_why_empty_is_wrong) {
  const QueueCall push = call(Kind::push, 0, 1, true, 101);
  const QueueCall empty = call(Kind::pop, 0, 2, false, 0);
  const QueueCall pop = call(Kind::pop, 0, 3, true, 101);
  const std::string text = "thread 0's pop number 1 answered \"empty\" while 101 was inside";
  EXPECT_EQ(wrong({push, empty, pop}, {.ordering = Ordering::fifo_happens_before}),
            text + ", by happens-before");
  EXPECT_EQ(wrong({push, empty, pop}, {}), text + ", and no call in flight explains it");
  EXPECT_EQ(wrong({push, empty, pop}, {.empty = Answer::this_worker}),
            text + ", which the same worker took next, with nobody else at work");
}

TEST(Judge, accepts_full_and_empty_where_they_are_right) {
  const QueueCall first = call(Kind::push, 0, 1, true, 101);
  const QueueCall second = call(Kind::push, 0, 2, true, 102);
  const QueueCall full = call(Kind::push, 0, 3, false, 103);
  const QueueCall pop = call(Kind::pop, 0, 4, true, 101, Phase::after);
  const QueueCall last = call(Kind::pop, 0, 5, true, 102, Phase::after);
  const QueueCall empty = call(Kind::pop, 0, 6, false, 0, Phase::after);
  EXPECT_EQ(wrong({first, second, full, pop, last, empty}, exact_ring), "nothing");
}

TEST(Contradiction, names_what_can_have_been_inside_when_full_was_answered) {
  const QueueCall full = call(Kind::push, 1, 3, false, 201);
  EXPECT_EQ(contradiction(full, {full}), "nothing can have been inside");
  const QueueCall before = call(Kind::push, 0, 1, true, 101, Phase::before);
  const QueueCall taken = call(Kind::pop, 1, 2, true, 101);
  const QueueCall beside = call(Kind::push, 0, 2, true, 102);
  const QueueCall later = call(Kind::push, 1, 4, true, 202);
  EXPECT_EQ(contradiction(full, {before, full}), "inside was at most: 101");
  EXPECT_EQ(contradiction(full, {before, taken, beside, full, later}), "inside was at most: 102")
      << "101 was taken before, 202 came after";
  EXPECT_EQ(contradiction(later, {full, later}), "") << "it was accepted";
}

}  // namespace
}  // namespace irt::checker
