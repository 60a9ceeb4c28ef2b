// Memory held against live elements, over a long run.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <fmt/format.h>
#include <thread>
#include <vector>

#include "stress/threads/allocator.hpp"
#include "stress/threads/signals.hpp"
#include "stress/threads/suites.hpp"
#include "stress/threads/team.hpp"

namespace irt::stress {
namespace {

using Clock = std::chrono::steady_clock;

/// The bytes the process holds more than at the start, while two threads pass elements through the
/// queue with at most `most_inside` of them inside.
class Churn {
 public:
  Churn(const Assignment& assignment, Messenger& messenger)
      : assignment_(assignment),
        messenger_(messenger),
        cast_(cast_for({.name = "memory", .summary = "", .pushers = 1, .poppers = 1},
                       assignment.queue.claims)),
        slots_(cast_.workers) {}

  void run() {
    const Accounting accounting;
    Team team(cast_.workers, slots_.data());
    const std::int64_t start = Accounting::live().bytes;
    const auto queue = assignment_.queue.make_word_queue(cast_.workers, most_inside);
    team.run([&](unsigned worker) { work(worker, *queue); });
    tell(start);
  }

 private:
  static constexpr std::int64_t most_inside = 1'024;

  struct Sample {
    std::int64_t pushed;
    std::int64_t bytes;
  };

  void work(unsigned worker, ElementQueue& queue) {
    const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(assignment_.seconds));
    const bool alone = cast_.pushes(worker) && cast_.pops(worker);
    std::int64_t own_inside = 0;
    std::uint64_t sequence = 0;
    for (std::uint64_t i = 0; i % 256 != 0 || Clock::now() < end; ++i) {
      if (cast_.pushes(worker)) {
        const std::int64_t inside = alone ? own_inside
                                          : pushed_.load(std::memory_order_relaxed) -
                                                popped_.load(std::memory_order_relaxed);
        if (inside < most_inside &&
            queue.push(worker, next_element(assignment_.queue.claims, worker, sequence))) {
          ++sequence;
          ++own_inside;
          const std::int64_t pushed = pushed_.fetch_add(1, std::memory_order_relaxed) + 1;
          if (worker == 0) sample(pushed);
        } else if (!alone) {
          std::this_thread::yield();
        }
      }
      Element e = 0;
      // Now and then the queue fills up, so that it must grow and shrink.
      const bool due = !assignment_.pop_waits || pushed_.load() > popped_.load();
      if (cast_.pops(worker) && due && (!alone || i % 4'096 >= 512)) {
        if (queue.pop(worker, e)) {
          --own_inside;
          popped_.fetch_add(1, std::memory_order_relaxed);
          if (alone && queue.pop(worker, e)) {
            --own_inside;
            popped_.fetch_add(1, std::memory_order_relaxed);
          }
        }
      }
    }
  }

  /// Keeps some thousand samples, evenly spread over the run so far.
  void sample(std::int64_t pushed) {
    if (pushed < next_sample_) return;
    if (samples_.size() == samples_.capacity()) {
      for (std::size_t i = 0; 2 * i < samples_.size(); ++i) samples_[i] = samples_[2 * i];
      samples_.resize(samples_.size() / 2);
      sample_distance_ *= 2;
      messenger_.progress(static_cast<std::uint64_t>(pushed));
    }
    samples_.push_back({pushed, Accounting::live().bytes});
    next_sample_ = pushed + sample_distance_;
  }

  void tell(std::int64_t start) {
    messenger_.progress(static_cast<std::uint64_t>(pushed_.load()));
    if (samples_.size() < 16) {
      messenger_.limit("memory: too few elements passed through the queue to tell");
      return;
    }
    std::int64_t peak = 0;
    for (const Sample& s : samples_) peak = std::max(peak, s.bytes - start);
    // Growth between the medians of the second and of the last quarter: what is set up on the way
    // and what is batched does not count.
    const auto median = [&](std::size_t from, std::size_t to) {
      std::vector<std::int64_t> bytes;
      for (std::size_t i = from; i < to; ++i) bytes.push_back(samples_[i].bytes);
      std::nth_element(bytes.begin(), bytes.begin() + std::ssize(bytes) / 2, bytes.end());
      return bytes[bytes.size() / 2];
    };
    const std::size_t quarter = samples_.size() / 4;
    const std::int64_t growth = median(3 * quarter, 4 * quarter) - median(quarter, 2 * quarter);
    const std::int64_t pushes = samples_[3 * quarter].pushed - samples_[quarter].pushed;
    const double per_push = static_cast<double>(growth) / static_cast<double>(pushes);
    messenger_.figure("peak_bytes", peak);
    messenger_.figure("bytes_per_push", per_push);
    // Eight bytes each, and not all places are taken all the time.
    if (peak < most_inside * 6) {
      messenger_.limit("memory: this queue's elements do not live in malloc's memory");
      return;
    }
    messenger_.note(
        fmt::format("{} elements passed, at most {} inside: high water {} bytes ({:.0f} "
                    "per place), growth {:.3f} bytes per push",
                    pushed_.load(), most_inside, peak, static_cast<double>(peak) / most_inside,
                    std::max(0.0, per_push)));
    const bool keeps = assignment_.queue.claims.reclamation == Reclamation::at_destruction;
    if (per_push > 1 && !keeps) {
      messenger_.finding(
          {.claim = "reclaims memory",
           .evidence = fmt::format("memory grew by {:.1f} bytes with every push, over "
                                   "{} pushes, with at most {} elements inside",
                                   per_push, pushes, most_inside),
           .repeat = assignment_.repeat});
    }
  }

  const Assignment& assignment_;
  Messenger& messenger_;
  Cast cast_;
  std::vector<Slot> slots_;
  std::atomic<std::int64_t> pushed_{0};
  std::atomic<std::int64_t> popped_{0};
  std::int64_t sample_distance_ = 64;
  std::int64_t next_sample_ = 0;
  std::vector<Sample> samples_ = [] {
    std::vector<Sample> samples;
    samples.reserve(1U << 12);
    return samples;
  }();
};

}  // namespace

void run_memory(const Assignment& assignment, Messenger& messenger) {
  install_signals();
  Churn(assignment, messenger).run();
}

}  // namespace irt::stress
