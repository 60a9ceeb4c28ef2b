/// What `irt check` does to one queue: its battery of shapes, each as far as the time allows.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stress/checker/checker.hpp"
#include "stress/checker/queue_client.hpp"
#include "stress/checker/unseen.hpp"

namespace irt::checker {

struct CheckSettings {
  std::vector<std::string> shapes{};  ///< empty: the battery of the queue's claims
  std::optional<Search> search{};     ///< none: exhaustive, then bounded and sampled
  std::size_t capacity = 0;           ///< of the queue, where a shape leaves it open
  unsigned jobs = 1;                  ///< processes that share a search
  double seconds = 50;                ///< for all shapes and searches together, at most
  bool progress = true;               ///< stop threads to see whether others go on
  bool no_memory = true;     ///< let an allocation fail, if the queue claims to survive that
  bool keep_going = false;   ///< collect distinct findings instead of stopping at the first
  bool old = false;          ///< age queues by nearly 2^32 pairs, which takes minutes
  unsigned all_clients = 0;  ///< instead of shapes every client of so many calls at most
  std::uint64_t generated = ~std::uint64_t{0};  ///< generated shapes, at most
  bool quiet = false;                           ///< say nothing while running
  bool reports = true;  ///< of findings; without, the first one ends the check at once
  /// Calls are ordered by a clock, see QueueClient. None: if the queue claims `fifo_real_time`,
  /// wherever an order is weakened, and else in a search of its own, at last.
  std::optional<bool> real_time{};
  Options options{};
};

/// Where a shape comes from.
enum class Origin : std::uint8_t { battery, elements, aged, generated, clients };

/// What was found out about one shape.
struct ShapeResult {
  std::string shape;
  std::string search{};  ///< which search it was
  Origin origin = Origin::battery;
  Result result{};
  std::size_t histories = 0;  ///< different ones
  std::string report{};       ///< of the finding; empty if there is none
  bool proved = false;        ///< every execution was looked at, and everything in it was seen
  std::string unproved{};     ///< why a whole search of this queue is no proof; empty if it is one
};

struct QueueResult {
  std::vector<ShapeResult> shapes;
  Unseen unseen;  ///< its instructions and what they mean are left out without `reports`
  /// Executions differ somewhere, see Result: what was found is withheld.
  bool differs = false;
  bool found = false;
  unsigned all_clients = 0;   ///< see CheckSettings
  std::size_t not_tried = 0;  ///< of these clients
};

/// With the limits `as_seen` there.
CheckSettings as_seen(CheckSettings settings, virtual_cores::Module& module);

/// Checks the queue in `module`. Stops at the first finding, unless it is to keep going: then each
/// kind and place of a finding has one entry. `command` is how to call the tool
/// again for this queue.
QueueResult check_queue(const QueueEntry& entry, virtual_cores::Module& module,
                        const CheckSettings& settings, const std::string& command);

/// The report of what `schedule` does on one shape; empty if it finds nothing.
std::string replay(const QueueEntry& entry, virtual_cores::Module& module,
                   const CheckSettings& settings, const std::string& shape,
                   const std::string& schedule, const std::string& dot_file);

/// Weakens each memory order of the queue in turn and prints what breaks; returns how many orders
/// nothing in the battery needs.
std::size_t mutate_orders(const QueueEntry& entry, virtual_cores::Module& module,
                          const CheckSettings& settings);

}  // namespace irt::checker
