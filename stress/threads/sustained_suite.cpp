// As hard as the benchmarks: threads push and pop without a pause, without clocks and without logs.
// Each adds up what it moved; again and again all stand still, and the sums must agree with what is
// inside. Half of the time, some are put to sleep in the middle of an operation, while others go
// round the queue.
#include <algorithm>
#include <array>
#include <chrono>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "stress/history/specification.hpp"
#include "stress/history/violation.hpp"
#include "stress/threads/call.hpp"
#include "stress/threads/interrupter.hpp"
#include "stress/threads/signals.hpp"
#include "stress/threads/suites.hpp"
#include "stress/threads/team.hpp"
#include "stress/threads/watchdog.hpp"

namespace irt::stress {
namespace {

using Clock = std::chrono::steady_clock;

enum class Traffic : std::uint8_t { pairs, exchange, bursts, sides };

std::string_view name(Traffic traffic) {
  constexpr std::array<std::string_view, 4> names{
      "each thread pushes one and pops one", "each thread pops one and pushes one, half full",
      "each thread pushes up to 64 and pops as many", "threads push or pop as fast as they can"};
  return names.at(static_cast<std::size_t>(traffic));
}

/// Elements as sums: equal multisets have equal sums, and one element that is missing is their
/// difference.
struct Sums {
  std::uint64_t count = 0;
  std::uint64_t sum = 0;
  std::uint64_t mixed = 0;  ///< of a function that is not linear

  void add(Element e) {
    ++count;
    sum += e;
    mixed += (e ^ (e >> 7)) * 0x9e3779b97f4a7c15U;
  }
  Sums& operator+=(const Sums& other) {
    count += other.count;
    sum += other.sum;
    mixed += other.mixed;
    return *this;
  }
  friend bool operator==(const Sums&, const Sums&) = default;
};

/// What one thread keeps: plain memory of its own.
struct alignas(128) Account {
  Sums pushed;
  Sums popped;
  std::uint64_t next = 0;                 ///< number of its next element
  std::vector<std::uint64_t> first_free;  ///< by producer: numbers below have come out here
  std::optional<Element> out_of_order;    ///< the first that came here after a later one
  std::optional<Element> invented;        ///< the first that names no worker of the run
  bool wrongly_full = false;
};

/// One queue, used for some phases.
class Life {
 public:
  Life(const Assignment& assignment, const Roles& roles, std::size_t capacity, Traffic traffic,
       std::vector<Slot>& slots, std::uint64_t seed)
      : claims_(assignment.queue.claims),
        roles_(roles),
        capacity_(capacity),
        traffic_(traffic),
        slots_(slots),
        random_(seed),
        most_work_(seed % 3 == 0 ? 0U : 100U << seed % 3),
        accounts_(roles.workers),
        queue_(assignment.queue.make_word_queue(roles.workers, capacity)) {
    for (Account& account : accounts_) account.first_free.resize(roles.workers);
    fill(first_inside());
    leave_all(*queue_, roles_.workers);
  }

  /// Every worker's part of a phase that lasts until `end`.
  void work(unsigned worker, Clock::time_point end) {
    const bool pushes = roles_.pushes(worker);
    const bool pops = roles_.pops(worker);
    Slot& slot = slots_[worker];
    std::uint64_t random = random_ + worker;
    for (unsigned turn = 0; turn % 64 != 0 || Clock::now() < end; ++turn) {
      switch (traffic_) {
        case Traffic::bursts:
          for (int i = 0; pushes && i < 64 && push(worker, slot); ++i) rest(random);
          for (int i = 0; pops && i < 64 && pop(worker, slot); ++i) rest(random);
          break;
        case Traffic::exchange:
          if (pops) pop(worker, slot);
          rest(random);
          if (pushes) push(worker, slot);
          rest(random);
          break;
        default: {
          const bool pushed = pushes && push(worker, slot);
          if (!pushed && !pops) std::this_thread::yield();
          rest(random);
          const bool popped = pops && pop(worker, slot);
          if (!popped && !pushes) std::this_thread::yield();
          rest(random);
        }
      }
    }
    const Call call(slot, Doing::leave);
    queue_->leave(worker);
  }

  /// While all stand still. Empties the queue, on behalf of everybody who may pop, and compares;
  /// fills it up, and leaves inside what a life starts with.
  std::optional<BrokenClaim> count() {
    std::optional<BrokenClaim> found = count_all();
    leave_all(*queue_, roles_.workers);
    return found;
  }

  /// Whether more came out than went in.
  [[nodiscard]] bool overdrawn() const {
    return total(&Account::popped).count > total(&Account::pushed).count;
  }

  /// What can be said without emptying it.
  [[nodiscard]] std::optional<BrokenClaim> look() const {
    for (const Account& account : accounts_) {
      if (account.invented) return finding("pops only what was pushed", *account.invented);
      if (account.out_of_order && ordered())
        return finding("order of elements", *account.out_of_order);
      if (account.wrongly_full)
        return BrokenClaim{"never full, for it claims no bound", "a push answered full\n", {}};
    }
    return std::nullopt;
  }

 private:
  std::optional<BrokenClaim> count_all() {
    const Sums pushed = total(&Account::pushed);
    const std::uint64_t before = total(&Account::popped).count;
    std::uint64_t left = pushed.count - std::min(before, pushed.count) + 1'000;
    std::optional<unsigned> denied;  // a worker who found nothing before others found something
    bool false_empty = false;
    for (bool found = true; found && left > 0;) {
      found = false;
      for (unsigned worker = 0; worker < roles_.workers; ++worker) {
        if (!roles_.pops(worker)) continue;
        for (; left > 0 && pop(worker, slots_.back()); --left) {
          found = true;
          false_empty = false_empty || denied;
        }
        denied = worker;
      }
    }
    if (std::optional<BrokenClaim> broken = judge(pushed, total(&Account::popped))) return broken;
    const Specification specification(claims_, capacity_);
    if (false_empty && specification.empty() != Answer::this_worker && !claims_.own_queues())
      return BrokenClaim{
          std::string(promise(Pattern::witness)),
          "with all others at rest a pop answered empty; then another worker's found "
          "something\n",
          {}};
    if (claims_.bounded) return fill_up();
    fill(first_inside());
    return std::nullopt;
  }

  /// How many elements are inside from the beginning.
  [[nodiscard]] std::size_t first_inside() const {
    return traffic_ == Traffic::exchange ? capacity_ / 2 : 0;
  }

  /// Pushes so many, on behalf of all who may; how many were accepted.
  std::size_t fill(std::size_t elements) {
    std::size_t accepted = 0;
    for (std::size_t i = 0; i < elements; ++i)
      accepted += push(static_cast<unsigned>(i) % roles_.producers, slots_.back()) ? 1 : 0;
    return accepted;
  }

  /// Of an empty queue with a bound: as many as it was made for must find a place.
  std::optional<BrokenClaim> fill_up() {
    const std::size_t accepted = fill(capacity_);
    if (accepted < capacity_)
      return BrokenClaim{
          std::string(promise(Pattern::full)),
          fmt::format("with all others at rest, an empty queue took {} elements of {}\n", accepted,
                      capacity_),
          {}};
    std::size_t left = capacity_ - first_inside();
    for (unsigned worker = 0; worker < roles_.workers; ++worker)
      while (left > 0 && roles_.pops(worker) && pop(worker, slots_.back())) --left;
    return std::nullopt;
  }

  /// What a program does between its operations: at full speed, threads seldom meet, for each
  /// keeps the cache line while it has a processor.
  void rest(std::uint64_t& random) const {
    if (most_work_ == 0) return;
    random = random * 6364136223846793005U + 1442695040888963407U;
    for (std::uint64_t left = (random >> 33) % most_work_; left > 0; --left) asm volatile("");
  }

  bool push(unsigned worker, Slot& slot) {
    Account& account = accounts_[worker];
    const Element e = next_element(claims_, worker, account.next);
    const bool accepted = [&] {
      const Call call(slot, Doing::push);
      return queue_->push(worker, e);
    }();
    if (accepted) {
      account.pushed.add(e);
      ++account.next;
    } else if (!claims_.bounded) {
      account.wrongly_full = true;
    }
    return accepted;
  }

  bool pop(unsigned worker, Slot& slot) {
    Account& account = accounts_[worker];
    Element e = 0;
    const bool found = [&] {
      const Call call(slot, Doing::pop);
      return queue_->pop(worker, e);
    }();
    if (!found) return false;
    account.popped.add(e);
    const std::uint64_t producer = e >> sequence_bits;
    if (producer >= roles_.workers) {
      if (!account.invented) account.invented = e;
      return true;
    }
    std::uint64_t& first_free = account.first_free[producer];
    if (sequence_of(e) < first_free && !account.out_of_order) account.out_of_order = e;
    first_free = std::max(first_free, sequence_of(e) + 1);
    return true;
  }

  /// Whether one producer's elements come to one consumer in order.
  [[nodiscard]] bool ordered() const {
    return claims_.ordering != Ordering::unordered && claims_.ordering != Ordering::k_relaxed_fifo;
  }

  [[nodiscard]] Sums total(Sums Account::*which) const {
    Sums all;
    for (const Account& account : accounts_) all += account.*which;
    return all;
  }

  [[nodiscard]] std::optional<BrokenClaim> judge(const Sums& pushed, const Sums& popped) const {
    if (std::optional<BrokenClaim> found = look()) return found;
    if (pushed == popped) return std::nullopt;
    if (popped.count < pushed.count) {
      BrokenClaim lost{
          "no element is lost",
          fmt::format("{} of {} elements that were accepted did not come out, not even "
                      "when the queue was emptied\n",
                      pushed.count - popped.count, pushed.count),
          {}};
      if (popped.count + 1 == pushed.count)
        lost.evidence += fmt::format("by the sums, it is {}\n", word(pushed.sum - popped.sum));
      return lost;
    }
    BrokenClaim twice{"every element leaves once",
                      fmt::format("{} pushes and {} pops, counted when the queue was empty\n",
                                  pushed.count, popped.count),
                      {}};
    if (popped.count == pushed.count + 1)
      twice.evidence +=
          fmt::format("by the sums, what left twice is {}\n", word(popped.sum - pushed.sum));
    if (popped.count == pushed.count)
      twice.evidence += "by the sums, some elements left twice and some not at all\n";
    return twice;
  }

  static std::string word(Element e) {
    return fmt::format("{}:{} (producer:number)", producer_of(e), sequence_of(e));
  }
  static BrokenClaim finding(std::string_view claim, Element e) {
    return {std::string(claim), fmt::format("{} was popped\n", word(e)), {}};
  }

  const Claims& claims_;
  Roles roles_;
  std::size_t capacity_;
  Traffic traffic_;
  std::vector<Slot>& slots_;
  std::uint64_t random_;
  std::uint64_t most_work_;  ///< steps of an empty loop between two operations
  std::vector<Account> accounts_;
  std::unique_ptr<ElementQueue> queue_;
};

/// Lives with one number of threads, one after the other.
class Sustained {
 public:
  Sustained(const Assignment& assignment, unsigned threads, Messenger& messenger)
      : assignment_(assignment),
        roles_(roles_within(assignment.queue.claims,
                            together(assignment) ? all_do_both(threads)
                                                 : apart(threads / 2, threads - threads / 2))),
        slots_(roles_.workers + 1),
        watchdog_(slots_, hang_patience(), messenger),
        team_(roles_.workers, slots_.data()),
        interrupter_(slots_, assignment.seed),
        random_(assignment.seed * 2 + threads) {}

  std::optional<BrokenClaim> run(double seconds) {
    const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(seconds));
    for (unsigned number = 0; Clock::now() < end; ++number) {
      if (auto found = live(number, std::min(end, Clock::now() + std::chrono::milliseconds(250))))
        return found;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::uint64_t points() const { return points_; }

 private:
  static bool together(const Assignment& assignment) {
    const Claims& claims = assignment.queue.claims;
    return !claims.one_producer() && !claims.one_consumer();
  }

  std::uint64_t next() {
    random_ = random_ * 6364136223846793005U + 1442695040888963407U;  // Knuth's MMIX generator
    return random_ >> 33;
  }

  std::optional<BrokenClaim> live(unsigned number, Clock::time_point end) {
    // Most of them small, so that rings go round; one so large that segments follow each other.
    constexpr std::array<std::size_t, 9> capacities{1024, 1 << 15, 100, 2, 64, 5, 256, 3, 1024};
    const std::size_t capacity = capacities.at(number % capacities.size());
    const Traffic used = together(assignment_) ? static_cast<Traffic>(number % 4) : Traffic::sides;
    const bool stalls = next() % 2 == 0;
    const Presence presence(slots_.back());
    Life life(assignment_, roles_, capacity, used, slots_, next());
    std::optional<BrokenClaim> found;
    do {
      // From a tenth of a millisecond to a tenth of a second: a thread that loses its processor
      // in an operation is to find that others have gone round the queue a hundred times.
      const auto phase = std::chrono::microseconds(std::uint64_t{100} << next() % 11);
      const auto stop = std::min(Clock::now() + phase, end);
      interrupter_.set_active(stalls);
      team_.run([&](unsigned worker) { life.work(worker, stop); });
      interrupter_.set_active(false);
      ++points_;
      // Not always: what stays inside is carried over, and may be what matters.
      found = life.overdrawn() || next() % 4 == 0 ? life.count() : life.look();
      if (found) break;
    } while (Clock::now() < end);
    if (!found) found = life.count();
    if (!found) return found;
    found->evidence += fmt::format("{} threads ({}{}), capacity {}, in phase {}\n", roles_.workers,
                                   name(used), stalls ? ", stalls" : "", capacity, points_);
    found->repeat = assignment_.repeat;
    return found;
  }

  const Assignment& assignment_;
  Roles roles_;
  std::vector<Slot> slots_;  ///< one per worker, and one for the thread that counts
  Watchdog watchdog_;
  Team team_;
  Interrupter interrupter_;
  std::uint64_t random_;
  std::uint64_t points_ = 0;
};

}  // namespace

void run_sustained(const Assignment& assignment, Messenger& messenger) {
  install_signals();
  std::uint64_t points = 0;
  for (const unsigned threads : {4U, 8U}) {
    Sustained sustained(assignment, threads, messenger);
    const std::optional<BrokenClaim> found = sustained.run(assignment.seconds / 2);
    points += sustained.points();
    if (found) {
      messenger.finding(*found);
      break;
    }
  }
  messenger.figure("quiescent_points", points);
}

}  // namespace irt::stress
