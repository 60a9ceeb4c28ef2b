// Who can go on while somebody stands still in the middle of an operation? Runners use the queue;
// the driver suspends one of them where it happens to stand and makes calls of its own. A monitor
// sees when the driver is stuck. A call that ends with a wrong answer is no progress either: in the
// first part the driver is alone with the victim and must get back what it pushes.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <fmt/format.h>
#include <string>
#include <string_view>
#include <sys/prctl.h>
#include <thread>
#include <vector>

#include "stress/history/specification.hpp"
#include "stress/threads/call.hpp"
#include "stress/threads/kernel_view.hpp"
#include "stress/threads/signals.hpp"
#include "stress/threads/suites.hpp"
#include "stress/threads/team.hpp"

namespace irt::stress {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr std::size_t capacity = 64;
constexpr std::int64_t most_inside = 48;
constexpr std::uint64_t enough_blocks = 3;

/// What the suspensions have shown for one method.
struct MethodVerdict {
  std::uint64_t passed = 0;   ///< suspensions during which a call of it ended
  std::uint64_t blocked = 0;  ///< suspensions that stopped it
  std::uint64_t misled = 0;   ///< suspensions that made it answer *empty* or *full* wrongly
  std::uint64_t guarded = 0;  ///< suspensions that stopped it in the guard of a local static
  // Of the first that did one or the other:
  Doing victim_in = Doing::nothing;
  Trace victim = {};
  Trace stuck = {};     ///< where the method stood, if it was stopped
  unsigned inside = 0;  ///< elements of its own, if it answered wrongly
};

struct Verdicts {
  std::uint64_t suspensions = 0;
  std::uint64_t operations = 0;
  MethodVerdict push;
  MethodVerdict pop;

  MethodVerdict& of(Doing method) { return method == Doing::push ? push : pop; }
};

std::string stack(const Trace& trace) {
  std::string text;
  for (const std::string& line : describe(trace)) text += fmt::format("    {}\n", line);
  return text;
}

/// One distribution of roles: the driver is one worker, the runners are the others.
/// With one runner only, the driver works alone while that one is held.
class ProgressRun {
 public:
  ProgressRun(const Assignment& assignment, const Roles& roles, unsigned driver, Verdicts& verdicts,
              Messenger& messenger)
      : assignment_(assignment),
        roles_(roles),
        driver_(driver),
        alone_(roles.workers == 2 && roles.pushes(driver) && roles.pops(driver)),
        verdicts_(verdicts),
        messenger_(messenger),
        slots_(roles.workers),
        sequences_(roles.workers, 0) {}

  void run(double seconds) {
    queue_ = assignment_.queue.make_word_queue(roles_.workers, capacity);
    const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(seconds));
    std::thread monitor([&] { watch(); });
    Team team(roles_.workers, slots_.data());
    team.run([&](unsigned worker) {
      if (worker == driver_) {
        drive(end);
        stop_.store(true, std::memory_order_relaxed);
      } else {
        use(worker);
      }
      const Call call(slots_[worker], Doing::leave);
      queue_->leave(worker);
    });
    monitor.join();
    for (const Slot& slot : slots_) verdicts_.operations += slot.done;
  }

 private:
  /// Whether the queue took, or gave, an element.
  bool call(unsigned worker, Doing method) {
    const Call call(slots_[worker], method);
    if (method == Doing::push) {
      if (!queue_->push(worker, next_element(assignment_.queue.claims, worker, sequences_[worker])))
        return false;
      ++sequences_[worker];
      inside_.fetch_add(1, std::memory_order_relaxed);
      return true;
    }
    Element e = 0;
    if (!queue_->pop(worker, e)) return false;
    inside_.fetch_sub(1, std::memory_order_relaxed);
    return true;
  }

  void use(unsigned worker) {
    while (!stop_.load(std::memory_order_relaxed)) {
      if (roles_.pushes(worker) && inside_.load(std::memory_order_relaxed) < most_inside) {
        call(worker, Doing::push);
      } else if (!roles_.pops(worker)) {
        std::this_thread::yield();
      }
      if (roles_.pops(worker)) call(worker, Doing::pop);
    }
  }

  void drive(Clock::time_point end) {
    std::uint64_t random = assignment_.seed;
    auto last_word = Clock::now();
    for (auto now = last_word; now < end; now = Clock::now()) {
      random = random * 6364136223846793005U + 1442695040888963407U;
      for (std::uint64_t left = (random >> 33) % 5'000; left > 0; --left) asm volatile("");
      const auto choice = static_cast<unsigned>((random >> 40) % (roles_.workers - 1));
      Slot& victim = slots_[choice < driver_ ? choice : choice + 1];
      if (suspend(victim)) {
        ++verdicts_.suspensions;
        // (1) release: pairs with the acquire load (2)
        victim_.store(&victim, std::memory_order_release);
        if (alone_) {
          work_alone(victim);
        } else {
          try_both(victim, (random >> 60) % 2 == 0 ? Doing::push : Doing::pop);
        }
        if (victim_.exchange(nullptr, std::memory_order_acq_rel) != nullptr) {
          release(victim);
        } else {
          // The monitor lets it go; who is stopped before it is done would be let go, too.
          while (!let_go_.exchange(false, std::memory_order_relaxed)) std::this_thread::yield();
        }
      } else if (roles_.pushes(driver_) && inside_.load(std::memory_order_relaxed) < most_inside) {
        call(driver_, Doing::push);
      } else if (roles_.pops(driver_)) {
        call(driver_, Doing::pop);
      }
      if (now - last_word > 200ms) {
        last_word = now;
        messenger_.progress(verdicts_.operations + slots_[driver_].done);
      }
      if (decided()) break;
    }
  }

  [[nodiscard]] bool holds(const Slot& victim) const {
    return victim_.load(std::memory_order_relaxed) == &victim;
  }

  /// Whether each method that the driver may call has been stopped often enough to stop looking.
  [[nodiscard]] bool decided() const {
    const auto enough = [](const MethodVerdict& v) {
      return v.blocked + v.misled >= enough_blocks;
    };
    return (!roles_.pushes(driver_) || enough(verdicts_.push)) &&
           (!roles_.pops(driver_) || enough(verdicts_.pop));
  }

  void try_both(const Slot& victim, Doing first) {
    for (const Doing method : {first, first == Doing::push ? Doing::pop : Doing::push}) {
      if (method == Doing::push ? !roles_.pushes(driver_) : !roles_.pops(driver_)) continue;
      call(driver_, method);
      // Where the monitor had to let the victim go, what follows would prove nothing.
      if (!holds(victim)) return;
      ++verdicts_.of(method).passed;
    }
  }

  /// Nobody else moves. Empties the queue, then pushes and pops until a ring of the capacity has
  /// gone round: the queue must take each element and give it back. The victim's own operation may
  /// take effect at any moment, so one element more or less proves nothing.
  void work_alone(const Slot& victim) {
    while (holds(victim) && call(driver_, Doing::pop)) {
    }
    unsigned own = 0;
    for (std::size_t turn = 0; turn < 2 * capacity && holds(victim); ++turn) {
      if (!call(driver_, Doing::push)) return mislead(Doing::push, own, victim);
      ++own;
      if (call(driver_, Doing::pop)) {
        --own;
      } else if (own > 1) {
        return mislead(Doing::pop, own, victim);
      }
    }
    if (!holds(victim)) return;
    ++verdicts_.push.passed;
    ++verdicts_.pop.passed;
  }

  void mislead(Doing method, unsigned own, const Slot& victim) {
    if (!holds(victim)) return;
    MethodVerdict& verdict = verdicts_.of(method);
    if (verdict.misled++ + verdict.blocked > 0) return;
    note_victim(verdict, victim);
    verdict.inside = own;
  }

  /// Notices a driver who has stood in one call for 0.1 s, with time on a core or asleep on a lock,
  /// while a victim is held; writes it down and lets the victim go.
  void watch() {
    const Slot& driver = slots_[driver_];
    std::uint64_t done = 0;
    std::uint64_t cpu = 0;
    auto since = Clock::now();
    while (!stop_.load(std::memory_order_relaxed)) {
      std::this_thread::sleep_for(5ms);
      const std::uint64_t now_done = driver.done.load(std::memory_order_relaxed);
      const Doing method = driver.doing.load(std::memory_order_relaxed);
      const pid_t thread = driver.thread.load(std::memory_order_relaxed);
      // (2) acquire: pairs with the release store (1)
      if (victim_.load(std::memory_order_acquire) == nullptr || now_done != done ||
          method == Doing::nothing) {
        done = now_done;
        since = Clock::now();
        cpu = cpu_time(thread).value_or(0);
        continue;
      }
      if (Clock::now() - since < 100ms) continue;
      if (cpu_time(thread).value_or(0) < cpu + 20'000'000 && !sleeps(thread)) continue;
      Slot* victim = victim_.exchange(nullptr, std::memory_order_acq_rel);
      if (victim == nullptr) continue;
      block(method, *victim);
      release(*victim);
      let_go_.store(true, std::memory_order_relaxed);
    }
  }

  void block(Doing method, const Slot& victim) {
    MethodVerdict& verdict = verdicts_.of(method);
    Slot& stuck = slots_[driver_];
    const bool answered = ask_trace(stuck);
    if (answered && stuck.standing == Standing::static_guard) {
      ++verdict.guarded;
      return;
    }
    if (verdict.blocked++ > 0) return;
    note_victim(verdict, victim);
    if (answered) verdict.stuck = stuck.trace;
  }

  static void note_victim(MethodVerdict& verdict, const Slot& victim) {
    verdict.victim_in = victim.doing.load(std::memory_order_relaxed);
    verdict.victim = victim.trace;
  }

  const Assignment& assignment_;
  Roles roles_;
  unsigned driver_;
  bool alone_;  ///< with the victim
  Verdicts& verdicts_;
  Messenger& messenger_;
  std::vector<Slot> slots_;
  std::vector<std::uint64_t> sequences_;
  std::unique_ptr<ElementQueue> queue_;
  std::atomic<std::int64_t> inside_{0};
  std::atomic<Slot*> victim_{nullptr};  ///< who is held; whoever takes it out releases
  std::atomic<bool> let_go_{false};     ///< the monitor has released whom it took out
  std::atomic<bool> stop_{false};
};

std::string evidence(Doing method, const MethodVerdict& verdict) {
  const std::string text =
      fmt::format("  suspended in {}:\n{}", name(verdict.victim_in), stack(verdict.victim));
  if (verdict.blocked > 0)
    return text + fmt::format("  stuck in {}:\n{}", name(method), stack(verdict.stuck));
  return text +
         fmt::format(
             "  meanwhile the only other thread's {} answered {} with {} of {} places taken\n",
             name(method), method == Doing::push ? "full" : "empty", verdict.inside, capacity);
}

void tell(const Assignment& assignment, Doing method, const Verdicts& verdicts,
          Messenger& messenger) {
  const MethodVerdict& verdict = method == Doing::push ? verdicts.push : verdicts.pop;
  const Claims& claims = assignment.queue.claims;
  const Progress claimed = method == Doing::push ? claims.push : claims.pop;
  const bool stops = verdict.blocked + verdict.misled > 0;
  messenger.figure(std::string(name(method)), stops                 ? "blocking"
                                              : verdict.passed == 0 ? "not seen"
                                                                    : "goes on");
  if (verdict.guarded > 0) {
    messenger.limit(fmt::format(
        "{}: {} times it waited for a stopped thread's first use of a local static: the C++ "
        "runtime's lock, not judged",
        name(method), verdict.guarded));
  }
  const Specification specification(claims, capacity);
  const bool goes_past = method == Doing::push ? specification.pushes_past_stopped()
                                               : specification.pops_past_stopped();
  if (!stops && verdict.passed == 0) {
    messenger.limit(fmt::format(
        "{}: no call of it met a thread that was stopped in the queue's own code: no verdict",
        name(method)));
  } else if (!stops) {
    messenger.note(fmt::format("{}: went on in all of {} suspensions{}", name(method),
                               verdict.passed,
                               claimed == Progress::blocking ? " (claimed: blocking)" : ""));
  } else if (claimed == Progress::blocking) {
    messenger.note(fmt::format("{}: blocking, as claimed", name(method)));
  } else if (verdict.blocked > 0 || goes_past) {
    messenger.finding(
        {.claim = fmt::format("{} goes on when another thread is stopped", name(method)),
         .evidence = evidence(method, verdict),
         .repeat = assignment.repeat});
  } else {
    messenger.note(fmt::format(
        "{}: answered {} because of a stopped thread in {} of {} suspensions; it claims no more",
        name(method), method == Doing::push ? "full" : "empty", verdict.misled,
        verdict.misled + verdict.passed));
  }
}

}  // namespace

void run_progress(const Assignment& assignment, Messenger& messenger) {
  install_signals();
  const Claims& claims = assignment.queue.claims;
  if (claims.own_queues()) {
    messenger.note("each worker has a queue of its own: nobody can stop another");
    return;
  }
  if (claims.max_workers == 1) {
    messenger.note("for one worker: there is nobody to be stopped");
    return;
  }
  // Threads inherit it: the naps around a suspension last as long as they say.
  prctl(PR_SET_TIMERSLACK, 1);
  const bool together = !claims.one_producer() && !claims.one_consumer();
  const auto roles = [&](unsigned workers) {
    return roles_within(claims, together ? all_do_both(workers) : apart(workers, workers));
  };
  Verdicts verdicts;
  if (together) {
    ProgressRun(assignment, roles(2), 0, verdicts, messenger).run(0.2 * assignment.seconds);
  }
  const Roles several = roles(3);
  // The first worker may push, the last may pop: each is the driver for a part of the time.
  for (const unsigned driver : {0U, several.workers - 1}) {
    ProgressRun(assignment, several, driver, verdicts, messenger).run(0.4 * assignment.seconds);
  }
  messenger.progress(verdicts.operations);
  messenger.figure("suspensions", verdicts.suspensions);
  tell(assignment, Doing::push, verdicts, messenger);
  tell(assignment, Doing::pop, verdicts, messenger);
}

}  // namespace irt::stress
