/// Contention scenarios: what threads do with a queue as fast as they can, or with work between
/// their operations. All of them are in this file, and every instrument runs them from here, each
/// with *hands* of its own, which say what an operation, work and the end mean:
///
///     irt bench contention   bench/contention/hand.hpp              the clock of this machine
///     irt simulate           bench/many_core/workloads/point.cpp    simulated time
///     irt stress, irt check  stress/scenarios/core_hand.hpp         histories, judged
///
/// A hand belongs to one thread and one queue:
///
///     running()                 whether to go on; what every loop asks that has no other end
///     push(), pop()             one try with an element of its own; false for full, for empty
///     push_until_accepted(), pop_until_found()   tries until then; false where the end comes first
///     push_bulk(), pop_bulk(most)   one call with `bulk` elements, and for so many of these at
///     most;
///                               how many went in, and came out
///     pop_wait()                a pop that sleeps until then; false where the queue is closed
///     close()                   the queue, at the end, for whoever sleeps there
///     put(), take()             push_until_accepted and pop_until_found, and the work that follows
///     an operation; at the end put
///                               may answer true as well
///     put_back()                put, of what was taken last (of another, where each goes once);
///                               nothing at the end
///     push_tagged(tag), pop_tagged(tag)          one try with an element that carries a tag
///     work()                    the work between operations
///     random(bound)             below `bound`
///     produces()                whether this thread is among the producers
///     leads()                   whether it is the one that does what only one should
///     consumers_caught_up()     waits where the queue would grow without end; false at the end
///     rest()                    a producer's pause, on top of its work
///     meet()                    waits for all threads; false, to all alike, at the end
///     finished_one(), all_finished(tasks)        a task more is done; whether all threads together
///                               have done so many
///     burst()                   how this instrument makes bursts
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "queues/roles.hpp"

namespace irt::contention {

/// Tags of elements are below this.
inline constexpr unsigned tags = 32;

/// Elements of a call for several.
inline constexpr std::size_t bulk = 16;

/// So many pushes, then so many pops. Either the work follows each of them, or a burst.
struct Burst {
  unsigned size = 64;
  bool works_after_each = false;
};

// --- Programs: what each thread does until the end -----------------------------------------------

/// Push, work, pop until an element is found, work.
template <class Hand>
[[gnu::always_inline]] inline void pairs(Hand&& hand) {
  while (hand.running()) {
    if (hand.put()) hand.take();
  }
}

/// Pop, work, push what was popped, work: the queue stays as full as it was.
template <class Hand>
[[gnu::always_inline]] inline void exchange(Hand&& hand) {
  while (hand.running()) {
    hand.take();
    hand.put_back();
  }
}

/// Many pushes, work, as many pops, work. A bounded queue may cut a burst short.
template <class Hand>
[[gnu::always_inline]] inline void bursts(Hand&& hand) {
  const Burst burst = hand.burst();
  while (hand.running()) {
    unsigned inside = 0;
    while (inside < burst.size && (burst.works_after_each ? hand.put() : hand.push())) ++inside;
    if (!burst.works_after_each) hand.work();
    while (inside > 0 && (burst.works_after_each ? hand.take() : hand.pop_until_found())) --inside;
    if (!burst.works_after_each) hand.work();
  }
}

/// Sixteen pushes in a call, work, as many pops in as few calls as the queue takes, work.
template <class Hand>
[[gnu::always_inline]] inline void bulks(Hand&& hand) {
  while (hand.running()) {
    std::size_t inside = hand.push_bulk();
    hand.work();
    while (inside > 0 && hand.running()) inside -= std::min(inside, hand.pop_bulk(inside));
    hand.work();
  }
}

/// Push or pop once, by the toss of a coin, work: the "50 % enqueues" of many papers on queues, as
/// Morrison and Afek's on LCRQ (2013). A pop of an empty queue fails, and is not tried again.
template <class Hand>
[[gnu::always_inline]] inline void coin_toss(Hand&& hand) {
  while (hand.running()) {
    if (hand.random(2) == 0) {
      hand.push();
    } else {
      hand.pop();
    }
    hand.work();
  }
}

/// Producers push, with work after each; the others pop, with work after each found.
template <class Hand>
[[gnu::always_inline]] inline void sides(Hand&& hand) {
  if (hand.produces()) {
    while (hand.consumers_caught_up()) {
      hand.put();
      hand.rest();
    }
    return;
  }
  while (hand.running()) hand.take();
}

/// Each producer sends an element to any of the others and waits for one to come back. `ping` is
/// the hand on the queue there, `pong` on that back.
template <class Hand>
[[gnu::always_inline]] inline void ping_pong(Hand&& ping, Hand&& pong) {
  const bool sends = ping.produces();
  Hand& there = sends ? ping : pong;
  Hand& back = sends ? pong : ping;
  while (there.running() && (sends || back.pop_until_found())) {
    if (!sends) back.work();
    if (!there.push_until_accepted()) return;
    if (sends) {
      if (!back.pop_until_found()) return;
      there.work();
    }
  }
}

/// The same with one that sleeps: how long it takes from a push until the other one has woken.
template <class Hand>
[[gnu::always_inline]] inline void wake(Hand&& ping, Hand&& pong) {
  const bool sends = ping.produces();
  Hand& there = sends ? ping : pong;
  Hand& back = sends ? pong : ping;
  while (there.running() && (sends || back.pop_wait())) {
    if (!sends) back.work();
    if (!there.push_until_accepted()) break;
    if (sends) {
      if (!back.pop_wait()) break;
      there.work();
    }
  }
  there.close();
  back.close();
}

/// The renderer's shape. A frame starts with a share of tasks from each thread; a task leads to up
/// to six more, of which each leads to up to two; a thread that finds the queue empty waits for the
/// others at the end of the frame, and so does the time they take. What a full queue does not take
/// is worked off at once.
template <class Hand>
[[gnu::always_inline]] inline void frames(Hand&& hand) {
  constexpr unsigned roots = 64;
  while (hand.meet()) {
    for (unsigned i = 0; i < roots && hand.running(); ++i) {
      if (!hand.push_tagged(0)) hand.work();
    }
    unsigned depth = 0;
    while (hand.running() && hand.pop_tagged(depth)) {
      hand.work();
      std::uint64_t children = depth == 0 ? hand.random(7) : depth == 1 ? hand.random(3) : 0;
      for (; children > 0; --children) {
        if (!hand.push_tagged(depth + 1)) hand.work();
      }
    }
  }
}

/// All push a burst, one takes out what they brought and puts as much in, all pop: so the order in
/// which a queue took the pushes, and served the pops, of a rush is seen from outside.
template <class Hand>
[[gnu::always_inline]] inline void rushes(Hand&& hand) {
  while (hand.meet()) {
    for (unsigned left = hand.burst().size; left > 0 && hand.push(); --left) hand.work();
    if (!hand.meet()) return;
    unsigned taken = 0;
    while (hand.leads() && hand.running() && hand.pop()) ++taken;
    while (taken > 0 && hand.push()) --taken;
    if (!hand.meet()) return;
    while (hand.running() && hand.pop()) hand.work();
  }
}

/// The recursive Fibonacci number of 24, without its sums: each call is a task.
struct Fibonacci {
  static constexpr unsigned root = 24;
  static constexpr std::uint64_t tasks = 150'049;
  template <class Spawn>
  static void children(unsigned n, Spawn spawn) {
    if (n < 2) return;
    spawn(n - 1);
    spawn(n - 2);
  }
};

/// Ten tasks from each, five levels deep: the skynet benchmark (atemerev/skynet), a tenth of it.
struct Skynet {
  static constexpr unsigned root = 5;
  static constexpr std::uint64_t tasks = 111'111;
  template <class Spawn>
  static void children(unsigned levels, Spawn spawn) {
    for (unsigned child = 0; levels > 0 && child < 10; ++child) spawn(levels - 1);
  }
};

/// Does a task, and at once those of its children that a full queue does not take.
template <class Tree, class Hand>
void grow(Hand& hand, unsigned tag) {
  hand.work();
  Tree::children(tag, [&](unsigned child) {
    if (hand.running() && !hand.push_tagged(child)) grow<Tree>(hand, child);
  });
  hand.finished_one();
}

/// A tree of tasks grows from one root, again and again: it is done when all its tasks are, which
/// only threads that find the queue empty ask.
template <class Tree, class Hand>
[[gnu::always_inline]] inline void trees(Hand&& hand) {
  std::uint64_t tasks = 0;
  while (hand.meet()) {
    tasks += Tree::tasks;
    if (hand.leads()) grow<Tree>(hand, Tree::root);
    while (hand.running()) {
      unsigned tag = 0;
      if (hand.pop_tagged(tag)) {
        grow<Tree>(hand, tag);
      } else if (hand.all_finished(tasks)) {
        break;
      }
    }
  }
}

enum class Program : std::uint8_t {
  pairs,
  exchange,
  bursts,
  bulks,
  coin_toss,
  sides,
  ping_pong,
  wake,
  frames,
  rushes,
  fibonacci,
  skynet
};

/// Runs `program` with a `Hand(queue, rest...)` on `first`, and where there are two queues one on
/// `second`. Each program has a hand to itself: one that several share would have to live in
/// memory. So would they all, by GCC 12, if this were inlined.
template <class Hand, class Queue, class... Rest>
[[gnu::noinline]] void play(Program program, Queue& first, Queue* second, Rest&... rest) {
  switch (program) {
    case Program::pairs:
      return pairs(Hand(first, rest...));
    case Program::exchange:
      return exchange(Hand(first, rest...));
    case Program::bursts:
      return bursts(Hand(first, rest...));
    case Program::bulks:
      return bulks(Hand(first, rest...));
    case Program::coin_toss:
      return coin_toss(Hand(first, rest...));
    case Program::sides:
      return sides(Hand(first, rest...));
    case Program::frames:
      return frames(Hand(first, rest...));
    case Program::rushes:
      return rushes(Hand(first, rest...));
    case Program::fibonacci:
      return trees<Fibonacci>(Hand(first, rest...));
    case Program::skynet:
      return trees<Skynet>(Hand(first, rest...));
    case Program::ping_pong:
      // Each thread pushes into one queue only and pops from the other only, so that what two hands
      // count of one thread does not overlap.
      return ping_pong(Hand(first, rest...), Hand(*second, rest...));
    case Program::wake:
      return wake(Hand(first, rest...), Hand(*second, rest...));
  }
}

// --- Scenarios: who plays which program ----------------------------------------------------------

struct Scenario {
  std::string_view name;
  std::string_view operation_mix;  ///< in words, for the results
  Program program = Program::pairs;
  Roles (*roles)(unsigned threads) = nullptr;
  unsigned least_threads = 1;
  double producer_pause_ns = 0;  ///< on top of the work between operations
  double prefill = 0;            ///< share of the capacity that is inside all the time

  [[nodiscard]] constexpr bool has_two_queues() const {
    return program == Program::ping_pong || needs_pop_wait();
  }
  [[nodiscard]] constexpr bool needs_pop_wait() const { return program == Program::wake; }
  [[nodiscard]] constexpr bool needs_bulk() const { return program == Program::bulks; }
  [[nodiscard]] constexpr bool needs_elements() const {
    return program == Program::frames || program == Program::fibonacci ||
           program == Program::skynet;
  }

  /// Why a queue with these claims and optional methods cannot play it, apart from who pushes and
  /// who pops; empty if it can.
  [[nodiscard]] constexpr std::string_view obstacle(const Claims& claims,
                                                    const Methods& methods) const {
    if (needs_elements() && !claims.carries_elements)
      return "it carries no elements, and a task says what comes of it";
    if (needs_pop_wait() && !methods.pop_wait) return "it has no pop_wait";
    if (needs_bulk() && !methods.bulk) return "it has no push_bulk and pop_bulk";
    return {};
  }
};

constexpr Roles halves(unsigned threads) {
  return apart(threads - threads / 2, threads / 2);
}
constexpr Roles to_one(unsigned threads) {
  return apart(threads - 1, 1);
}
constexpr Roles from_one(unsigned threads) {
  return apart(1, threads - 1);
}
constexpr Roles few_producers(unsigned threads) {
  const unsigned producers = std::max(threads / 4, 1U);
  return apart(producers, threads - producers);
}
// A thread that is left over would have nobody to play with.
constexpr Roles couples(unsigned threads) {
  return apart(threads / 2, threads / 2);
}

/// Those with a name; beside them, instruments may take others' numbers of producers and consumers.
inline constexpr std::array scenario_table{
    Scenario{.name = "pairs",
             .operation_mix = "each thread pushes one, then pops one",
             .program = Program::pairs,
             .roles = all_do_both},
    Scenario{.name = "producers-consumers",
             .operation_mix = "producers push, consumers pop",
             .program = Program::sides,
             .roles = halves,
             .least_threads = 2},
    Scenario{.name = "fan-in",
             .operation_mix = "all push, one pops",
             .program = Program::sides,
             .roles = to_one,
             .least_threads = 2},
    Scenario{.name = "fan-out",
             .operation_mix = "one pushes, all others pop",
             .program = Program::sides,
             .roles = from_one,
             .least_threads = 2},
    Scenario{.name = "near-empty",
             .operation_mix = "a quarter push, with 1 us more between pushes; the others pop",
             .program = Program::sides,
             .roles = few_producers,
             .least_threads = 2,
             .producer_pause_ns = 1000},
    Scenario{.name = "prefilled",
             .operation_mix = "each thread pops one, then pushes one; the queue is half full",
             .program = Program::exchange,
             .roles = all_do_both,
             .prefill = 0.5},
    Scenario{.name = "bursts",
             .operation_mix = "each thread pushes 64, then pops 64",
             .program = Program::bursts,
             .roles = all_do_both},
    Scenario{.name = "bulk",
             .operation_mix = "each thread pushes 16 in a call, then pops 16",
             .program = Program::bulks,
             .roles = all_do_both},
    Scenario{.name = "coin-toss",
             .operation_mix = "each thread pushes one or pops one, by the toss of a coin",
             .program = Program::coin_toss,
             .roles = all_do_both},
    Scenario{.name = "ping-pong",
             .operation_mix = "couples pass one element to and fro over two queues",
             .program = Program::ping_pong,
             .roles = couples,
             .least_threads = 2},
    Scenario{.name = "wake",
             .operation_mix = "ping-pong with pop_wait; one element's way to a thread that sleeps",
             .program = Program::wake,
             .roles = couples,
             .least_threads = 2},
    Scenario{.name = "renderer",
             .operation_mix = "frames of 64 tasks per thread; a task leads to 6 more on average",
             .program = Program::frames,
             .roles = all_do_both},
    Scenario{.name = "rush",
             .operation_mix = "all push a burst, one pops and pushes as many, all pop",
             .program = Program::rushes,
             .roles = all_do_both},
    Scenario{.name = "fib",
             .operation_mix = "a binary tree of 150,049 tasks from one root; two operations a task",
             .program = Program::fibonacci,
             .roles = all_do_both},
    Scenario{.name = "skynet",
             .operation_mix = "a tree of 111,111 tasks, ten from each; two operations a task",
             .program = Program::skynet,
             .roles = all_do_both},
};

/// The scenario `name`, or null.
constexpr const Scenario* find_scenario(std::string_view name) {
  for (const Scenario& each : scenario_table)
    if (each.name == name) return &each;
  return nullptr;
}

}  // namespace irt::contention
