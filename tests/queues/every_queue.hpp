/// Tests that run once for each queue there is: built in, and in the plug-ins that the environment
/// variable IRT_TEST_PLUGINS lists, separated by ':'.
#pragma once

#include <cstdlib>
#include <gtest/gtest.h>
#include <sstream>
#include <string>

#include "queues/registry.hpp"

namespace irt {

/// All queues under test.
inline const QueueRegistry& queues_under_test() {
  static const QueueRegistry registry = [] {
    QueueRegistry all;
    const char* plugins = std::getenv("IRT_TEST_PLUGINS");
    std::stringstream list(plugins == nullptr ? "" : plugins);
    for (std::string file; std::getline(list, file, ':');) all.open(file);
    return all;
  }();
  return registry;
}

/// How a failure names the queue.
inline void PrintTo(const QueueEntry& queue,  // NOLINT(readability-identifier-naming): GoogleTest's
                    std::ostream* out) {
  *out << queue.name;
}

class EveryQueue : public testing::TestWithParam<QueueEntry> {};

/// The queue's name as GoogleTest takes it.
inline std::string test_name(const testing::TestParamInfo<QueueEntry>& info) {
  std::string name(info.param.name);
  for (char& letter : name)
    if (letter == '-') letter = '_';
  return name;
}

}  // namespace irt

/// Instantiates the suite `Suite` for every queue.
#define IRT_FOR_EVERY_QUEUE(Suite)                                                            \
  INSTANTIATE_TEST_SUITE_P(All, Suite, testing::ValuesIn(irt::queues_under_test().entries()), \
                           irt::test_name)
