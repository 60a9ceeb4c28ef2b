// The judge of few calls: by hand, and against the table of the specification taken literally.
#include "stress/history/orders.hpp"

#include <algorithm>
#include <deque>
#include <functional>
#include <gtest/gtest.h>
#include <numeric>
#include <set>
#include <sstream>

#include "stress/history/happens_before.hpp"
#include "stress/history/judge.hpp"
#include "tests/stress/history/random.hpp"

namespace irt::stress {
namespace {

/// Calls of which call i precedes call j as `order` says, for i < j; the last `after` in a row.
Calls ordered(const std::vector<Call>& calls, std::size_t after,
              const std::function<bool(std::size_t, std::size_t)>& order) {
  Calls result(calls, 0, after);
  for (std::size_t b = 0; b < result.end(); ++b)
    for (std::size_t a = 0; a < b; ++a)
      if (order(a, b)) result.order(a, b);
  return result;
}

bool always(std::size_t /*a*/, std::size_t /*b*/) {
  return true;
}

std::optional<Pattern> breach(const Calls& calls, const Claims& claims, std::size_t capacity) {
  const Judgement judgement = judge_in_every_order(calls, Specification(claims, capacity));
  EXPECT_TRUE(judgement.decided);
  return judgement.breach ? std::optional(judgement.breach->pattern) : std::nullopt;
}

TEST(Orders, TheBoundIsJudgedWhateverTheOrder) {
  const std::vector<Call> calls{
      {Kind::push, 0, 1}, {Kind::full, 0, 2}, {Kind::pop, 0, 1}, {Kind::empty, 0, 0}};
  for (const Ordering ordering :
       {Ordering::unordered, Ordering::per_producer_fifo, Ordering::k_relaxed_fifo,
        Ordering::fifo_happens_before, Ordering::fifo_real_time}) {
    const Claims ring{.ordering = ordering, .bounded = true};
    EXPECT_EQ(breach(ordered(calls, 2, always), ring, 1), std::nullopt);
    EXPECT_EQ(breach(ordered(calls, 2, always), ring, 2), Pattern::full);
    EXPECT_EQ(breach(ordered(calls, 2, always), {.ordering = ordering}, 1), Pattern::full)
        << "without a bound";
  }
}

TEST(Orders, APopInFlightExcusesFullWhereThatIsClaimed) {
  const std::vector<Call> calls{{Kind::push, 0, 1}, {Kind::pop, 1, 1}, {Kind::full, 0, 2}};
  const Calls in_flight = ordered(calls, 0, [](std::size_t a, std::size_t) { return a == 0; });
  Claims ring{.ordering = Ordering::fifo_happens_before, .bounded = true};
  EXPECT_EQ(breach(in_flight, ring, 2), Pattern::full);
  ring.full = Answer::calls_in_flight;
  EXPECT_EQ(breach(in_flight, ring, 2), std::nullopt);
  EXPECT_EQ(breach(ordered(calls, 0, always), ring, 1), Pattern::full) << "it had returned";
}

TEST(Orders, TwoAnswersThatCannotBothBeTrueAreAccusedOfExactQueuesOnly) {
  // A push with one place: somebody is refused, then finds nothing.
  const std::vector<Call> calls{
      {Kind::push, 0, 1}, {Kind::full, 1, 2}, {Kind::empty, 1, 0}, {Kind::pop, 0, 1}};
  const Calls reserved =
      ordered(calls, 1, [](std::size_t a, std::size_t b) { return a == 1 && b == 2; });
  Claims ring{.ordering = Ordering::fifo_happens_before, .bounded = true};
  const Judgement judgement = judge_in_every_order(reserved, Specification(ring, 1));
  ASSERT_TRUE(judgement.breach);
  EXPECT_EQ(judgement.breach->pattern, Pattern::witness);
  EXPECT_TRUE(judgement.breach->calls.empty()) << "each could be true";
  ring.full = Answer::calls_in_flight;
  EXPECT_EQ(breach(reserved, ring, 1), std::nullopt);
}

// A ring of three places whose producer reads the head before a pop moves it, and whose consumer
// reads the tail as it was before both pushes: acquire and release allow both.
TEST(Orders, FullAndEmptyNeedNoCommonMomentByHappensBeforeAlone) {
  const std::vector<Call> calls{{Kind::push, 0, 1}, {Kind::pop, 1, 1},  {Kind::empty, 1, 0},
                                {Kind::push, 0, 2}, {Kind::push, 0, 3}, {Kind::full, 0, 4},
                                {Kind::pop, 1, 2},  {Kind::pop, 1, 3},  {Kind::empty, 1, 0}};
  const auto each_in_its_order = [&](std::size_t a, std::size_t b) {
    return a == 0 || calls[a].worker == calls[b].worker;
  };
  const Calls late = ordered(calls, 3, each_in_its_order);
  Claims ring{.ordering = Ordering::fifo_happens_before, .bounded = true};
  EXPECT_EQ(breach(late, ring, 3), std::nullopt);
  EXPECT_EQ(breach(late, ring, 4), Pattern::full) << "never were there four";
  EXPECT_TRUE(breach(ordered(calls, 3, always), ring, 3)) << "one after the other";
  ring.ordering = Ordering::fifo_real_time;
  EXPECT_TRUE(breach(late, ring, 3));
}

TEST(Orders, OwnQueuesAreJudgedEachByItself) {
  Claims own{.ordering = Ordering::fifo_happens_before,
             .producers = Callers::own_worker,
             .consumers = Callers::own_worker};
  const std::vector<Call> fine{{Kind::push, 0, 1},
                               {Kind::empty, 1, 0},
                               {Kind::push, 1, 2},
                               {Kind::pop, 1, 2},
                               {Kind::pop, 0, 1}};
  EXPECT_EQ(breach(ordered(fine, 0, always), own, 1), std::nullopt);
  const std::vector<Call> stolen{{Kind::push, 0, 1}, {Kind::pop, 1, 1}};
  EXPECT_EQ(breach(ordered(stolen, 0, always), own, 1), Pattern::fresh);
}

TEST(Orders, ALongHistoryInOneOrderIsJudged) {
  std::vector<Call> calls;
  for (Element e = 1; e <= 300; ++e) {
    calls.push_back({Kind::push, 0, e});
    calls.push_back({Kind::pop, 0, e});
  }
  const Claims fifo{.ordering = Ordering::fifo_happens_before};
  EXPECT_EQ(breach(ordered(calls, 0, always), fifo, 1), std::nullopt);
  calls.insert(calls.begin() + 101, {Kind::empty, 1, 0});
  EXPECT_EQ(breach(ordered(calls, 0, always), fifo, 1), Pattern::witness);
}

TEST(Orders, SaysWhereThereAreTooManyToTry) {
  // Twenty elements of as many workers that come out in no order of one queue and its reverse.
  std::vector<Call> calls;
  constexpr Element elements = 20;
  for (Element e = 1; e <= elements; ++e) calls.push_back({Kind::push, unsigned(e), e});
  for (Element e = elements; e >= 1; --e) calls.push_back({Kind::pop, 0, e});
  calls.push_back({Kind::push, 0, 100});
  calls.push_back({Kind::empty, 0, 0});
  calls.push_back({Kind::pop, 0, 100});
  const Calls many = ordered(calls, 0, [](std::size_t a, std::size_t b) {
    return a < b && b >= elements && a >= elements;
  });
  const Specification fifo({.ordering = Ordering::fifo_happens_before}, 1);
  const Judgement judgement = judge_in_every_order(many, fifo, 1000);
  EXPECT_FALSE(judgement.breach);
  EXPECT_FALSE(judgement.decided);
}

// --- The table, literally -------------------------------------------------------------------

class Literal {
 public:
  Literal(const Calls& calls, const Claims& claims, std::size_t capacity)
      : calls_(calls), all_(calls.all()), claims_(claims), capacity_(capacity) {}

  [[nodiscard]] bool accepts() const {
    if (!elements_are_right()) return false;
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (all_[i].kind == Kind::full && !claims_.bounded) return false;
      if (all_[i].kind == Kind::full && full() != Answer::exact && !excused_full(i)) return false;
      if (all_[i].kind == Kind::empty && empty() != Answer::exact && !excused_empty(i))
        return false;
    }
    if (claims_.ordering == Ordering::per_producer_fifo)
      for (unsigned producer = 0; producer < 8; ++producer)
        if (!some_order(
                0, [&](const Call& c) { return owner(c.value) == producer; },
                [](std::size_t) { return false; }))
          return false;
    std::uint64_t passes = 0;
    if (claims_.ordering == Ordering::k_relaxed_fifo) passes = claims_.relaxation;
    if (claims_.ordering == Ordering::unordered || claims_.ordering == Ordering::per_producer_fifo)
      passes = 1000;
    const auto true_at_once = [&](const std::function<bool(std::size_t)>& answers) {
      return some_order(
          passes, [](const Call&) { return true; }, answers);
    };
    if (claims_.ordering != Ordering::fifo_happens_before)
      return true_at_once([](std::size_t) { return true; });
    for (const Kind kind : {Kind::full, Kind::empty})
      if (!true_at_once([&](std::size_t i) { return all_[i].kind == kind; })) return false;
    for (std::size_t a = 0; a < all_.size(); ++a)
      for (std::size_t b = 0; b < all_.size(); ++b)
        if (calls_.precedes(a, b) && !true_at_once([&](std::size_t i) { return i == a || i == b; }))
          return false;
    return true;
  }

 private:
  [[nodiscard]] bool fifo() const { return claims_.ordering >= Ordering::fifo_happens_before; }
  [[nodiscard]] Answer full() const {
    if (claims_.full != Answer::by_ordering) return claims_.full;
    return fifo() ? Answer::exact : Answer::calls_in_flight;
  }
  [[nodiscard]] Answer empty() const {
    if (claims_.empty != Answer::by_ordering) return claims_.empty;
    return fifo() ? Answer::exact : Answer::calls_in_flight;
  }
  [[nodiscard]] unsigned owner(Element e) const {
    for (const Call& c : all_)
      if (c.kind == Kind::push && c.value == e) return c.worker;
    return ~0U;
  }
  [[nodiscard]] bool overlap(std::size_t a, std::size_t b) const {
    return a != b && !calls_.precedes(a, b) && !calls_.precedes(b, a);
  }

  [[nodiscard]] bool elements_are_right() const {
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (all_[i].kind != Kind::push && all_[i].kind != Kind::pop) continue;
      std::size_t pushes = 0, pops = 0;
      for (std::size_t j = 0; j < all_.size(); ++j) {
        if (all_[j].value != all_[i].value) continue;
        pushes += all_[j].kind == Kind::push ? 1 : 0;
        pops += all_[j].kind == Kind::pop ? 1 : 0;
        if (all_[i].kind == Kind::push && all_[j].kind == Kind::pop && calls_.precedes(j, i))
          return false;
      }
      if (pushes != 1 || pops != 1) return false;
    }
    return true;
  }

  [[nodiscard]] bool excused_full(std::size_t at) const {
    std::size_t places = 0;
    std::set<unsigned> refused;
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (overlap(i, at) && all_[i].kind == Kind::pop) return true;
      if (overlap(i, at) && all_[i].kind == Kind::full) refused.insert(all_[i].worker);
      // Inside, for all that the order says.
      if (all_[i].kind != Kind::push || calls_.precedes(at, i)) continue;
      bool gone = false;
      for (std::size_t j = 0; j < all_.size(); ++j)
        gone = gone || (all_[j].kind == Kind::pop && all_[j].value == all_[i].value &&
                        calls_.precedes(j, at));
      places += gone ? 0 : 1;
    }
    return places + refused.size() >= capacity_;
  }

  [[nodiscard]] bool excused_empty(std::size_t at) const {
    for (std::size_t push = 0; push < all_.size(); ++push) {
      if (all_[push].kind != Kind::push || !calls_.precedes(push, at)) continue;
      for (std::size_t pop = 0; pop < all_.size(); ++pop) {
        if (all_[pop].kind != Kind::pop || all_[pop].value != all_[push].value) continue;
        if (!calls_.precedes(at, pop)) continue;
        if (empty() == Answer::this_worker) {
          bool others = all_[pop].worker != all_[at].worker;
          for (std::size_t i = 0; i < all_.size(); ++i)
            others = others || (all_[i].worker != all_[at].worker && !calls_.precedes(i, at) &&
                                !calls_.precedes(pop, i));
          if (!others) return false;
          continue;
        }
        bool explained = false;
        for (std::size_t i = 0; i < all_.size(); ++i) {
          if (!overlap(i, at)) continue;
          const bool throughout = calls_.precedes(push, i) && calls_.precedes(i, pop);
          explained = explained || all_[i].kind == Kind::push || all_[i].kind == Kind::pop ||
                      (all_[i].kind == Kind::empty && !throughout);
        }
        if (!explained) return false;
      }
    }
    return true;
  }

  // Every permutation, without memory.
  [[nodiscard]] bool some_order(std::uint64_t passes,
                                const std::function<bool(const Call&)>& counts,
                                const std::function<bool(std::size_t)>& answers) const {
    std::vector<bool> done(all_.size(), false);
    std::vector<Element> held;
    const std::function<bool(std::size_t)> go = [&](std::size_t left) {
      if (left == 0) return true;
      for (std::size_t i = 0; i < all_.size(); ++i) {
        bool next = !done[i];
        for (std::size_t j = 0; next && j < all_.size(); ++j)
          next = done[j] || !calls_.precedes(j, i);
        if (!next) continue;
        const std::vector<Element> saved = held;
        const Call& c = all_[i];
        bool allowed = true;
        if (c.kind == Kind::push && counts(c)) held.push_back(c.value);
        if (c.kind == Kind::pop && counts(c)) {
          const auto at = std::ranges::find(held, c.value);
          allowed = at != held.end() && std::uint64_t(at - held.begin()) <= passes;
          if (allowed) held.erase(at);
        }
        if (c.kind == Kind::full && answers(i) && full() == Answer::exact)
          allowed = held.size() >= capacity_;
        if (c.kind == Kind::empty && answers(i) && empty() == Answer::exact) allowed = held.empty();
        if (allowed) {
          done[i] = true;
          if (go(left - 1)) return true;
          done[i] = false;
        }
        held = saved;
      }
      return false;
    };
    return go(all_.size());
  }

  const Calls& calls_;
  const std::vector<Call>& all_;
  Claims claims_;
  std::size_t capacity_;
};

struct Sample {
  History history;
  std::vector<Call> calls;  ///< in the order of their starts, then the drain
  std::vector<std::pair<Stamp, Stamp>> times;
};

/// Answers of a bounded FIFO at random moments, some of them bent, and what then was left.
Sample random_sample(Random& random, unsigned workers, unsigned operations, std::size_t capacity) {
  struct Made {
    Call call;
    Stamp from, to;
  };
  std::vector<Made> made;
  std::vector<Element> held;
  std::vector<std::uint64_t> pushed(workers, 0);
  std::vector<Stamp> free_from(workers, 0);
  const Stamp stretch = std::uint64_t{2} << (2 * below(random, 3));
  const std::uint64_t bend = below(random, 3);
  Stamp now = 0;
  for (unsigned i = 0; i < operations; ++i) {
    now += 1 + below(random, 4);
    const auto worker = static_cast<unsigned>(below(random, workers));
    const Stamp from = std::max(free_from[worker], now - std::min(now, below(random, stretch)));
    const Stamp to = std::max(from + 1, now + below(random, stretch));
    free_from[worker] = to + 1;
    Call call{.worker = worker};
    const bool wrong = bend > 0 && below(random, 4) == 0;
    if (below(random, 2) == 0) {
      call.value = element(worker, pushed[worker]);
      call.kind = (held.size() >= capacity) != wrong ? Kind::full : Kind::push;
      if (call.kind == Kind::push) {
        ++pushed[worker];
        held.push_back(call.value);
      }
    } else if (held.empty() || wrong) {
      call.kind = Kind::empty;
    } else {
      const std::size_t at = bend == 2 ? below(random, held.size()) : 0;
      call.kind = Kind::pop;
      call.value = held[at];
      held.erase(held.begin() + static_cast<std::ptrdiff_t>(at));
    }
    made.push_back({call, from, to});
  }
  std::ranges::stable_sort(made, [](const Made& a, const Made& b) { return a.from < b.from; });
  Sample sample;
  sample.history.logs.resize(workers);
  for (const Made& m : made) {
    sample.calls.push_back(m.call);
    sample.times.emplace_back(m.from, m.to);
    sample.history.logs[m.call.worker].push_back({m.from, m.to, m.call.value, m.call.kind});
  }
  now += 100;
  for (const Element e : held) {
    sample.calls.push_back({Kind::pop, workers, e});
    sample.history.drain.push_back({now, now + 1, e, Kind::pop});
    now += 2;
  }
  return sample;
}

Claims random_claims(Random& random) {
  Claims claims{.ordering = static_cast<Ordering>(below(random, 5)), .bounded = true};
  if (claims.ordering == Ordering::k_relaxed_fifo) claims.relaxation = 1;
  claims.full = static_cast<Answer>(below(random, 3));
  claims.empty = static_cast<Answer>(below(random, 4));
  return claims;
}

std::string print(const Sample& sample, const Claims& claims, std::size_t capacity) {
  std::ostringstream text;
  text << "ordering " << int(claims.ordering) << " full " << int(claims.full) << " empty "
       << int(claims.empty) << " capacity " << capacity << '\n';
  for (const Call& c : sample.calls)
    text << "worker " << c.worker << " kind " << int(c.kind) << ' ' << element_name(c.value)
         << '\n';
  return text.str();
}

TEST(Orders, AgreeWithTheTableTakenLiterallyOn50000Histories) {
  Random random(16);
  int accepted = 0;
  constexpr int samples = 50'000;
  for (int i = 0; i < samples; ++i) {
    const std::size_t capacity = 1 + below(random, 2);
    const Sample sample = random_sample(random, static_cast<unsigned>(2 + below(random, 2)),
                                        static_cast<unsigned>(3 + below(random, 5)), capacity);
    const Claims claims = random_claims(random);
    const Calls calls =
        ordered(sample.calls, sample.history.drain.size(), [&](std::size_t a, std::size_t b) {
          return sample.times[a].second < sample.times[b].first;
        });
    const bool right = Literal(calls, claims, capacity).accepts();
    const Judgement judgement = judge_in_every_order(calls, Specification(claims, capacity));
    ASSERT_EQ(!judgement.breach, right) << print(sample, claims, capacity);
    accepted += right ? 1 : 0;
  }
  EXPECT_GT(accepted, samples / 4);
  EXPECT_LT(accepted, samples * 9 / 10);
}

// What stays inside would come out in some order: the calls are right if they are with that.
TEST(Orders, WhatStaysInsideIsAsIfItCameOutInSomeOrder) {
  Random random(7);
  int accepted = 0;
  constexpr int samples = 5'000;
  for (int i = 0; i < samples; ++i) {
    const std::size_t capacity = 1 + below(random, 3);
    Sample sample = random_sample(random, 2, static_cast<unsigned>(3 + below(random, 5)), capacity);
    const Claims claims = random_claims(random);
    const Specification specification(claims, capacity);
    const auto by_time = [&](std::size_t a, std::size_t b) {
      return sample.times[a].second < sample.times[b].first;
    };
    const auto first_left =
        sample.calls.end() - static_cast<std::ptrdiff_t>(sample.history.drain.size());
    const auto by_value = [](const Call& a, const Call& b) { return a.value < b.value; };
    std::sort(first_left, sample.calls.end(), by_value);
    bool in_some_order = false;
    do {
      const Calls emptied = ordered(sample.calls, sample.history.drain.size(), by_time);
      in_some_order =
          in_some_order || !judge_in_every_order(emptied, specification).breach.has_value();
    } while (std::next_permutation(first_left, sample.calls.end(), by_value));
    sample.calls.erase(first_left, sample.calls.end());
    Calls left = ordered(sample.calls, 0, by_time);
    left.leave_inside();
    ASSERT_EQ(!judge_in_every_order(left, specification).breach, in_some_order)
        << print(sample, claims, capacity);
    accepted += in_some_order ? 1 : 0;
  }
  EXPECT_GT(accepted, samples / 4);
  EXPECT_LT(accepted, samples * 9 / 10);
  EXPECT_EQ(breach(ordered({{Kind::push, 0, 1}}, 0, always), {}, 1), Pattern::lost) << "emptied";
}

/// Ordered by the closure of each worker's own order and push -> pop, with the drain after all;
/// none if that is a cycle.
std::optional<Calls> by_happens_before(const Sample& sample) {
  const std::size_t n = sample.calls.size() - sample.history.drain.size();
  std::vector<std::vector<bool>> before(n, std::vector<bool>(n, false));
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b) {
      const Call& first = sample.calls[a];
      const Call& second = sample.calls[b];
      before[a][b] =
          (a < b && first.worker == second.worker) ||
          (first.kind == Kind::push && second.kind == Kind::pop && first.value == second.value);
    }
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b)
        if (before[a][k] && before[k][b]) before[a][b] = true;
  // The more a call has before it, the later it may stand.
  std::vector<std::size_t> stand(sample.calls.size());
  std::iota(stand.begin(), stand.end(), std::size_t{0});
  const auto past = [&](std::size_t b) {
    std::size_t sum = b >= n ? n : 0;
    for (std::size_t a = 0; b < n && a < n; ++a) sum += before[a][b] ? 1 : 0;
    return sum;
  };
  for (std::size_t a = 0; a < n; ++a)
    if (before[a][a]) return std::nullopt;
  std::ranges::stable_sort(stand, [&](std::size_t a, std::size_t b) { return past(a) < past(b); });
  std::vector<Call> calls;
  calls.reserve(stand.size());
  for (const std::size_t i : stand) calls.push_back(sample.calls[i]);
  return ordered(calls, sample.history.drain.size(),
                 [&](std::size_t a, std::size_t b) { return bool(before[stand[a]][stand[b]]); });
}

TEST(Orders, TheOraclesOfLongHistoriesNeverAccuseWhatTheyAccept) {
  Random random(61);
  int wrong = 0;
  int caught = 0;
  for (int i = 0; i < 50'000; ++i) {
    const std::size_t capacity = 1 + below(random, 2);
    Sample sample = random_sample(random, 3, static_cast<unsigned>(3 + below(random, 6)), capacity);
    Claims claims = random_claims(random);
    // What the clock says is for another test.
    if (claims.ordering == Ordering::fifo_real_time)
      claims.ordering = Ordering::fifo_happens_before;
    if (claims.ordering == Ordering::k_relaxed_fifo) claims.ordering = Ordering::unordered;
    const Specification specification(claims, capacity);
    const std::optional<Calls> calls = by_happens_before(sample);
    const bool right = calls && !judge_in_every_order(*calls, specification).breach;
    const bool accused = !judge(sample.history, claims, capacity).violations.empty();
    ASSERT_FALSE(right && accused) << print(sample, claims, capacity);
    wrong += right ? 0 : 1;
    caught += accused ? 1 : 0;
  }
  EXPECT_GT(wrong, 5'000);
  EXPECT_GT(caught, wrong * 3 / 4);
  std::printf("long histories: %d of %d wrong ones caught\n", caught, wrong);
}

}  // namespace
}  // namespace irt::stress
