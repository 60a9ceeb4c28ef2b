/// Searches of programs of one module. With `keep_going` they know what was found before, and a
/// search goes on past it.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "stress/checker/checker.hpp"

namespace irt::checker {

/// "exhaustive", "bounded", ...
std::string_view name_of(Search search);

/// The one of that name. Throws UsageError if there is none.
Search search_named(std::string_view name);

/// How searches are made, whatever they look for.
struct Conduct {
  unsigned jobs = 1;        ///< processes that share a search
  bool keep_going = false;  ///< collect distinct findings instead of stopping at the first
  bool quiet = false;       ///< say nothing while running
  bool reports = true;      ///< of findings; without, the first one ends the check at once
};

class ProgramSearch {
 public:
  ProgramSearch(virtual_cores::Module& module, const Conduct& conduct)
      : module_(module), conduct_(conduct) {}

  /// Describes a finding for the reader.
  using Describe = std::function<std::string(const Options&, const Result&)>;

  /// Searches `program` for at most `seconds`, adds that to `result` and returns the report of its
  /// finding, empty if there is none. Before each finding that it goes past, `found` has the
  /// report.
  std::string search(const Program& program, Options options, double seconds, Result& result,
                     const Describe& describe,
                     const std::function<void(const std::string& report)>& found);

  /// Whether no finding of this kind and place was there before; it is known from now on.
  bool is_new(const Finding& finding);
  /// Says in words where the limit was that `result` has reached.
  void place(Result& result) const;

 private:
  virtual_cores::Module& module_;
  const Conduct conduct_;
  std::vector<Finding> known_;
  std::set<std::string> reported_;  ///< kinds and lines
};

}  // namespace irt::checker
