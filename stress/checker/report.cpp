#include "stress/checker/report.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace irt::checker {

namespace {

const char* name_of(Order order) {
  static constexpr const char* names[] = {"relaxed", "consume", "acquire",
                                          "release", "acq_rel", "seq_cst"};
  return names[static_cast<unsigned>(order)];
}

/// Blocks of the heap by their number, so that a reader can tell nodes apart.
class Names {
 public:
  explicit Names(const Execution& execution) : heap_(execution.heap()) {}

  [[nodiscard]] std::string value(Value value) const {
    if (value >> 64 != 0)
      return fmt::format("{{{}, {}}}", word(static_cast<std::uint64_t>(value)),
                         static_cast<std::uint64_t>(value >> 64));
    return word(static_cast<std::uint64_t>(value));
  }

 private:
  [[nodiscard]] std::string word(std::uint64_t word) const {
    // Some algorithms keep marks in the bits that a pointer leaves unused.
    const std::uint64_t address = word & 0xFFFF'FFFF'FFF8U;
    const std::vector<Block>& blocks = heap_.blocks();
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (address < blocks[i].address || address >= blocks[i].address + blocks[i].size) continue;
      std::string text = fmt::format("&{}", i + 1);
      if (address != blocks[i].address) text += fmt::format("+{}", address - blocks[i].address);
      if (word != address) text += "*";
      return text;
    }
    return word < 1'000'000 ? std::to_string(word) : fmt::format("{:#x}", word);
  }

  const Heap& heap_;
};

std::string fitted(std::string text, std::size_t width) {
  if (text.size() > width) text = text.substr(0, width - 1) + "~";
  return text;
}

std::string what_it_did(const Event& event, const Names& names) {
  switch (event.kind) {
    case EventKind::load:
      return (event.blocked ? " waits, sees " : " = ") + names.value(event.read);
    case EventKind::store:
      return " <- " + names.value(event.written);
    case EventKind::modify:
      return " = " + names.value(event.read) + " <- " + names.value(event.written);
    case EventKind::choice:
      return event.option == 0 ? "" : " (by chance)";
    case EventKind::fence:
    case EventKind::initial:
      break;
  }
  return "";
}

// Threads that touch each location, as bits.
std::vector<std::uint32_t> users(const Execution& execution) {
  const Graph& graph = execution.graph();
  std::vector<std::uint32_t> result(graph.locations());
  for (unsigned thread = 0; thread < execution.threads(); ++thread)
    for (const EventId id : graph.thread(thread).events) {
      const Event& event = graph.event(id);
      if (event.reads || event.writes) result[event.location] |= 1U << thread;
    }
  return result;
}

}  // namespace

std::string sentence(const Finding& finding, Symbols& symbols) {
  std::string text = finding.text;
  for (std::size_t i = 0; i < finding.places.size(); ++i) {
    const std::string mark = "{" + std::to_string(i) + "}";
    for (auto at = text.find(mark); at != std::string::npos; at = text.find(mark))
      text.replace(at, mark.size(), symbols.name(finding.places[i]));
  }
  return text;
}

std::string columns(const Execution& execution, const std::vector<Operation>& operations,
                    Symbols& symbols) {
  const Graph& graph = execution.graph();
  const Names names(execution);
  const unsigned threads = execution.threads();
  const std::size_t width = threads <= 2 ? 58 : threads == 3 ? 46 : 36;
  const std::vector<std::uint32_t> who = users(execution);
  std::string text;
  std::string last;
  std::size_t repeats = 0;
  const auto flush = [&] {
    if (repeats > 2)
      text +=
          std::string(last.find_first_not_of(' '), ' ') + fmt::format("... {} times\n", repeats);
    if (repeats == 2) text += last;
    repeats = 0;
  };
  const auto line = [&](unsigned thread, const std::string& content) {
    const std::string next = std::string(thread * width, ' ') + fitted(content, width - 2) + "\n";
    if (repeats != 0 && next == last) {
      ++repeats;
      return;
    }
    flush();
    text += next;
    last = next;
    repeats = 1;
  };
  for (unsigned thread = 0; thread < threads; ++thread)
    text += fmt::format("{:<{}}", fmt::format("thread {}", thread), width);
  text += "\n";
  for (unsigned thread = 0; thread < threads; ++thread)
    text += fmt::format("{:<{}}", std::string(width - 2, '-'), width);
  text += "\n";

  // Steps are counted as the execution does: events of the threads, in order.
  std::size_t step = 0;
  std::set<const Operation*> begun;
  const auto announce = [&](unsigned thread) {
    for (const Operation& o : operations)
      if (o.phase == Operation::Phase::during && o.thread == thread && o.first_step <= step &&
          begun.insert(&o).second)
        line(thread, o.kind == Operation::Kind::push ? "push " + std::to_string(o.value) : "pop");
  };
  const auto conclude = [&](unsigned thread) {
    for (const Operation& o : operations)
      if (o.phase == Operation::Phase::during && o.thread == thread && o.finished &&
          begun.contains(&o) && o.last_step == step)
        line(thread, "  " + std::string(o.kind == Operation::Kind::push
                                            ? (o.answered ? "-> done" : "-> full")
                                            : (o.answered ? "-> " + std::to_string(o.value)
                                                          : std::string("-> empty"))));
  };
  for (EventId id = 0; id < graph.size(); ++id) {
    const Event& event = graph.event(id);
    if (event.kind == EventKind::initial || event.thread >= threads) continue;
    announce(event.thread);
    const bool shared = event.kind == EventKind::fence || event.kind == EventKind::choice ||
                        (who[event.location] & (who[event.location] - 1)) != 0;
    if (shared) {
      const Line& source = symbols.at(event.pc);
      const std::string result = what_it_did(event, names);
      std::string place = fmt::format("  {} ", source.number);
      if (event.pc == nullptr) place = event.silent ? "  clock " : "  signal ";
      std::string code = source.text.empty() ? std::string(name_of(event.order)) : source.text;
      const std::size_t room = width - 2 - std::min(width / 2, place.size() + result.size());
      place.append(fitted(code, room)).append(result);
      line(event.thread, place);
      const std::size_t choice =
          step < execution.steps().size() ? execution.steps()[step].choice : 0;
      if (choice != 0 && event.reads) {
        const Location& location = graph.location(event.location);
        const std::size_t at = graph.place_of(event.from);
        if (at + 1 < location.stores.size()) {
          const Event& newer = graph.event(location.stores[at + 1]);
          line(event.thread, fmt::format("      ^ old: the store at {} by thread {}",
                                         symbols.name(newer.pc), newer.thread));
          line(event.thread, "        does not happen before this read");
        }
      }
    }
    ++step;
    conclude(event.thread);
  }
  flush();
  return text;
}

std::string history(const std::vector<Operation>& operations) {
  std::string text;
  std::size_t last = 1;
  for (const Operation& o : operations) last = std::max({last, o.first_step, o.last_step});
  for (const Operation& o : operations) {
    constexpr std::size_t width = 48;
    std::string bar(width + 1, ' ');
    if (o.phase == Operation::Phase::during) {
      const std::size_t from = o.first_step * width / last;
      const std::size_t to = o.finished ? std::max(o.last_step * width / last, from) : width;
      for (std::size_t i = from; i <= to; ++i) bar[i] = '-';
      bar[from] = '|';
      if (o.finished) bar[to] = '|';
    }
    const char* who = o.phase == Operation::Phase::before  ? "before"
                      : o.phase == Operation::Phase::after ? "after"
                                                           : "";
    text += fmt::format("  {:<9} {:<18} {}\n",
                        *who != '\0' ? who : fmt::format("thread {}", o.thread), to_string(o), bar);
  }
  return text;
}

std::string dot(const Execution& execution, Symbols& symbols) {
  const Graph& graph = execution.graph();
  const Names names(execution);
  std::string text = "digraph execution {\n  node [shape=box, fontname=monospace];\n";
  for (unsigned thread = 0; thread < execution.threads(); ++thread) {
    text += fmt::format("  subgraph cluster_{0} {{ label=\"thread {0}\";\n", thread);
    EventId before = no_event;
    for (const EventId id : graph.thread(thread).events) {
      const Event& event = graph.event(id);
      text += fmt::format("    e{} [label=\"{}\\n{}{}\"];\n", id, symbols.name(event.pc),
                          name_of(event.order), what_it_did(event, names));
      if (before != no_event) text += fmt::format("    e{} -> e{};\n", before, id);
      before = id;
    }
    text += "  }\n";
  }
  const auto drawn = [&](EventId id) {
    return graph.event(id).kind != EventKind::initial &&
           graph.event(id).thread < execution.threads();
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
