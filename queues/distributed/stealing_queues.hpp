/// STEALING: a deque for each worker, and who has nothing left steals from the others (Blumofe and
/// Leiserson 1999, "Scheduling Multithreaded Computations by Work Stealing", JACM), over the deque
/// of Chase and Lev.
///
/// When to use: tasks make tasks, as in the renderer or where work forks and joins, and loads
/// differ. A worker meets others only when one of them has nothing to do. When not: one worker
/// pushes what all the others pop, for then every pop is a theft; the oldest task must leave first;
/// workers without work go on looking all the time, for each look takes from the others the lines
/// that they write.
///
/// Ordering: none. *Empty* speaks of one deque after the other. Progress: `push` is wait-free,
/// apart from the allocator, `pop` lock-free. Memory: an array of 8 bytes per place for each
/// worker, which grows and is kept; see chase_lev_deque.hpp. Unbounded.
///
/// How it works: a worker pushes to its own deque and pops the newest task from there, so that it
/// works depth first: what it pops is still in its caches, and its deque stays as short as a path
/// is deep. (Taking the oldest would work breadth first: of the renderer's frame all tasks of one
/// depth would lie about at once.) A thief takes the oldest, which of a tree is the largest part:
/// in the renderer a primary task that was dealt and that nobody has begun. A pop goes round all
/// other deques until it has a task. Where it has lost a race for one, it goes round once more, so
/// that *empty* means that each deque was seen empty; the winner of a race goes on.
///
/// Whom a thief visits first is a policy, and so is whether it takes a single task or half of what
/// it finds. Half is taken one by one, by as many thefts, into the thief's own deque, where others
/// find it at once. By a single compare-and-swap a thief would get words that the owner, who does
/// not look at `top` before it has reached it, takes as well. (Hendler and Shavit 2002,
/// "Non-blocking Steal-half Work Queues", PODC, have the owner write down now and then how far
/// thieves may go.) At most as many are taken as the thief's array has room for, so that no theft
/// has to allocate, and not more than 32, so that none takes long.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/distributed/chase_lev_deque.hpp"
#include "queues/distributed/theft.hpp"
#include "queues/distributed/victims.hpp"
#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// The queue, of any deque with the methods of `ChaseLevDeque`; one whose `steal` asks for the
/// thief's deque says itself how much it takes. `half`: a thief takes half of what it finds, and
/// else a single task.
template <class T, class Deque, class Victims, bool half>
class Stealing {
 public:
  static constexpr Claims claims{.push = Progress::wait_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::free_list};

  /// Each deque begins with its part of `capacity`.
  Stealing(unsigned workers, std::size_t capacity) {
    workers_.reserve(workers);
    for (unsigned worker = 0; worker < workers; ++worker)
      workers_.push_back(std::make_unique<Worker>(worker, workers, capacity / workers));
  }

  /// Adds `task` to the worker's own deque. Wait-free. Always true.
  bool push(unsigned worker, T task) {
    workers_[worker]->deque.push(word_of(task));
    return true;
  }

  /// Takes the worker's own newest task or another worker's oldest; false if each deque was empty
  /// when it was looked at. Lock-free.
  bool pop(unsigned worker, T& task) {
    std::uint64_t word = 0;
    if (!workers_[worker]->deque.take(word) && !steal(*workers_[worker], word)) return false;
    task = element_of<T>(word);
    return true;
  }

  /// Where a deque keeps something from thieves, they may have it now. Wait-free.
  void leave(unsigned worker) requires requires(Deque& deque) { deque.leave(); }
  { workers_[worker]->deque.leave(); }

 private:
  struct alignas(cache_line_pair) Worker {
    Worker(unsigned worker, unsigned workers, std::size_t capacity)
        : victims(worker, workers), deque(std::min(capacity, most_at_first)) {}

    Victims victims;
    Deque deque;
  };

  static constexpr std::size_t most_at_first = 1024;  // places of a deque
  static constexpr std::size_t most_stolen = 32;      // by one call

  bool steal(Worker& me, std::uint64_t& word) {
    for (;;) {
      bool lost = false;
      const bool found = me.victims.find([&](unsigned victim) {
        Deque& from = workers_[victim]->deque;
        Theft theft = Theft::empty;
        if constexpr (requires { from.steal(word, me.deque); })
          theft = from.steal(word, me.deque);
        else
          theft = from.steal(word);
        lost |= theft == Theft::lost;
        if constexpr (half)
          if (theft == Theft::taken) steal_more(me, from);
        return theft == Theft::taken;
      });
      if (found || !lost) return found;
    }
  }

  // Of `about()` and one that is stolen already, half.
  void steal_more(Worker& me, Deque& victim) {
    std::uint64_t word = 0;
    for (std::size_t left = std::min({victim.about() / 2, me.deque.room(), most_stolen - 1});
         left != 0 && victim.steal(word) == Theft::taken; --left)
      me.deque.push(word);
  }

  std::vector<std::unique_ptr<Worker>> workers_;
};

template <class T>
class StealingQueues : public Stealing<T, ChaseLevDeque, RandomVictims, false> {
 public:
  static constexpr std::string_view summary =
      "a Chase-Lev deque for each worker, random victims, one task stolen";
  using Stealing<T, ChaseLevDeque, RandomVictims, false>::Stealing;
};

template <class T>
class StealingHalfQueues : public Stealing<T, ChaseLevDeque, RandomVictims, true> {
 public:
  static constexpr std::string_view summary =
      "a Chase-Lev deque for each worker, random victims, half stolen";
  using Stealing<T, ChaseLevDeque, RandomVictims, true>::Stealing;
};

template <class T>
class StealingLastQueues : public Stealing<T, ChaseLevDeque, LastVictims, false> {
 public:
  static constexpr std::string_view summary =
      "a Chase-Lev deque for each worker, the last victim first, one task stolen";
  using Stealing<T, ChaseLevDeque, LastVictims, false>::Stealing;
};

template <class T>
class StealingNearQueues : public Stealing<T, ChaseLevDeque, NearestVictims, false> {
 public:
  static constexpr std::string_view summary =
      "a Chase-Lev deque for each worker, nearest victims first, one task stolen";
  using Stealing<T, ChaseLevDeque, NearestVictims, false>::Stealing;
};

}  // namespace irt
