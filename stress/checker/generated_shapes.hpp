/// Shapes beyond the batteries, drawn from a seed: small ones first, then larger ones without end.
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "queues/work_queue.hpp"
#include "stress/checker/random.hpp"
#include "stress/checker/shapes.hpp"

namespace irt::checker {

/// Draws clients that a queue's claims allow: two to four threads, each pushing and popping as its
/// roles let it; elements from before the threads; signals, by which also a role for one is handed
/// over; repeated parts; for bounded queues capacities 1, 2, 3 and 5, and queues to be filled; one
/// in four destroyed as it is. Of a queue with a waiting pop some pops wait, and somebody closes it
/// where one of them might wait for ever; of one with bulk methods some calls are of two. The same
/// claims and seed give the same shapes in the same order.
class GeneratedShapes {
 public:
  GeneratedShapes(const Claims& claims, const Methods& methods, std::uint64_t seed);

  /// The next one; none comes twice. Its steps grow slowly with how many there were.
  Shape next();

 private:
  Shape draw(unsigned steps);
  std::string word(unsigned thread, unsigned steps);
  void add_signal(Shape& shape);
  void add_size_and_age(Shape& shape);
  void add_methods(Shape& shape);
  void add_closing(Shape& shape);
  bool one_in(std::uint32_t n) { return random_.below(n) == 0; }

  Claims claims_;
  Methods methods_;
  Generator random_;
  unsigned pusher_ = 0;  ///< where only one thread may push
  unsigned popper_ = 0;  ///< where only one may pop
  std::set<std::string> drawn_;
  std::uint64_t count_ = 0;
};

}  // namespace irt::checker
