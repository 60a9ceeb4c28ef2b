// The k-th allocation fails, for every k: what was accepted must come out, what was refused must
// not, and nothing may leak.
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <new>
#include <optional>

#include "stress/threads/allocator.hpp"
#include "stress/threads/suites.hpp"

namespace irt::stress {
namespace {

constexpr std::size_t capacity = 64;
constexpr std::uint64_t elements = 192;
constexpr std::uint64_t most_allocations = 5'000;

/// One run with the k-th allocation failing. Nothing here allocates but the queue.
class FaultRun {
 public:
  explicit FaultRun(const Assignment& assignment) : assignment_(assignment) {}

  /// The broken promise, or null.
  const char* run(std::uint64_t k) {
    fates_.fill(Fate::unknown);
    const Cast cast =
        cast_for({.name = "faults", .summary = "", .pushers = 2, .poppers = 2, .together = true},
                 assignment_.queue.claims);
    const FailingAllocation failing(k);
    const char* broken = nullptr;
    try {
      const auto queue = assignment_.queue.make_word_queue(cast.workers, capacity);
      broken = use(*queue, cast.workers);
    } catch (const std::bad_alloc&) {
      // The constructor threw: there is no queue, nothing was accepted.
    }
    allocations_ = FailingAllocation::seen();
    return broken;
  }

  [[nodiscard]] std::uint64_t allocations() const { return allocations_; }

 private:
  enum class Fate : std::uint8_t { unknown, accepted, refused, popped };

  /// Fills and empties the queue three times, far below its capacity in between.
  const char* use(ElementQueue& queue, unsigned workers) {
    std::uint64_t next = 0;
    for (int wave = 0; wave < 3; ++wave) {
      for (std::uint64_t i = 0; i < elements / 3; ++i, ++next) {
        const auto worker = static_cast<unsigned>(next % workers);
        try {
          fates_[next] = queue.push(worker, element(worker, next)) ? Fate::accepted : Fate::refused;
        } catch (const std::bad_alloc&) {
          fates_[next] = Fate::refused;
        }
        if (i % 4 == 3) {
          if (const char* broken = pop(queue, worker)) return broken;
        }
      }
      for (unsigned worker = 0; worker < workers; ++worker) {
        for (std::uint64_t i = 0; i < 2 * elements; ++i) {
          if (const char* broken = pop(queue, worker)) return broken;
        }
      }
    }
    const bool lost =
        std::any_of(fates_.begin(), fates_.end(), [](Fate fate) { return fate == Fate::accepted; });
    return lost ? "loses nothing it accepted when an allocation fails" : nullptr;
  }

  const char* pop(ElementQueue& queue, unsigned worker) {
    Element e = 0;
    try {
      if (!queue.pop(worker, e)) return nullptr;
    } catch (const std::bad_alloc&) {
      return nullptr;
    }
    const std::uint64_t i = sequence_of(e);
    if (i >= elements || fates_[i] == Fate::unknown) return "pops only what was pushed";
    if (fates_[i] == Fate::refused) return "refuses an element entirely when an allocation fails";
    if (fates_[i] == Fate::popped) return "every element leaves once when an allocation fails";
    fates_[i] = Fate::popped;
    return nullptr;
  }

  const Assignment& assignment_;
  std::array<Fate, elements> fates_{};
  std::uint64_t allocations_ = 0;
};

}  // namespace

void run_faults(const Assignment& assignment, Messenger& messenger) {
  FaultRun run(assignment);
  const auto fail = [&](const char* claim, std::uint64_t k) {
    messenger.finding({.claim = claim,
                       .evidence = fmt::format("with the {}-th allocation failing", k),
                       .repeat = assignment.repeat});
  };
  // What is set up once per thread or process must not look like a leak.
  for (int warm_up = 0; warm_up < 3; ++warm_up) {
    if (const char* broken = run.run(0)) return fail(broken, 0);
  }
  const Accounting accounting;
  const auto leaked_by = [&](std::uint64_t k) {
    const std::int64_t before = Accounting::live().blocks;
    run.run(k);
    return Accounting::live().blocks - before;
  };
  std::uint64_t k = 1;
  for (; k <= most_allocations; ++k) {
    // The parent hears about the k that crashes.
    if (k % 16 == 1) messenger.progress(k);
    const std::int64_t before = Accounting::live().blocks;
    const char* broken = run.run(k);
    if (broken != nullptr) return fail(broken, k);
    if (Accounting::live().blocks > before && leaked_by(k) > 0 && leaked_by(k) > 0) {
      return fail("leaks nothing when an allocation fails", k);
    }
    if (run.allocations() < k) break;  // there was no k-th allocation: all have failed once
  }
  messenger.progress(k);
  messenger.figure("allocations_failed", k - 1);
  messenger.note(k == 1
                     ? "allocates nothing"
                     : fmt::format("each of {} allocations failed once: nothing lost, doubled or "
                                   "leaked",
                                   k - 1));
}

}  // namespace irt::stress
