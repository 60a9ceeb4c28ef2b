#include "stress/history/judge.hpp"

#include <fmt/format.h>
#include <utility>

#include "stress/history/closing.hpp"
#include "stress/history/happens_before.hpp"
#include "stress/history/specification.hpp"

namespace irt::stress {
namespace {

void add(Verdict& verdict, std::optional<Violation> violation) {
  if (violation) verdict.violations.push_back(std::move(*violation));
}

void judge_one_queue(const History& history, const Specification& specification, Verdict& verdict) {
  const Claims& claims = specification.claims();
  const Matching matching(history);
  for (const Violation& violation : matching.violations()) verdict.violations.push_back(violation);

  const HappensBefore order(matching);
  add(verdict, order.cycle());
  if (order.cycle()) return;
  HappensBefore::Empties empties = order.judge_empties(specification);
  verdict.refuted_empties += empties.refuted;

  if (specification.fifo()) add(verdict, order.judge_order(false));
  add(verdict, std::move(empties.first));
  if (claims.bounded) add(verdict, order.judge_full(specification));
  if (claims.ordering == Ordering::fifo_real_time) {
    for (Violation& violation : judge_real_time(matching, specification)) {
      verdict.violations.push_back(std::move(violation));
    }
  }
  if (claims.ordering == Ordering::per_producer_fifo) add(verdict, order.judge_order(true));
  if (!specification.fifo()) {
    Relaxation relaxation = measure_relaxation(matching);
    if (relaxation.rank_error.max > specification.overtakes()) {
      Violation violation = *relaxation.worst;
      violation.text += fmt::format(", and the queue claims at most {}", specification.overtakes());
      verdict.violations.push_back(std::move(violation));
    }
    verdict.relaxation = std::move(relaxation);
  }
}

/// The first *full* of a queue that claims no bound.
std::optional<Violation> unbounded_full(const History& history) {
  for (unsigned worker = 0; worker < history.logs.size(); ++worker) {
    for (const Operation& operation : history.logs[worker]) {
      if (operation.kind != Kind::full) continue;
      return Violation{.pattern = Pattern::full,
                       .text = "push answered full, and the queue claims no bound",
                       .culprits = {{worker, operation}}};
    }
  }
  return std::nullopt;
}

}  // namespace

Verdict judge(const History& as_logged, const Claims& claims, std::size_t capacity) {
  const Specification specification(claims, capacity);
  Verdict verdict;
  add(verdict, judge_closing(as_logged, specification));
  const std::optional<History> rest = without_closing(as_logged);
  const History& history = rest ? *rest : as_logged;
  const auto count = [&](const std::vector<Operation>& log) {
    for (const Operation& operation : log) {
      verdict.pushes += operation.kind == Kind::push ? 1 : 0;
      verdict.pops += operation.kind == Kind::pop ? 1 : 0;
      verdict.empties += operation.kind == Kind::empty ? 1 : 0;
      verdict.fulls += operation.kind == Kind::full ? 1 : 0;
    }
  };
  for (const auto& log : history.logs) count(log);
  count(history.drain);
  if (!claims.bounded && verdict.fulls > 0) add(verdict, unbounded_full(history));

  if (!claims.own_queues()) {
    judge_one_queue(history, specification, verdict);
    return verdict;
  }
  for (std::size_t worker = 0; worker < history.logs.size(); ++worker) {
    History own{.logs = std::vector<std::vector<Operation>>(history.logs.size()),
                .drain = {},
                .emptied = history.emptied,
                .error = history.error};
    own.logs[worker] = history.logs[worker];
    // What others popped of this worker's elements is for their own histories to explain.
    for (const Operation& operation : history.drain) {
      if (operation.kind == Kind::pop && producer_of(operation.value) == worker) {
        own.drain.push_back(operation);
      }
    }
    judge_one_queue(own, specification, verdict);
  }
  verdict.relaxation = measure_relaxation(Matching(history));
  return verdict;
}

}  // namespace irt::stress
