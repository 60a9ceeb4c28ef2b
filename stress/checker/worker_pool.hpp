/// Numbered pieces of work by several processes, and what they come to in the order of the numbers.
///
/// Each worker is a forked child. Worker w of n makes the pieces w, w + n, w + 2n, ...: who is done
/// sooner does not change who makes what. Results wait in pipes, which bounds how far a worker is
/// ahead.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "stress/checker/child.hpp"

namespace irt::checker {

class WorkerPool {
 public:
  /// What the piece with this number comes to, in bytes; none: this worker stops here.
  using Work = std::function<std::optional<std::string>(std::uint64_t number)>;

  /// Starts the workers. A piece for which one needs more than `patience` seconds is taken to hang.
  WorkerPool(unsigned workers, double patience, const Work& work);

  /// What the next piece came to; none if its worker has stopped. Throws std::runtime_error with
  /// what `work` threw, or if the worker crashed or hangs.
  std::optional<std::string> next();

 private:
  void take(Child& worker, void* bytes, std::size_t size) const;

  double patience_;
  std::vector<Child> workers_;
  std::uint64_t next_ = 0;
};

}  // namespace irt::checker
