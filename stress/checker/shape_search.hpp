/// One search of one shape over one queue, with its finding reported.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "stress/checker/program_search.hpp"
#include "stress/checker/queue_check.hpp"

namespace irt::checker {

/// How far a search may go, and in which way.
struct SearchBounds {
  double seconds = 1e9;
  std::uint64_t executions = ~std::uint64_t{0};
  std::uint64_t seed = 0;  ///< 0: that of the settings
  bool clocked = false;    ///< calls are ordered by a clock as well
  unsigned failing_allocations = 0;
};

/// Searches shapes of one queue.
class ShapeSearch {
 public:
  ShapeSearch(const QueueEntry& entry, virtual_cores::Module& module, const CheckSettings& settings,
              const std::string& command)
      : entry_(entry),
        module_(module),
        settings_(settings),
        command_(command),
        search_(module, {.jobs = settings.jobs,
                         .keep_going = settings.keep_going,
                         .quiet = settings.quiet,
                         .reports = settings.reports}) {}

  /// Adds its work to what `shape` holds already. Each finding but the one in `shape` after it goes
  /// to `found`.
  void search(ShapeResult& shape, Search kind, const SearchBounds& bounds,
              const std::function<void(ShapeResult)>& found);

  /// Stops each thread of the shape before each of its steps, as far as `seconds` go.
  ShapeResult stall(const std::string& shape, double seconds);

 private:
  const QueueEntry& entry_;
  virtual_cores::Module& module_;
  const CheckSettings& settings_;
  const std::string& command_;
  std::shared_ptr<AgedMemory> aged_ = std::make_shared<AgedMemory>();
  ProgramSearch search_;
};

}  // namespace irt::checker
