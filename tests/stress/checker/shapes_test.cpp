// How clients of a queue are written, and which ones the batteries choose.

#include "stress/checker/shapes.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>

#include "stress/checker/batteries.hpp"
#include "tests/stress/checker/claims.hpp"

namespace irt::checker {
namespace {

TEST(Shapes, are_read_and_written_alike) {
  for (const char* text :
       {"EE:D|ED", "E|D;C", "E|D;X", "F;EX@3", "F:D@256", "EES|D|WD", "E:D|D@3+65534", "E:D|D+250",
        "(ED)*40|D", "EEE(ED)*200:(DE)*7|D;(E)*12@5"})
    EXPECT_EQ(to_string(parse_shape(text)), text);
}

TEST(Shapes, repeat_parts_and_parts_of_parts) {
  const Shape shape = parse_shape("((E)*2D)x3 DDD:(ED)*1|D;(D)*4@3");
  EXPECT_EQ(shape.prologue, "EEDEEDEEDDDD");
  EXPECT_EQ(shape.threads, (std::vector<std::string>{"ED", "D"}));
  EXPECT_EQ(shape.epilogue, "DDDD");
  EXPECT_EQ(parse_shape("(ED)x254 EEE:DDD@3").prologue.size(), 2 * 254 + 3U);
  for (const char* text : {"(EED)*100|D", "EEEEEEEEEEEEEEED|D", "EDEDEDEDEDEE:D"})
    EXPECT_EQ(parse_shape(to_string(parse_shape(text))), parse_shape(text)) << text;
}

TEST(Shapes, hold_what_is_pushed_and_not_popped_again) {
  EXPECT_EQ(most_held(parse_shape("EE:D|D")), 2U);
  EXPECT_EQ(most_held(parse_shape("(ED)*254 EEE:DDD")), 3U);
  EXPECT_EQ(most_held(parse_shape("DDE:D")), 1U);
  EXPECT_EQ(most_held(parse_shape("E|D")), 0U);
}

TEST(Shapes, are_refused_with_a_reason) {
  for (const char* text :
       {"",       "E|",    "EX|D",         "|D",     "E|D@",
        "E|D@0",  "E|D+",  "E|D+0",        "E|D+4x", "(ED|D",
        "ED)*3",  "(ED)3", "X:E",          "E|D;XE", "E|D;XX",
        "(ED)*0", "(ED)*", "((E)*9999)*2", "()*3",   "(E)*99999999999999999999|D"})
    EXPECT_THROW(parse_shape(text), std::invalid_argument) << text;
}

TEST(Shapes, give_a_role_for_one_to_one_at_a_time) {
  for (const char* text : {"E|D", "ED|S", "EES|WED", "EEWD|DS", "EE:D|E", "EC|D", "E:D|C", "E|C|D"})
    EXPECT_TRUE(allows(single, parse_shape(text))) << text;
  for (const char* text : {"E|E", "D|D", "ED|D", "ESE|WE", "ES|EWE", "ES|WE|WE", "ES|SD|WE",
                           "F|D|D", "R|D", "EESD|WE", "DSE|EWD"})
    EXPECT_FALSE(allows(single, parse_shape(text))) << text;
  EXPECT_TRUE(allows(anything, parse_shape("ED|ED|F")));
}

TEST(Batteries, keep_to_the_claims) {
  for (const Callers producers : {Callers::one, Callers::many, Callers::own_worker})
    for (const Callers consumers : {Callers::one, Callers::many, Callers::own_worker})
      for (const bool bounded : {false, true}) {
        const Claims claims{.bounded = bounded, .producers = producers, .consumers = consumers};
        std::vector<std::string> all = battery(claims);
        EXPECT_GE(all.size(), 6U);
        for (const bool old : {false, true}) {
          const auto aged = aged_battery(claims, old);
          EXPECT_FALSE(aged.empty());
          all.insert(all.end(), aged.begin(), aged.end());
        }
        for (const std::string& text : all) {
          const Shape shape = parse_shape(text);
          EXPECT_EQ(to_string(shape), text);
          EXPECT_TRUE(allows(claims, shape)) << text;
          EXPECT_TRUE(bounded || shape.capacity == 0) << text;
        }
      }
}

TEST(Batteries, try_rings_of_sizes_that_are_no_powers_of_two) {
  std::set<std::size_t> capacities;
  std::set<std::size_t> aged;
  for (const std::string& shape : battery(anything)) capacities.insert(parse_shape(shape).capacity);
  for (const std::string& text : aged_battery(anything)) {
    const Shape shape = parse_shape(text);
    if (shape.age != 0) aged.insert(shape.capacity);
  }
  for (const std::size_t capacity : {1U, 2U, 3U, 5U}) {
    EXPECT_TRUE(capacities.contains(capacity)) << capacity;
    EXPECT_TRUE(aged.contains(capacity)) << capacity;
  }
}

// Photon's ring before #504: *empty* to a thread that looked while another pushed and popped twice.
TEST(Batteries, push_and_pop_in_several_threads_of_a_ring_that_is_never_full) {
  const std::vector<std::string> shapes = battery(anything);
  EXPECT_TRUE(std::ranges::any_of(shapes, [](const std::string& text) {
    const Shape shape = parse_shape(text);
    std::size_t pushes = shape.prologue.size();
    for (const std::string& thread : shape.threads) {
      if (!thread.starts_with("ED")) return false;
      pushes += static_cast<std::size_t>(std::ranges::count(thread, 'E'));
    }
    return pushes >= 3 && shape.capacity > pushes;
  }));
}

TEST(Batteries, age_a_queue_to_just_before_a_counter_wraps) {
  const auto crosses = [](const Claims& claims, bool old, std::uint64_t range) {
    for (const std::string& text : aged_battery(claims, old)) {
      const Shape shape = parse_shape(text);
      auto pushes = static_cast<std::size_t>(std::ranges::count(shape.prologue, 'E'));
      if (shape.prologue == "F") pushes = shape.capacity;
      for (const std::string& thread : shape.threads)
        pushes += static_cast<std::size_t>(std::ranges::count(thread, 'E'));
      if (shape.age < range && shape.age + pushes > range) return true;
    }
    return false;
  };
  for (const Claims& claims : {anything, single, Claims{}}) {
    for (const std::uint64_t range : {1U << 7U, 1U << 8U, 1U << 15U, 1U << 16U})
      EXPECT_TRUE(crosses(claims, false, range)) << range;
    EXPECT_FALSE(crosses(claims, false, std::uint64_t{1} << 32U)) << "that takes minutes";
    EXPECT_TRUE(crosses(claims, true, std::uint64_t{1} << 32U));
  }
}

TEST(Batteries, destroy_queues_with_elements_inside) {
  const auto left = [](const std::vector<std::string>& shapes) {
    return std::ranges::count_if(
        shapes, [](const std::string& text) { return leaves_inside(parse_shape(text)); });
  };
  for (const Claims& claims : {anything, single, Claims{}}) {
    EXPECT_GE(left(battery(claims)), 3);
    EXPECT_GE(left(aged_battery(claims)), 4);
  }
}

TEST(Shapes, that_may_leave_a_waiting_pop_without_an_element_are_known) {
  for (const char* text : {"E|P", "EE:P|D", "EE|P|P", "C|P", "E|C|P", "P|C", "EC|P|P|P", "PE|E",
                           "EP|EP", "E|L", "L|L", "B|P|D", "PC|E", "C:P|P", "E|D;CP", "ES|WP"})
    EXPECT_FALSE(may_starve(parse_shape(text), Claims{})) << text;
  for (const char* text : {"P", "E|PP", "PE|PE", "E:P|D", "E|P|L", "E|P|D", "EE|G|P", "E|P;P",
                           "P:E", "E:R|P", "WE|PS", "E|P|P;C"})
    EXPECT_TRUE(may_starve(parse_shape(text), Claims{})) << text;
  EXPECT_TRUE(may_starve(parse_shape("EE|PP@1"), anything)) << "a push may find no place";
  EXPECT_FALSE(may_starve(parse_shape("EEC|PP@1"), anything));
  EXPECT_FALSE(may_starve(parse_shape("EE|PP"), anything)) << "room for both";
  EXPECT_TRUE(may_starve(parse_shape("EE|PP"), anything, 1)) << "as the caller has it";
  EXPECT_FALSE(may_starve(parse_shape("EE|PP"), Claims{}, 1));
  constexpr Claims own{.producers = Callers::own_worker, .consumers = Callers::own_worker};
  EXPECT_TRUE(may_starve(parse_shape("E|P"), own)) << "the element is not its own";
  EXPECT_FALSE(may_starve(parse_shape("EC|P"), own));
}

TEST(Batteries, leave_nobody_waiting_and_call_what_there_is) {
  constexpr Methods every{.pop_wait = true, .deadline = true, .bulk = true};
  for (const Claims& claims : {anything, single, Claims{}}) {
    for (const std::string& text : battery(claims, every))
      EXPECT_FALSE(may_starve(parse_shape(text), claims)) << text;
    for (const std::string& text : battery(claims))
      EXPECT_EQ(obstacle({}, parse_shape(text)), "") << text;
    const auto with = [&](char letter) {
      const auto shapes = battery(claims, every);
      return std::ranges::count_if(
          shapes, [&](const std::string& text) { return text.find(letter) != std::string::npos; });
    };
    for (const char letter : {'P', 'C', 'L', 'B', 'G'}) EXPECT_GE(with(letter), 3) << letter;
  }
}

TEST(Batteries, let_each_thread_do_what_the_claims_allow) {
  EXPECT_EQ(even_shape({}, 2, 2), "EEDD|EEDD");
  EXPECT_EQ(even_shape(single, 2, 3), "EEE|DDD");
  EXPECT_EQ(even_shape({.consumers = Callers::one}, 3, 1), "E|E|ED");
  EXPECT_EQ(even_shape(single, 3, 1), "") << "the second would have nothing to do";
}

}  // namespace
}  // namespace irt::checker
