#include "stress/history/orders.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "stress/history/closing.hpp"

namespace irt::stress {
namespace {

constexpr std::size_t nobody = ~std::size_t{0};
constexpr std::uint64_t any_number = ~std::uint64_t{0};

/// Which call pushed an element and which took it: `nobody`, which all calls precede, where it is
/// still inside.
struct Fate {
  std::size_t push = nobody;
  std::size_t pop = nobody;
};
using Fates = std::unordered_map<Element, Fate>;

/// The call that shows where an element is in the end.
std::size_t last_of(const Fate& fate) {
  return fate.pop == nobody ? fate.push : fate.pop;
}

bool has_effect(const Call& call, Kind kind) {
  return call.kind == kind && !call.no_effect;
}

Fates fates_of(const Calls& calls) {
  Fates fates;
  for (std::size_t i = 0; i < calls.all().size(); ++i) {
    const Call& call = calls.all()[i];
    if (has_effect(call, Kind::push)) fates[call.value].push = i;
  }
  for (std::size_t i = 0; i < calls.all().size(); ++i) {
    const Call& call = calls.all()[i];
    if (has_effect(call, Kind::pop)) fates[call.value].pop = i;
  }
  return fates;
}

/// What every queue owes: what comes out was put in, once, before, for this worker if each has a
/// queue of its own, and nothing stays behind where the queue was emptied.
std::optional<Breach> judge_elements(const Calls& calls, const Claims& claims) {
  const std::vector<Call>& all = calls.all();
  Fates fates;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (has_effect(all[i], Kind::push)) fates[all[i].value].push = i;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!has_effect(all[i], Kind::pop)) continue;
    Fate& fate = fates[all[i].value];
    if (fate.push == nobody) return Breach{Pattern::fresh, {i}};
    if (fate.pop != nobody) return Breach{Pattern::repeat, {i, fate.pop, fate.push}};
    fate.pop = i;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!has_effect(all[i], Kind::push)) continue;
    const std::size_t pop = fates[all[i].value].pop;
    if (pop == nobody && calls.emptied()) return Breach{Pattern::lost, {i}};
    if (pop == nobody) continue;
    if (calls.precedes(pop, i)) return Breach{Pattern::fresh, {pop, i}};
    if (claims.own_queues() && all[pop].worker != all[i].worker)
      return Breach{Pattern::fresh, {pop, i}};
  }
  return std::nullopt;
}

/// Two elements of which one was pushed first and left last; of one producer, or of any.
std::optional<Breach> judge_pairs(const Calls& calls, const Fates& fates, bool same_producer) {
  const std::vector<Call>& all = calls.all();
  for (std::size_t a = 0; a < all.size(); ++a) {
    if (!has_effect(all[a], Kind::push)) continue;
    const Fate& first = fates.at(all[a].value);
    for (std::size_t b = a + 1; b < all.size(); ++b) {
      if (!has_effect(all[b], Kind::push)) continue;
      if (same_producer && all[a].worker != all[b].worker) continue;
      const std::size_t second = fates.at(all[b].value).pop;
      if (calls.precedes(a, b) && calls.precedes(second, first.pop))
        return Breach{Pattern::order, {second, last_of(first), b, a}};
    }
  }
  return std::nullopt;
}

/// The answers that do not ask for the state of the queue at one moment: what surrounds each of
/// them says whether it is right.
class Answers {
 public:
  Answers(const Calls& calls, const Fates& fates, const Specification& specification)
      : calls_(calls), fates_(fates), specification_(specification) {}

  [[nodiscard]] std::optional<Breach> judge() const {
    for (std::size_t i = 0; i < calls_.all().size(); ++i) {
      const Call& call = calls_.all()[i];
      if (call.no_effect) continue;
      if (call.kind == Kind::full && !allows_full(i)) return Breach{Pattern::full, {i}};
      if (call.kind != Kind::empty || specification_.empty() == Answer::exact) continue;
      if (auto breach = judge_empty(i)) return breach;
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] bool in_flight_during(std::size_t a, std::size_t b) const {
    return a != b && !calls_.precedes(a, b) && !calls_.precedes(b, a);
  }

  [[nodiscard]] InFlight around(std::size_t at) const {
    InFlight around;
    std::set<unsigned> refused;
    for (std::size_t i = 0; i < calls_.all().size(); ++i) {
      if (!in_flight_during(i, at)) continue;
      const Call& call = calls_.all()[i];
      if (call.kind == Kind::push) ++around.pushes;
      // What found no memory may have held a place, or an element, until it noticed.
      if (call.kind == Kind::pop || (call.kind == Kind::empty && call.no_effect)) ++around.pops;
      if (call.kind == Kind::full) refused.insert(call.worker);
      if (call.kind == Kind::full && call.no_effect) ++around.pushes;
    }
    around.refused = refused.size();
    return around;
  }

  // With the most elements that can have been inside. An exact answer has to pass the search, too.
  [[nodiscard]] bool allows_full(std::size_t at) const {
    std::uint64_t inside = 0;
    for (std::size_t i = 0; i < calls_.all().size(); ++i) {
      const Call& call = calls_.all()[i];
      if (has_effect(call, Kind::push) && !calls_.precedes(at, i)) ++inside;
      if (has_effect(call, Kind::pop) && calls_.precedes(i, at)) --inside;
    }
    return specification_.allows_full(inside, around(at));
  }

  [[nodiscard]] std::optional<Breach> judge_empty(std::size_t at) const {
    InFlight in_flight = around(at);
    for (const auto& [value, fate] : fates_) {
      if (!calls_.precedes(fate.push, at) || !calls_.precedes(at, fate.pop)) continue;
      in_flight.doubtful_empty = false;
      for (std::size_t i = 0; i < calls_.all().size(); ++i)
        if (calls_.all()[i].kind == Kind::empty && in_flight_during(i, at) &&
            !(calls_.precedes(fate.push, i) && calls_.precedes(i, fate.pop)))
          in_flight.doubtful_empty = true;
      if (!specification_.allows_empty(in_flight, found_again(at, fate.pop)))
        return Breach{Pattern::witness, {at, fate.push, last_of(fate)}};
    }
    return std::nullopt;
  }

  [[nodiscard]] bool found_again(std::size_t at, std::size_t pop) const {
    const unsigned worker = calls_.all()[at].worker;
    if (pop == nobody || calls_.all()[pop].worker != worker) return false;
    for (std::size_t i = 0; i < calls_.all().size(); ++i)
      if (calls_.all()[i].worker != worker && !calls_.precedes(i, at) && !calls_.precedes(pop, i))
        return false;
    return true;
  }

  const Calls& calls_;
  const Fates& fates_;
  const Specification& specification_;
};

/// Depth-first search for an order, with the states seen (Lowe 2017).
class Search {
 public:
  Search(const Calls& calls, const Specification& specification, std::size_t most_states)
      : calls_(calls), specification_(specification), most_states_(most_states) {}

  /// Whether there is an order in which the answers that refuse are true, as far as `judged` has
  /// them.
  bool exists(std::vector<bool> judged) {
    judged_ = std::move(judged);
    seen_.clear();
    held_.clear();
    done_.assign((calls_.end() - calls_.begin() + 63) / 64, 0);
    left_ = calls_.end() - calls_.begin();
    for (std::size_t i = 0; i < calls_.begin(); ++i)
      if (!apply(i)) return false;
    return go();
  }

  /// Whether every search came to its end.
  [[nodiscard]] bool decided() const { return decided_; }

 private:
  bool go() {
    if (left_ == 0) return ends();
    if (!seen_.insert(state()).second) return false;
    if (seen_.size() > most_states_) {
      decided_ = false;
      return true;
    }
    for (std::size_t i = 0; i < calls_.end() - calls_.begin(); ++i) {
      if (!is_next(i)) continue;
      std::vector<Element> saved = held_;
      if (apply(calls_.begin() + i)) {
        done_[i / 64] ^= std::uint64_t{1} << i % 64;
        --left_;
        if (go()) return true;
        ++left_;
        done_[i / 64] ^= std::uint64_t{1} << i % 64;
      }
      held_ = std::move(saved);
    }
    return false;
  }

  [[nodiscard]] bool is_next(std::size_t i) const {
    if ((done_[i / 64] >> i % 64 & 1) != 0) return false;
    const std::vector<std::uint64_t>& past = calls_.past(i);
    for (std::size_t word = 0; word < past.size(); ++word)
      if ((past[word] & ~done_[word]) != 0) return false;
    return true;
  }

  bool ends() {
    const std::vector<Element> saved = held_;
    bool allowed = true;
    for (std::size_t i = calls_.end(); allowed && i < calls_.all().size(); ++i) allowed = apply(i);
    held_ = saved;
    return allowed;
  }

  // Whether the specification allows the call now; if so, makes it.
  bool apply(std::size_t number) {
    const Call& call = calls_.all()[number];
    if (call.no_effect) return true;
    const bool judged = judged_[number];
    switch (call.kind) {
      case Kind::push:
        // Where any may leave, states that hold the same are the same.
        held_.insert(specification_.overtakes() == any_number
                         ? std::ranges::upper_bound(held_, call.value)
                         : held_.end(),
                     call.value);
        return true;
      case Kind::full:
        return !judged || specification_.full() != Answer::exact ||
               specification_.allows_full(held_.size(), {});
      case Kind::empty:
        return !judged || specification_.empty() != Answer::exact || held_.empty();
      case Kind::pop: {
        const auto found = std::ranges::find(held_, call.value);
        if (found == held_.end()) return false;
        if (static_cast<std::uint64_t>(found - held_.begin()) > specification_.overtakes())
          return false;
        held_.erase(found);
        return true;
      }
      case Kind::closed:
      case Kind::timed_out:
      case Kind::close:
      case Kind::leave:
      case Kind::meet:
        break;
    }
    return true;
  }

  [[nodiscard]] std::string state() const {
    std::string text(reinterpret_cast<const char*>(done_.data()), done_.size() * sizeof done_[0]);
    text.append(reinterpret_cast<const char*>(held_.data()), held_.size() * sizeof held_[0]);
    return text;
  }

  const Calls& calls_;
  const Specification& specification_;
  std::size_t most_states_;
  std::vector<bool> judged_;
  std::vector<Element> held_;
  std::vector<std::uint64_t> done_;
  std::size_t left_ = 0;
  std::unordered_set<std::string> seen_;
  bool decided_ = true;
};

Judgement judge_orders(const Calls& calls, const Fates& fates, const Specification& specification,
                       std::size_t most_states) {
  std::vector<std::size_t> exact;
  for (std::size_t i = 0; i < calls.all().size(); ++i) {
    const Call& call = calls.all()[i];
    if (call.no_effect) continue;
    if ((call.kind == Kind::full && specification.full() == Answer::exact) ||
        (call.kind == Kind::empty && specification.empty() == Answer::exact))
      exact.push_back(i);
  }
  if (specification.overtakes() == any_number && exact.empty()) return {};
  Search search(calls, specification, most_states);
  const auto true_at_once = [&](auto judged) {
    std::vector<bool> some(calls.all().size(), false);
    for (const std::size_t answer : exact) some[answer] = judged(answer);
    return search.exists(std::move(some));
  };
  const auto of_kind = [&](Kind kind) {
    return true_at_once([&](std::size_t i) { return calls.all()[i].kind == kind; });
  };
  // Happens-before alone gives *full* and *empty* no common moment: see specification.hpp.
  const bool apart = specification.claims().ordering == Ordering::fifo_happens_before &&
                     std::ranges::any_of(exact, [&calls](std::size_t i) {
                       return calls.all()[i].kind == Kind::full;
                     });
  const auto pairs_are_right = [&] {
    for (const std::size_t a : exact)
      for (const std::size_t b : exact)
        if (calls.precedes(a, b) && calls.all()[a].kind != calls.all()[b].kind &&
            !true_at_once([a, b](std::size_t i) { return i == a || i == b; }))
          return false;
    return true;
  };
  const bool right = apart ? of_kind(Kind::full) && of_kind(Kind::empty) && pairs_are_right()
                           : true_at_once([](std::size_t) { return true; });
  if (right) return {std::nullopt, search.decided()};
  // Which answer is it?
  if (!true_at_once([](std::size_t) { return false; })) {
    auto pair = specification.fifo() ? judge_pairs(calls, fates, false) : std::nullopt;
    return {pair ? pair : Breach{specification.fifo() ? Pattern::order : Pattern::rank, {}}};
  }
  for (const std::size_t answer : exact) {
    if (true_at_once([answer](std::size_t i) { return i == answer; })) continue;
    Breach breach{Pattern::full, {answer}};
    if (calls.all()[answer].kind == Kind::empty) {
      breach.pattern = Pattern::witness;
      for (const auto& [value, fate] : fates) {
        if (!calls.precedes(fate.push, answer) || !calls.precedes(answer, fate.pop)) continue;
        breach.calls = {answer, fate.push, last_of(fate)};
        break;
      }
    }
    return {breach};
  }
  return {Breach{Pattern::witness, {}}};
}

}  // namespace

Calls::Calls(std::vector<Call> calls, std::size_t before, std::size_t after)
    : calls_(std::move(calls)), before_(before), after_(after) {
  past_.resize(end() - begin(), std::vector<std::uint64_t>((end() - begin() + 63) / 64, 0));
}

bool Calls::precedes(std::size_t a, std::size_t b) const {
  const bool a_in_the_middle = a >= begin() && a < end();
  const bool b_in_the_middle = b >= begin() && b < end();
  if (!a_in_the_middle || !b_in_the_middle) return a < b;
  return (past_[b - before_][(a - before_) / 64] >> (a - before_) % 64 & 1) != 0;
}

namespace {

Judgement judge_one_queue(const Calls& calls, const Specification& specification,
                          std::size_t most_states) {
  const Fates fates = fates_of(calls);
  if (specification.claims().ordering == Ordering::per_producer_fifo)
    if (auto breach = judge_pairs(calls, fates, true)) return {breach};
  if (auto breach = Answers(calls, fates, specification).judge()) return {breach};
  return judge_orders(calls, fates, specification, most_states);
}

/// Only the calls of `worker`, and their numbers among all.
std::pair<Calls, std::vector<std::size_t>> calls_of(unsigned worker, const Calls& calls) {
  std::vector<Call> own;
  std::vector<std::size_t> numbers;
  std::size_t before = 0;
  std::size_t after = 0;
  for (std::size_t i = 0; i < calls.all().size(); ++i) {
    if (calls.all()[i].worker != worker) continue;
    own.push_back(calls.all()[i]);
    numbers.push_back(i);
    before += i < calls.begin() ? 1 : 0;
    after += i >= calls.end() ? 1 : 0;
  }
  Calls result(std::move(own), before, after);
  for (std::size_t a = result.begin(); a < result.end(); ++a)
    for (std::size_t b = a + 1; b < result.end(); ++b)
      if (calls.precedes(numbers[a], numbers[b])) result.order(a, b);
  return {std::move(result), std::move(numbers)};
}

}  // namespace

Judgement judge_in_every_order(const Calls& all_calls, const Specification& specification,
                               std::size_t most_states) {
  if (auto breach = judge_closing(all_calls, specification)) return {breach};
  const Calls calls = without_closing(all_calls);
  if (auto breach = judge_elements(calls, specification.claims())) return {breach};
  if (!specification.claims().own_queues())
    return judge_one_queue(calls, specification, most_states);
  std::set<unsigned> workers;
  for (const Call& call : calls.all()) workers.insert(call.worker);
  bool decided = true;
  for (const unsigned worker : workers) {
    const auto [own, numbers] = calls_of(worker, calls);
    Judgement judgement = judge_one_queue(own, specification, most_states);
    decided = decided && judgement.decided;
    if (!judgement.breach) continue;
    for (std::size_t& call : judgement.breach->calls) call = numbers[call];
    return judgement;
  }
  return {std::nullopt, decided};
}

}  // namespace irt::stress
