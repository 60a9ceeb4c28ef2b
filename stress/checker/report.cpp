#include "stress/checker/report.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>
#include <utility>

namespace irt::checker {

namespace {

std::string quoted(std::string text) {
  for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2)
    text.insert(at, "\\");
  return text;
}

// Where a value comes from: ", stored at queue.hpp:70 by thread 0"; "" of what no code has stored.
std::string origin(const Execution& execution, const Event& read, Symbols& symbols) {
  const Graph& graph = execution.graph();
  if (is_made_up(graph.location(read.location).address)) return "";
  const Event& store = graph.event(read.from);
  if (store.kind == EventKind::initial) return ", as before the threads";
  return fmt::format(", stored at {} by thread {}", symbols.name(store.pc), store.thread);
}

// What the last round of its loop has read, or its last look at a lock or futex.
std::vector<EventId> last_round(const Execution& execution, unsigned thread, const void* pc) {
  const Graph& graph = execution.graph();
  const std::vector<EventId>& events = graph.thread(thread).events;
  std::vector<EventId> reads;
  std::set<const void*> seen;
  for (std::size_t i = events.size(); i-- > 0;) {
    const Event& event = graph.event(events[i]);
    if (!event.reads || event.pc == nullptr) continue;
    if (!seen.insert(event.pc).second) break;
    reads.insert(reads.begin(), events[i]);
    if (event.pc == pc) break;
  }
  return reads;
}

}  // namespace

std::string described(const Execution& execution, const Event& event, Symbols& symbols,
                      Values& values, std::size_t width) {
  if (event.reads || event.writes) {
    const std::uintptr_t address = execution.graph().location(event.location).address;
    if (std::string what = Process::what_is(address, event.writes); !what.empty()) return what;
    if (std::string what = Kernel::what_is(address, event); !what.empty()) return what;
  }
  return describe(event, symbols, values, width);
}

std::string words(OnX86 answer) {
  switch (answer) {
    case OnX86::shows:
      return "x86 hardware can show it, too.\n";
    case OnX86::cannot:
      return "Only machines with weaker orders than x86 can show it, as ARM and POWER are, or a "
             "compiler\n"
             "that makes use of the orders: none of all executions on x86 does.\n";
    case OnX86::unknown:
      break;
  }
  return "Whether x86 hardware can show it is not known: by x86's rules it was not found in the "
         "time\n"
         "there was.\n";
}

std::string with_places(std::string text, const std::vector<const void*>& places,
                        const std::function<std::string(const void*)>& name) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::string mark = "{" + std::to_string(i) + "}";
    for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark))
      text.replace(at, mark.size(), name(places[i]));
  }
  return text;
}

std::string sentence(const Finding& finding, Symbols& symbols) {
  return with_places(finding.text, finding.places,
                     [&](const void* pc) { return symbols.name(pc); });
}

std::string heading(const Finding& finding, Symbols& symbols) {
  return std::string(name_of(finding.kind)) + ": " + sentence(finding, symbols) + "\n\n";
}

std::string contradiction(const QueueCall& answer, const std::vector<QueueCall>& operations) {
  using Kind = QueueCall::Kind;
  const bool refused = answer.kind == Kind::push && answer.closed;
  if (!answer.finished || answer.answered || answer.no_memory || answer.untried || refused)
    return "";
  const auto left_by = [&](const QueueCall& push, auto when) {
    return std::ranges::any_of(operations, [&](const QueueCall& o) {
      return o.kind == Kind::pop && (!o.finished || (o.answered && o.value == push.value)) &&
             when(o);
    });
  };
  std::vector<std::uint64_t> inside;
  for (const QueueCall& push : operations) {
    if (push.kind != Kind::push || !push.finished || !push.answered) continue;
    if (answer.kind == Kind::push) {
      if (!precedes(answer, push) &&
          !left_by(push, [&](const QueueCall& o) { return precedes(o, answer); }))
        inside.push_back(push.value);
    } else if (precedes(push, answer) &&
               !left_by(push, [&](const QueueCall& o) { return !precedes(answer, o); })) {
      return fmt::format("push {} happens before it, and nobody had taken that", push.value);
    }
  }
  if (answer.kind != Kind::push) return "";
  if (inside.empty()) return "nothing can have been inside";
  return fmt::format("inside was at most: {}", fmt::join(inside, ", "));
}

std::string standings(const Execution& execution, Symbols& symbols) {
  constexpr std::size_t most = 6;
  Values values(execution.heap());
  std::string text = "Where the threads stand:\n";
  for (unsigned thread = 0; thread < shown_threads(execution); ++thread) {
    const Turns::Thread* standing = execution.standing(thread);
    const auto& events = execution.graph().thread(thread).events;
    const void* last = events.empty() ? nullptr : execution.graph().event(events.back()).pc;
    text += fmt::format("  thread {} ", thread);
    if (execution.stopped() == thread) {
      text += last == nullptr ? "was stopped before its first step\n"
                              : fmt::format("was stopped after {}\n", symbols.name(last));
      continue;
    }
    if (execution.ended(thread)) {
      text += "has ended\n";
      continue;
    }
    const void* pc = standing != nullptr ? standing->wait_pc : last;
    text += fmt::format("{} at {}",
                        standing == nullptr       ? "was"
                        : standing->sleeps        ? "sleeps"
                        : standing->location != 0 ? "waits"
                                                  : "loops",
                        pc == nullptr ? "its beginning" : symbols.name(pc));
    const std::vector<EventId> reads = last_round(execution, thread, pc);
    text += reads.empty() ? "\n" : ", and last saw\n";
    for (std::size_t i = 0; i < std::min(reads.size(), most); ++i) {
      const Event& read = execution.graph().event(reads[i]);
      text += fmt::format("    {} {}{}\n", symbols.name(read.pc),
                          described(execution, read, symbols, values, 70),
                          origin(execution, read, symbols));
    }
    if (reads.size() > most) text += fmt::format("    and {} more\n", reads.size() - most);
  }
  return text;
}

/// Whether the call stands amid others like it, before or after the threads: three on either side.
bool is_one_of_many(const std::vector<QueueCall>& operations, std::size_t number) {
  constexpr std::size_t around = 3;
  if (number < around || number + around >= operations.size()) return false;
  const QueueCall& o = operations[number];
  return o.phase != QueueCall::Phase::during &&
         std::all_of(operations.begin() + static_cast<std::ptrdiff_t>(number - around),
                     operations.begin() + static_cast<std::ptrdiff_t>(number + around + 1),
                     [&o](const QueueCall& other) {
                       return other.phase == o.phase && other.kind == o.kind &&
                              other.worker == o.worker && other.answered == o.answered &&
                              other.no_memory == o.no_memory && other.waits == o.waits;
                     });
}

std::string history(const std::vector<QueueCall>& operations, std::string_view wrong) {
  std::string text;
  std::size_t last = 1;
  for (const QueueCall& o : operations) last = std::max({last, o.first_step, o.last_step});
  std::size_t left_out = 0;
  for (const QueueCall& o : operations) {
    const bool refused = o.kind == QueueCall::Kind::push && !o.answered &&
                         wrong.find(refusal(o)) != std::string_view::npos;
    if (!refused && is_one_of_many(operations, static_cast<std::size_t>(&o - operations.data()))) {
      ++left_out;
      continue;
    }
    if (left_out != 0) text += fmt::format("            and {} more\n", std::exchange(left_out, 0));
    constexpr std::size_t width = 48;
    std::string bar(width + 1, ' ');
    if (o.phase == QueueCall::Phase::during) {
      const std::size_t from = o.first_step * width / last;
      const std::size_t to = o.finished ? std::max(o.last_step * width / last, from) : width;
      for (std::size_t i = from; i <= to; ++i) bar[i] = '-';
      bar[from] = '|';
      if (o.finished) bar[to] = '|';
    }
    const char* who = o.phase == QueueCall::Phase::before  ? "before"
                      : o.phase == QueueCall::Phase::after ? "after"
                                                           : "";
    text += fmt::format("  {:<9} {:<18} {}\n",
                        *who != '\0' ? who : fmt::format("thread {}", o.thread), to_string(o), bar);
    if (o.phase != QueueCall::Phase::during && refused)
      text += fmt::format("            ^ {}\n", contradiction(o, operations));
  }
  return text;
}

std::string picture(const Execution& execution, const std::vector<QueueCall>& operations,
                    Symbols& symbols) {
  std::string text = columns(execution, operations, symbols) + "\n";
  const FindingKind kind = execution.finding() ? execution.finding()->kind : FindingKind::failure;
  if (execution.freezes() || kind == FindingKind::deadlock || kind == FindingKind::livelock)
    text += standings(execution, symbols) + "\n";
  return text + history(operations, kind == FindingKind::wrong_outcome
                                        ? std::string_view(execution.finding()->text)
                                        : "");
}

std::string dot(const Execution& execution, Symbols& symbols) {
  const Graph& graph = execution.graph();
  std::vector<const void*> pcs;
  for (unsigned thread = 0; thread < shown_threads(execution); ++thread)
    for (const EventId id : graph.thread(thread).events) pcs.push_back(graph.event(id).pc);
  symbols.look_up(pcs);
  Values values(execution.heap());
  std::string text = "digraph execution {\n  node [shape=box, fontname=monospace];\n";
  for (unsigned thread = 0; thread < shown_threads(execution); ++thread) {
    text += fmt::format("  subgraph cluster_{0} {{ label=\"thread {0}\";\n", thread);
    EventId before = no_event;
    for (const EventId id : graph.thread(thread).events) {
      const Event& event = graph.event(id);
      text += fmt::format("    e{} [label=\"{}\\n{}\"];\n", id, symbols.name(event.pc),
                          quoted(described(execution, event, symbols, values, 60)));
      if (before != no_event) text += fmt::format("    e{} -> e{};\n", before, id);
      before = id;
    }
    text += "  }\n";
  }
  const auto drawn = [&](EventId id) {
    return graph.event(id).kind != EventKind::initial &&
           graph.event(id).thread < shown_threads(execution);
  };
  for (EventId id = 0; id < graph.size(); ++id)
    if (drawn(id) && graph.event(id).reads && drawn(graph.event(id).from))
      text += fmt::format("  e{} -> e{} [color=green, label=rf];\n", graph.event(id).from, id);
  for (std::uint32_t l = 0; l < graph.locations(); ++l) {
    const std::vector<EventId>& stores = graph.location(l).stores;
    for (std::size_t i = 1; i < stores.size(); ++i)
      if (drawn(stores[i - 1]) && drawn(stores[i]))
        text += fmt::format("  e{} -> e{} [color=red, label=mo];\n", stores[i - 1], stores[i]);
  }
  return text + "}\n";
}

}  // namespace irt::checker
