/// Queues with one known bug each, beside healthy twins that differ in the bug alone.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "queues/work_queue.hpp"
#include "stress/scenarios/scenarios.hpp"

namespace irt::stress {

/// Which instruments see a mutant's bug on real threads; a set.
enum Seen : std::uint8_t {
  by_none = 0,
  by_oracles = 1,  ///< histories, hangs and crashes of the plain build
  by_tsan = 2,
  by_asan = 4,
  by_progress = 8,  ///< the suite that stops threads, in the plain build
};

struct Mutant {
  std::string_view id;      ///< as in the bug corpus; the queue's name
  std::string_view defect;  ///< one line
  QueueEntry queue;
  QueueEntry twin;
  Scenario scenario;  ///< the pattern of use that shows it
  std::uint8_t seen;  ///< a set of `Seen`
  /// For those that no instrument here sees: what it takes.
  std::string_view needs;
};

/// All of them, in the order of the corpus; the thesis' listings last.
std::span<const Mutant> mutants();

}  // namespace irt::stress
