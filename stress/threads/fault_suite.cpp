// The k-th allocation fails, for every k: what was accepted must come out, what was refused must
// not, and nothing may leak.
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <new>
#include <string>
#include <vector>

#include "stress/threads/allocator.hpp"
#include "stress/threads/call.hpp"
#include "stress/threads/signals.hpp"
#include "stress/threads/suites.hpp"
#include "stress/threads/watchdog.hpp"

namespace irt::stress {
namespace {

constexpr std::size_t capacity = 64;
constexpr std::uint64_t elements = 192;
constexpr std::uint64_t most_allocations = 5'000;

std::string failing(std::uint64_t k) {
  return k == 0 ? "with no allocation failing"
                : fmt::format("with allocation number {} failing", k);
}

/// What an operation answered.
enum class Reply : std::uint8_t { yes, no, no_memory };

/// One run with the k-th allocation failing. Nothing here allocates but the queue.
class FaultRun {
 public:
  FaultRun(const Assignment& assignment, Slot& slot)
      : assignment_(assignment),
        slot_(slot),
        roles_(roles_within(assignment.queue.claims, all_do_both(2))) {
    std::uint64_t sequence = 0;
    for (std::size_t i = 0; i < elements; ++i, ++sequence)
      words_[i] = next_element(assignment.queue.claims, static_cast<unsigned>(i % roles_.workers),
                               sequence);
  }

  /// The broken promise, or null.
  const char* run(std::uint64_t k) {
    fates_.fill(Fate::unknown);
    due_ = 0;
    const FailingAllocation failing(k);
    const char* broken = nullptr;
    try {
      const auto queue = assignment_.queue.make_word_queue(roles_.workers, capacity);
      broken = use(*queue, roles_.workers);
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
        const auto push = [&] { return queue.push(worker, words_[next]); };
        fates_[next] = call(Doing::push, push) == Reply::yes ? Fate::accepted : Fate::refused;
        if (fates_[next] == Fate::accepted) ++due_;
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
    const bool lost = std::ranges::any_of(fates_, [](Fate fate) { return fate == Fate::accepted; });
    return lost ? "loses nothing it accepted when an allocation fails" : nullptr;
  }

  /// An operation that the watchdog sees.
  template <class Operation>
  Reply call(Doing method, const Operation& operation) {
    const Call call(slot_, method);
    try {
      return operation() ? Reply::yes : Reply::no;
    } catch (const std::bad_alloc&) {
      return Reply::no_memory;  // refused; what it did all the same comes to light
    }
  }

  const char* pop(ElementQueue& queue, unsigned worker) {
    Element e = 0;
    if (call(Doing::pop, [&] { return queue.pop(worker, e); }) != Reply::yes) return nullptr;
    const auto i = static_cast<std::size_t>(std::ranges::find(words_, e) - words_.begin());
    if (i == elements || fates_[i] == Fate::unknown) return "pops only what was pushed";
    if (fates_[i] == Fate::refused) return "refuses an element entirely when an allocation fails";
    if (fates_[i] == Fate::popped) return "every element leaves once when an allocation fails";
    fates_[i] = Fate::popped;
    --due_;
    return nullptr;
  }

  const Assignment& assignment_;
  Slot& slot_;
  Roles roles_;
  std::array<Element, elements> words_{};
  std::array<Fate, elements> fates_{};
  std::uint64_t due_ = 0;  ///< accepted and not popped
  std::uint64_t allocations_ = 0;
};

}  // namespace

void run_faults(const Assignment& assignment, Messenger& messenger) {
  if (!assignment.queue.claims.survives_no_memory) {
    messenger.note("claims nothing of allocations that fail: none was made to");
    return;
  }
  install_signals();
  std::vector<Slot> slots(1);
  const Watchdog watchdog(slots, hang_patience(), messenger);
  const Presence presence(slots[0]);
  FaultRun run(assignment, slots[0]);
  const auto fail = [&](const char* claim, std::uint64_t k) {
    messenger.finding({.claim = claim, .evidence = failing(k), .repeat = assignment.repeat});
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
    {
      const OutsideAccounting outside;
      messenger.trying(failing(k));
    }
    const std::int64_t before = Accounting::live().blocks;
    const char* broken = run.run(k);
    if (broken != nullptr) return fail(broken, k);
    if (Accounting::live().blocks > before && leaked_by(k) > 0 && leaked_by(k) > 0) {
      return fail("leaks nothing when an allocation fails", k);
    }
    if (run.allocations() < k) break;  // there was no k-th allocation: all have failed once
  }
  if (k > most_allocations) {
    messenger.limit(fmt::format("faults: only the first {} allocations failed", most_allocations));
  }
  messenger.figure("allocations_failed", k - 1);
  messenger.note(k == 1
                     ? "allocates nothing"
                     : fmt::format("each of {} allocations failed once: nothing lost, doubled or "
                                   "leaked",
                                   k - 1));
}

}  // namespace irt::stress
