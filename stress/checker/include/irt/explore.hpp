/// A test's body in every execution that C++ allows, in any test framework:
///
///     #include <gtest/gtest.h>
///     #include <irt/explore.hpp>
///
///     TEST(Lock, Excludes) {
///       irt::explore([] {
///         MyLock lock;
///         int inside = 0;
///         std::thread other([&] { lock.lock(); ++inside; lock.unlock(); });
///         lock.lock(); ++inside; lock.unlock();
///         other.join();
///         EXPECT_EQ(inside, 2);
///       });
///     }
///
/// built by irt_add_check() of CMake's package `irt`, which runs it, too. The body runs many times,
/// so that what it works on is made within it; docs/check-a-program.md says more.
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>

// The framework that was included before. What follows has another name in each, for the sources of
// a program may differ in that.
#if defined(GTEST_TEST)
#define IRT_EXPLORE_IN in_googletest
#elif defined(TWOBLUECUBES_SINGLE_INCLUDE_CATCH_HPP_INCLUDED) || \
    defined(CATCH_AMALGAMATED_HPP_INCLUDED) || defined(CATCH_TEST_MACROS_HPP_INCLUDED)
#define IRT_EXPLORE_IN in_catch
#define IRT_EXPLORE_IN_CATCH
#if defined(CATCH_TEST_MACROS_HPP_INCLUDED) && !defined(CATCH_AMALGAMATED_HPP_INCLUDED)
#include <catch2/catch_assertion_result.hpp>
#include <catch2/interfaces/catch_interfaces_config.hpp>
#include <catch2/internal/catch_context.hpp>
#endif
#elif defined(BOOST_TEST_CASE)
#define IRT_EXPLORE_IN in_boost_test
#include <boost/test/framework.hpp>
#include <boost/test/results_collector.hpp>
#elif defined(DOCTEST_VERSION)
#define IRT_EXPLORE_IN in_doctest
#else
#define IRT_EXPLORE_IN in_no_framework
#endif

// NOLINTBEGIN(readability-identifier-naming): names of C
extern "C" {
struct irt_exploration {
  unsigned threads;
  double seconds;
  const char* strategy;
  std::uint64_t seed;
  unsigned (*failures)();  ///< of assertions in this test so far; null where none are known
};
struct irt_explored {
  std::uint64_t executions;
  bool whole;
  const char* wrong;  ///< a report, valid until the next call; null if nothing was found
};
/// Of the program that runs tests built by irt_add_check().
void irt_explore(void (*body)(void*), void* argument, const irt_exploration* how,
                 irt_explored* explored);
}
// NOLINTEND(readability-identifier-naming)

namespace irt {
inline namespace IRT_EXPLORE_IN {

struct Exploration {
  unsigned threads = 8;           ///< at most, that of the body included; up to 15
  double seconds = 10;            ///< at most
  const char* strategy = "auto";  ///< or exhaustive, bounded, random, pct, pos
  std::uint64_t seed = 1;         ///< of the random ones
};

struct Explored {
  std::uint64_t executions;
  bool whole;  ///< all there are
};

namespace detail {

// Failed assertions that a framework notes without an exception, of the test in progress.
#if defined(GTEST_TEST)
inline void begin(const char*, unsigned) {}
inline unsigned failures() {
  const testing::TestInfo* const test = testing::UnitTest::GetInstance()->current_test_info();
  unsigned count = 0;
  for (int i = 0; test != nullptr && i < test->result()->total_part_count(); ++i)
    count += test->result()->GetTestPartResult(i).failed() ? 1 : 0;
  return count;
}
#elif defined(IRT_EXPLORE_IN_CATCH)
// It tells no number to tests. Its last result is that of the last assertion that has failed,
// unless it is asked to report those that pass, too.
inline void begin(const char* file, unsigned line) {
  if (Catch::getCurrentContext().getConfig()->includeSuccessfulResults())
    throw std::runtime_error(
        "irt::explore: nothing is explored with --success (-s), for it hides a CHECK that fails "
        "behind the next one that passes; leave it away");
  const Catch::AssertionInfo info{
      "irt::explore", {file, line}, "", Catch::ResultDisposition::Normal};
  Catch::AssertionReaction reaction;
  Catch::getResultCapture().handleMessage(info, Catch::ResultWas::Info, {}, reaction);
}
inline unsigned failures() {
  return Catch::getResultCapture().getLastResult()->isOk() ? 0 : 1;
}
#elif defined(BOOST_TEST_CASE)
inline void begin(const char*, unsigned) {}
inline unsigned failures() {
  namespace boost_test = boost::unit_test;
  return static_cast<unsigned>(
      boost_test::results_collector.results(boost_test::framework::current_test_case_id())
          .p_assertions_failed.get());
}
#elif defined(DOCTEST_VERSION)
inline unsigned failed_assertions = 0;
struct FailedAssertions : doctest::IReporter {
  explicit FailedAssertions(const doctest::ContextOptions&) {}
  void report_query(const doctest::QueryData&) override {}
  void test_run_start() override {}
  void test_run_end(const doctest::TestRunStats&) override {}
  void test_case_start(const doctest::TestCaseData&) override {}
  void test_case_reenter(const doctest::TestCaseData&) override {}
  void test_case_end(const doctest::CurrentTestCaseStats&) override {}
  void test_case_exception(const doctest::TestCaseException&) override {}
  void subcase_start(const doctest::SubcaseSignature&) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData& assertion) override {
    if (assertion.m_failed) ++failed_assertions;
  }
  void log_message(const doctest::MessageData&) override {}
  void test_case_skipped(const doctest::TestCaseData&) override {}
};
inline const int listens = doctest::registerReporter<FailedAssertions>("irt", 1, false);
inline void begin(const char*, unsigned) {}
inline unsigned failures() {
  return listens >= 0 ? failed_assertions : 0;
}
#else
inline void begin(const char*, unsigned) {}
inline constexpr unsigned (*failures)() = nullptr;
#endif

[[noreturn]] inline void fail(const std::string& report) {
#ifdef IRT_EXPLORE_IN_CATCH
  // Which fills paragraphs, and would break the columns of a counterexample.
  std::fprintf(stderr, "%s\n", report.c_str());
  throw std::runtime_error(report.substr(0, report.find('\n')));
#else
  throw std::runtime_error(report);
#endif
}

}  // namespace detail

/// Runs `body` and the threads that it begins in every execution, or in as many as there is time
/// for. Throws std::runtime_error, with the counterexample, where one is wrong: a failed assertion,
/// an exception, a data race, a deadlock, memory that is used after it was freed, ...; also where
/// there was nothing to explore, for `body` began no threads. `file` and `line` are the caller's.
inline Explored explore(const std::function<void()>& body, const Exploration& how = {},
                        const char* file = __builtin_FILE(), unsigned line = __builtin_LINE()) {
  detail::begin(file, line);
  const irt_exploration asked{how.threads, how.seconds, how.strategy, how.seed, detail::failures};
  irt_explored explored{};
  irt_explore([](void* function) { (*static_cast<const std::function<void()>*>(function))(); },
              const_cast<std::function<void()>*>(&body), &asked, &explored);
  if (explored.wrong != nullptr) detail::fail(explored.wrong);
  return {explored.executions, explored.whole};
}

}  // namespace IRT_EXPLORE_IN
}  // namespace irt

#undef IRT_EXPLORE_IN
#undef IRT_EXPLORE_IN_CATCH
