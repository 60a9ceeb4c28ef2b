/// A simulated machine: threads of instrumented code on virtual cores, in simulated time.
///
///     Machine machine(load_profile("granite-rapids-96"), place(profile, 64), seed);
///     machine.set_up([&] { queue = ...; });                    // thread 0, costs nothing
///     const Ending ending = machine.run(2e6, [&](unsigned thread) {
///       while (!machine.over()) { queue->push(thread, 1); machine.work(85); ... }
///     });
///
/// Every access of the instrumented code to shared memory happens at a moment of simulated time,
/// and all happen in the order of these moments (ties: lines first, then first come, first served).
/// So what the code computes is what it would compute on a sequentially consistent machine with
/// these delays, and an operation takes effect when the simulated directory grants its line.
///
/// One exception makes private data fast: accesses to a line that no other thread has ever used,
/// and reads of a line that nobody has ever written to in simulated time, may run ahead of the
/// others by `private_window`. They are still made one after the other, on the real memory; only
/// who comes first when that ends may differ by that much.
///
/// What the host's code does between calls of the instrumented code (`body`) takes no time.
///
/// Not modelled: weaker memory orders than the machine's store buffer gives; see directory.hpp,
/// heap.hpp and docs/simulator.md for what else.
#pragma once

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

#include "bench/many_core/coherence/directory.hpp"
#include "bench/many_core/machine/heap.hpp"
#include "bench/many_core/machine/thread.hpp"
#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::many_core {

/// What a thread does with its time besides running.
enum class Cause : std::uint8_t {
  transfer,   ///< a line is on its way
  queueing,   ///< other cores are served first
  stores,     ///< earlier stores must be done before this operation
  spinning,   ///< asleep in a loop that looks at the same lines again and again
  parked,     ///< asleep in the kernel, and being woken
  scheduler,  ///< other threads have the core
};
inline constexpr std::size_t causes = 6;
std::string_view name_of(Cause cause);

/// How a run ended.
struct Ending {
  enum class Kind : std::uint8_t {
    finished,  ///< every thread returned
    asleep,    ///< all that are left wait for each other
    late,      ///< some did not return, long after they should have
    failed,    ///< the code cannot go on
  };
  Kind kind = Kind::finished;
  std::string message;
};

/// What happened in the measured part of a run.
struct Counts {
  std::uint64_t accesses = 0;      ///< to memory that threads share
  std::uint64_t transfers = 0;     ///< lines that moved
  std::uint64_t swaps = 0;         ///< compare-and-swaps that succeeded
  std::uint64_t failed_swaps = 0;  ///< and that did not
  std::uint64_t sleeps = 0;        ///< waits in the kernel
  std::array<Time, causes> waited{};
};

/// Which hardware thread of the profile each of `threads` threads runs on. More threads than the
/// machine has share its hardware threads in turn.
enum class Placement : std::uint8_t {
  close,     ///< a core each, neighbours first; second hardware threads last
  siblings,  ///< neighbours first, both hardware threads of a core together
  spread,    ///< a core each, alternating between sockets
};
std::vector<unsigned> place(const Profile& profile, unsigned threads, Placement placement);

/// A number of threads up to which all are within one group of the machine, and with one more no
/// longer.
struct Level {
  unsigned threads;
  std::string_view name;  ///< "one cache"
};
/// The levels that threads placed so pass, by rising number; at 2 threads and more.
std::vector<Level> levels(const Profile& profile, Placement placement);

class Machine final : public virtual_cores::Tenant {
 public:
  static constexpr Time private_window = 200 * nanosecond;
  static constexpr Time patience = 20'000'000 * nanosecond;
  static constexpr std::uint64_t patience_events = 50'000'000;

  /// `hardware_threads[i]` is where thread i runs, by the profile's numbers.
  Machine(const Profile& profile, const std::vector<unsigned>& hardware_threads,
          std::uint64_t seed);
  ~Machine() override;

  /// Runs `body` as thread 0, outside of simulated time. Throws std::runtime_error where the code
  /// cannot go on.
  void set_up(const std::function<void()>& body);

  /// Runs `body(thread)` on every thread, from time 0. What happens from `count_from` on is
  /// counted, `over()` is true from `until` on. Who has not returned `patience` later is late; so
  /// are all when as many events as `patience_events` have passed since.
  Ending run(Time count_from, Time until, std::function<void(unsigned)> body);

  // Within `body`.
  /// Whether time is up for the calling thread.
  bool over() const { return me_->clock >= until_; }
  /// Where the calling thread is.
  Time clock() const { return me_->clock; }
  /// `ns` of work that no other thread can see or disturb.
  void work(double ns);
  /// The same, and then what the others have done meanwhile is done.
  void idle(double ns) {
    work(ns);
    sync(*me_);
  }
  /// A step that waited in vain; counted here so that a sleeping loop's rounds are, too.
  void count_failure() { ++me_->failures; }

  /// Whether what happens at `time` is counted.
  bool counts_at(Time time) const { return time >= count_from_ && time <= until_; }
  /// The latest moment that any thread has reached.
  Time last_clock() const;

  std::uint64_t failures(unsigned thread) const { return threads_[thread].failures; }
  /// Of all threads, from `count_from` on.
  const Counts& counts() const { return counts_; }
  const Directory& directory() const { return directory_; }
  const Heap& heap() const { return heap_; }
  std::uint64_t events() const { return events_taken_; }

  // As a tenant.
  void plain_read(std::uintptr_t address, std::size_t size, const void* pc) override;
  void plain_write(std::uintptr_t address, std::size_t size, const void* pc) override;
  virtual_cores::Value load(const virtual_cores::Access& access) override;
  void store(const virtual_cores::Access& access, virtual_cores::Value value) override;
  virtual_cores::Value modify(const virtual_cores::Access& access,
                              virtual_cores::Operation operation,
                              virtual_cores::Value operand) override;
  bool compare_exchange(const virtual_cores::Access& access, virtual_cores::Order failure,
                        bool weak, virtual_cores::Value& expected,
                        virtual_cores::Value desired) override;
  void fence(virtual_cores::Order order, const void* pc) override;
  void* allocate(std::size_t size, std::size_t alignment, const void* pc) override;
  void release(void* block, const void* pc) override;
  std::size_t block_size(void* block) override;
  void lock(std::uintptr_t address, const void* pc) override;
  bool try_lock(std::uintptr_t address, const void* pc) override;
  void unlock(std::uintptr_t address, const void* pc) override;
  virtual_cores::Wake wait(std::uintptr_t address, std::uint32_t expected, std::int64_t nanoseconds,
                           const void* pc) override;
  unsigned wake(std::uintptr_t address, unsigned count, const void* pc) override;
  void yield(const void* pc) override;
  void sleep(std::int64_t nanoseconds, const void* pc) override;
  void pause() override;
  std::int64_t now() override;
  unsigned finished(unsigned core) override;
  void on_failure(const std::string& what, const void* pc) override;

 private:
  // One hardware thread, and the threads that run there.
  struct Hardware {
    unsigned running = nobody;
    std::deque<unsigned> ready;
    Time quantum_end = never;
  };
  // Who sleeps until a word is woken.
  struct Sleepers {
    std::uintptr_t bucket = 0;  // where the kernel keeps them
    std::deque<unsigned> threads;
  };

  static void enter(void* thread);

  // Order of events (machine.cpp).
  // Notes that `thread`, or the host, goes on now.
  unsigned going_on(unsigned thread) {
    if (thread != virtual_cores::host) me_ = &threads_[thread];
    return thread;
  }
  // Takes the next event. There must be one.
  Event& next_event() {
    Event& event = events_.pop();
    ++events_taken_;
    if (event.time >= mark_) pass_mark(event.time);
    return event;
  }
  void pass_mark(Time time);
  unsigned next_thread();
  unsigned serve(Line& line, Time now, Time limit);
  // The current thread has nothing to do until its event.
  void go_on() { cores_.switch_to(going_on(next_thread())); }
  [[noreturn]] void end(Ending::Kind kind, const std::string& message);
  [[noreturn]] void end_late(Time time);
  void reach_deadline(Thread& me);
  // Whether nothing else happens before the thread's next step, or before it is `ahead` of others.
  bool is_next(const Thread& me, Time ahead) const {
    return me.clock < me.deadline && me.clock - ahead < events_.front_time();
  }
  void sync(Thread& me, Time ahead = 0) {
    if (me.clock >= me.deadline) reach_deadline(me);
    if (me.clock - ahead >= events_.front_time()) let_others(me, ahead);
  }
  void let_others(Thread& me, Time ahead);
  void start_counting();
  void note_wait(Cause cause, Time from, Time to) {
    counts_.waited[static_cast<std::size_t>(cause)] +=
        std::max<Time>(0, std::min(to, until_) - std::max(from, count_from_));
  }

  // Accesses (accesses.cpp).
  Line& line_of(const Thread& me, std::uintptr_t address) {
    Line* line = directory_.find(address / line_bytes);
    return line != nullptr ? *line : new_line(me, address);
  }
  Line& new_line(const Thread& me, std::uintptr_t address);
  Time ahead_of(const Thread& me, const Line& line) const {
    return (line.only_mine && line.owner == me.core) || (line.only_read && line.held_by(me.core))
               ? private_window
               : 0;
  }
  // What nearly all accesses to private data are: the line of these bytes, if the thread may use
  // them at once, for it holds the line, its stores are done, nothing happens before its next step,
  // and it is in no loop. The access is counted. Else null, nothing is counted, and the slower way
  // is taken (the functions named `late`).
  Line* at_hand(const Thread& me, std::uintptr_t address, std::size_t size, bool to_write) {
    Line* line = directory_.find(address / line_bytes);
    if (line == nullptr || !timed_ || me.loop.rounds != 0) return nullptr;
    if (!me.stores.empty() || me.clock < me.committed) return nullptr;
    if (line->owner != me.core && (to_write || !line->sharers.has(me.core))) return nullptr;
    if (address % line_bytes + size > line_bytes) return nullptr;
    if (!is_next(me, ahead_of(me, *line))) return nullptr;
    ++counts_.accesses;
    (to_write ? line->written : line->read) |= bytes_of(address, size);
    return line;
  }
  void fetch(Thread& me, Line& line, Want want, const void* pc, std::uint64_t bytes);
  Line& own(Thread& me, const virtual_cores::Access& access, bool arithmetic);
  void finish_update(Thread& me, Line& line, bool changed) {
    me.changes += changed ? 1 : 0;
    if (line.owner != me.core) return;  // it was done at the home
    me.clock += me.costs->rmw_hit;
    line.available = std::max(line.available, me.clock);
  }
  virtual_cores::Value load_late(const virtual_cores::Access& access);
  void plain_read_late(Thread& me, std::uintptr_t address, std::size_t size, const void* pc);
  void plain_write_late(Thread& me, std::uintptr_t address, std::size_t size, const void* pc);
  void read_line(Thread& me, std::uintptr_t address, std::uint64_t bytes, const void* pc);
  void post(Thread& me, Line& line, const virtual_cores::Access& access,
            const virtual_cores::Value* value);
  void issue_store(Thread& me, Time now);
  void commit_store(Thread& me, Line& line, Time done);
  void drain(Thread& me) {
    if (!me.stores.empty() || me.clock < me.committed) wait_for_stores(me);
  }
  void wait_for_stores(Thread& me);

  // Loops that wait (loops.cpp).
  void check_loop(Thread& me, const virtual_cores::Access& access) {
    LoopState& loop = me.loop;
    const bool elsewhere = access.pc != loop.pc || access.address != loop.address;
    if (!elsewhere || ++loop.age >= LoopState::longest) note_round(me, access);
  }
  void note_round(Thread& me, const virtual_cores::Access& access);
  // A line that the thread found where it left it.
  void watch(Thread& me, Line& line) {
    if (me.loop.rounds != 0) note_watch(me.loop, line);
  }
  static void note_watch(LoopState& loop, Line& line);
  void sleep_in_loop(Thread& me);
  void wake_watchers(Line& line, Time now);

  // The kernel (kernel.cpp).
  Sleepers& sleepers_of(std::uintptr_t address);
  void enter_bucket(Thread& me, std::uintptr_t bucket, const void* pc);
  void park(Thread& me, Time until);
  void unpark(Thread& thread, Time at);
  void time_out(Thread& thread, Time at);
  void give_way(Thread& me);
  void run_next(Hardware& hardware, Time at);
  void set_deadline(unsigned place);
  void set_busy(unsigned place, unsigned thread);
  void allocator_traffic(Thread& me, const Heap::Traffic& traffic, const void* pc);

  Profile profile_;
  LocalCosts alone_, beside_sibling_;
  Time syscall_, futex_wait_, wake_call_, wake_latency_, switch_, quantum_;
  EventQueue events_;
  Directory directory_;
  Heap heap_;
  std::vector<Thread> threads_;
  std::vector<Hardware> hardware_;
  std::unordered_map<std::uintptr_t, Sleepers> sleepers_;
  virtual_cores::Cores cores_;
  Thread* me_ = nullptr;  // in progress
  std::function<void(unsigned)> body_;
  std::function<void()> set_up_;
  bool timed_ = false;
  unsigned left_ = 0;  // threads that have not returned
  Time count_from_ = 0, until_ = 0, limit_ = 0;
  Time mark_ = 0;  // events before it are neither the first that counts nor after `until_`
  bool counting_ = false;
  Counts counts_;
  std::uint64_t events_taken_ = 0, events_after_ = 0;
  Ending ending_;
};

}  // namespace irt::many_core
