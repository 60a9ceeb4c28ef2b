/// The programs of the scenarios: what each thread does until the measurement ends. Each has a hand
/// to itself.
#pragma once

#include <utility>

#include "bench/contention/hand.hpp"

namespace irt::contention {

/// Push, work, pop until an element is found, work.
template <class Hand>
[[gnu::always_inline]] inline void pairs(Hand&& hand) {
  std::uint64_t element = 0;
  while (hand.running()) {
    hand.push_until_accepted(hand.fresh());
    hand.work();
    hand.pop_until_found(element);
    hand.work();
  }
}

/// Pop, work, push what was popped, work: the queue stays as full as it was.
template <class Hand>
[[gnu::always_inline]] inline void exchange(Hand&& hand) {
  std::uint64_t element = 0;
  while (hand.pop_until_found(element)) {
    hand.work();
    hand.push_until_accepted(element);
    hand.work();
  }
}

/// Many pushes, work, as many pops, work. A bounded queue may cut a burst short.
template <class Hand>
[[gnu::always_inline]] inline void bursts(Hand&& hand) {
  constexpr unsigned size = 64;
  std::uint64_t element = 0;
  while (hand.running()) {
    unsigned inside = 0;
    while (inside < size && hand.push(hand.fresh())) ++inside;
    hand.work();
    for (; inside > 0 && hand.pop_until_found(element); --inside) {
    }
    hand.work();
  }
}

/// The first threads push, with work after each; the others pop, with work after each found.
template <class Hand>
[[gnu::always_inline]] inline void sides(Hand&& hand) {
  if (hand.seat().worker < hand.seat().table.roles.producers) {
    while (hand.running()) {
      hand.let_consumers_catch_up();
      hand.push_until_accepted(hand.fresh());
      hand.work();
      busy_wait(hand.seat().producer_pause_steps);
    }
    return;
  }
  std::uint64_t element = 0;
  while (hand.pop_until_found(element)) hand.work();
}

/// Each of the first threads sends an element to any of the others and waits for one to come back.
/// `ping` is the hand on the queue there, `pong` on that back.
template <class Hand>
[[gnu::always_inline]] inline void ping_pong(Hand&& ping, Hand&& pong) {
  const bool sends = ping.seat().worker < ping.seat().table.roles.producers;
  Hand& there = sends ? ping : pong;
  Hand& back = sends ? pong : ping;
  std::uint64_t element = there.fresh();
  while (sends || back.pop_until_found(element)) {
    if (!sends) back.work();
    if (!there.push_until_accepted(element)) return;
    if (sends) {
      if (!back.pop_until_found(element)) return;
      there.work();
    }
  }
}

/// The renderer's shape. A frame starts with a share of tasks from each thread; a task leads to up
/// to six more, of which each leads to up to two; a thread that finds the queue empty waits for the
/// others at the end of the frame, and so does the time they take. What a full queue does not take
/// is worked off at once.
template <class Hand>
[[gnu::always_inline]] inline void frames(Hand&& hand) {
  constexpr unsigned roots = 64;
  constexpr unsigned depth_bits = 2;
  Table& table = hand.seat().table;
  while (table.gate.pass(table.stop)) {
    for (unsigned i = 0; i < roots; ++i) {
      if (!hand.push(hand.fresh() << depth_bits)) hand.work();
    }
    std::uint64_t task = 0;
    while (hand.running() && hand.pop(task)) {
      hand.work();
      const std::uint64_t depth = task & ((1U << depth_bits) - 1);
      std::uint64_t children = depth == 0 ? hand.random(7) : depth == 1 ? hand.random(3) : 0;
      for (; children > 0; --children) {
        if (!hand.push((hand.fresh() << depth_bits) | (depth + 1))) hand.work();
      }
    }
  }
}

}  // namespace irt::contention
