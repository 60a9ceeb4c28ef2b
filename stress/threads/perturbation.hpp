/// Seeded disturbance at the edges of operations.
#pragma once

#include <cstdint>
#include <string>
#include <sys/types.h>

namespace irt::stress {

/// What may happen between two operations of a thread. Drawn once per round from the seed.
struct Perturbation {
  bool delays = false;      ///< spins for up to a few microseconds
  bool yields = false;      ///< gives up the processor
  bool moves = false;       ///< pins the thread to another core
  bool priorities = false;  ///< changes its own priority (nice)
  bool stalls = false;      ///< not only at edges: threads are put to sleep at random moments

  static Perturbation draw(std::uint64_t seed);
  [[nodiscard]] std::string describe() const;
};

/// Gives `thread` back its cores and, where the system allows that, its priority.
void stop_disturbing(pid_t thread);

/// Applies a perturbation to the calling thread; every thread has its own.
class Disturber {
 public:
  Disturber(const Perturbation& what, std::uint64_t seed) : what_(what), random_(seed) {}
  Disturber(const Disturber&) = delete;
  Disturber& operator=(const Disturber&) = delete;
  /// As `stop_disturbing`.
  ~Disturber();

  /// One edge: usually nothing.
  void edge();

 private:
  std::uint64_t next();

  Perturbation what_;
  std::uint64_t random_;
  bool changed_ = false;
};

}  // namespace irt::stress
