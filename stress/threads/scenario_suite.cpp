#include <algorithm>
#include <array>
#include <chrono>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include "stress/history/judge.hpp"
#include "stress/threads/call.hpp"
#include "stress/threads/complement.hpp"
#include "stress/threads/interrupter.hpp"
#include "stress/threads/sanitizer.hpp"
#include "stress/threads/signals.hpp"
#include "stress/threads/suites.hpp"
#include "stress/threads/thread_core.hpp"
#include "stress/threads/watchdog.hpp"

namespace irt::stress {
namespace {

using Clock = std::chrono::steady_clock;

/// How many elements have gone through the queue, one by one, before a round starts: mostly none,
/// else so many that counters of 8 or 16 bits wrap while it lasts.
std::uint64_t round_age(std::uint64_t dice) {
  const std::uint64_t before = dice / 64 % 12;
  if (dice % 64 < 8) return (1U << 8) - before;
  // Growing so old takes as long as some hundred rounds.
  if (dice % 64 == 8 && sanitizer == Sanitizer::none) return (1U << 16) - before;
  return 0;
}

/// The capacity of a round: every second time the scenario's own, else a small one or one that is
/// no power of two, by whose remainder a counter that wraps gives itself away.
std::size_t round_capacity(std::uint64_t dice, std::size_t own) {
  constexpr std::array<std::size_t, 8> others{1, 2, 3, 5, 3, 7, 20, 100};
  return dice % 2 == 0 ? own : others.at(dice / 2 % others.size());
}

/// How many operations each thread of a round makes: mostly few, from a common start, because most
/// bugs need few; sometimes many, for what must wrap, grow or be reclaimed first. In time, each
/// kind has about a third.
std::uint64_t round_size(std::uint64_t dice, unsigned workers) {
  const std::uint64_t slow = sanitizer == Sanitizer::none ? 1 : 4;
  const std::uint64_t size = dice / 64;
  switch (dice % 64) {
    case 0:
      return (workers > 6 ? 4'000 : 20'000) / slow;
    case 1:
    case 2:
    case 3:
    case 4:
    case 5:
    case 6:
    case 7:
    case 8:
      return (200 + size % 1'800) / slow;
    default:
      return size % 3 == 0 ? 2 + size / 3 % 4 : 4 + size / 3 % 28;
  }
}

/// What is drawn for one round.
struct Round {
  std::size_t capacity = 0;
  std::uint64_t age = 0;      ///< elements that go through the queue before
  Claims claims{};            ///< as the workers see them
  bool complemented = false;  ///< complements are pushed
  WordQueueMaker make_queue = nullptr;
  std::string_view element_kind{};  ///< what the words go through; empty: nothing
};

class ScenarioRunner {
 public:
  ScenarioRunner(const Assignment& assignment, const Scenario& scenario, Messenger& messenger)
      : assignment_(assignment),
        scenario_(scenario),
        roles_(roles_for(scenario, assignment.queue.claims)),
        slots_(roles_.workers + 1),
        states_(roles_.workers),
        watchdog_(slots_, hang_patience(), messenger),
        team_(roles_.workers, slots_.data()),
        interrupter_(slots_, assignment.seed) {}

  ~ScenarioRunner() = default;
  ScenarioRunner(const ScenarioRunner&) = delete;
  ScenarioRunner& operator=(const ScenarioRunner&) = delete;

  /// One round; the finding, if a claim broke.
  std::optional<BrokenClaim> round(std::uint64_t number) {
    const std::uint64_t seed = mix_seed(assignment_.seed, number);
    const Perturbation perturbation = Perturbation::draw(seed >> 8);
    prepare(seed);
    History history;
    std::optional<BrokenClaim> finding;
    Slot& own_slot = slots_.back();
    const auto bump = [&] {
      own_slot.done.store(own_slot.done.load(std::memory_order_relaxed) + 1,
                          std::memory_order_relaxed);
    };
    {
      const Presence presence(own_slot);
      bump();
      const auto queue = make_(roles_.workers, round_.capacity);
      interrupter_.set_active(perturbation.stalls);
      try {
        if (round_.age > 0) age(*queue);
        leave_all(*queue, roles_.workers);
        run_team(*queue, perturbation, seed);
        interrupter_.set_active(false);
        history.emptied = !scenario_.leaves_inside;
        if (scenario_.drains) drain(*queue, history.drain);
        leave_all(*queue, roles_.workers);
      } catch (const std::exception& error) {
        finding =
            BrokenClaim{.claim = "keeps its contract", .evidence = error.what(), .repeat = {}};
      }
      interrupter_.set_active(false);
      bump();
    }
    for (WorkerState& state : states_) history.logs.push_back(std::move(state.log));
    history.error = assignment_.clock.error;
    if (!finding) finding = judge_history(history);
    if (!finding) finding = judge_payloads();
    bump();
    if (finding) {
      finding->evidence +=
          fmt::format("in round {} of {} threads with {} operations each, capacity {}, {}{}\n",
                      number, roles_.workers, states_[0].operations, round_.capacity,
                      round_.age > 0 ? fmt::format("after {} elements, ", round_.age) : "",
                      perturbation.describe());
      if (round_.complemented)
        finding->evidence += "what was pushed were the complements of the elements\n";
      if (!round_.element_kind.empty())
        finding->evidence += fmt::format("the queue was one of elements {}\n", round_.element_kind);
      finding->repeat = assignment_.repeat;
    }
    return finding;
  }

  [[nodiscard]] const Verdict& sums() const { return sums_; }

 private:
  void prepare(std::uint64_t seed) {
    round_ = {.capacity = round_capacity(mix_seed(seed, 101), scenario_.capacity),
              .age = round_age(mix_seed(seed, 102)),
              .claims = assignment_.queue.claims,
              .make_queue = assignment_.queue.make_word_queue};
    if (mix_seed(seed, 103) % 8 == 0) {
      if (const auto seen = Complement(round_.claims).seen(round_.claims)) {
        round_.claims = *seen;
        round_.complemented = true;
      }
    }
    draw_elements(mix_seed(seed, 104));
    // A thread that only comes and goes shows nothing.
    const std::uint64_t size = round_size(seed >> 32, roles_.workers);
    const std::uint64_t operations =
        std::max(std::min<std::uint64_t>(size, 32), size / scenario_.generations);
    for (unsigned worker = 0; worker < roles_.workers; ++worker) {
      WorkerState& state = states_[worker] = state_of(roles_, worker);
      state.capacity = round_.capacity;
      state.claims = round_.claims;
      state.random = SplitMix(mix_seed(seed, worker));
      state.operations = operations;
      state.payloads = &payloads_;
      state.log.reserve(state.log_size(scenario_.generations));
    }
    payloads_.prepare(roles_.workers, states_[0].log_size(scenario_.generations), seed);
  }

  /// One round in four is of elements that are no words, if the queue claims to take any.
  void draw_elements(std::uint64_t dice) {
    if (dice % 4 != 0 || scenario_.needs.bulk) return;
    const auto kinds = element_kinds(assignment_.queue);
    const ElementKind& kind = kinds.at(dice / 4 % kinds.size());
    if (kind.make_queue == nullptr) return;
    round_.make_queue = kind.make_queue;
    round_.element_kind = kind.words;
  }

  /// Sends elements through the queue, each alone in it. None is left inside when it returns.
  void age(ElementQueue& queue) {
    const bool own = assignment_.queue.claims.own_queues();
    for (std::uint64_t i = 0, sequence = 0; i < round_.age; ++i, ++sequence) {
      const auto pusher = static_cast<unsigned>(i % roles_.producers);
      const Element pushed = next_element(round_.claims, pusher, sequence);
      const bool accepted = [&] {
        const Call call(slots_.back(), Doing::push);
        return queue.push(pusher, pushed);
      }();
      Element popped = no_element;
      bool found = false;
      for (unsigned p = 0; accepted && !found && p < (own ? 1 : roles_.consumers); ++p) {
        const auto popper = roles_.workers - 1 - static_cast<unsigned>((i + p) % roles_.consumers);
        const Call call(slots_.back(), Doing::pop);
        found = queue.pop(own ? pusher : popper, popped);
      }
      // Others may not see what the pusher has.
      if (accepted && !found && assignment_.queue.claims.empty == Answer::this_worker) {
        const Call call(slots_.back(), Doing::pop);
        found = queue.pop(pusher, popped);
      }
      if (!accepted)
        throw Complaint(
            fmt::format("push number {} answered full, alone with an empty queue\n", i));
      if (!found || popped != pushed)
        throw Complaint(
            fmt::format("element number {}, alone in the queue, did not come out\n", i));
    }
  }

  void run_team(ElementQueue& queue, const Perturbation& perturbation, std::uint64_t seed) {
    Gate gate(roles_.workers);
    // Where others load the machine, threads that wait for each other get slow: many rounds find
    // more than one long one.
    const double budget = std::min(0.5, assignment_.seconds / 8) * 1e9;  // nanoseconds
    const Stamp deadline =
        stamp_after() + static_cast<Stamp>(budget * assignment_.clock.ticks_per_nanosecond);
    const auto one_thread = [&](unsigned worker, unsigned generation) {
      ThreadCore core(states_[worker], queue, make_, slots_[worker], gate, perturbation,
                      seed + worker + 1000 * generation, deadline);
      try {
        scenario_.run(core);
        if (assignment_.queue.methods.leave) core.leave_queue();
      } catch (...) {
        gate.abandon();
        slots_[worker].doing.store(Doing::nothing, std::memory_order_relaxed);
        throw;
      }
    };
    team_.run([&](unsigned worker) {
      if (scenario_.generations == 1) {
        one_thread(worker, 0);
        return;
      }
      for (unsigned generation = 0; generation < scenario_.generations; ++generation) {
        std::exception_ptr failure;
        std::thread([&] {
          Slot*& slot = current_slot();
          const pid_t owner = slots_[worker].thread.load(std::memory_order_relaxed);
          {
            const Presence presence(slots_[worker]);
            try {
              one_thread(worker, generation);
            } catch (...) {
              failure = std::current_exception();
            }
          }
          slot = nullptr;
          slots_[worker].thread.store(owner, std::memory_order_relaxed);
        }).join();
        if (failure) std::rethrow_exception(failure);
      }
    });
  }

  /// Takes out what is left, on behalf of every worker that may pop, until all of them find
  /// nothing.
  void drain(ElementQueue& queue, std::vector<Operation>& log) {
    std::uint64_t limit = 1'000;
    for (const WorkerState& state : states_) limit += state.next_sequence;
    Gate gate(1);
    for (bool found = true; found;) {
      found = false;
      for (unsigned worker = 0; worker < roles_.workers; ++worker) {
        if (!roles_.pops(worker)) continue;
        WorkerState state{.worker = worker, .operations = 0, .log = std::move(log)};
        ThreadCore core(state, queue, make_, slots_.back(), gate, {}, 0);
        while (state.log.size() < limit && core.pop()) found = true;
        log = std::move(state.log);
      }
      if (log.size() >= limit) return;  // a queue that returns elements for ever: see the repeats
    }
  }

  std::optional<BrokenClaim> judge_history(const History& history) {
    const Verdict verdict = judge(history, assignment_.queue.claims, round_.capacity);
    sums_.empties += verdict.empties;
    sums_.fulls += verdict.fulls;
    sums_.refuted_empties += verdict.refuted_empties;
    if (verdict.relaxation) {
      if (!sums_.relaxation ||
          verdict.relaxation->rank_error.max > sums_.relaxation->rank_error.max) {
        sums_.relaxation = verdict.relaxation;
      }
    }
    if (verdict.violations.empty()) return std::nullopt;
    BrokenClaim finding;
    finding.claim = promise(verdict.violations[0].pattern);
    for (const Violation& violation : verdict.violations) {
      finding.evidence += explain(violation, assignment_.clock.ticks_per_nanosecond);
    }
    return finding;
  }

  /// Where the processor, not ThreadSanitizer, shows what is not published.
  [[nodiscard]] std::optional<BrokenClaim> judge_payloads() const {
    for (const WorkerState& state : states_) {
      if (state.unpublished == no_element) continue;
      return BrokenClaim{
          .claim = "what was done before a push is seen after the pop of its element",
          .evidence = fmt::format("worker {} popped {} and did not see what worker {} had written "
                                  "before it pushed that\n",
                                  state.worker, element_name(state.unpublished),
                                  producer_of(state.unpublished)),
          .repeat = {}};
    }
    return std::nullopt;
  }

  const Assignment& assignment_;
  const Scenario& scenario_;
  Roles roles_;
  QueueMaker make_ = [this](unsigned workers, std::size_t capacity) {
    auto queue = round_.make_queue(workers, capacity);
    if (!round_.complemented) return queue;
    const Complement complement(assignment_.queue.claims);
    return std::unique_ptr<ElementQueue>(new ComplementQueue(std::move(queue), complement));
  };
  Payloads payloads_;
  std::vector<Slot> slots_;  ///< one per worker, and one for the thread that drives the rounds
  std::vector<WorkerState> states_;
  Round round_{};
  Verdict sums_;
  Watchdog watchdog_;
  Team team_;
  Interrupter interrupter_;
};

void tell_figures(const Verdict& sums, Messenger& messenger) {
  messenger.figure("empties", sums.empties);
  messenger.figure("fulls", sums.fulls);
  if (sums.refuted_empties > 0) {
    messenger.figure("refuted_empties", sums.refuted_empties);
    messenger.note(fmt::format(
        "{} of {} empties are refuted by happens-before, and excused by what the queue claims",
        sums.refuted_empties, sums.empties));
  }
  if (!sums.relaxation) return;
  const Relaxation& r = *sums.relaxation;
  messenger.figure(
      "rank_error",
      {{"mean", r.rank_error.mean}, {"p99", r.rank_error.p99}, {"max", r.rank_error.max}});
  messenger.figure(
      "overtaken",
      {{"mean", r.overtaken.mean}, {"p99", r.overtaken.p99}, {"max", r.overtaken.max}});
  if (r.rank_error.max > 0) {
    messenger.note(fmt::format(
        "most relaxed round: rank error mean {:.2f}, p99 {}, max {}; overtaken mean {:.2f}, p99 "
        "{}, max {}",
        r.rank_error.mean, r.rank_error.p99, r.rank_error.max, r.overtaken.mean, r.overtaken.p99,
        r.overtaken.max));
  }
}

}  // namespace

void run_scenario(const Assignment& assignment, const Scenario& scenario, Messenger& messenger) {
  install_signals();
  const auto start = Clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  std::uint64_t rounds = 0;
  ScenarioRunner runner(assignment, scenario, messenger);
  for (; passed() < assignment.seconds; ++rounds) {
    if (std::optional<BrokenClaim> finding = runner.round(rounds)) {
      finding->seconds = passed();
      messenger.finding(*finding);
      break;
    }
  }
  messenger.figure("rounds", rounds);
  tell_figures(runner.sums(), messenger);
  if (const std::uint64_t fences = fences_executed(); fences > 0) {
    messenger.figure("fences", fences);
    messenger.limit(fmt::format(
        "{} times std::atomic_thread_fence, which ThreadSanitizer does not understand: silence "
        "proves less, and a report is looked at twice",
        fences));
  }
}

}  // namespace irt::stress
