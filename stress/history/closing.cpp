#include "stress/history/closing.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <string>
#include <vector>

namespace irt::stress {
namespace {

bool is_of_closing(Kind kind) {
  return kind == Kind::closed || kind == Kind::timed_out || kind == Kind::close;
}

template <class Calls>
bool has_closing_calls(const Calls& calls) {
  return std::ranges::any_of(calls, [](const auto& call) { return is_of_closing(call.kind); });
}

// --- Few calls -----------------------------------------------------------------------------------

/// Whether `calls` have a close that precedes call `i`, and one that does not follow it.
struct Closes {
  std::optional<std::size_t> before;
  bool begun = false;

  Closes(const Calls& calls, std::size_t i) {
    for (std::size_t k = 0; k < calls.all().size(); ++k) {
      if (calls.all()[k].kind != Kind::close) continue;
      if (calls.precedes(k, i)) before = k;
      begun = begun || !calls.precedes(i, k);
    }
  }
};

constexpr std::size_t nobody = ~std::size_t{0};

/// The pop of what call `push` pushed; `nobody`, which all calls precede, if it stayed inside.
std::size_t pop_of(const Calls& calls, std::size_t push) {
  const auto found = std::ranges::find_if(calls.all(), [&](const Call& c) {
    return c.kind == Kind::pop && !c.no_effect && c.value == calls.all()[push].value;
  });
  return found == calls.all().end() ? nobody
                                    : static_cast<std::size_t>(found - calls.all().begin());
}

std::optional<Breach> judge_end(const Calls& calls, const Specification& specification,
                                std::size_t closed) {
  const auto in_flight = [&](std::size_t i) {
    return !calls.precedes(i, closed) && !calls.precedes(closed, i);
  };
  if (specification.empty() != Answer::exact)
    for (std::size_t i = 0; i < calls.all().size(); ++i)
      if (i != closed && calls.all()[i].kind == Kind::pop && in_flight(i)) return std::nullopt;
  for (std::size_t push = 0; push < calls.all().size(); ++push) {
    const Call& call = calls.all()[push];
    if (call.kind != Kind::push || call.no_effect) continue;
    if (specification.claims().own_queues() && call.worker != calls.all()[closed].worker) continue;
    const std::size_t pop = pop_of(calls, push);
    if (pop == nobody ? calls.emptied() : calls.precedes(closed, pop))
      return Breach{Pattern::closed, {closed, push, pop == nobody ? push : pop}};
  }
  return std::nullopt;
}

}  // namespace

std::optional<Breach> judge_closing(const Calls& calls, const Specification& specification) {
  if (!has_closing_calls(calls.all())) return std::nullopt;
  for (std::size_t i = 0; i < calls.all().size(); ++i) {
    const Call& call = calls.all()[i];
    if (call.no_effect) continue;
    const Closes closes(calls, i);
    if ((call.kind == Kind::push || call.kind == Kind::timed_out) && closes.before)
      return Breach{Pattern::closed, {i, *closes.before}};
    if (call.kind != Kind::closed) continue;
    if (!closes.begun) return Breach{Pattern::closed, {i}};
    if (auto breach = judge_end(calls, specification, i)) return breach;
  }
  return std::nullopt;
}

Calls without_closing(const Calls& calls) {
  Calls result = calls;
  if (!has_closing_calls(calls.all())) return result;
  for (std::size_t i = 0; i < calls.all().size(); ++i) {
    const Kind kind = calls.all()[i].kind;
    if (kind == Kind::close || (kind == Kind::full && Closes(calls, i).begun)) result.excuse(i);
    if (kind == Kind::closed || kind == Kind::timed_out) result.take_for_empty(i);
  }
  return result;
}

// --- Long histories ------------------------------------------------------------------------------

namespace {

/// An operation with what it takes to tell what precedes it: its worker, its place in that one's
/// log, and how many barriers come before.
struct Placed {
  const Operation* operation;
  unsigned worker;
  std::size_t place;
  std::size_t barriers;
};

class Log {
 public:
  Log(const History& history, const Specification& specification)
      : slack_(2 * history.error),
        by_clock_(specification.claims().ordering == Ordering::fifo_real_time) {
    for (unsigned worker = 0; worker < history.logs.size(); ++worker) {
      std::size_t barriers = 0;
      for (std::size_t place = 0; place < history.logs[worker].size(); ++place) {
        const Operation& operation = history.logs[worker][place];
        barriers += operation.kind == Kind::meet ? 1 : 0;
        add({&operation, worker, place, barriers});
      }
    }
    constexpr std::size_t last = ~std::size_t{0};
    for (const Operation& operation : history.drain)
      if (operation.kind == Kind::pop) pops_.push_back({&operation, drain_worker, last, last});
  }

  [[nodiscard]] std::optional<Violation> judge(const Specification& specification) const {
    for (const Placed& push : pushes_)
      if (const Placed* close = close_before(push))
        return violation("a push was accepted after the queue had been closed", {*close, push});
    for (const Placed& pop : waits_) {
      if (pop.operation->kind == Kind::timed_out) {
        if (const Placed* close = close_before(pop))
          return violation(
              "a waiting pop gave up at its deadline although the queue had been closed",
              {*close, pop});
        continue;
      }
      if (std::ranges::all_of(closes_, [&](const Placed& close) {
            return pop.operation->returned + slack_ < close.operation->invoked;
          }))
        return violation("a waiting pop answered closed, and nobody had closed the queue", {pop});
      const auto later = std::ranges::find_if(pops_, [&](const Placed& other) {
        return precedes(pop, other) && (!specification.claims().own_queues() ||
                                        producer_of(other.operation->value) == pop.worker);
      });
      const bool excused =
          specification.empty() != Answer::exact &&
          std::ranges::any_of(pops_, [&](const Placed& other) { return overlaps(pop, other); });
      if (later != pops_.end() && !excused)
        return violation("a waiting pop answered closed although an element came out afterwards",
                         {pop, *later});
    }
    return std::nullopt;
  }

 private:
  void add(const Placed& placed) {
    switch (placed.operation->kind) {
      case Kind::push:
        return pushes_.push_back(placed);
      case Kind::pop:
        return pops_.push_back(placed);
      case Kind::closed:
      case Kind::timed_out:
        return waits_.push_back(placed);
      case Kind::close:
        return closes_.push_back(placed);
      default:
        return;
    }
  }

  [[nodiscard]] bool precedes(const Placed& a, const Placed& b) const {
    if (a.worker == b.worker) return a.place < b.place;
    if (a.barriers < b.barriers) return true;
    return by_clock_ && a.operation->returned + slack_ < b.operation->invoked;
  }
  [[nodiscard]] bool overlaps(const Placed& a, const Placed& b) const {
    return a.operation->invoked <= b.operation->returned + slack_ &&
           b.operation->invoked <= a.operation->returned + slack_;
  }
  [[nodiscard]] const Placed* close_before(const Placed& placed) const {
    const auto found =
        std::ranges::find_if(closes_, [&](const Placed& close) { return precedes(close, placed); });
    return found == closes_.end() ? nullptr : &*found;
  }

  static Violation violation(const char* text, const std::vector<Placed>& culprits) {
    Violation result{.pattern = Pattern::closed, .text = text, .culprits = {}};
    for (const Placed& culprit : culprits)
      result.culprits.push_back({culprit.worker, *culprit.operation});
    return result;
  }

  std::vector<Placed> pushes_, pops_, waits_, closes_;
  Stamp slack_;
  bool by_clock_;
};

bool has_closing(const History& history) {
  return std::ranges::any_of(history.logs, [](const auto& log) { return has_closing_calls(log); });
}

}  // namespace

std::optional<Violation> judge_closing(const History& history, const Specification& specification) {
  if (!has_closing(history)) return std::nullopt;
  return Log(history, specification).judge(specification);
}

std::optional<History> without_closing(const History& history) {
  if (!has_closing(history)) return std::nullopt;
  History result{
      .logs = {}, .drain = history.drain, .emptied = history.emptied, .error = history.error};
  Stamp closed = never;
  for (const auto& log : history.logs)
    for (const Operation& operation : log)
      if (operation.kind == Kind::close) closed = std::min(closed, operation.invoked);
  for (auto log : history.logs) {
    std::erase_if(log, [&](const Operation& o) {
      return o.kind == Kind::close ||
             (o.kind == Kind::full && closed != never && o.returned + 2 * history.error >= closed);
    });
    for (Operation& o : log)
      if (is_of_closing(o.kind)) o.kind = Kind::empty;
    result.logs.push_back(std::move(log));
  }
  return result;
}

}  // namespace irt::stress
