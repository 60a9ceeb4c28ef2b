/// What a suite found out, as it travels from child to parent and into reports.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace irt::stress {

/// A claim that broke.
struct BrokenClaim {
  std::string claim;     ///< what was promised
  std::string evidence;  ///< the operations, the stacks or the sanitizer's report
  std::string repeat;    ///< the command that repeats it
  double seconds = 0;    ///< from the start of the slot to the finding
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(BrokenClaim, claim, evidence, repeat, seconds)

/// The result of one suite (and scenario) on one queue.
struct Result {
  std::string queue;
  std::string suite;
  std::string scenario;  ///< empty for suites without
  std::uint64_t seed = 0;
  std::uint64_t operations = 0;
  double seconds = 0;
  std::vector<BrokenClaim> findings;
  std::vector<std::string> notes;   ///< verdicts and figures, one sentence each
  std::vector<std::string> limits;  ///< what this run could not judge, and why
  bool third_party = false;         ///< a comparator: its findings are its library's
  nlohmann::json figures = nlohmann::json::object();  ///< the notes' numbers, for machines
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(Result, queue, suite, scenario, seed, operations,
                                                seconds, findings, notes, limits, third_party,
                                                figures)

/// For people.
std::string to_text(const Result& result);

/// JUnit XML: a test suite per queue, a test case per result.
std::string to_junit(const std::vector<Result>& results);

}  // namespace irt::stress
