#include "stress/history/real_time.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace irt::stress {
namespace {

/// An open interval during which the queue cannot have been empty.
struct Cover {
  Stamp from;
  Stamp to;
};

void find_fresh(const Matching& matching, std::vector<Violation>& found) {
  const Stamp slack = 2 * matching.history().error;
  for (const auto& lives : matching.lives()) {
    for (const Life& life : lives) {
      if (life.push == nullptr || life.pop == nullptr) continue;
      if (life.pop->returned + slack < life.push->invoked) {
        found.push_back(
            {Pattern::fresh,
             fmt::format("{} was popped before its push began", element_name(life.push->value)),
             {matching.culprit(*life.pop), matching.culprit(*life.push)}});
        return;
      }
    }
  }
}

/// For each b in the order in which pushes began: of all a whose push had returned before, did one
/// leave only after b had?
void find_order(const Matching& matching, std::vector<Violation>& found) {
  const Stamp slack = 2 * matching.history().error;
  PushesInOrder<&Operation::returned> finished(matching);
  const Life* latest = nullptr;
  Stamp latest_pop = 0;
  for (PushesInOrder<&Operation::invoked> begun(matching); !begun.done();) {
    const Stamp began = begun.stamp();
    while (!finished.done() && finished.stamp() + slack < began) {
      const Life& a = finished.next();
      if (latest == nullptr || a.pop_invoked() > latest_pop) {
        latest = &a;
        latest_pop = a.pop_invoked();
      }
    }
    const Life& b = begun.next();
    if (b.pop == nullptr || latest == nullptr || b.pop->returned + slack >= latest_pop) continue;
    Violation violation{
        Pattern::order,
        fmt::format("{} left before {}, whose push had returned before the other's "
                    "began",
                    element_name(b.push->value), element_name(latest->push->value)),
        {matching.culprit(*latest->push), matching.culprit(*b.push), matching.culprit(*b.pop)}};
    if (latest->pop != nullptr) violation.culprits.push_back(matching.culprit(*latest->pop));
    found.push_back(std::move(violation));
    return;
  }
}

/// The union of the intervals in which single elements were surely inside.
std::vector<Cover> covers(const Matching& matching) {
  const Stamp error = matching.history().error;
  std::vector<Cover> merged;
  for (PushesInOrder<&Operation::returned> pushes(matching); !pushes.done();) {
    const Life& life = pushes.next();
    const Stamp from = life.push->returned + error;
    const Stamp to = life.pop != nullptr ? life.pop->invoked - error : never;
    if (from >= to) continue;
    if (!merged.empty() && from < merged.back().to) {
      merged.back().to = std::max(merged.back().to, to);
    } else {
      merged.push_back({from, to});
    }
  }
  return merged;
}

/// The few elements whose stays together cover `empty`, longest reach first.
std::vector<Culprit> covering_chain(const Matching& matching, const Operation& empty) {
  const Stamp error = matching.history().error;
  std::vector<Culprit> chain;
  Stamp reached = empty.invoked - error;
  const Stamp goal = empty.returned + error;
  bool first = true;
  while (first || reached <= goal) {
    const Life* best = nullptr;
    for (const auto& lives : matching.lives()) {
      for (const Life& life : lives) {
        if (life.push == nullptr || life.push->returned + error >= reached) continue;
        if (best == nullptr || life.pop_invoked() > best->pop_invoked()) best = &life;
      }
    }
    const Stamp to = best == nullptr        ? 0
                     : best->pop == nullptr ? never
                                            : best->pop->invoked - error;
    if (to <= reached) break;
    first = false;
    chain.push_back(matching.culprit(*best->push));
    if (best->pop != nullptr) chain.push_back(matching.culprit(*best->pop));
    reached = to;
  }
  return chain;
}

void find_witness(const Matching& matching, std::vector<Violation>& found) {
  const Stamp error = matching.history().error;
  const std::vector<Cover> inside = covers(matching);
  const auto accuse = [&](const Operation& empty) {
    std::vector<Culprit> culprits = covering_chain(matching, empty);
    culprits.insert(culprits.begin() + std::min<std::ptrdiff_t>(1, std::ssize(culprits)),
                    matching.culprit(empty));
    found.push_back({Pattern::witness,
                     "pop answered empty although the queue held an element all the while",
                     std::move(culprits)});
  };
  const auto search = [&](const std::vector<Operation>& log) {
    std::size_t at = 0;
    for (const Operation& operation : log) {
      if (operation.kind != Kind::empty) continue;
      const Stamp from = operation.invoked - error;
      const Stamp to = operation.returned + error;
      while (at < inside.size() && inside[at].to <= to) ++at;
      if (at == inside.size()) return false;
      if (inside[at].from < from) {
        accuse(operation);
        return true;
      }
    }
    return false;
  };
  if (search(matching.history().drain)) return;
  for (const auto& log : matching.history().logs) {
    if (search(log)) return;
  }
}

std::optional<Violation> find_full(const Matching& matching, std::size_t capacity) {
  struct Change {
    Stamp at;
    int by;
  };
  const Stamp error = matching.history().error;
  std::vector<Change> changes;
  for (const auto& lives : matching.lives()) {
    for (const Life& life : lives) {
      if (life.push == nullptr) continue;
      changes.push_back({life.push->invoked - error, +1});
      if (life.pop != nullptr) changes.push_back({life.pop->returned + error, -1});
    }
  }
  std::ranges::sort(changes, [](const Change& a, const Change& b) {
    return a.at != b.at ? a.at < b.at : a.by > b.by;
  });
  // highest[l][i]: the largest possible content after changes i .. i + 2^l - 1.
  std::vector<std::vector<std::int64_t>> highest(1);
  std::int64_t content = 0;
  for (const Change& change : changes) highest[0].push_back(content += change.by);
  for (std::size_t span = 1; 2 * span <= changes.size(); span *= 2) {
    const auto& half = highest.back();
    std::vector<std::int64_t> level(changes.size() - 2 * span + 1);
    for (std::size_t i = 0; i < level.size(); ++i) level[i] = std::max(half[i], half[i + span]);
    highest.push_back(std::move(level));
  }
  const auto changes_before = [&changes](Stamp at) {
    return std::ranges::lower_bound(changes, at, {}, &Change::at) - changes.begin();
  };
  for (const auto& log : matching.history().logs) {
    for (const Operation& operation : log) {
      if (operation.kind != Kind::full) continue;
      // From the state in force when the call began to the last change before it returned.
      const auto first = changes_before(operation.invoked - error);
      const auto last = changes_before(operation.returned + error + 1);
      const auto from = static_cast<std::size_t>(std::max<std::ptrdiff_t>(first - 1, 0));
      const auto end = static_cast<std::size_t>(last);
      std::int64_t most = 0;
      if (end > from) {
        std::size_t level = 0;
        while ((std::size_t{2} << level) <= end - from) ++level;
        most = std::max(highest[level][from], highest[level][end - (std::size_t{1} << level)]);
      }
      if (most < static_cast<std::int64_t>(capacity)) {
        return Violation{Pattern::full,
                         fmt::format("push answered full although at most {} of {} places can "
                                     "have been taken",
                                     most, capacity),
                         {matching.culprit(operation)}};
      }
    }
  }
  return std::nullopt;
}

/// Counts by position, with prefix sums in O(log n) (Fenwick 1994).
class Counts {
 public:
  explicit Counts(std::size_t size) : tree_(size + 1, 0) {}
  void add(std::size_t position) {
    for (std::size_t i = position + 1; i < tree_.size(); i += i & (~i + 1)) ++tree_[i];
  }
  /// How many were added at positions below `end`.
  [[nodiscard]] std::uint64_t below(std::size_t end) const {
    std::uint64_t sum = 0;
    for (std::size_t i = end; i > 0; i -= i & (~i + 1)) sum += tree_[i];
    return sum;
  }

 private:
  std::vector<std::uint32_t> tree_;
};

Distances summarise(std::vector<std::uint64_t>& values) {
  if (values.empty()) return {};
  Distances d;
  for (const std::uint64_t v : values) d.mean += static_cast<double>(v);
  d.mean /= static_cast<double>(values.size());
  const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 99 / 100);
  std::ranges::nth_element(values, at);
  d.p99 = *at;
  d.max = *std::ranges::max_element(at, values.end());
  return d;
}

/// The share of lives with `begin` after the `end` of another one whose `begun` is later than their
/// own, both surely.
template <class Begin, class End, class Begun>
double share_passed(const std::vector<const Life*>& lives, Stamp slack, Begin begin, End end,
                    Begun begun) {
  if (lives.empty()) return 0;
  std::vector<const Life*> by_begin = lives, by_end = lives;
  std::ranges::sort(by_begin, {}, begin);
  std::ranges::sort(by_end, {}, end);
  auto before = by_end.begin();
  Stamp latest = 0;
  const auto passed = std::ranges::count_if(by_begin, [&](const Life* life) {
    for (; before != by_end.end() && end(*before) + slack < begin(life); ++before)
      latest = std::max(latest, begun(*before));
    return latest > begun(life) + slack;
  });
  return static_cast<double>(passed) / static_cast<double>(lives.size());
}

}  // namespace

std::vector<Violation> judge_real_time(const Matching& matching,
                                       const Specification& specification) {
  std::vector<Violation> found;
  find_fresh(matching, found);
  find_order(matching, found);
  if (specification.empty() == Answer::exact) find_witness(matching, found);
  if (specification.claims().bounded && specification.full() == Answer::exact) {
    if (auto full = find_full(matching, specification.capacity())) found.push_back(*full);
  }
  return found;
}

Relaxation measure_relaxation(const Matching& matching) {
  const Stamp slack = 2 * matching.history().error;
  std::vector<const Life*> by_push_end;
  for (PushesInOrder<&Operation::returned> pushes(matching); !pushes.done();) {
    by_push_end.push_back(&pushes.next());
  }
  std::vector<Stamp> pops_invoked;
  std::vector<Stamp> pops_returned;
  for (const Life* life : by_push_end) {
    pops_invoked.push_back(life->pop_invoked());
    pops_returned.push_back(life->pop_returned());
  }
  std::ranges::sort(pops_invoked);
  std::ranges::sort(pops_returned);
  const auto position = [](const std::vector<Stamp>& sorted, Stamp at) {
    return static_cast<std::size_t>(std::ranges::lower_bound(sorted, at) - sorted.begin());
  };

  Relaxation result;
  std::vector<std::uint64_t> ranks;
  std::vector<std::uint64_t> overtaken;
  const Life* worst = nullptr;
  std::uint64_t worst_rank = 0;

  // Rank of b: the a with push(a) before push(b) that left after b had left.
  Counts older(pops_invoked.size());
  std::uint64_t counted = 0;
  auto a = by_push_end.begin();
  for (PushesInOrder<&Operation::invoked> begun(matching); !begun.done();) {
    const Stamp began = begun.stamp();
    for (; a != by_push_end.end() && (*a)->push->returned + slack < began; ++a, ++counted) {
      older.add(position(pops_invoked, (*a)->pop_invoked()));
    }
    const Life& b = begun.next();
    if (b.pop == nullptr) continue;
    const std::size_t gone = position(pops_invoked, b.pop->returned + slack + 1);
    ranks.push_back(counted - older.below(gone));
    if (ranks.back() > worst_rank) {
      worst_rank = ranks.back();
      worst = &b;
    }
  }

  // The mirror image, from the youngest push to the oldest: the b that overtook a.
  std::vector<const Life*> by_push_begin;
  for (PushesInOrder<&Operation::invoked> pushes(matching); !pushes.done();) {
    by_push_begin.push_back(&pushes.next());
  }
  Counts younger(pops_returned.size());
  auto b = by_push_begin.rbegin();
  for (auto it = by_push_end.rbegin(); it != by_push_end.rend(); ++it) {
    const Life& life = **it;
    for (; b != by_push_begin.rend() && (*b)->push->invoked > life.push->returned + slack; ++b) {
      younger.add(position(pops_returned, (*b)->pop_returned()));
    }
    if (life.pop == nullptr) continue;
    const Stamp left = life.pop->invoked > slack ? life.pop->invoked - slack : 0;
    overtaken.push_back(younger.below(position(pops_returned, left)));
  }

  std::vector<const Life*> left;
  for (const Life* life : by_push_begin)
    if (life->pop != nullptr) left.push_back(life);
  const auto push_invoked = [](const Life* life) { return life->push->invoked; };
  const auto push_returned = [](const Life* life) { return life->push->returned; };
  const auto pop_invoked = [](const Life* life) { return life->pop->invoked; };
  const auto pop_returned = [](const Life* life) { return life->pop->returned; };
  result.pushes_overtaken = share_passed(left, slack, pop_invoked, pop_returned, push_invoked);
  result.pops_overtaken = share_passed(left, slack, push_invoked, push_returned, pop_invoked);

  result.rank_error = summarise(ranks);
  result.overtaken = summarise(overtaken);
  if (worst != nullptr) {
    result.worst = Violation{Pattern::rank,
                             fmt::format("{} left while {} older elements were inside",
                                         element_name(worst->push->value), worst_rank),
                             {matching.culprit(*worst->push), matching.culprit(*worst->pop)}};
  }
  return result;
}

History distinct(std::vector<std::vector<Operation>> logs, Stamp error) {
  std::vector<Operation*> pushes, pops;
  for (auto& log : logs)
    for (Operation& operation : log)
      (operation.kind == Kind::push ? pushes : pops).push_back(&operation);
  // A word is in one place at a time: its n-th pop took what its n-th push brought. Its pushes
  // begin in their order, its pops end in theirs; a pop may have begun long before.
  std::ranges::sort(pushes, {}, [](const Operation* o) { return std::pair(o->value, o->invoked); });
  std::ranges::sort(pops, {}, [](const Operation* o) { return std::pair(o->value, o->returned); });
  std::vector<std::pair<const Operation*, Operation*>> lives;
  auto pop = pops.begin();
  for (const Operation* push : pushes) {
    while (pop != pops.end() && (*pop)->value < push->value) ++pop;
    if (pop != pops.end() && (*pop)->value == push->value) lives.emplace_back(push, *pop++);
  }
  for (unsigned producer = 0; producer < logs.size(); ++producer) {
    std::uint64_t sequence = 0;
    for (Operation& operation : logs[producer])
      if (operation.kind == Kind::push) operation.value = element(producer, sequence++);
  }
  for (const auto& [push, its_pop] : lives) its_pop->value = push->value;
  return {.logs = std::move(logs), .drain = {}, .emptied = false, .error = error};
}

}  // namespace irt::stress
