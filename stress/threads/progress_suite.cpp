// Who can go on while somebody stands still in the middle of an operation? Runners use the queue;
// the driver suspends one of them where it happens to stand and makes calls of its own. A monitor
// sees when the driver is stuck.
#include <atomic>
#include <chrono>
#include <fmt/format.h>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

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

std::string_view name(Doing doing) {
  return doing == Doing::push ? "push" : "pop";
}

/// What the suspensions have shown for one method.
struct MethodVerdict {
  std::uint64_t passed = 0;   ///< suspensions during which a call of it ended
  std::uint64_t blocked = 0;  ///< suspensions that stopped it
  std::string evidence = {};  ///< of the first that did
};

struct Verdicts {
  std::uint64_t suspensions = 0;
  std::uint64_t operations = 0;
  MethodVerdict push;
  MethodVerdict pop;

  MethodVerdict& of(Doing method) { return method == Doing::push ? push : pop; }
};

/// CPU time of a thread in nanoseconds; nothing if it cannot be read.
std::optional<std::uint64_t> cpu_time(pid_t thread) {
  std::ifstream file(fmt::format("/proc/self/task/{}/schedstat", thread));
  std::uint64_t time = 0;
  return file >> time ? std::optional(time) : std::nullopt;
}

bool sleeps(pid_t thread) {
  std::ifstream file(fmt::format("/proc/self/task/{}/stat", thread));
  std::string text;
  std::getline(file, text);
  const std::size_t end = text.rfind(')');
  return end != std::string::npos && end + 2 < text.size() && text[end + 2] == 'S';
}

std::string stack(const Trace& trace) {
  std::string text;
  for (const std::string& line : describe(trace)) text += fmt::format("    {}\n", line);
  return text;
}

/// One distribution of roles: the driver is one worker, the runners are the others.
class ProgressRun {
 public:
  ProgressRun(const Assignment& assignment, const Cast& cast, unsigned driver, Verdicts& verdicts,
              Messenger& messenger)
      : assignment_(assignment),
        cast_(cast),
        driver_(driver),
        verdicts_(verdicts),
        messenger_(messenger),
        slots_(cast.workers),
        sequences_(cast.workers, 0) {}

  void run(double seconds) {
    queue_ = assignment_.queue.make_word_queue(cast_.workers, capacity);
    const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(seconds));
    std::thread monitor([&] { watch(); });
    Team team(cast_.workers, slots_.data());
    team.run([&](unsigned worker) {
      if (worker == driver_) {
        drive(end);
        stop_.store(true, std::memory_order_relaxed);
      } else {
        use(worker);
      }
    });
    monitor.join();
    for (const Slot& slot : slots_) verdicts_.operations += slot.done;
  }

 private:
  void call(unsigned worker, Doing method) {
    Slot& slot = slots_[worker];
    slot.doing.store(method, std::memory_order_relaxed);
    if (method == Doing::push) {
      if (queue_->push(worker, element(worker, sequences_[worker]))) {
        ++sequences_[worker];
        inside_.fetch_add(1, std::memory_order_relaxed);
      }
    } else {
      Element e = 0;
      if (queue_->pop(worker, e)) inside_.fetch_sub(1, std::memory_order_relaxed);
    }
    slot.doing.store(Doing::nothing, std::memory_order_relaxed);
    slot.done.store(slot.done.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  void use(unsigned worker) {
    while (!stop_.load(std::memory_order_relaxed)) {
      if (cast_.pushes(worker) && inside_.load(std::memory_order_relaxed) < most_inside) {
        call(worker, Doing::push);
      } else if (!cast_.pops(worker)) {
        std::this_thread::yield();
      }
      if (cast_.pops(worker)) call(worker, Doing::pop);
    }
  }

  void drive(Clock::time_point end) {
    std::uint64_t random = assignment_.seed;
    auto last_word = Clock::now();
    for (auto now = last_word; now < end; now = Clock::now()) {
      random = random * 6364136223846793005U + 1442695040888963407U;
      for (std::uint64_t left = (random >> 33) % 5'000; left > 0; --left) asm volatile("");
      const auto choice = static_cast<unsigned>((random >> 40) % (cast_.workers - 1));
      Slot& victim = slots_[choice < driver_ ? choice : choice + 1];
      if (suspend(victim)) {
        ++verdicts_.suspensions;
        // (1) release: pairs with the acquire load (2)
        victim_.store(&victim, std::memory_order_release);
        for (const Doing method : {Doing::pop, Doing::push, Doing::pop}) {
          if (method == Doing::push ? cast_.pushes(driver_) : cast_.pops(driver_)) {
            call(driver_, method);
          }
        }
        if (victim_.exchange(nullptr, std::memory_order_acq_rel) != nullptr) release(victim);
      } else if (inside_.load(std::memory_order_relaxed) < most_inside) {
        if (cast_.pushes(driver_)) call(driver_, Doing::push);
      } else if (cast_.pops(driver_)) {
        call(driver_, Doing::pop);
      }
      if (now - last_word > 200ms) {
        last_word = now;
        messenger_.progress(verdicts_.operations + slots_[driver_].done);
      }
      if (verdicts_.push.blocked + verdicts_.pop.blocked >= 2 * enough_blocks) break;
    }
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
    }
  }

  void block(Doing method, const Slot& victim) {
    MethodVerdict& verdict = verdicts_.of(method);
    if (verdict.blocked++ > 0) return;
    verdict.evidence =
        fmt::format("  suspended in {}:\n{}", name(victim.doing.load(std::memory_order_relaxed)),
                    stack(victim.trace));
    if (Slot& stuck = slots_[driver_]; ask_trace(stuck)) {
      verdict.evidence += fmt::format("  stuck in {}:\n{}", name(method), stack(stuck.trace));
    }
  }

  const Assignment& assignment_;
  Cast cast_;
  unsigned driver_;
  Verdicts& verdicts_;
  Messenger& messenger_;
  std::vector<Slot> slots_;
  std::vector<std::uint64_t> sequences_;
  std::unique_ptr<ElementQueue> queue_;
  std::atomic<std::int64_t> inside_{0};
  std::atomic<Slot*> victim_{nullptr};  ///< who is held; whoever takes it out releases
  std::atomic<bool> stop_{false};
};

void tell(const Assignment& assignment, Doing method, const Verdicts& verdicts,
          Messenger& messenger) {
  const MethodVerdict& verdict = method == Doing::push ? verdicts.push : verdicts.pop;
  const Claims& claims = assignment.queue.claims;
  const Progress claimed = method == Doing::push ? claims.push : claims.pop;
  const bool blocking = verdict.blocked > 0;
  messenger.figure(std::string(name(method)), blocking ? "blocking" : "goes on");
  if (blocking && claimed != Progress::blocking) {
    messenger.finding(
        {.claim = fmt::format("{} goes on when another thread is stopped", name(method)),
         .evidence = verdict.evidence,
         .repeat = assignment.repeat});
  } else if (blocking) {
    messenger.note(fmt::format("{}: blocking, as claimed", name(method)));
  } else {
    messenger.note(fmt::format("{}: went on in all of {} suspensions{}", name(method),
                               verdicts.suspensions,
                               claimed == Progress::blocking ? " (claimed: blocking)" : ""));
  }
}

}  // namespace

void run_progress(const Assignment& assignment, Messenger& messenger) {
  install_signals();
  const Claims& claims = assignment.queue.claims;
  if (claims.consumers == Callers::own_worker) {
    messenger.note("each worker has a queue of its own: nobody can stop another");
    return;
  }
  const Cast cast =
      cast_for({.name = "progress",
                .summary = "",
                .pushers = 3,
                .poppers = 3,
                .together = claims.producers != Callers::one && claims.consumers != Callers::one},
               claims);
  Verdicts verdicts;
  // The first worker may push, the last may pop: each is the driver for half of the time.
  for (const unsigned driver : {0U, cast.workers - 1}) {
    ProgressRun(assignment, cast, driver, verdicts, messenger).run(assignment.seconds / 2);
  }
  messenger.progress(verdicts.operations);
  messenger.figure("suspensions", verdicts.suspensions);
  tell(assignment, Doing::push, verdicts, messenger);
  tell(assignment, Doing::pop, verdicts, messenger);
}

}  // namespace irt::stress
