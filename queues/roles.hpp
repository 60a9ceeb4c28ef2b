/// Who pushes and who pops among the workers of a run: decided here, from what a queue claims.
#pragma once

#include <algorithm>
#include <string>

#include "queues/work_queue.hpp"

namespace irt {

/// The first workers push, the last ones pop; who is both does both.
struct Roles {
  unsigned workers = 0;
  unsigned producers = 0;  ///< workers [0, producers) push
  unsigned consumers = 0;  ///< workers [workers - consumers, workers) pop

  [[nodiscard]] constexpr bool pushes(unsigned worker) const { return worker < producers; }
  [[nodiscard]] constexpr bool pops(unsigned worker) const { return worker >= workers - consumers; }
  /// Whether some do both.
  [[nodiscard]] constexpr bool together() const { return producers + consumers > workers; }
};

/// Each of `workers` does both.
constexpr Roles all_do_both(unsigned workers) {
  return {workers, workers, workers};
}

/// Each of `producers` pushes, each of `consumers` pops, nobody does both.
constexpr Roles apart(unsigned producers, unsigned consumers) {
  return {producers + consumers, producers, consumers};
}

/// All that `workers` may do of a queue with these claims: a role for one at a time is the first
/// worker's (pushing) or the last one's (popping).
constexpr Roles most_roles(const Claims& claims, unsigned workers) {
  return {workers, claims.one_producer() ? 1 : workers, claims.one_consumer() ? 1 : workers};
}

/// The largest part of `wanted` that the claims allow; at least one worker pushes and one pops.
/// Where each worker has a queue of its own, and of a queue for one worker alone, all do both.
constexpr Roles roles_within(const Claims& claims, const Roles& wanted) {
  const unsigned most = claims.max_workers == 0 ? ~0U : claims.max_workers;
  unsigned producers = claims.one_producer() ? 1 : wanted.producers;
  unsigned consumers = claims.one_consumer() ? 1 : wanted.consumers;
  if (claims.own_queues())
    return all_do_both(std::min(most, std::max({2U, wanted.producers, wanted.consumers})));
  if (wanted.together() || most == 1) return all_do_both(std::min({most, producers, consumers}));
  // Who is one too many leaves the larger side.
  while (producers + consumers > most) --(producers > consumers ? producers : consumers);
  return apart(producers, consumers);
}

/// Why the claims do not allow `roles`, as a clause; empty if they do.
inline std::string obstacle(const Claims& claims, const Roles& roles) {
  if (claims.own_queues() && !roles.together()) return "a worker pops only what it pushed itself";
  if (!claims.allows_workers(roles.workers))
    return "it is for at most " + std::to_string(claims.max_workers) + " workers";
  if (claims.one_producer() && roles.producers > 1) return "it allows one producer";
  if (claims.one_consumer() && roles.consumers > 1) return "it allows one consumer";
  return {};
}

}  // namespace irt
