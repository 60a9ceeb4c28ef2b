/// What a sweep measures, settled to the last choice.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/contention/job.hpp"
#include "bench/contention/placement.hpp"
#include "bench/contention/scenarios.hpp"
#include "queues/registry.hpp"

namespace irt {

// As journals have them.
inline void to_json(nlohmann::json& json, const Roles& roles) {
  json = {
      {"threads", roles.workers}, {"producers", roles.producers}, {"consumers", roles.consumers}};
}
inline void from_json(const nlohmann::json& json, Roles& roles) {
  json.at("threads").get_to(roles.workers);
  json.at("producers").get_to(roles.producers);
  json.at("consumers").get_to(roles.consumers);
}

namespace contention {

/// Every combination of the lists is measured, as far as a queue's claims allow. Stands at the head
/// of the journal.
struct Plan {
  std::vector<std::string> queues;  ///< empty: all, and what they are measured against
  std::vector<std::string> scenarios{"pairs"};
  std::vector<unsigned> threads;  ///< empty: 1, 2, 4 ... up to the processors, and twice as many
  std::vector<double> work{100};  ///< nanoseconds between operations
  std::vector<std::string> placements{"close"};
  std::vector<std::size_t> capacities{65'536};
  double work_spread = 0;
  unsigned repetitions = 5;
  double seconds = 0.2;  ///< the timed interval of a repetition
  double warmup = 0.5;   ///< seconds that a warm-up takes at most
  double patience = 5;   ///< seconds
  bool latency = false;  ///< each repetition once more, with stamps
  bool order = false;    ///< and once more, with a log of all operations
  std::uint64_t seed = 1;
  std::vector<std::string> plugins;
  unsigned shard = 0, shards = 1;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Plan, queues, scenarios, threads, work, placements, capacities,
                                   work_spread, repetitions, seconds, warmup, patience, latency,
                                   order, seed, plugins, shard, shards)

/// A line of the results: one queue in one cell. Lines of a cell differ in the queue only.
// NOLINTNEXTLINE(bugprone-exception-escape): moving JSON does not throw
struct Row {
  unsigned cell = 0;
  std::string queue, scenario;
  Roles cast;
  double work_ns = 0;
  std::size_t capacity = 0;
  Placement placement;
  bool oversubscribed = false;  ///< more threads than processors
  bool type_erased = false;     ///< measured at a virtual call per operation
  std::string not_countable;    ///< why no counting build is measured beside it; empty: one is
  nlohmann::json claims;        ///< in words
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Placement, processors, text)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Row, cell, queue, scenario, cast, work_ns, capacity, placement,
                                   oversubscribed, type_erased, not_countable, claims)

/// Fills what is left open and checks everything. Throws UsageError or RegistryError.
void settle(Plan& plan, const QueueRegistry& queues, const Machine& machine);

struct Rows {
  std::vector<Row> rows;
  std::vector<std::string> left_out;  ///< a line each: what a queue's claims do not allow
};

/// The lines of a settled plan. A shard has every `shards`-th cell, whole, so that queues are
/// always compared on one machine.
Rows rows_of(const Plan& plan, const QueueRegistry& queues, const Machine& machine);

/// What the process for a repetition of `row` is told. Each repetition has a seed of its own, the
/// same for all queues of a cell. A plain one is measured in turns, others in one go.
Job job_of(const Plan& plan, const Row& row, unsigned repetition, const Pace& pace, Pass pass);

/// The passes of a repetition of `row`, in their order. Counting takes place in the first one
/// alone: its figures are shares of many operations, which hardly vary.
std::vector<Pass> passes_of(const Plan& plan, const Row& row, unsigned repetition);

/// The name that stands for `baseline_queues()` among those of queues.
inline constexpr const char* baselines = "baselines";

/// The lines by number in the order in which one repetition of the sweep measures them: cell by
/// cell, and in each cell the queues in an order drawn anew for each repetition, so that none
/// always follows the same other.
std::vector<unsigned> order_of(const std::vector<Row>& rows, unsigned repetition,
                               std::uint64_t seed);

/// `order` in groups whose lines take turns: those of a cell, or, where they are more than fit,
/// several groups as equal as can be. Since the order of a cell is drawn anew for each repetition,
/// so are such groups.
std::vector<std::vector<unsigned>> groups_of(const std::vector<unsigned>& order,
                                             const std::vector<Row>& rows, double memory_bytes);

/// How many lines like `row` fit side by side: at most 16, so that a lap lasts no longer than the
/// machine keeps its pace, and as many as `memory_bytes` hold if each takes 32 MB and 128 bytes for
/// each element of its capacity. At least one.
std::size_t most_together(const Row& row, double memory_bytes);

}  // namespace contention
}  // namespace irt
