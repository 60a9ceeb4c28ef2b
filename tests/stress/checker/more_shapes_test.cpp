// Shapes beyond the batteries: generated from a seed, and every client of few calls.

#include <algorithm>
#include <gtest/gtest.h>
#include <set>
#include <stdexcept>

#include "stress/checker/all_clients.hpp"
#include "stress/checker/generated_shapes.hpp"
#include "tests/stress/checker/claims.hpp"

namespace irt::checker {
namespace {

constexpr Claims own{.producers = Callers::own_worker, .consumers = Callers::own_worker};

std::vector<Shape> generated(const Claims& claims, std::uint64_t seed, unsigned count = 300,
                             const Methods& methods = {}) {
  GeneratedShapes shapes(claims, methods, seed);
  std::vector<Shape> result;
  for (unsigned i = 0; i < count; ++i) result.push_back(shapes.next());
  return result;
}

bool any(const std::vector<Shape>& shapes, bool (*is)(const Shape&)) {
  return std::ranges::any_of(shapes, is);
}

bool both_in_one_thread(const Shape& shape) {
  return std::ranges::any_of(shape.threads, [](const std::string& thread) {
    return thread.find('E') != std::string::npos && thread.find('D') != std::string::npos;
  });
}

TEST(GeneratedShapes, are_the_same_for_a_seed_and_never_come_twice) {
  EXPECT_EQ(generated(anything, 7), generated(anything, 7));
  EXPECT_NE(generated(anything, 7), generated(anything, 8));
  std::set<std::string> texts;
  for (const Shape& shape : generated(anything, 7)) {
    EXPECT_TRUE(texts.insert(to_string(shape)).second) << to_string(shape);
    EXPECT_EQ(parse_shape(to_string(shape)), shape);
  }
}

TEST(GeneratedShapes, keep_to_the_claims) {
  for (const Claims& claims :
       {anything, single, own, Claims{.consumers = Callers::one}, Claims{.max_workers = 2},
        Claims{.bounded = true, .producers = Callers::one}})
    for (const Shape& shape : generated(claims, 3)) {
      EXPECT_TRUE(allows(claims, shape)) << to_string(shape);
      EXPECT_EQ(shape.capacity != 0, claims.bounded) << to_string(shape);
      EXPECT_GE(shape.threads.size(), 2U);
      EXPECT_LE(shape.threads.size(), 4U);
    }
}

TEST(GeneratedShapes, grow_and_vary) {
  const std::vector<Shape> shapes = generated(anything, 1);
  EXPECT_LE(calls_of(shapes.front()), 4U);
  EXPECT_GE(calls_of(shapes.back()), 5U);
  EXPECT_TRUE(any(shapes, both_in_one_thread));
  EXPECT_TRUE(any(shapes, [](const Shape& s) { return s.threads.size() == 4; }));
  EXPECT_TRUE(any(shapes, [](const Shape& s) { return s.prologue.size() >= 3; }));
  EXPECT_TRUE(any(shapes, [](const Shape& s) { return s.prologue == "F"; }));
  EXPECT_TRUE(any(shapes, [](const Shape& s) { return s.age > 60'000; }));
  EXPECT_TRUE(any(shapes, leaves_inside));
  for (const std::size_t capacity : {1U, 2U, 3U, 5U})
    EXPECT_TRUE(
        std::ranges::any_of(shapes, [capacity](const Shape& s) { return s.capacity == capacity; }));
  EXPECT_TRUE(
      any(shapes, [](const Shape& s) { return to_string(s).find('W') != s.prologue.npos; }));
}

// Where one only may push and one only may pop, a worker does both when a role is handed over.
TEST(GeneratedShapes, let_a_worker_push_and_pop_where_its_claims_allow) {
  EXPECT_TRUE(any(generated(own, 1), both_in_one_thread));
  EXPECT_TRUE(any(generated({.consumers = Callers::one}, 1), both_in_one_thread));
  EXPECT_TRUE(any(generated(single, 1), both_in_one_thread));
}

TEST(GeneratedShapes, call_the_optional_methods_and_leave_nobody_waiting) {
  constexpr Methods every{.pop_wait = true, .deadline = true, .bulk = true};
  for (const Claims& claims : {anything, single, Claims{}}) {
    const std::vector<Shape> shapes = generated(claims, 1, 600, every);
    for (const Shape& shape : shapes) {
      EXPECT_TRUE(allows(claims, shape)) << to_string(shape);
      EXPECT_FALSE(may_starve(shape, claims)) << to_string(shape);
    }
    for (const char letter : {'P', 'L', 'C', 'B', 'G', 'D', 'E'})
      EXPECT_TRUE(std::ranges::any_of(shapes, [&](const Shape& s) {
        return to_string(s).find(letter) != std::string::npos;
      })) << letter;
  }
  for (const Shape& shape : generated(anything, 1))
    EXPECT_EQ(obstacle({}, shape), "") << to_string(shape);
}

TEST(AllClients, of_two_calls_are_these) {
  const std::vector<std::string> clients = all_clients({}, 2);
  const std::set<std::string> all(clients.begin(), clients.end());
  EXPECT_EQ(clients.size(), all.size());
  EXPECT_EQ(all, (std::set<std::string>{"E",     "D",       "EE",      "ED",     "DE",
                                        "DD",                       // one thread
                                        "E|E",   "E|D",     "D|D",  // two
                                        "ES|WE", "ES|WD",   "DS|WD",
                                        "WE|DS",  // and one hears of the other
                                        "E;X",   "EE;X",    "ED;X",    "DE;X",   "E|E;X",
                                        "E|D;X", "ES|WE;X", "ES|WD;X", "WE|DS;X"}));  // not emptied
}

TEST(AllClients, of_three_calls_have_what_was_pushed_before) {
  const std::vector<std::string> clients = all_clients({}, 3);
  const std::set<std::string> all(clients.begin(), clients.end());
  EXPECT_EQ(clients.size(), all.size());
  for (const char* text : {"E:D|D", "E:E|D", "D:E|D", "E|D|D", "ED|D", "DD|E", "E:DS|WD"})
    EXPECT_TRUE(all.contains(text)) << text;
  EXPECT_FALSE(all.contains("E:D")) << "that is ED";
}

TEST(AllClients, keep_to_the_claims) {
  for (const std::string& text : all_clients(single, 4)) {
    const Shape shape = parse_shape(text);
    EXPECT_TRUE(allows(single, shape)) << text;
    EXPECT_GE(shape.capacity, 1U);
    EXPECT_LE(shape.capacity, 4U);
  }
  const std::vector<std::string> clients = all_clients(single, 4);
  EXPECT_NE(std::ranges::find(clients, "EE|DD@2"), clients.end());
  EXPECT_EQ(std::ranges::find(clients, "E|E@1"), clients.end());
}

}  // namespace
}  // namespace irt::checker
