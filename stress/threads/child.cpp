#include "stress/threads/child.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <string_view>
#include <unistd.h>

#include "stress/running/child_process.hpp"
#include "stress/threads/sanitizer.hpp"
#include "stress/threads/signals.hpp"

namespace irt::stress {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Trace trace_of(const json& addresses) {
  Trace trace{};
  std::size_t at = 0;
  for (const json& address : addresses) {
    const auto value = address.get<std::uint64_t>();
    if (value != 0 && at < trace.size()) {
      // An address of the child, who is our copy: it names the same function here.
      trace[at++] = reinterpret_cast<void*>(value);  // NOLINT(performance-no-int-to-ptr)
    }
  }
  return trace;
}

std::string stack_text(const json& addresses) {
  std::string text;
  for (const std::string& line : describe(trace_of(addresses))) {
    text += fmt::format("    {}\n", line);
  }
  return text.empty() ? "    (no answer)\n" : text;
}

/// A sanitizer's report without the frames that are ours or the language's: what called the queue,
/// and what started the thread, is the same in every report.
std::string without_testbed(const std::string& report) {
  static constexpr std::array<std::string_view, 6> ours{
      "/stress/threads/", "/stress/scenarios/", "/bits/std_function.h",
      "/bits/invoke.h",   "/bits/std_thread.h", "libstdc++.so"};
  std::string text;
  for (std::size_t at = 0; at < report.size();) {
    const std::size_t end = std::min(report.find('\n', at), report.size() - 1) + 1;
    const std::string_view line(report.data() + at, end - at);
    const bool frame = line.find_first_not_of(' ') == line.find('#');
    if (!frame || std::ranges::none_of(ours, [&](std::string_view word) {
          return line.find(word) != std::string_view::npos;
        })) {
      text += line;
    }
    at = end;
  }
  return text;
}

/// Everything the parent keeps about a running child.
struct Listener {
  Result& result;
  Clock::time_point start = Clock::now();
  const std::function<void(std::uint64_t)>& on_progress;
  std::string trying = {};  ///< `Messenger::trying`

  void add(BrokenClaim finding) {
    if (finding.seconds == 0) finding.seconds = since(start);
    result.findings.push_back(std::move(finding));
  }

  /// A finding that the child cannot put into words itself.
  void add_end(const std::string& claim, std::string evidence) {
    if (!evidence.empty() && !evidence.ends_with('\n')) evidence += '\n';
    add({.claim = claim, .evidence = evidence + trying, .repeat = {}});
  }

  void take(const json& message) {
    if (message.contains("operations")) {
      result.operations = message["operations"];
      on_progress(result.operations);
    } else if (message.contains("finding")) {
      add(message["finding"].get<BrokenClaim>());
    } else if (message.contains("note")) {
      result.notes.push_back(message["note"]);
    } else if (message.contains("limit")) {
      result.limits.push_back(message["limit"]);
    } else if (message.contains("figure")) {
      result.figures[message["figure"].get<std::string>()] = message["value"];
    } else if (message.contains("crash")) {
      const int signal = message["crash"];
      add_end(fmt::format("does not crash ({})", strsignal(signal)),
              "the thread that crashed stood in\n" + stack_text(message["trace"]));
    } else if (message.contains("hang")) {
      std::string text;
      for (const auto& [thread, addresses] : message["stacks"].items()) {
        text += fmt::format("  {}\n{}", thread, stack_text(addresses));
      }
      add_end(message["hang"], text);
    } else if (message.contains("trying")) {
      trying = message["trying"].get<std::string>() + "\n";
    }
  }
};

/// What the way in which a child ended tells.
void judge_end(Listener& listener, const Ending& ending) {
  Result& result = listener.result;
  const std::string& errors = ending.errors;
  if (ending.signal != 0) {
    listener.add_end(fmt::format("does not crash ({})", strsignal(ending.signal)), errors);
    return;
  }
  if (ending.code == 0 || !result.findings.empty()) return;
  if (sanitizer == Sanitizer::thread && errors.find("ThreadSanitizer") != std::string::npos) {
    if (fences_executed() > 0 && !result.figures.contains("strengthened") &&
        errors.find("data race") != std::string::npos) {
      result.figures["unjudged_report"] = errors;
      return;
    }
    listener.add({.claim = "free of data races (ThreadSanitizer)",
                  .evidence = without_testbed(errors),
                  .repeat = {}});
  } else if (errors.find("Sanitizer") != std::string::npos) {
    listener.add({.claim = "free of memory errors (AddressSanitizer)",
                  .evidence = without_testbed(errors),
                  .repeat = {}});
  } else {
    listener.add_end(fmt::format("does not end the process (exit code {})", ending.code), errors);
  }
}

}  // namespace

void Messenger::send(const json& message) const {
  say(descriptor_, message.dump(-1, ' ', false, json::error_handler_t::replace) + '\n');
}
void Messenger::progress(std::uint64_t operations) {
  send({{"operations", operations}});
}
void Messenger::finding(const BrokenClaim& finding) {
  send({{"finding", finding}});
}
void Messenger::note(const std::string& sentence) {
  send({{"note", sentence}});
}
void Messenger::limit(const std::string& sentence) {
  send({{"limit", sentence}});
}
void Messenger::figure(const std::string& name, const json& value) {
  send({{"figure", name}, {"value", value}});
}
void Messenger::trying(const std::string& what) {
  send({{"trying", what}});
}
void Messenger::hang(const std::string& what, const json& stacks) {
  send({{"hang", what}, {"stacks", stacks}});
  _exit(3);
}

namespace {

void run_once(Result& result, double seconds, double patience,
              const std::function<void(Messenger&)>& suite,
              const std::function<void(std::uint64_t)>& on_progress) {
  forget_fences();
  ChildProcess child([&](int line) {
    report_crashes_to(line);
    Messenger messenger(line);
    suite(messenger);
    std::exit(0);  // not _exit: LeakSanitizer reports at exit
  });
  Listener listener{.result = result, .on_progress = on_progress};
  static constexpr std::atomic<bool> never{false};
  const auto next = [&] {
    return child.line(std::max(patience, seconds - since(listener.start)), never);
  };
  for (auto message = next(); message; message = next()) listener.take(json::parse(*message));
  const Ending ending = child.end(patience, never);
  result.seconds = since(listener.start);
  if (ending.status == "hung") {
    listener.add_end("does not hang",
                     fmt::format("silent for {} s; not even the watchdog answered", patience));
  } else {
    judge_end(listener, ending);
  }
}

}  // namespace

void run_in_child(Result& result, double seconds, double patience,
                  const std::function<void(Messenger&)>& suite,
                  const std::function<void(std::uint64_t)>& on_progress) {
  run_once(result, seconds, patience, suite, on_progress);
  if (!result.figures.contains("unjudged_report")) return;
  const std::uint64_t fences = fences_executed();
  result.figures["strengthened"] = true;
  const auto strong = [&](Messenger& messenger) {
    strengthen_atomics();
    suite(messenger);
  };
  run_once(result, seconds, patience, strong, on_progress);
  if (!result.findings.empty()) return;
  result.limits.push_back(fmt::format(
      "ThreadSanitizer reports a race, but this queue executes fences (std::atomic_thread_fence; "
      "{} before the report), which ThreadSanitizer does not understand; with every atomic taken "
      "as acquire and release it reports none: no verdict",
      fences));
}

}  // namespace irt::stress
