#include "stress/checker/program_search.hpp"

#include <algorithm>
#include <utility>

#include "stress/checker/deadline.hpp"
#include "stress/checker/parts.hpp"
#include "stress/checker/report.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::checker {

std::string_view name_of(Search search) {
  switch (search) {
    case Search::exhaustive:
      return "exhaustive";
    case Search::bounded:
      return "bounded";
    case Search::random:
      return "random";
    case Search::pct:
      return "pct";
    case Search::pos:
      return "pos";
  }
  return "?";
}

Search search_named(std::string_view name) {
  for (const Search search :
       {Search::exhaustive, Search::bounded, Search::random, Search::pct, Search::pos})
    if (name == name_of(search)) return search;
  throw UsageError("strategy " + std::string(name) +
                   ": there are auto, exhaustive, bounded, random, pct and pos");
}

void ProgramSearch::place(Result& result) const {
  if (result.incomplete_at == nullptr) return;
  const std::string where = Symbols(module_).name(result.incomplete_at);
  if (result.incomplete.empty())
    result.time_went = where;
  else
    result.incomplete += " at " + where;
  result.incomplete_at = nullptr;
}

bool ProgramSearch::is_new(const Finding& finding) {
  known_.push_back(finding);
  if (!conduct_.reports) return true;
  // One line of source may have been compiled into several places.
  Symbols symbols(module_);
  std::string key = sentence(finding, symbols);
  std::erase_if(key, [&](char c) { return finding.places.empty() && c >= '0' && c <= '9'; });
  return reported_.insert(std::string(checker::name_of(finding.kind)) + key).second;
}

std::string ProgramSearch::search(const Program& program, Options options, double seconds,
                                  Result& result, const Describe& describe,
                                  const std::function<void(const std::string& report)>& found) {
  const Stopwatch stopwatch;
  for (;;) {
    const double spent = stopwatch.seconds();
    options.seconds = std::max(seconds - spent, 0.01);
    if (conduct_.keep_going) options.known = known_;
    const Result before = std::exchange(result, check_in_parts(program, options, conduct_.jobs));
    place(result);
    add_counts(result, before);
    result.seconds += before.seconds;
    if (result.incomplete.empty()) result.incomplete = before.incomplete;
    if (!result.finding) return "";
    const bool is_news = is_new(*result.finding);
    std::string report;
    if (is_news && conduct_.reports) report = describe(options, simplest(program, options, result));
    if (!conduct_.keep_going) return report;
    if (is_news) found(report);
    result.finding.reset();
    if (result.incomplete.empty())
      result.incomplete = "some executions end in what is reported already";
    if (spent > seconds) return "";
  }
}

}  // namespace irt::checker
