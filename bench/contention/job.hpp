/// One repetition of one line of a sweep: what is to be measured, and what was.
///
/// Both travel as JSON between the sweep and the process that it starts for each repetition.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "bench/contention/busy_wait.hpp"
#include "bench/counted/atomic_events.hpp"
#include "bench/results/order_of_elements.hpp"

namespace irt {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(AtomicEvents, compare_exchanges, failed_compare_exchanges,
                                   other_modifications, loads, stores)

namespace contention {

/// What a repetition is for. Only `plain` ones make rates.
enum class Pass : std::uint8_t {
  plain,
  stamped,  ///< the time of every operation
  counted,  ///< the counting build of the queue, see counting.hpp
  logged,   ///< every operation is written down from the first on, for the order of elements
};
NLOHMANN_JSON_SERIALIZE_ENUM(Pass, {{Pass::plain, "plain"},
                                    {Pass::stamped, "stamped"},
                                    {Pass::counted, "counted"},
                                    {Pass::logged, "logged"}})

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Pace, fixed_ns, step_ns)

struct Job {
  std::string queue;  ///< a queue of the registry, or `no_queue`
  std::string scenario;
  unsigned producers = 1, consumers = 1, threads = 1;
  double work_ns = 0;      ///< between operations
  double work_spread = 0;  ///< the share of `work_ns` by which it varies at random
  Pace pace;               ///< of busy waits, as calibrated
  std::size_t capacity = 0;
  std::vector<unsigned> processors;  ///< to which the threads are bound in turn; empty: not bound
  double seconds = 0.2;              ///< the timed interval
  unsigned turns = 1;                ///< parts of it, see turns.hpp
  double settling_seconds = 0.001;   ///< what passes before each of them
  double warmup_seconds = 0.5;       ///< the warm-up ends then at the latest
  double patience_seconds = 5;       ///< how long threads may take to stop
  Pass pass = Pass::plain;           ///< what this repetition is for
  std::uint64_t seed = 1;
  std::vector<std::string> plugins;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Job, queue, scenario, producers, consumers, threads, work_ns,
                                   work_spread, pace, capacity, processors, seconds, turns,
                                   settling_seconds, warmup_seconds, patience_seconds, pass, seed,
                                   plugins)

/// The name of the queue that does nothing, by which the loop itself is measured.
inline constexpr const char* no_queue = "(nothing)";

/// Durations of one method, in the buckets of `Histogram`, nanoseconds.
struct Times {
  std::vector<std::pair<std::size_t, std::uint64_t>> buckets;
  std::uint64_t max = 0;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Times, buckets, max)

/// All threads of a repetition, over the common interval of `seconds`.
struct Sample {
  std::string status = "ok";  ///< ok, hung, crashed or failed
  std::string message;        ///< of any other status: one line
  double seconds = 0;
  std::uint64_t pushes = 0, pops = 0;  ///< that succeeded
  std::uint64_t failed_pushes = 0, failed_pops = 0;
  std::uint64_t held_back = 0;  ///< times that a producer waited for consumers to catch up
  double fairness = 0;  ///< least over most operations of a thread, among threads of one role
  double cpu_seconds = 0;
  bool steady = false;     ///< the warm-up ended because the rate was steady
  double variation = 0;    ///< of the last slices of the warm-up: standard deviation over mean
  std::string not_pinned;  ///< why threads could not be bound; empty if they were, or not asked to
  double work_ns_measured = 0;
  double clock_ns = 0;  ///< between two stamps with nothing between them; of a stamped pass
  std::uint64_t context_switches = 0;
  std::uint64_t memory_peak_bytes = 0;  ///< resident, above what was before the queue was made
  nlohmann::json memory_held_bytes;  ///< allocated since then and not freed when threads stopped;
                                     ///< null where the allocator does not say
  nlohmann::json energy_joules;      ///< null where there is no meter
  nlohmann::json counters;           ///< by name; null where none can be read
  std::vector<std::string> missing;  ///< why figures are null, a line each
  Times push_times, pop_times;       ///< of a stamped pass
  AtomicEvents events;               ///< of a counted pass, warm-up included, as are
  std::uint64_t all_operations = 0;  ///< these: pushes and pops that succeeded
  results::OrderOfElements order;    ///< of a logged pass

  [[nodiscard]] std::uint64_t operations() const { return pushes + pops; }
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Sample, status, message, seconds, pushes, pops, failed_pushes,
                                   failed_pops, held_back, fairness, cpu_seconds, steady, variation,
                                   not_pinned, work_ns_measured, clock_ns, context_switches,
                                   memory_peak_bytes, memory_held_bytes, energy_joules, counters,
                                   missing, push_times, pop_times, events, all_operations, order)

}  // namespace contention
}  // namespace irt
