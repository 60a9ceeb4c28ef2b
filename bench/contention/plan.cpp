#include "bench/contention/plan.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>
#include <thread>

#include "bench/conditions/claims.hpp"
#include "bench/contention/busy_wait.hpp"
#include "bench/contention/counting.hpp"
#include "bench/contention/shuffle.hpp"
#include "bench/contention/subjects.hpp"
#include "bench/contention/turns.hpp"
#include "queues/baselines/baselines.hpp"
#include "stress/running/usage_error.hpp"

namespace irt::contention {
namespace {

// 1, 2, 4 ... and the number of processors itself; then twice as many.
std::vector<unsigned> default_threads(unsigned processors) {
  std::vector<unsigned> threads;
  for (unsigned n = 1; n < processors; n *= 2) threads.push_back(n);
  threads.push_back(processors);
  threads.push_back(std::min(2 * processors, most_threads));
  return threads;
}

template <class T>
void drop_repeats(std::vector<T>& values) {
  std::vector<T> once;
  for (const T& value : values) {
    if (std::ranges::find(once, value) == once.end()) once.push_back(value);
  }
  values = std::move(once);
}

// What keeps the queue from playing; empty where there is nothing.
std::string obstacle(const Scenario& scenario, const Roles& roles, const QueueEntry& queue) {
  const std::string_view why = scenario.obstacle(queue.claims, queue.methods);
  return why.empty() ? contention::obstacle(roles, queue.claims) : std::string(why);
}

std::vector<std::string> with_baselines(const std::vector<std::string>& names) {
  std::vector<std::string> all;
  for (const std::string& name : names) {
    if (name != baselines) {
      all.push_back(name);
      continue;
    }
    for (std::string& baseline : baseline_queues()) all.push_back(std::move(baseline));
  }
  return all;
}

}  // namespace

void settle(Plan& plan, const QueueRegistry& queues, const Machine& machine) {
  if (plan.queues.empty()) {
    for (const QueueEntry& queue : queues.entries()) plan.queues.emplace_back(queue.name);
    plan.queues.emplace_back(baselines);
  }
  plan.queues = with_baselines(plan.queues);
  queues.prepare(plan.queues);
  for (const std::string& name : plan.queues) queues.at_or_counter(name);
  for (const std::string& name : plan.scenarios) scenario_at(name);
  for (const std::string& name : plan.placements) place(name, machine);
  if (plan.threads.empty()) {
    plan.threads = default_threads(static_cast<unsigned>(machine.processors.size()));
  }
  drop_repeats(plan.queues);
  drop_repeats(plan.scenarios);
  drop_repeats(plan.placements);
  drop_repeats(plan.threads);
  drop_repeats(plan.work);
  drop_repeats(plan.capacities);
  const unsigned most = *std::ranges::max_element(plan.threads);
  for (const std::size_t capacity : plan.capacities) {
    if (capacity < most) {
      throw UsageError(fmt::format("--capacity {}: must hold an element of each of the {} threads",
                                   capacity, most));
    }
  }
}

Rows rows_of(const Plan& plan, const QueueRegistry& queues, const Machine& machine) {
  Rows all;
  std::set<std::string> left_out;
  unsigned cells = 0;
  const auto cell = [&](const Chosen& chosen, unsigned threads, double work, std::size_t capacity,
                        const std::string& policy) {
    const unsigned number = cells++;
    if (number % plan.shards != plan.shard) return;
    const Roles roles = chosen.roles(threads);
    for (const std::string& name : plan.queues) {
      const QueueEntry& queue = queues.at_or_counter(name);
      const std::string why = obstacle(*chosen.scenario, roles, queue);
      if (!why.empty()) {
        left_out.insert(fmt::format("{} does not play {}: {}", name, chosen.name(), why));
        continue;
      }
      all.rows.push_back({.cell = number,
                          .queue = name,
                          .scenario = chosen.name(),
                          .cast = roles,
                          .work_ns = work,
                          .capacity = capacity,
                          .placement = place(policy, machine),
                          .oversubscribed = roles.workers > machine.processors.size(),
                          .type_erased = type_erased(queues, name),
                          .not_countable = not_countable(queues, name),
                          .claims = claims_in_words(queue.claims)});
    }
  };
  for (const std::string& name : plan.scenarios) {
    const Chosen chosen = scenario_at(name);
    std::vector<unsigned> threads = plan.threads;
    if (chosen.fixed) threads = {chosen.fixed->workers};
    std::set<unsigned> played;  // an odd number of threads may play as one less
    for (const unsigned count : threads) {
      if (count < chosen.scenario->least_threads) continue;
      if (!played.insert(chosen.roles(count).workers).second) continue;
      for (const double work : plan.work) {
        for (const std::size_t capacity : plan.capacities) {
          for (const std::string& policy : plan.placements) {
            cell(chosen, count, work, capacity, policy);
          }
        }
      }
    }
  }
  all.left_out.assign(left_out.begin(), left_out.end());
  return all;
}

Job job_of(const Plan& plan, const Row& row, unsigned repetition, const Pace& pace, Pass pass) {
  SplitMix seeds(plan.seed + (std::uint64_t{row.cell} << 32) + repetition);
  const auto processors = row.placement.processors.empty()
                              ? std::max(1U, std::thread::hardware_concurrency())
                              : static_cast<unsigned>(row.placement.processors.size());
  const Turn turn = turn_of(row.cast.workers, processors);
  return {.queue = row.queue,
          .scenario = row.scenario,
          .producers = row.cast.producers,
          .consumers = row.cast.consumers,
          .threads = row.cast.workers,
          .work_ns = row.work_ns,
          .work_spread = plan.work_spread,
          .pace = pace,
          .capacity = row.capacity,
          .processors = row.placement.processors,
          .seconds = plan.seconds,
          .turns = pass == Pass::plain ? turns_in(plan.seconds, turn) : 1,
          .settling_seconds = turn.settling_seconds,
          .warmup_seconds = plan.warmup,
          .patience_seconds = plan.patience,
          .pass = pass,
          .seed = seeds.next(),
          .plugins = plan.plugins};
}

std::vector<Pass> passes_of(const Plan& plan, const Row& row, unsigned repetition) {
  std::vector<Pass> passes{Pass::plain};
  if (plan.latency) passes.push_back(Pass::stamped);
  if (plan.order && !scenario_at(row.scenario).scenario->has_two_queues())
    passes.push_back(Pass::logged);
  if (repetition == 0 && row.not_countable.empty()) passes.push_back(Pass::counted);
  return passes;
}

std::vector<unsigned> order_of(const std::vector<Row>& rows, unsigned repetition,
                               std::uint64_t seed) {
  std::vector<unsigned> order(rows.size());
  for (unsigned i = 0; i < order.size(); ++i) order[i] = i;
  SplitMix random(seed * 1'000'003 + repetition);
  for (std::size_t begin = 0; begin < rows.size();) {
    std::size_t end = begin;
    while (end < rows.size() && rows[end].cell == rows[begin].cell) ++end;
    shuffle(std::span(order).subspan(begin, end - begin), random);
    begin = end;
  }
  return order;
}

std::vector<std::vector<unsigned>> groups_of(const std::vector<unsigned>& order,
                                             const std::vector<Row>& rows, double memory_bytes) {
  std::vector<std::vector<unsigned>> groups;
  for (std::size_t begin = 0; begin < order.size();) {
    const Row& first = rows[order[begin]];
    std::size_t end = begin;
    while (end < order.size() && rows[order[end]].cell == first.cell) ++end;
    const std::size_t lines = end - begin, most = most_together(first, memory_bytes);
    const std::size_t parts = (lines + most - 1) / most;
    for (std::size_t part = 0; part < parts; ++part) {
      const auto at = [&](std::size_t i) {
        return order.begin() + static_cast<long>(begin + lines * i / parts);
      };
      groups.emplace_back(at(part), at(part + 1));
    }
    begin = end;
  }
  return groups;
}

std::size_t most_together(const Row& row, double memory_bytes) {
  const double each = 32e6 + 128.0 * static_cast<double>(row.capacity);
  return static_cast<std::size_t>(std::clamp(memory_bytes / each, 1.0, 16.0));
}

}  // namespace irt::contention
