// The steps of an execution, a column for each thread.

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <set>

#include "stress/checker/fold.hpp"
#include "stress/checker/interleaving.hpp"
#include "stress/checker/report.hpp"
#include "stress/checker/values.hpp"

namespace irt::checker {

namespace {

/// What a terminal shows at least, and up to how many threads have columns there. Of more, each
/// line begins with its thread.
constexpr std::size_t page = 120;
constexpr unsigned most_columns = 3;

/// `text` in lines of at most `room` characters; those after the first are indented further.
std::vector<std::string> wrapped(std::string text, std::size_t room) {
  std::vector<std::string> lines;
  const std::string indent(std::min(text.find_first_not_of(' '), room / 4) + 4, ' ');
  while (text.size() > room) {
    const std::size_t space = text.rfind(' ', room);
    const bool fits = space != std::string::npos && space > indent.size();
    lines.push_back(text.substr(0, fits ? space : room));
    text.replace(0, fits ? space + 1 : room, indent);
  }
  lines.push_back(text);
  return lines;
}

/// Threads that touch each location, as bits.
std::vector<std::uint32_t> users(const Execution& execution) {
  const Graph& graph = execution.graph();
  std::vector<std::uint32_t> result(graph.locations());
  for (unsigned thread = 0; thread < shown_threads(execution); ++thread)
    for (const EventId id : graph.thread(thread).events) {
      const Event& event = graph.event(id);
      if (event.reads || event.writes) result[event.location] |= 1U << thread;
    }
  return result;
}

class Columns {
 public:
  Columns(const Execution& execution, const std::vector<QueueCall>& operations, Symbols& symbols)
      : execution_(execution),
        graph_(execution.graph()),
        operations_(operations),
        symbols_(symbols),
        values_(execution.heap()),
        threads_(shown_threads(execution)),
        width_(threads_ <= most_columns ? page / std::max(threads_, 2U) : page),
        users_(users(execution)),
        shown_(execution.finding() ? execution.finding()->moments.size() : 0) {
    std::vector<const void*> pcs;
    for (EventId id = 0; id < graph_.size(); ++id) pcs.push_back(graph_.event(id).pc);
    for (const Block& block : execution.heap().blocks())
      pcs.insert(pcs.end(), {block.allocated_at, block.freed_at});
    symbols_.look_up(pcs);
    std::map<std::string, unsigned> lines;
    for (EventId id = 0; id < graph_.size(); ++id)
      if (const symbols::Line& source = symbols_.at(graph_.event(id).pc); source.number != 0)
        if (!symbols::is_foreign(source.file) && ++lines[source.file] > lines[file_])
          file_ = source.file;
  }

  std::string draw() {
    put_in_order();
    for (const EventId id : order_) {
      const Event& event = graph_.event(id);
      step_ = step_of_[id];
      show_payloads(event);
      if (event.index == 1) show_moments(event.thread, 0, &event);
      begin_calls(event.thread);
      show(id);
      ++step_;
      show_moments(event.thread, event.index, next_of(event));
      end_calls(event.thread);
    }
    for (unsigned thread = 0; thread < threads_; ++thread) show_rest(thread);
    show_rest(threads_);
    return text();
  }

 private:
  void line(unsigned thread, const std::string& text, const std::string& what = "") {
    rows_.push_back({thread, text, what.empty() ? text : what});
  }

  // A line of the file that most are of by its number, of others with their names.
  [[nodiscard]] std::string place_of(const void* pc) const {
    const symbols::Line& source = symbols_.at(pc);
    if (source.number == 0) return "";
    return source.file == file_ ? fmt::format("{} ", source.number) : symbols_.name(pc) + " ";
  }

  // As one interleaving of the threads, where it is one.
  void put_in_order() {
    step_of_.resize(graph_.size());
    for (EventId id = 0; id < graph_.size(); ++id) {
      const Event& event = graph_.event(id);
      if (event.kind == EventKind::initial || event.thread >= threads_) continue;
      step_of_[id] = order_.size();
      order_.push_back(id);
    }
    const auto interleaved = interleaving(graph_);
    is_interleaving_ = interleaved.has_value();
    if (!is_interleaving_) return;
    order_ = *interleaved;
    std::erase_if(order_, [&](EventId id) { return graph_.event(id).thread >= threads_; });
  }

  [[nodiscard]] const Event* next_of(const Event& event) const {
    const std::vector<EventId>& events = graph_.thread(event.thread).events;
    return event.index < events.size() ? &graph_.event(events[event.index]) : nullptr;
  }

  // Steps are counted as the execution does: events of the threads, in order.
  void begin_calls(unsigned thread) {
    for (const QueueCall& o : operations_)
      if (o.phase == QueueCall::Phase::during && o.thread == thread && o.first_step <= step_ &&
          begun_.insert(&o).second)
        line(thread, name_of(o));
  }

  void end_calls(unsigned thread) {
    for (const QueueCall& o : operations_) {
      if (o.phase != QueueCall::Phase::during || o.thread != thread || !o.finished ||
          !begun_.contains(&o) || o.last_step != step_)
        continue;
      const bool push = o.kind == QueueCall::Kind::push;
      const std::string answer = answer_of(o);
      line(thread, "  -> " + (answer.empty() ? "done" : answer));
      if (!execution_.finding() || execution_.finding()->kind != FindingKind::wrong_outcome)
        continue;
      const bool refused = push && !o.answered && !o.no_memory && !o.closed;
      if (refused && execution_.finding()->text.find(refusal(o)) == std::string::npos) continue;
      if (const std::string why = contradiction(o, operations_); !why.empty())
        line(thread, "      ^ " + why);
    }
  }

  // What the program did itself before `event`, which has no line in the code.
  void show_payloads(const Event& event) {
    if (!execution_.finding()) return;
    const std::vector<Moment>& moments = execution_.finding()->moments;
    for (std::size_t i = 0; i < moments.size(); ++i) {
      const Moment& m = moments[i];
      if (shown_[i] || m.pc != nullptr || m.thread != event.thread || m.after + 1 != event.index)
        continue;
      shown_[i] = true;
      show(m);
    }
  }

  // What the finding speaks of, done by `thread` after so many events of its own. `next` is the
  // event that follows: an atomic access is that event itself, and is marked when it is shown.
  void show_moments(unsigned thread, std::uint16_t after, const Event* next) {
    if (!execution_.finding()) return;
    const std::vector<Moment>& moments = execution_.finding()->moments;
    for (std::size_t i = 0; i < moments.size(); ++i) {
      const Moment& m = moments[i];
      if (shown_[i] || m.pc == nullptr || m.thread != thread || m.after != after) continue;
      if (next != nullptr && next->pc == m.pc && m.what.starts_with("atomic")) continue;
      shown_[i] = true;
      begin_calls(thread);
      show(m);
    }
  }

  void show(const Moment& m) {
    if (m.pc == nullptr)
      line(m.thread, m.what);
    else
      line(m.thread, fmt::format("  {}{}  {}", place_of(m.pc), symbols_.at(m.pc).text, m.what));
    if (!m.note.empty()) line(m.thread, "      ^ " + with_places(m.note));
  }

  [[nodiscard]] std::string with_places(const std::string& text) const {
    return checker::with_places(text, execution_.finding()->places, [this](const void* pc) {
      const symbols::Line& source = symbols_.at(pc);
      return source.number != 0 && source.file == file_ ? fmt::format("line {}", source.number)
                                                        : symbols_.name(pc);
    });
  }

  // The moments that no event of their thread followed; those of the preparing thread above all or
  // below all columns.
  void show_rest(unsigned thread) {
    if (!execution_.finding()) return;
    const std::vector<Moment>& moments = execution_.finding()->moments;
    for (std::size_t i = 0; i < moments.size(); ++i) {
      const Moment& m = moments[i];
      if (shown_[i] || m.thread != thread) continue;
      shown_[i] = true;
      if (thread < threads_)
        show(m);
      else if (m.after != 0)
        last_ += fmt::format("after the threads: {} at {}{}\n", m.what, symbols_.name(m.pc),
                             m.note.empty() ? "" : ", " + with_places(m.note));
    }
  }

  // The note of the finding on an atomic access, which is `event`.
  std::string note_on(const Event& event) {
    if (!execution_.finding()) return "";
    const std::vector<Moment>& moments = execution_.finding()->moments;
    for (std::size_t i = 0; i < moments.size(); ++i) {
      const Moment& m = moments[i];
      if (shown_[i] || m.thread != event.thread || m.after + 1 != event.index || m.pc != event.pc)
        continue;
      shown_[i] = true;
      return with_places(m.note);
    }
    return "";
  }

  void show(EventId id) {
    const Event& event = graph_.event(id);
    const std::string note = note_on(event);
    const bool touches = event.reads || event.writes;
    const bool alone = touches && (users_[event.location] & (users_[event.location] - 1)) == 0;
    if (alone && note.empty()) return;
    // A thread's own look at its birth and note of its end tell nothing.
    if (event.pc == nullptr && touches &&
        Process::is_of_threads(graph_.location(event.location).address))
      return;
    const std::string place = "  " + place_of(event.pc);
    line(event.thread, place + described(execution_, event, symbols_, values_, page - place.size()),
         fmt::format("{} {} {}", fmt::ptr(event.pc), static_cast<int>(event.kind), event.failed));
    if (!note.empty()) line(event.thread, "      ^ " + note);
    const std::size_t choice =
        step_ < execution_.steps().size() ? execution_.steps()[step_].choice : 0;
    if (choice == 0 || !touches || is_interleaving_) return;
    // The store after it in modification order, of those made before it in this execution.
    const std::vector<EventId>& stores = graph_.location(event.location).stores;
    auto after = std::ranges::find(stores, event.reads ? event.from : id);
    if (after == stores.end()) return;  // a plain write has replaced what was there
    ++after;
    while (after != stores.end() && *after >= id) ++after;
    if (after == stores.end()) return;
    const Event& newer = graph_.event(*after);
    const std::string store =
        fmt::format("the store at {} by thread {}", symbols_.name(newer.pc), newer.thread);
    if (event.reads) {
      line(event.thread, "      ^ old: " + store);
      line(event.thread, "        does not happen before this read");
    } else {
      line(event.thread, "      ^ placed before " + store);
      line(event.thread, "        in modification order");
    }
  }

  [[nodiscard]] std::string text() const {
    std::string text;
    if (!file_.empty())
      text += fmt::format("Numbers are lines of {}.\n\n", file_.substr(file_.rfind('/') + 1));
    text += threads_ <= most_columns ? in_columns() : in_lines();
    text += last_;
    if (const std::string legend = values_.legend(threads_, symbols_); !legend.empty())
      text += "\nBlocks of the heap:\n" + legend;
    return text;
  }

  [[nodiscard]] std::string in_columns() const {
    std::string text;
    const auto row = [&](auto cell) {
      for (unsigned thread = 0; thread < threads_; ++thread)
        text += thread + 1 < threads_ ? fmt::format("{:<{}}", cell(thread), width_) : cell(thread);
      text += "\n";
    };
    row([](unsigned thread) { return fmt::format("thread {}", thread); });
    row([this](unsigned) { return std::string(width_ - 2, '-'); });
    for (const Row& r : fold(rows_))
      for (const std::string& part : wrapped(r.text, width_ - 2))
        text += std::string(r.thread * width_, ' ') + part + "\n";
    return text;
  }

  [[nodiscard]] std::string in_lines() const {
    std::string text;
    std::optional<unsigned> last;
    for (const Row& r : fold(rows_)) {
      const std::string name = last == r.thread ? "" : fmt::format("thread {}", r.thread);
      last = r.thread;
      std::string head = fmt::format("{:<9} | ", name);
      for (const std::string& part : wrapped(r.text, page - head.size())) {
        text += head + part + "\n";
        head = fmt::format("{:<9} | ", "");
      }
    }
    return text;
  }

  const Execution& execution_;
  const Graph& graph_;
  const std::vector<QueueCall>& operations_;
  Symbols& symbols_;
  Values values_;
  unsigned threads_;
  std::size_t width_;
  std::string file_;  ///< that most lines are of
  std::vector<std::uint32_t> users_;
  std::vector<bool> shown_;  ///< the finding's moments
  std::vector<EventId> order_;
  std::vector<std::size_t> step_of_;  ///< by event: which step of the execution it is
  bool is_interleaving_ = false;
  std::vector<Row> rows_;
  std::string last_;
  std::size_t step_ = 0;
  std::set<const QueueCall*> begun_;
};

}  // namespace

std::string columns(const Execution& execution, const std::vector<QueueCall>& operations,
                    Symbols& symbols) {
  return Columns(execution, operations, symbols).draw();
}

}  // namespace irt::checker
