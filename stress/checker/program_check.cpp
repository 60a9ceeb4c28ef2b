#include "stress/checker/program_check.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <set>
#include <utility>

#include "stress/checker/deadline.hpp"
#include "stress/checker/program_output.hpp"
#include "stress/checker/report.hpp"
#include "stress/checker/verdict.hpp"

namespace irt::checker {

namespace {

/// What is done by default, each until that part of the time is used up. The first two are a look
/// from either side: at what is small, and at what is far from the beginning of a large search.
struct Part {
  Search search;
  double until;
};
constexpr Part parts[] = {{Search::exhaustive, 0.05}, {Search::pos, 0.1},
                          {Search::exhaustive, 0.6},  {Search::bounded, 0.7},
                          {Search::pct, 0.85},        {Search::pos, 1}};
constexpr std::uint64_t next_seed = 1'000'003;  // a search begins where no other one does

void say(const SearchResult& s) {
  const Result& r = s.result;
  std::string outcome = "nothing found";
  if (r.finding)
    outcome = checker::name_of(r.finding->kind);
  else if (r.finished)
    outcome = s.search == name_of(Search::exhaustive) ? "whole" : "nothing within the bound";
  else if (!r.incomplete.empty())
    outcome = "not whole: " + r.incomplete;
  fmt::print("  {:<11} {:>10} executions {:>8.3f} s  {}\n", s.search, r.executions, r.seconds,
             outcome);
  std::fflush(stdout);
}

class ProgramCheck {
 public:
  ProgramCheck(virtual_cores::Module& module, const ProgramSettings& settings, Again again)
      : module_(module),
        settings_(settings),
        again_(std::move(again)),
        search_(module, settings.conduct) {
    options_ = settings.options;
    if (is_test())
      options_.limits.uninitialised = false;
    else
      options_.limits = as_seen(options_.limits, module);
    options_.limits.kept_memory_leaks = settings.unfreed;
    program_.threads.push_back(settings.work ? settings.work : main_of_module());
    program_.own_threads = settings.threads - 1;
    program_.module = &module;
    program_.afresh = [this] {
      output_.afresh();
      if (is_test()) failures_before_ = settings_.failures();
    };
    if (is_test())
      program_.judge = [this](const Execution&) -> std::optional<std::string> {
        if (settings_.failures() == failures_before_) return std::nullopt;
        return "an assertion of the test has failed";
      };
  }

  ProgramResult run() {
    if (is_test())
      all_.unseen.unproved = "its framework is compiled code";
    else
      all_.unseen = unseen_of(module_);
    if (!all_.unseen.refused.empty()) return std::move(all_);
    if (settings_.search) {
      search(*settings_.search, 1);
    } else {
      for (const Part& part : parts) {
        if (done()) break;
        if (part.search != Search::exhaustive || !limited_) search(part.search, part.until);
      }
    }
    all_.whole = is_whole();
    all_.proved = all_.whole && !all_.found && !all_.differs && all_.unseen.unproved.empty();
    Symbols symbols(module_);
    std::set<std::string> lines;
    for (const void* place : never_freed_) lines.insert(symbols.name(place));
    all_.never_freed.assign(lines.begin(), lines.end());
    return std::move(all_);
  }

  std::string replay(const std::string& schedule, const std::string& dot_file) {
    Result result;
    result.schedule = parse_schedule(schedule);
    return picture_of(options_, result, dot_file);
  }

 private:
  /// The module has a test framework in it, of which nothing is seen.
  [[nodiscard]] bool is_test() const { return settings_.failures != nullptr; }

  [[nodiscard]] std::function<void()> main_of_module() const {
    std::vector<std::string> words{settings_.name};
    words.insert(words.end(), settings_.arguments.begin(), settings_.arguments.end());
    auto* const main = reinterpret_cast<void (*)()>(module_.find("irt_main"));
    return [main, words, constructors = module_.constructors()] {
      virtual_cores::run_program(main, words, constructors);
    };
  }

  [[nodiscard]] bool done() const {
    return all_.differs || fruitless_ || (all_.found && !settings_.conduct.keep_going) ||
           is_whole();
  }

  [[nodiscard]] bool is_whole() const {
    return std::ranges::any_of(all_.searches, [](const SearchResult& s) {
      return s.search == name_of(Search::exhaustive) && s.result.finished;
    });
  }

  void search(Search kind, double until) {
    const double seconds = until * settings_.seconds - stopwatch_.seconds();
    if (seconds <= 0) return;
    SearchResult made{.search = std::string(name_of(kind))};
    Options options = options_;
    options.search = kind;
    options.seed += all_.searches.size() * next_seed;
    if (!settings_.conduct.quiet)
      options.progress = [&](const SearchProgress& now) {
        const ProgramOutput::Pause pause(output_);
        checker::say(settings_.name, made.search, now);
      };
    made.report = search_.search(
        program_, options, seconds, made.result,
        [this](const Options& used, const Result& result) { return report_of(used, result); },
        [&](const std::string& report) {
          SearchResult found = made;
          found.report = report;
          add(std::move(found));
        });
    add(std::move(made));
  }

  void add(SearchResult made) {
    const Result& result = made.result;
    limited_ =
        limited_ || (made.search == name_of(Search::exhaustive) && !result.incomplete.empty());
    fruitless_ = result.complete + result.blocked == 0 && !result.incomplete.empty();
    all_.found = all_.found || result.finding;
    all_.differs = all_.differs || result.differs;
    all_.threads = std::max(all_.threads, result.threads);
    never_freed_.insert(result.never_freed.begin(), result.never_freed.end());
    if (result.finding) {
      Symbols symbols(module_);
      made.sentence = sentence(*result.finding, symbols);
      for (const void* place : result.finding->places) made.places.push_back(symbols.at(place));
    }
    if (!settings_.conduct.quiet) {
      const ProgramOutput::Pause pause(output_);
      say(made);
    }
    all_.searches.push_back(std::move(made));
  }

  std::string report_of(const Options& options, const Result& result) {
    return fmt::format("{}\n{}\nreplay: {}\n", picture_of(options, result, ""),
                       words(on_x86(program_, options, *result.finding)),
                       again_(to_string(result.schedule)));
  }

  /// Empty if `result` does not come out as before.
  std::string picture_of(const Options& options, const Result& result,
                         const std::string& dot_file) {
    const auto execution = repeat(program_, options, result.schedule);
    if (execution == nullptr) return "";
    const std::string written = output_.text();
    Symbols symbols(module_);
    if (!dot_file.empty()) std::ofstream(dot_file) << dot(*execution, symbols);
    std::string text = heading(*execution->finding(), symbols) + picture(*execution, {}, symbols);
    if (!written.empty()) text += "\nIts output, in this execution:\n" + written;
    return text;
  }

  virtual_cores::Module& module_;
  const ProgramSettings& settings_;
  const Again again_;
  ProgramOutput output_;
  Program program_;
  Options options_;
  ProgramSearch search_;
  Stopwatch stopwatch_;
  bool limited_ = false;    ///< a whole search would end at a limit again
  bool fruitless_ = false;  ///< all executions of the last one have
  unsigned failures_before_ = 0;
  std::set<const void*> never_freed_;
  ProgramResult all_;
};

}  // namespace

ProgramResult check_program(virtual_cores::Module& module, const ProgramSettings& settings,
                            const Again& again) {
  return ProgramCheck(module, settings, again).run();
}

std::string replay(virtual_cores::Module& module, const ProgramSettings& settings,
                   const std::string& schedule, const std::string& dot_file) {
  return ProgramCheck(module, settings, {}).replay(schedule, dot_file);
}

std::string verdict(const ProgramSettings& settings, const ProgramResult& result) {
  std::uint64_t executions = 0;
  std::size_t findings = 0;
  std::string why = "time";
  for (const SearchResult& s : result.searches) {
    executions += s.result.executions;
    findings += s.result.finding ? 1 : 0;
    if (s.search == name_of(Search::exhaustive) && !s.result.incomplete.empty())
      why = s.result.incomplete;
  }
  std::string text = settings.name + ": ";
  if (result.found)
    text += fmt::format("{} finding{} in {} executions.", findings, findings == 1 ? "" : "s",
                        executions);
  else if (result.proved)
    text += fmt::format("nothing found. Proved: all of its {} executions were looked at.",
                        result.searches.back().result.executions);
  else if (result.differs)
    text +=
        "nothing is known of it: executions differ where all choices are the same, so that it "
        "depends on chance, time or a state that the checker does not give it.";
  else if (result.whole)
    text += fmt::format(
        "nothing found. All of its executions were looked at; nothing is proved, "
        "for {}.",
        result.unseen.unproved);
  else if (std::ranges::any_of(result.searches, [](const SearchResult& s) {
             return s.search == name_of(Search::exhaustive);
           }))
    text +=
        fmt::format("nothing found in {} executions. Not searched whole, for {}.", executions, why);
  else
    text += fmt::format("nothing found in {} executions; samples prove nothing.", executions);
  if (result.threads <= 1 && !result.found)
    text += " It began no threads, so that there was nothing to explore.";
  if (!result.never_freed.empty())
    text += fmt::format(
        " Lost at the end, and taken to be meant so because nothing of the kind is "
        "ever freed: what is allocated at {} (--unfreed makes that a finding).",
        fmt::join(result.never_freed, ", "));
  return text;
}

}  // namespace irt::checker
