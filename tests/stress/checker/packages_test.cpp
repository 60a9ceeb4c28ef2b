// Libraries' queues as they come out of their packages; those that are not installed are skipped.

#include <filesystem>
#include <gtest/gtest.h>
#include <string>

#include "stress/checker/queue_client.hpp"
#include "stress/virtual_cores/queue_modules.hpp"

namespace irt::checker {
namespace {

/// The finding on one shape; no kind if there is none.
std::string finding(const std::string& name, const std::string& shape) {
  virtual_cores::Module module(virtual_cores::QueueModules().at(name));
  const QueueEntry& entry = virtual_cores::queue_of(module);
  QueueClient client(entry, parse_shape(shape), 0, &module);
  const Result result = check(client.program(), {.seconds = 20});
  EXPECT_TRUE(result.finished || result.finding) << name << " on " << shape;
  return result.finding ? std::string(name_of(result.finding->kind)) : "";
}

bool installed(const std::string& name) {
  return virtual_cores::QueueModules().find(name).has_value();
}

TEST(Packages, libcds_moves_its_head_with_too_weak_an_order) {
  if (!installed("libcds-queue")) GTEST_SKIP() << "libcds-dev is not installed";
  // https://github.com/khizmax/libcds/issues/186: the second of two pops in a row reads a node that
  // nothing makes visible to it.
  EXPECT_EQ(finding("libcds-queue", "E|D|D"), "data race");
  EXPECT_EQ(finding("libcds-queue", "ED|ED"), "wrong outcome");
}

// A node that was given back holds the free list's link, written as plain memory, where others
// still read its atomic one: a race by the letter of C++, which the count beside the head makes
// harmless. What races then leave of an atomic object is no plan to follow, and no reason to crash.
TEST(Packages, boost_writes_a_free_list_over_what_others_read) {
  for (const std::string name : {"boost-lockfree", "boost-lockfree-fixed"}) {
    if (!installed(name)) GTEST_SKIP() << "libboost-dev is not installed";
    EXPECT_EQ(finding(name, "E:D|D"), "data race") << name;
    virtual_cores::Module module(virtual_cores::QueueModules().at(name));
    const QueueEntry& entry = virtual_cores::queue_of(module);
    QueueClient client(entry, parse_shape("EE:D|DD"), 0, &module);
    Options options{.seconds = 20};
    options.limits.races = false;
    const Result result = check(client.program(), options);
    EXPECT_TRUE(result.finished || result.finding || !result.incomplete.empty()) << name;
  }
}

TEST(Packages, others_keep_their_promises) {
  for (const char* name : {"moodycamel-tokens", "small-atomic-queue"}) {
    if (!installed(name)) continue;
    for (const char* shape : {"E|E|D", "E|D|D", "EE:DE|D"})
      EXPECT_EQ(finding(name, shape), "") << name << " on " << shape;
  }
}

}  // namespace
}  // namespace irt::checker
