#include "stress/checker/operations.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace irt::checker {

namespace {

using Kind = Operation::Kind;

/// Depth-first search for an order (Wing and Gong 1993) with the states seen (Lowe 2017).
class Search {
 public:
  Search(const std::vector<Operation>& operations, const Claims& claims, std::size_t capacity)
      : operations_(operations), claims_(claims), capacity_(capacity) {
    if (operations.size() > most) return;
    for (const Operation& b : operations) {
      std::uint64_t before = 0;
      for (std::size_t a = 0; a < operations.size(); ++a)
        if (precedes(operations[a], b)) before |= std::uint64_t{1} << a;
      before_.push_back(before);
    }
  }

  bool exists() { return operations_.size() > most ? is_in_order() : go(0); }

 private:
  static constexpr std::size_t most = 64;

  // Too many to try orders: whether theirs is right if they have only one, else a shrug.
  bool is_in_order() {
    for (std::size_t i = 0; i < operations_.size(); ++i) {
      if (i > 0 && !precedes(operations_[i - 1], operations_[i])) return true;
      if (!apply(operations_[i])) return false;
    }
    return true;
  }

  bool go(std::uint64_t done) {
    if (done == (operations_.size() == 64 ? ~std::uint64_t{0}
                                          : (std::uint64_t{1} << operations_.size()) - 1))
      return true;
    if (!seen_.emplace(done, held_).second) return false;
    for (std::size_t i = 0; i < operations_.size(); ++i) {
      const std::uint64_t bit = std::uint64_t{1} << i;
      if ((done & bit) != 0 || (before_[i] & ~done) != 0) continue;
      const std::vector<std::uint64_t> saved = held_;
      if (apply(operations_[i]) && go(done | bit)) return true;
      held_ = saved;
    }
    return false;
  }

  // Whether the specification allows `operation` now; if so, makes it.
  bool apply(const Operation& operation) {
    if (operation.no_memory) return true;
    if (operation.kind == Kind::push) {
      if (!operation.answered) return claims_.bounded && held_.size() >= capacity_;
      held_.push_back(operation.value);
      return true;
    }
    if (!operation.answered) return held_.empty();
    const auto found = std::find(held_.begin(), held_.end(), operation.value);
    if (found == held_.end()) return false;
    if (static_cast<std::uint64_t>(found - held_.begin()) > claims_.relaxation) return false;
    held_.erase(found);
    return true;
  }

  const std::vector<Operation>& operations_;
  const Claims& claims_;
  std::size_t capacity_;
  std::vector<std::uint64_t> before_;
  std::vector<std::uint64_t> held_;
  std::set<std::pair<std::uint64_t, std::vector<std::uint64_t>>> seen_;
};

// What every queue owes: what comes out was put in, once, and nothing stays behind.
std::optional<std::string> judge_conservation(const std::vector<Operation>& operations) {
  std::map<std::uint64_t, int> balance;
  for (const Operation& o : operations)
    if (o.kind == Kind::push && o.answered) ++balance[o.value];
  std::map<std::uint64_t, int> taken;
  for (const Operation& o : operations) {
    if (o.kind != Kind::pop || !o.answered) continue;
    if (!balance.contains(o.value))
      return "pop returned " + std::to_string(o.value) + ", which nobody pushed";
    if (++taken[o.value] > balance[o.value])
      return "element " + std::to_string(o.value) + " was popped twice";
  }
  for (const auto& [value, pushed] : balance)
    if (taken[value] < pushed)
      return "element " + std::to_string(value) + " was pushed and never came out";
  for (const Operation& push : operations)
    for (const Operation& pop : operations)
      if (push.kind == Kind::push && pop.kind == Kind::pop && pop.answered && push.answered &&
          push.value == pop.value && precedes(pop, push))
        return "element " + std::to_string(push.value) + " was popped before it was pushed";
  return std::nullopt;
}

// Who is told that the frame is over leaves; a push of which nothing has happened by then would be
// left to the others.
std::optional<std::string> judge_frame_end(const std::vector<Operation>& operations) {
  for (const Operation& end : operations)
    for (const Operation& push : operations)
      if (end.ends_frame && push.kind == Kind::push && push.phase == end.phase &&
          end.before_return.count[push.thread] <= push.called.count[push.thread])
        return "worker " + std::to_string(end.worker) +
               " was told that the frame is over before task " + std::to_string(push.value) +
               " of it was pushed";
  return std::nullopt;
}

// Elements of one producer leave in the order it pushed them.
std::optional<std::string> judge_producers(const std::vector<Operation>& operations) {
  const auto pop_of = [&](std::uint64_t value) -> const Operation* {
    for (const Operation& o : operations)
      if (o.kind == Kind::pop && o.answered && o.value == value) return &o;
    return nullptr;
  };
  for (const Operation& a : operations)
    for (const Operation& b : operations) {
      if (a.kind != Kind::push || b.kind != Kind::push || !a.answered || !b.answered) continue;
      if (&a == &b || a.worker != b.worker || !precedes(a, b)) continue;
      const Operation* first = pop_of(a.value);
      const Operation* second = pop_of(b.value);
      if (first != nullptr && second != nullptr && precedes(*second, *first))
        return "worker " + std::to_string(a.worker) + " pushed " + std::to_string(a.value) +
               " before " + std::to_string(b.value) + ", and they left the other way round";
    }
  return std::nullopt;
}

}  // namespace

bool precedes(const Operation& a, const Operation& b) {
  if (a.phase != b.phase) return a.phase < b.phase;
  if (a.thread == b.thread) return a.number < b.number;
  if (b.called_at != 0 && a.returned_at != 0 && a.returned_at < b.called_at) return true;
  return b.called.count[a.thread] >= a.returned;
}

std::string to_string(const Operation& o) {
  if (o.kind == Kind::push)
    return "push " + std::to_string(o.value) +
           (!o.finished   ? " ..."
            : o.no_memory ? " -> no memory"
            : o.answered  ? ""
                          : " -> full");
  return "pop -> " + (!o.finished   ? "..."
                      : o.no_memory ? "no memory"
                      : o.answered  ? std::to_string(o.value)
                                    : "empty");
}

std::optional<std::string> judge(const std::vector<Operation>& operations, const Claims& claims,
                                 std::size_t capacity) {
  if (auto wrong = judge_conservation(operations)) return wrong;
  if (auto wrong = judge_frame_end(operations)) return wrong;
  switch (claims.ordering) {
    case Ordering::unordered:
      return std::nullopt;
    case Ordering::per_producer_fifo:
      return judge_producers(operations);
    case Ordering::k_relaxed_fifo:
    case Ordering::fifo_happens_before:
    case Ordering::fifo_real_time:
      break;
  }
  Claims claimed = claims;
  if (claims.ordering != Ordering::k_relaxed_fifo) claimed.relaxation = 0;
  if (Search(operations, claimed, capacity).exists()) return std::nullopt;
  std::vector<Operation> answers;
  std::copy_if(operations.begin(), operations.end(), std::back_inserter(answers),
               [](const Operation& o) { return o.answered; });
  const bool timed = std::any_of(operations.begin(), operations.end(),
                                 [](const Operation& o) { return o.called_at != 0; });
  const std::string order = timed ? "real time" : "happens-before";
  if (!Search(answers, claimed, capacity).exists())
    return "no order of the operations that agrees with " + order + " is first-in first-out";
  return "the elements left in order, but in no order of the operations that agrees with " + order +
         " are all answers of \"empty\" and \"full\" true";
}

}  // namespace irt::checker
