#include "stress/checker/queue_calls.hpp"

#include <algorithm>
#include <utility>

#include "stress/history/orders.hpp"

namespace irt::checker {

namespace {

using Kind = QueueCall::Kind;

// Who is told that the frame is over leaves; a push of which nothing has happened by then would be
// left to the others.
std::optional<std::string> judge_frame_end(const std::vector<QueueCall>& operations) {
  for (const QueueCall& end : operations)
    for (const QueueCall& push : operations)
      if (end.ends_frame && push.kind == Kind::push && push.phase == end.phase &&
          end.before_return.count[push.thread] <= push.called.count[push.thread])
        return "worker " + std::to_string(end.worker) +
               " was told that the frame is over before task " + std::to_string(push.value) +
               " of it was pushed";
  return std::nullopt;
}

stress::Kind kind_of(const QueueCall& o) {
  using Answered = stress::Kind;
  switch (o.kind) {
    case Kind::push:
      return o.answered ? Answered::push : Answered::full;
    case Kind::pop:
      return o.answered    ? Answered::pop
             : o.closed    ? Answered::closed
             : o.timed_out ? Answered::timed_out
                           : Answered::empty;
    case Kind::close:
      return Answered::close;
    case Kind::leave:
      break;
  }
  return Answered::leave;
}

stress::Calls calls_of(const std::vector<QueueCall>& operations) {
  std::vector<stress::Call> calls;
  std::size_t before = 0;
  std::size_t after = 0;
  for (const QueueCall& o : operations) {
    calls.push_back({.kind = kind_of(o),
                     .worker = o.worker,
                     .value = o.value,
                     .no_effect = o.no_memory || o.untried});
    before += o.phase == QueueCall::Phase::before ? 1 : 0;
    after += o.phase == QueueCall::Phase::after ? 1 : 0;
  }
  stress::Calls result(std::move(calls), before, after);
  for (std::size_t b = result.begin(); b < result.end(); ++b)
    for (std::size_t a = result.begin(); a < b; ++a)
      if (precedes(operations[a], operations[b])) result.order(a, b);
  return result;
}

/// A broken promise in words, for readers who see the calls beneath.
class Sentence {
 public:
  Sentence(const std::vector<QueueCall>& operations, const stress::Specification& specification)
      : operations_(operations), specification_(specification) {
    const bool timed =
        std::ranges::any_of(operations, [](const QueueCall& o) { return o.called_at != 0; });
    order_ = timed ? "real time" : "happens-before";
  }

  [[nodiscard]] std::string of(const stress::Breach& breach) const {
    using stress::Pattern;
    const bool alone = breach.calls.empty();
    switch (breach.pattern) {
      case Pattern::fresh:
        if (breach.calls.size() == 1)
          return "pop returned " + value(breach, 0) + ", which nobody pushed";
        if (at(breach, 0).worker != at(breach, 1).worker && specification_.claims().own_queues())
          return "element " + value(breach, 0) + " was pushed for worker " +
                 std::to_string(at(breach, 1).worker) + " and popped for worker " +
                 std::to_string(at(breach, 0).worker);
        return "element " + value(breach, 0) + " was popped before it was pushed";
      case Pattern::repeat:
        return "element " + value(breach, 0) + " was popped twice";
      case Pattern::lost:
        return "element " + value(breach, 0) + " was pushed and never came out";
      case Pattern::order:
        if (alone) return no_order() + " is first-in first-out";
        if (at(breach, 2).worker == at(breach, 3).worker)
          return "worker " + std::to_string(at(breach, 2).worker) + " pushed " + value(breach, 1) +
                 " before " + value(breach, 0) + ", and they left the other way round";
        return value(breach, 1) + " was pushed before " + value(breach, 0) + " by " + order_ +
               ", and they left the other way round";
      case Pattern::rank:
        return no_order() + " lets no element pass more than " +
               std::to_string(specification_.overtakes()) + " older ones";
      case Pattern::full:
        return refused(at(breach, 0));
      case Pattern::closed:
        return end(breach);
      case Pattern::witness:
        if (alone)
          return "the elements left in order, but in no order of the operations that agrees with " +
                 order_ + " are all answers of \"empty\" and \"full\" true";
        return found_nothing(breach);
    }
    return "?";
  }

 private:
  [[nodiscard]] const QueueCall& at(const stress::Breach& breach, std::size_t i) const {
    return operations_[breach.calls[i]];
  }
  [[nodiscard]] std::string value(const stress::Breach& breach, std::size_t i) const {
    return std::to_string(at(breach, i).value);
  }
  [[nodiscard]] std::string no_order() const {
    return "no order of the operations that agrees with " + order_;
  }

  /// "thread 1's second pop", "a pop after the threads".
  [[nodiscard]] std::string who(const QueueCall& o) const {
    const std::string name = o.kind == Kind::push ? "push" : name_of(o);
    if (o.phase == QueueCall::Phase::before) return "a " + name + " before the threads";
    if (o.phase == QueueCall::Phase::after) return "a " + name + " after the threads";
    std::size_t number = 0;
    std::size_t all = 0;
    for (const QueueCall& other : operations_) {
      if (other.thread != o.thread || other.kind != o.kind || other.phase != o.phase) continue;
      ++all;
      number += other.number <= o.number ? 1 : 0;
    }
    return "thread " + std::to_string(o.thread) + "'s " +
           (all == 1 ? name : name + " number " + std::to_string(number));
  }

  [[nodiscard]] std::string refused(const QueueCall& push) const {
    const std::string text = who(push) + " " + refusal(push);
    if (!specification_.claims().bounded) return text + ", and the queue claims no bound";
    const std::string places = std::to_string(specification_.capacity());
    if (specification_.full() == Answer::exact)
      return text + ", and in no order of the operations that agrees with " + order_ +
             " were all " + places + " places taken then";
    return text + " with fewer than " + places +
           " elements inside, and no call in flight explains it";
  }

  [[nodiscard]] std::string end(const stress::Breach& breach) const {
    const QueueCall& o = at(breach, 0);
    const std::string after = " although the queue had been closed by then";
    if (o.kind == Kind::push)
      return who(o) + " (of " + std::to_string(o.value) + ") was accepted" + after;
    if (o.timed_out) return who(o) + " gave up at its deadline" + after;
    const std::string text = who(o) + " answered \"closed\"";
    if (breach.calls.size() == 1) return text + ", and nobody had called close";
    return text + ", and " + value(breach, 1) + ", which was accepted, " +
           (breach.calls[1] == breach.calls[2] ? "is left behind" : "came out afterwards");
  }

  [[nodiscard]] std::string found_nothing(const stress::Breach& breach) const {
    const std::string text = who(at(breach, 0)) + " answered \"" + answer_of(at(breach, 0)) + "\"";
    if (breach.calls.size() < 3)
      return text + ", and in no order of the operations that agrees with " + order_ +
             " was the queue empty then";
    const std::string inside = text + " while " + value(breach, 1) + " was inside";
    switch (specification_.empty()) {
      case Answer::this_worker:
        return inside + ", which the same worker took next, with nobody else at work";
      case Answer::calls_in_flight:
        return inside + ", and no call in flight explains it";
      default:
        return inside + ", by " + order_;
    }
  }

  const std::vector<QueueCall>& operations_;
  const stress::Specification& specification_;
  std::string order_;
};

}  // namespace

std::string refusal(const QueueCall& push) {
  return "(of " + std::to_string(push.value) + ") answered \"full\"";
}

bool precedes(const QueueCall& a, const QueueCall& b) {
  if (a.phase != b.phase) return a.phase < b.phase;
  if (a.thread == b.thread) return a.number < b.number;
  if (b.called_at != 0 && a.returned_at != 0 && a.returned_at < b.called_at) return true;
  return b.called.count[a.thread] >= a.returned;
}

std::string name_of(const QueueCall& o) {
  switch (o.kind) {
    case Kind::push:
      return "push " + std::to_string(o.value);
    case Kind::pop:
      return o.waits ? "pop_wait" : "pop";
    case Kind::close:
      return "close";
    case Kind::leave:
      break;
  }
  return "leave";
}

std::string answer_of(const QueueCall& o) {
  if (o.no_memory) return "no memory";
  if (o.untried) return "not tried";
  if (o.closed) return "closed";
  if (o.timed_out) return "timed out";
  if (o.kind == Kind::pop) return o.answered ? std::to_string(o.value) : "empty";
  return o.answered ? "" : "full";
}

std::string to_string(const QueueCall& o) {
  if (!o.finished) return name_of(o) + (o.kind == Kind::pop ? " -> ..." : " ...");
  const std::string answer = answer_of(o);
  return name_of(o) + (answer.empty() ? "" : " -> " + answer);
}

Opinion judge(const std::vector<QueueCall>& operations, const Claims& claims, std::size_t capacity,
              bool emptied) {
  if (auto wrong = judge_frame_end(operations)) return {std::move(wrong)};
  const stress::Specification specification(claims, capacity);
  stress::Calls calls = calls_of(operations);
  if (!emptied) calls.leave_inside();
  const stress::Judgement judgement = stress::judge_in_every_order(calls, specification);
  if (!judgement.breach) return {std::nullopt, judgement.decided};
  return {Sentence(operations, specification).of(*judgement.breach)};
}

std::optional<std::string> judge_stalled(const std::vector<QueueCall>& operations,
                                         const Claims& claims, std::size_t capacity,
                                         unsigned stopped) {
  const bool taken = std::ranges::any_of(
      operations, [](const QueueCall& o) { return o.kind == Kind::pop && !o.finished; });
  if (taken || !stress::Specification(claims, capacity).pops_past_stopped()) return std::nullopt;
  for (const QueueCall& push : operations) {
    if (push.kind != Kind::push || !push.answered) continue;
    // Where each has a queue of its own, only the stopped one could take it.
    if (claims.own_queues() && push.worker == stopped) continue;
    if (std::ranges::none_of(operations, [&](const QueueCall& o) {
          return o.kind == Kind::pop && o.value == push.value && o.answered;
        }))
      return "element " + std::to_string(push.value) +
             ", whose push has returned, does not come out while a thread is stopped";
  }
  return std::nullopt;
}

Opinion Histories::judge(const std::vector<QueueCall>& operations, const Claims& claims,
                         std::size_t capacity, bool emptied) {
  std::vector<const QueueCall*> sorted;
  sorted.reserve(operations.size());
  for (const QueueCall& operation : operations) sorted.push_back(&operation);
  std::ranges::stable_sort(sorted, {},
                           [](const QueueCall* o) { return std::pair(o->phase, o->thread); });
  std::string key;
  for (const QueueCall* b : sorted) {
    key += b->no_memory || b->untried ? 'm'
           : b->answered              ? 'y'
           : b->closed                ? 'c'
           : b->timed_out             ? 't'
                                      : 'n';
    key.append(reinterpret_cast<const char*>(&b->value), sizeof b->value);
    if (b->phase != QueueCall::Phase::during) continue;  // in the order in which they stand
    for (const QueueCall* a : sorted)
      if (a->phase == b->phase) key += precedes(*a, *b) ? '<' : ' ';
  }
  last_ = std::hash<std::string>{}(key);
  if (const auto known = fine_.find(key); known != fine_.end() && known->second) return {};
  Opinion opinion = checker::judge(operations, claims, capacity, emptied);
  fine_[key] = !opinion.wrong;
  return opinion;
}

std::vector<std::uint64_t> Histories::hashes() const {
  std::vector<std::uint64_t> result;
  for (const auto& [key, fine] : fine_) result.push_back(std::hash<std::string>{}(key));
  return result;
}

}  // namespace irt::checker
