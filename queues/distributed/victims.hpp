/// Whom a worker that has nothing left visits, in which order: three policies.
///
/// A policy is made for a worker of so many, and has one method, which visits all others, one after
/// the other:
///
///     template <class Visit>
///     bool find(Visit visit);  // calls visit(victim) until it answers true; whether it did
#pragma once

#include <bit>

#include "queues/split_mix.hpp"

namespace irt {

/// Visits all others, from a random one on. Thieves spread, whoever has work.
class RandomVictims {
 public:
  RandomVictims(unsigned worker, unsigned workers)
      : worker_(worker), workers_(workers), random_(worker) {}

  template <class Visit>
  bool find(Visit visit) {
    unsigned victim = static_cast<unsigned>(random_.below(workers_));
    for (unsigned i = 0; i < workers_; ++i, ++victim) {
      if (victim == workers_) victim = 0;
      if (victim != worker_ && visit(victim)) return true;
    }
    return false;
  }

 private:
  unsigned worker_, workers_;
  SplitMix random_;
};

/// Visits all others, from the one on that had something the last time. Few visits are in vain
/// where few have work, and thieves meet there.
class LastVictims {
 public:
  LastVictims(unsigned worker, unsigned workers)
      : worker_(worker), workers_(workers), last_(worker) {}

  template <class Visit>
  bool find(Visit visit) {
    for (unsigned i = 0; i < workers_; ++i) {
      if (last_ != worker_ && visit(last_)) return true;
      if (++last_ == workers_) last_ = 0;
    }
    return false;
  }

 private:
  unsigned worker_, workers_, last_;
};

/// Visits the nearest first. A queue does not know the machine, but workers are bound to cores in
/// the order of their numbers, and what cores share (a cache, a socket) are blocks of them. So
/// worker `w` visits `w ^ 1`, `w ^ 2`, `w ^ 3`, ...: its pair, then its four, its eight. That is
/// exact where the sizes are powers of two and nearly right elsewhere; a core's second hardware
/// thread, whose number is far away, counts as far. No two thieves are at one victim in the same
/// step.
class NearestVictims {
 public:
  NearestVictims(unsigned worker, unsigned workers) : worker_(worker), workers_(workers) {}

  template <class Visit>
  bool find(Visit visit) {
    for (unsigned step = 1; step < std::bit_ceil(workers_); ++step) {
      const unsigned victim = worker_ ^ step;
      if (victim < workers_ && visit(victim)) return true;
    }
    return false;
  }

 private:
  unsigned worker_, workers_;
};

}  // namespace irt
