#include "stress/checker/verdict.hpp"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <map>
#include <vector>

#include "stress/checker/shape_search.hpp"

namespace irt::checker {

namespace {

/// "about 3e+04 in all": what an estimate is worth.
std::string estimate(std::uint64_t executions, double explored) {
  if (explored <= 0) return "";
  return fmt::format("  about {:.0g} in all", static_cast<double>(executions) / explored);
}

/// What was saved by threads that do the same.
std::string exchanges(const Result& r) {
  if (r.exchanged.orders == 1 || !r.finished) return "";
  return fmt::format(" (1 of {} orders of equal threads; exchange verified on {} histories)",
                     r.exchanged.orders, r.exchanged.histories);
}

/// What was tried in one way: how many shapes, how many of them to the end.
struct Sum {
  std::size_t shapes = 0;
  std::size_t whole = 0;
  std::size_t calls = 0;  ///< of the largest
};

/// "22 of 22 shapes of the battery".
std::string words(const Sum& sum, std::string_view what) {
  return fmt::format("{} of {} {}", sum.whole, sum.shapes, what);
}

/// " Not searched whole, for time: E|D, ED|D and 3 more." for each reason.
std::string sentences(std::string_view what,
                      std::map<std::string, std::vector<std::string>>& by_reason) {
  std::string text;
  for (auto& [why, shapes] : by_reason) {
    constexpr std::size_t enough = 8;
    const std::size_t more = shapes.size() - std::min(shapes.size(), enough);
    shapes.resize(shapes.size() - more);
    text += fmt::format(" {}, for {}: {}{}.", what, why, fmt::join(shapes, ", "),
                        more == 0 ? "" : fmt::format(" and {} more", more));
  }
  return text;
}

std::string why_not(const ShapeResult& shape) {
  const Result& r = shape.result;
  if (!r.incomplete.empty()) return r.incomplete;
  return r.time_went.empty() ? "time" : "time, in one call without an event at " + r.time_went;
}

}  // namespace

std::string_view name_of(Origin origin) {
  switch (origin) {
    case Origin::battery:
      return "battery";
    case Origin::elements:
      return "elements";
    case Origin::aged:
      return "aged";
    case Origin::generated:
      return "generated";
    case Origin::clients:
      return "all clients";
  }
  return "?";
}

bool searched_whole(const ShapeResult& s) {
  return s.search == name_of(Search::exhaustive) || s.search == timed_search ||
         s.search == poor_search;
}

void say(std::string_view shape, std::string_view search, const SearchProgress& now) {
  fmt::print(stderr, "  {:<12} {:<11} {:>9} executions {:>8.1f} s  {:.0f}/s, {} steps{}\n", shape,
             search, now.executions, now.seconds, now.per_second, now.steps,
             estimate(now.executions, now.explored));
}

namespace {

/// The line of one shape and search.
void say(const ShapeResult& s) {
  const Result& r = s.result;
  std::string verdict = "nothing found" + estimate(r.executions, r.explored);
  if (!r.time_went.empty()) verdict += ", for " + why_not(s);
  if (r.finding)
    verdict = std::string(checker::name_of(r.finding->kind));
  else if (s.search == stalls_search)
    verdict = r.finished ? "nothing found" : "nothing found, and not finished: " + why_not(s);
  else if (r.finished && searched_whole(s))
    verdict = s.proved ? "proved" : "explored whole, not proved: " + s.unproved;
  else if (r.finished)
    verdict = "nothing within the bound";
  else if (!r.incomplete.empty())
    verdict = "not proved: " + r.incomplete;
  fmt::print("  {:<12} {:<11} {:>9} executions {:>8.3f} s  {:>5} histories  {}{}\n", s.shape,
             s.search, r.executions, r.seconds, s.histories, verdict, exchanges(r));
  std::fflush(stdout);
}

void withhold(ShapeResult& shape) {
  shape.proved = false;
  if (!shape.result.finding) return;
  shape.result.incomplete =
      fmt::format("executions differ, by which the {} that was seen may have come about",
                  checker::name_of(shape.result.finding->kind));
  shape.result.finding.reset();
  shape.report.clear();
}

// Where executions differ, what one of them finds may come from what the others left behind.
void withhold_findings(QueueResult& all) {
  all.differs = true;
  if (all.unseen.unproved.empty())
    all.unseen.unproved = "executions differ where all choices are the same";
  for (ShapeResult& shape : all.shapes) withhold(shape);
  all.found = false;
}

}  // namespace

void add(QueueResult& all, ShapeResult shape, bool quiet) {
  if (shape.result.differs && !all.differs) withhold_findings(all);
  if (all.differs) withhold(shape);
  shape.unproved = all.unseen.unproved;
  shape.proved = shape.result.finished && !shape.result.finding && searched_whole(shape) &&
                 shape.unproved.empty();
  // Of those that are many only what is found has a line.
  const bool listed = shape.origin == Origin::battery || shape.result.finding;
  if (!quiet && listed) say(shape);
  all.found = all.found || shape.result.finding;
  all.shapes.push_back(std::move(shape));
}

void say(Origin origin, const QueueResult& all) {
  std::size_t shapes = 0;
  std::size_t whole = 0;
  std::uint64_t executions = 0;
  double seconds = 0;
  std::map<std::string, std::size_t> incomplete;
  for (const ShapeResult& s : all.shapes) {
    if (s.origin != origin) continue;
    executions += s.result.executions;
    seconds += s.result.seconds;
    if (!searched_whole(s)) continue;
    ++shapes;
    whole += s.result.finished && !s.result.finding ? 1 : 0;
    if (!s.result.incomplete.empty()) ++incomplete[s.result.incomplete];
  }
  if (shapes == 0) return;
  fmt::print("  {:<24} {:>9} executions {:>8.3f} s  {} shapes, {} of them whole{}\n",
             name_of(origin), executions, seconds, shapes, whole,
             all.unseen.unproved.empty() ? " and proved" : "");
  for (const auto& [why, count] : incomplete) fmt::print("    {} not: {}\n", count, why);
  std::fflush(stdout);
}

std::string verdict(std::string_view queue, const QueueResult& all) {
  std::map<std::string, Sum> sums;
  std::map<std::string, std::vector<std::string>> open;  // by why
  std::map<std::string, std::vector<std::string>> unstopped;
  std::size_t findings = 0;
  for (const ShapeResult& s : all.shapes) {
    findings += s.result.finding ? 1 : 0;
    if (s.search == stalls_search && !s.result.finished && !s.result.finding)
      unstopped[why_not(s)].push_back(s.shape);
    if (!searched_whole(s)) continue;
    std::string key = s.search;
    if (key == name_of(Search::exhaustive)) key = std::string(name_of(s.origin));
    Sum& sum = sums[key];
    ++sum.shapes;
    const bool whole = s.result.finished && !s.result.finding;
    sum.whole += whole ? 1 : 0;
    sum.calls = std::max(sum.calls, calls_of(parse_shape(s.shape)));
    if (!whole && !s.result.finding && s.origin != Origin::generated && s.origin != Origin::aged &&
        s.origin != Origin::elements)
      open[why_not(s)].push_back(
          s.shape + (s.search == name_of(Search::exhaustive) ? "" : " (" + s.search + ")"));
  }
  std::vector<std::string> parts;
  const auto add = [&](std::string_view key, const std::string& what) {
    if (const auto sum = sums.find(std::string(key)); sum != sums.end())
      parts.push_back(words(sum->second, what));
  };
  add(name_of(Origin::battery), "shapes");
  add(name_of(Origin::clients), fmt::format("clients of at most {} calls", all.all_clients));
  add(timed_search, "by the clock");
  add(poor_search, "with one allocation that fails");
  add(name_of(Origin::elements), "with elements that are no words");
  add(name_of(Origin::aged), "of an aged queue");
  const auto generated = sums.find(std::string(name_of(Origin::generated)));
  if (generated != sums.end())
    parts.push_back(words(generated->second, fmt::format("generated shapes of up to {} calls",
                                                         generated->second.calls)));
  std::string text =
      fmt::format("{}: {}. ", queue,
                  findings == 0 ? "nothing found"
                                : fmt::format("{} finding{}", findings, findings == 1 ? "" : "s"));
  if (all.unseen.unproved.empty())
    text += fmt::format("Proved: {}.", fmt::join(parts, ", "));
  else
    text += fmt::format("Nothing is proved, for {}. Searched whole: {}.", all.unseen.unproved,
                        fmt::join(parts, ", "));
  text += sentences("Not searched whole", open);
  text += sentences("Threads were not stopped before each of their steps", unstopped);
  if (all.not_tried != 0)
    text += fmt::format(" {} more clients were not tried, for time.", all.not_tried);
  return text;
}

}  // namespace irt::checker
