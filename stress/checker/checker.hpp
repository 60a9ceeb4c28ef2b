/// The checker: explores what a program can do, and answers with a count or a counterexample.
///
///     checker::Program program{.threads = {...}, .module = &module};
///     checker::Result result = checker::check(program, {});
///     if (result.finding) ...
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stress/checker/execution.hpp"
#include "stress/checker/replay.hpp"

namespace irt::checker {

enum class Search : std::uint8_t {
  exhaustive,  ///< every graph: see dpor.hpp
  bounded,     ///< depth-first, budgets 0, 1, ..., `Options::budget`
  random,
  pct,
  pos,
};

/// How far a search has come.
struct SearchProgress {
  std::uint64_t executions = 0;
  double seconds = 0;     ///< since it began
  double per_second = 0;  ///< executions, of late
  std::size_t steps = 0;  ///< of the last execution
  double explored = 0;    ///< see Result
};

struct Options {
  Search search = Search::exhaustive;
  unsigned budget = 3;  ///< deviations, for `bounded`
  unsigned depth = 3;   ///< of the bugs that `pct` looks for
  std::uint64_t seed = 1;
  std::uint64_t executions = ~std::uint64_t{0};  ///< at most
  double seconds = 1e9;                          ///< at most
  Limits limits{};
  /// This one's part of the work where several share it: `shard` of `shards`, from 0.
  unsigned shard = 0;
  unsigned shards = 1;
  /// Orders to weaken in the code, see MemoryOrders::weaken.
  std::vector<std::pair<OrderSite, Order>> weakened{};
  /// Findings to pass over, see Conclusion::know.
  std::vector<Finding> known{};
  bool watch_orders = false;  ///< fills Result::order_sites
  /// Exchange equal threads in `exhaustive`, see exchange.hpp. Of several shards one may find that
  /// they are not equal, and stops there; then all must be made anew without.
  bool symmetry = true;
  /// Called after each execution that ran to its end.
  std::function<void(const Execution&)> each{};
  /// Asked before each execution, with the number of those before it; true ends the search.
  std::function<bool(std::uint64_t)> stops{};
  /// Called every two seconds.
  std::function<void(const SearchProgress&)> progress{};
};

/// Equal threads that were exchanged for each other, to explore one of all orders of them.
struct Exchanged {
  std::size_t orders = 1;        ///< of the threads; 1: none was exchanged
  std::size_t histories = 0;     ///< of single threads that the exchange was tried on
  std::uint64_t executions = 0;  ///< made for that, beyond those of the search
};

struct Result {
  std::optional<Finding> finding;
  Schedule schedule{};  ///< of the execution that found it
  std::vector<OrderSite> order_sites{};
  std::vector<std::uint64_t> histories{};  ///< see Program
  std::uint64_t executions = 0;            ///< of any outcome
  std::uint64_t complete = 0;              ///< ran to their end
  std::uint64_t blocked = 0;               ///< stopped at a wait that another execution ends
  std::uint64_t cut = 0;                   ///< given up as inconsistent
  std::size_t assumed_waits = 0;  ///< loops taken to wait although a counter of theirs changed
  bool allocates = false;         ///< threads asked for memory
  double seconds = 0;
  bool finished = false;  ///< the search came to its end: nothing is left within its bounds
  /// A limit that was reached, for which the search shows less than everything; else empty.
  std::string incomplete{};
  /// Executions differ where all choices are the same, so that nothing is known of the code:
  /// nothing is proved, and nobody is accused.
  bool differs = false;
  /// The place in the code that it speaks of, or the call in which time ran out; null if none.
  const void* incomplete_at = nullptr;
  std::string time_went{};  ///< into the call that computes here, if it was that: "queue.hpp:12"
  /// Where the code allocates what is lost and never freed: no finding, see Limits.
  std::vector<const void*> never_freed{};
  unsigned threads = 0;  ///< of the execution that had most
  Exchanged exchanged{};
  std::string uneven{};  ///< why equal threads were not exchanged after all; empty if not tried
  /// Estimated part of the work that was done, from 0 to 1; 0 where nobody knows. The tree of
  /// choices is weighed, each subtree like its siblings (Kilby, Slaney, Thiebaux and Walsh 2006,
  /// "Estimating Search Tree Size"): the order is right more often than the digits.
  double explored = 0;
};

Result check(const Program& program, const Options& options);

/// Adds to `sum` what was made and seen in another part of the same search.
void add_counts(Result& sum, const Result& part);

/// Takes back the finding of `result` if it does not come again when it is repeated.
void confirm(const Program& program, const Options& options, Result& result);

/// Repeats the execution that found something; null if it does not come out as before. The caller
/// may look at it until the next one.
std::unique_ptr<Execution> repeat(const Program& program, const Options& options,
                                  const Schedule& schedule);

/// Whether x86 hardware can show what was found.
enum class OnX86 : std::uint8_t {
  shows,
  cannot,   ///< none of all executions that it has: only machines with weaker orders can
  unknown,  ///< not found in the time there was, which is no proof
};

/// Searches again, by x86's rules, for a few seconds.
OnX86 on_x86(const Program& program, const Options& options, const Finding& finding);

/// An execution with the same kind of finding and as few deviations as a short search finds, or the
/// result itself.
Result simplest(const Program& program, const Options& options, const Result& result);

}  // namespace irt::checker
