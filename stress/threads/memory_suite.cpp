// Memory held against live elements, over a long run.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <fmt/format.h>
#include <string>
#include <thread>
#include <vector>

#include "stress/threads/allocator.hpp"
#include "stress/threads/call.hpp"
#include "stress/threads/low_water.hpp"
#include "stress/threads/signals.hpp"
#include "stress/threads/suites.hpp"
#include "stress/threads/team.hpp"
#include "stress/threads/watchdog.hpp"

namespace irt::stress {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::int64_t most_inside = 1'024;

/// The queue fills up and is emptied again once in so many pushes.
constexpr std::int64_t period = 4'096;
/// The pushes of a period, the last, that find the queue all but empty.
constexpr std::int64_t at_low_water = 64;

/// Fewer pushes do not show a leak of one node in a thousand.
constexpr std::int64_t fewest_pushes = 1 << 20;
/// How much longer than told it may take until there are so many, or growth is decided.
constexpr double patience = 20;  // seconds

/// The bytes the process holds more than at the start, while two threads pass elements through the
/// queue with at most `most_inside` of them inside.
class Churn {
 public:
  Churn(const Assignment& assignment, Messenger& messenger)
      : assignment_(assignment),
        messenger_(messenger),
        roles_(roles_within(assignment.queue.claims, apart(1, 1))),
        slots_(roles_.workers) {}

  void run() {
    const Watchdog watchdog(slots_, hang_patience(), messenger_);
    Team team(roles_.workers, slots_.data());
    const Accounting accounting;
    const auto queue = assignment_.queue.make_word_queue(roles_.workers, most_inside);
    team.run([&](unsigned worker) { work(worker, *queue); });
    tell();
  }

 private:
  [[nodiscard]] std::int64_t inside() const {
    return pushed_.load(std::memory_order_relaxed) - popped_.load(std::memory_order_relaxed);
  }

  /// The first worker, who may push, says when it is over.
  void work(unsigned worker, ElementQueue& queue) {
    const auto start = Clock::now();
    const bool alone = roles_.pushes(worker) && roles_.pops(worker);
    std::uint64_t sequence = 0;
    std::uint64_t idle = 0;
    for (std::uint64_t i = 0; !over_.load(std::memory_order_relaxed); ++i) {
      bool moved = roles_.pushes(worker) && push(worker, queue, sequence);
      for (int twice = 0; roles_.pops(worker) && twice < 2; ++twice)
        moved = pop(worker, queue) || moved;
      if (!moved && !alone && ++idle % 64 == 0) std::this_thread::yield();
      if (worker == 0 && i % 256 == 0) over_.store(enough(start), std::memory_order_relaxed);
    }
    const Call call(slots_[worker], Doing::leave);
    queue.leave(worker);
  }

  /// Asked now and then by the first worker.
  [[nodiscard]] bool enough(Clock::time_point start) {
    const auto now = Clock::now();
    const std::int64_t pushed = pushed_.load(std::memory_order_relaxed);
    if (pushed != last_pushed_) {
      last_pushed_ = pushed;
      last_push_ = now;
    }
    const LowWater::Growth growth = keeps_all() ? LowWater::Growth::none : low_water_.growth();
    const double passed = std::chrono::duration<double>(now - start).count();
    if (passed < assignment_.seconds) return growth == LowWater::Growth::unbounded;
    // A queue that has lost what the pusher waits for will not go on.
    return growth == LowWater::Growth::unbounded || passed >= assignment_.seconds + patience ||
           now - last_push_ > std::chrono::seconds(1) ||
           (growth == LowWater::Growth::none && pushed >= fewest_pushes);
  }

  [[nodiscard]] bool keeps_all() const {
    return assignment_.queue.claims.reclamation == Reclamation::at_destruction;
  }

  bool push(unsigned worker, ElementQueue& queue, std::uint64_t& sequence) {
    const bool low = pushed_.load(std::memory_order_relaxed) % period >= period - at_low_water;
    if (inside() >= (low ? 1 : most_inside)) return false;
    const Element e = next_element(assignment_.queue.claims, worker, sequence);
    const bool accepted = [&] {
      const Call call(slots_[worker], Doing::push);
      return queue.push(worker, e);
    }();
    refused_.store(!accepted, std::memory_order_relaxed);
    if (!accepted) return false;
    ++sequence;
    const std::int64_t pushed = pushed_.fetch_add(1, std::memory_order_relaxed) + 1;
    if (worker == 0 && (low || pushed % 64 == 0)) measure(pushed, low);
    return true;
  }

  bool pop(unsigned worker, ElementQueue& queue) {
    // While the queue fills up, nobody pops; unless it holds less than it should.
    if (pushed_.load(std::memory_order_relaxed) % period < most_inside / 2 &&
        inside() < most_inside / 2 && !refused_.load(std::memory_order_relaxed))
      return false;
    const Call call(slots_[worker], Doing::pop);
    Element e = 0;
    if (!queue.pop(worker, e)) return false;
    popped_.fetch_add(1, std::memory_order_relaxed);
    return true;
  }

  void measure(std::int64_t pushed, bool low) {
    const std::int64_t held = Accounting::live().bytes;
    peak_ = std::max(peak_, held);
    if (low) low_water_.add(static_cast<std::uint64_t>(pushed), held);
  }

  void tell() {
    messenger_.figure("peak_bytes", peak_);
    const LowWater::Growth growth = keeps_all() ? LowWater::Growth::none : low_water_.growth();
    if (growth == LowWater::Growth::unbounded) {
      messenger_.finding(
          {.claim = "reclaims memory",
           .evidence = fmt::format("with next to nothing inside, never more than {} elements, it "
                                   "held at least {}\n",
                                   most_inside, held()),
           .repeat = assignment_.repeat});
    } else if (pushed_ < fewest_pushes) {
      messenger_.limit(
          fmt::format("memory: {} elements passed through the queue, too few to tell (of {})",
                      pushed_.load(), fewest_pushes));
    } else if (peak_ < most_inside * 6) {  // eight bytes each, and not all places always taken
      messenger_.limit("memory: this queue's elements do not live in malloc's memory");
    } else {
      messenger_.note(fmt::format(
          "{} elements passed, at most {} inside: high water {} bytes ({:.0f} per place); all but "
          "empty it held {}",
          pushed_.load(), most_inside, peak_, static_cast<double>(peak_) / most_inside, held()));
      if (growth == LowWater::Growth::undecided)
        messenger_.limit(
            fmt::format("memory: it grew with the pushes when the time was up; a large batch or "
                        "cache looks the same until {} pushes: no verdict",
                        LowWater::enough_pushes));
    }
  }

  /// Low water, in words.
  [[nodiscard]] std::string held() const {
    std::string text;
    for (const LowWater::Mark& mark : low_water_.marks()) {
      if (mark.pushes == 0) continue;
      text += fmt::format("{}{} bytes from {} pushes on", text.empty() ? "" : ", ", mark.bytes,
                          mark.pushes);
    }
    return text;
  }

  const Assignment& assignment_;
  Messenger& messenger_;
  Roles roles_;
  std::vector<Slot> slots_;
  std::atomic<std::int64_t> pushed_{0};
  std::atomic<std::int64_t> popped_{0};
  std::atomic<bool> refused_{false};  ///< the last push answered *full*
  std::atomic<bool> over_{false};
  // The first worker's:
  Clock::time_point last_push_;
  std::int64_t last_pushed_ = 0;
  LowWater low_water_;
  std::int64_t peak_ = 0;
};

}  // namespace

void run_memory(const Assignment& assignment, Messenger& messenger) {
  install_signals();
  Churn(assignment, messenger).run();
}

}  // namespace irt::stress
