#include "stress/checker/scenario_client.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <fmt/format.h>

#include "stress/checker/publication.hpp"
#include "stress/history/judge.hpp"

namespace irt::checker {

using stress::Element;
using stress::Kind;
using stress::Stamp;
using stress::state_of;
using stress::WorkerState;

// --- The core ---------------------------------------------------------------------------------

Stamp VirtualCore::stamp() {
  // 0 where the threads do not run.
  const std::uint64_t tick = run_.clocked ? Execution::current_execution()->kernel().tick() : 0;
  return run_.now = std::max(tick, run_.now + 1);
}

irt::Deadline VirtualCore::now() {
  return irt::Deadline(std::chrono::nanoseconds(Execution::current_execution()->kernel().time()));
}

Stamp VirtualCore::enter(Kind kind) {
  const Execution& execution = *Execution::current_execution();
  const Stamp now = stamp();
  call_ = run_.calls.size();
  const unsigned thread = execution.state().current();
  run_.calls.push_back({.kind = kind,
                        .thread = thread,
                        .worker = state_.worker,
                        .entry = state_.log.size(),
                        .called = execution.clock_of(thread),
                        .first_step = execution.steps().size()});
  return now;
}

Stamp VirtualCore::leave() {
  const Execution& execution = *Execution::current_execution();
  CallPlace& call = run_.calls[call_];
  call.finished = true;
  call.returned =
      static_cast<std::uint16_t>(execution.clock_of(call.thread).count[call.thread] + 1);
  call.last_step = execution.steps().size();
  return stamp();
}

void VirtualCore::write_payload(Element e) {
  const Execution& execution = *Execution::current_execution();
  std::vector<std::uint16_t>& after = run_.pushed_after[state_.worker];
  after.resize(std::max<std::size_t>(after.size(), stress::sequence_of(e) + 1));
  after[stress::sequence_of(e)] = execution.clock_of(state_.worker).count[state_.worker];
}

bool VirtualCore::sees_payload(Element e) {
  const unsigned producer = stress::producer_of(e);
  // What nobody pushed is for the oracles to judge.
  if (producer >= run_.pushed_after.size()) return true;
  const std::vector<std::uint16_t>& after = run_.pushed_after[producer];
  if (stress::sequence_of(e) >= after.size()) return true;
  const std::uint16_t called = after[stress::sequence_of(e)];
  if (!sees_what_precedes(producer, called))
    report_unpublished(stress::element_name(e), producer, called);
  return true;
}

void VirtualCore::wait_for_all() {
  Execution::current_execution()->kernel().meet(run_.workers);
}

// --- The client -------------------------------------------------------------------------------

namespace {

/// Most bugs need few operations, and each of them makes an execution longer.
std::uint64_t few_operations(SplitMix& random) {
  return random.below(4) == 0 ? 8 + random.below(16) : 2 + random.below(6);
}

std::size_t small_capacity(SplitMix& random, std::size_t own) {
  constexpr std::array<std::size_t, 6> others{1, 2, 3, 5, 2, 7};
  return random.below(4) == 0 ? own : others.at(random.below(others.size()));
}

/// The roles that fit, with the thread that prepares, into one execution.
Roles few_roles(const stress::Scenario& scenario, Claims claims) {
  if (claims.allows_workers(max_threads)) claims.max_workers = max_threads - 1;
  return roles_for(scenario, claims);
}

/// What can be judged without a clock.
Claims unclocked(Claims claims) {
  if (claims.ordering == Ordering::fifo_real_time) claims.ordering = Ordering::fifo_happens_before;
  if (claims.ordering == Ordering::k_relaxed_fifo) claims.ordering = Ordering::unordered;
  return claims;
}

}  // namespace

ScenarioClient::ScenarioClient(const QueueEntry& entry, const stress::Scenario& scenario,
                               std::uint64_t seed, std::size_t capacity,
                               std::optional<bool> real_time, virtual_cores::Module* module)
    : entry_(entry),
      scenario_(scenario),
      seed_(seed),
      capacity_(capacity),
      claims_(entry.claims),
      roles_(few_roles(scenario, entry.claims)) {
  SplitMix random(SplitMix::mixed(seed));
  operations_ = few_operations(random);
  const std::size_t drawn = small_capacity(random, scenario.capacity);
  if (capacity_ == 0) capacity_ = drawn;
  const bool by_clock =
      claims_.ordering == Ordering::fifo_real_time || claims_.ordering == Ordering::k_relaxed_fifo;
  const bool drawn_clock = random.below(2) == 0;
  run_.clocked = by_clock && real_time.value_or(drawn_clock);
  if (!run_.clocked) claims_ = unclocked(claims_);
  run_.entry = &entry_;
  run_.workers = roles_.workers;
  states_.resize(roles_.workers);
  program_.module = module;
  program_.prepare = [this] { prepare(); };
  for (unsigned worker = 0; worker < roles_.workers; ++worker)
    program_.threads.emplace_back([this, worker] { run(worker); });
  program_.finish = [this] { finish(); };
  program_.judge = [this](const Execution&) { return judge(); };
}

void ScenarioClient::prepare() {
  run_.now = 0;
  run_.calls.clear();
  run_.pushed_after.assign(roles_.workers, {});
  drain_.clear();
  for (unsigned worker = 0; worker < roles_.workers; ++worker) {
    WorkerState& state = states_[worker] = state_of(roles_, worker);
    state.capacity = capacity_;
    state.claims = entry_.claims;
    state.random = SplitMix(SplitMix::mixed(seed_ + worker + 1));
    state.operations = operations_;
  }
  queue_ = entry_.make_word_queue(roles_.workers, capacity_).release();
}

void ScenarioClient::run(unsigned worker) {
  // On the stack, so that a loop which only uses up its operations is seen to go on.
  VirtualCore core(states_[worker], *queue_, run_);
  std::string complaint;
  try {
    scenario_.run(core);
    if (entry_.methods.leave) core.leave_queue();
    return;
  } catch (const stress::Complaint& broken) {
    complaint = broken.what();
  }
  Execution::current_execution()->conclusion().report(FindingKind::wrong_outcome, complaint, {});
}

// On behalf of every worker that may pop, until all of them find nothing.
void ScenarioClient::finish() {
  std::uint64_t most = 1'000;  // a queue that returns more may do so for ever
  for (const WorkerState& state : states_) most += state.next_sequence;
  for (bool found = scenario_.drains; found && drain_.size() < most;) {
    found = false;
    for (unsigned worker = 0; worker < roles_.workers; ++worker) {
      if (!roles_.pops(worker)) continue;
      WorkerState state{.worker = worker, .operations = 0, .log = std::move(drain_)};
      VirtualCore core(state, *queue_, run_);
      while (state.log.size() < most && core.pop()) found = true;
      drain_ = std::move(state.log);
    }
  }
  delete queue_;
}

std::optional<std::string> ScenarioClient::judge() const {
  stress::History history{.logs = {}, .drain = drain_, .emptied = !scenario_.leaves_inside};
  for (const WorkerState& state : states_) history.logs.push_back(state.log);
  const stress::Verdict verdict = stress::judge(history, claims_, capacity_);
  if (verdict.violations.empty()) return std::nullopt;
  const stress::Violation& first = verdict.violations.front();
  return fmt::format("{} (broken claim: {})", first.text, promise(first.pattern));
}

std::vector<QueueCall> ScenarioClient::operations() const {
  std::vector<QueueCall> result;
  for (std::size_t i = 0; i < run_.calls.size(); ++i) {
    const CallPlace& call = run_.calls[i];
    const bool drains = call.thread == roles_.workers;
    const std::vector<stress::Operation>& log = drains ? drain_ : states_[call.thread].log;
    // Up to the next call of that log; barriers have entries of their own.
    const auto next = std::find_if(run_.calls.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                                   run_.calls.end(), [&](const CallPlace& o) {
                                     return (o.thread == roles_.workers) == drains &&
                                            (drains || o.thread == call.thread);
                                   });
    const std::size_t end = next == run_.calls.end() ? log.size() : next->entry;
    for (std::size_t e = call.entry; e < std::max(end, call.entry + (call.finished ? 0 : 1)); ++e) {
      QueueCall operation{.kind = call.kind == Kind::push    ? QueueCall::Kind::push
                                  : call.kind == Kind::close ? QueueCall::Kind::close
                                  : call.kind == Kind::leave ? QueueCall::Kind::leave
                                                             : QueueCall::Kind::pop,
                          .thread = call.thread,
                          .worker = call.worker,
                          .number = result.size(),
                          .phase = drains ? QueueCall::Phase::after : QueueCall::Phase::during,
                          .finished = call.finished,
                          .called = call.called,
                          .returned = call.returned,
                          .first_step = call.first_step,
                          .last_step = call.last_step};
      if (e < log.size()) {
        const stress::Operation& entry = log[e];
        if (entry.kind == Kind::meet) continue;
        operation.answered = entry.kind == Kind::push || entry.kind == Kind::pop;
        operation.closed = entry.kind == Kind::closed;
        operation.timed_out = entry.kind == Kind::timed_out;
        operation.waits = operation.closed || operation.timed_out;
        operation.value = entry.value;
      }
      result.push_back(operation);
    }
  }
  return result;
}

std::string ScenarioClient::description() const {
  return fmt::format("{} workers with {} operations each, capacity {}{}", roles_.workers,
                     operations_, capacity_,
                     run_.clocked ? ", calls ordered by a clock as well" : "");
}

}  // namespace irt::checker
