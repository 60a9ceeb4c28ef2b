/// One execution after another: the tenant of the virtual cores that puts every event of the code
/// into a graph, asks a strategy where it may go several ways, and watches memory.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "stress/checker/ageing.hpp"
#include "stress/checker/cycle_watch.hpp"
#include "stress/checker/deadline.hpp"
#include "stress/checker/diary.hpp"
#include "stress/checker/finding.hpp"
#include "stress/checker/graph.hpp"
#include "stress/checker/heap.hpp"
#include "stress/checker/memory_orders.hpp"
#include "stress/checker/strategy.hpp"
#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::checker {

/// A small concurrent program. The functions call into instrumented code; what they do themselves
/// is not seen, so they must be the same in every execution and keep nothing on their stacks that
/// needs destruction.
struct Program {
  std::vector<std::function<void()>> threads;
  /// So many calls of `grow_older`, numbered from 0, come before `prepare`: natively, and once for
  /// all executions (see ageing.hpp). Programs with equal `aged_what` do the same there and may
  /// share what came of it.
  std::uint64_t age = 0;
  std::function<void(std::uint64_t)> grow_older;
  std::string aged_what;
  std::shared_ptr<AgedMemory> aged;
  std::function<void()> prepare;  ///< before the threads; may be empty
  std::function<void()> finish;   ///< after all threads ended; may be empty
  /// After everything: what is wrong with the outcome, if anything. Runs outside of the cores.
  std::function<std::optional<std::string>(const Execution&)> judge;
  /// What tells the outcomes that the judge was asked about from each other, a number for each; may
  /// be empty.
  std::function<std::vector<std::uint64_t>()> histories{};
  /// The number of the outcome that the judge was asked about last; equal threads of a program
  /// with a judge are not exchanged without it.
  std::function<std::uint64_t()> outcome{};
  virtual_cores::Module* module = nullptr;  ///< its globals start afresh each time
  /// By thread: those of one number seem to do the same; empty: none do. See exchange.hpp.
  std::vector<unsigned> roles{};
};

struct Limits {
  /// A thread that makes more ends the execution, which then proves nothing. At most 60,000.
  std::size_t events_per_thread = 20'000;
  /// A thread that runs alone and only counts its rounds is taken for endless after so many looks.
  std::uint64_t looks = std::uint64_t{1} << 20U;
  /// A loop is taken to wait if it reads the same store at the same place this often in a row; and
  /// no place reads one more often while there is a newer one.
  unsigned same_reads = 20;
  /// A thread is taken to wait if it makes so many events without reading anything new.
  std::size_t events_without_news = 400;
  bool reuse_memory = false;         ///< a thread may get back what it freed, as a choice
  unsigned failing_allocations = 0;  ///< so many in an execution may fail, each as a choice
  bool weak_may_fail = false;        ///< compare_exchange_weak fails for no reason, as a choice
  bool spurious_wakeups = false;     ///< futex and condition waits end for no reason, as a choice
  bool leaks = true;                 ///< blocks that are never freed are findings
  bool uninitialised = true;         ///< reads of memory that nothing was written to are findings
  bool races = true;  ///< data races are findings; if not, plain reads see what memory holds
};

/// A step of an execution, for replay and for the reader.
struct Step {
  std::uint8_t thread = 0;
  std::uint8_t kind = 0;  ///< EventKind
  std::uint16_t choice =
      0;  ///< distance from the newest store read, from the last place, or option
  friend bool operator==(const Step&, const Step&) = default;
};

class Execution final : public virtual_cores::Tenant {
 public:
  /// After so many accesses without an event it is asked whether they ever end.
  static constexpr std::uint64_t long_walk = 1'000'000;

  /// Threads of the program are numbered from 0; the one that prepares and finishes comes last.
  Execution(const Program& program, const Limits& limits);

  Outcome run(Strategy& strategy);

  /// Runs to come are cut when that time is there.
  void until(Deadline deadline) { deadline_ = deadline; }
  /// Whether the last run was.
  [[nodiscard]] bool out_of_time() const { return out_of_time_; }

  [[nodiscard]] const std::optional<Finding>& finding() const { return finding_; }
  [[nodiscard]] const Graph& graph() const { return graph_; }
  Graph& graph() { return graph_; }
  [[nodiscard]] const Limits& limits() const { return limits_; }
  [[nodiscard]] unsigned threads() const { return main_; }
  /// The thread that prepares and finishes.
  [[nodiscard]] unsigned main_thread() const { return main_; }
  /// Threads that could go on, as bits.
  [[nodiscard]] std::uint32_t runnable() const;
  /// What the next event of `thread` will touch: an address, or 0.
  [[nodiscard]] std::uintptr_t pending_address(unsigned thread) const {
    return states_[thread].pending;
  }
  [[nodiscard]] bool pending_writes(unsigned thread) const {
    return states_[thread].pending_writes;
  }
  /// What was chosen, in order.
  [[nodiscard]] const std::vector<Step>& steps() const { return steps_; }
  /// Why the executions so far do not show everything, although the search came to its end: a limit
  /// that was reached. Empty if none was.
  [[nodiscard]] const std::string& incomplete() const { return incomplete_; }
  /// The place in the code that it speaks of, or where the time went if it is empty; null if none.
  [[nodiscard]] const void* incomplete_at() const { return incomplete_at_; }
  void note_incomplete(std::string why) {
    if (incomplete_.empty()) incomplete_ = std::move(why);
  }
  /// Loops that were taken to wait although their state changed.
  [[nodiscard]] std::size_t assumed_waits() const { return assumed_waits_; }
  [[nodiscard]] const Heap& heap() const { return heap_; }
  Heap& heap() { return heap_; }
  /// Whether `address` is in a core's stack, and in a variable of the module.
  [[nodiscard]] bool is_stack(std::uintptr_t address) const;
  [[nodiscard]] bool is_global(std::uintptr_t address) const;
  [[nodiscard]] const virtual_cores::Cores& cores() const { return cores_; }

  /// The past of `thread`, as a judge may need it between operations.
  [[nodiscard]] const Clock& clock_of(unsigned thread) const { return graph_.thread(thread).now; }
  /// The execution in progress; null outside of `run`.
  static Execution* current_execution() { return running; }
  /// For programs: lets those that await it go on; what came before happens before what they do.
  void signal();
  void await_signal();
  /// For programs: waits until `threads` threads have come here as often as this one; what each
  /// did before happens before what any does afterwards. While the threads run only.
  void meet(unsigned threads);
  /// For programs: the time on a clock that all threads read in one order, and that makes nothing
  /// they did before visible to the others. From 1 on; 0 before and after the threads.
  std::uint64_t tick();
  /// The time on the clock that the code of the thread in progress sees, in nanoseconds. It passes
  /// with each look, and where a wait with a time-out is in vain.
  [[nodiscard]] std::int64_t time() { return me().clock_reads * 1000 + me().waited; }
  /// Allocations of `thread` that have failed by choice.
  [[nodiscard]] unsigned failed_allocations(unsigned thread) const {
    return states_[thread].failed_allocations;
  }
  /// Where each allocation was made that has failed by choice in the last execution, and by whom.
  [[nodiscard]] const std::vector<std::pair<unsigned, const void*>>& failed_at() const {
    return failed_at_;
  }
  /// Whether threads have allocated memory in any execution so far.
  [[nodiscard]] bool allocates() const { return allocates_; }
  /// The thread in progress. Valid while the program's functions run.
  [[nodiscard]] unsigned current() const { return cores_.current(); }
  /// Stops `thread` for good before event number `events` (from 0) of its own, in runs to come.
  void freeze(unsigned thread, std::size_t events) { frozen_ = {{thread, events}}; }
  [[nodiscard]] bool freezes() const { return frozen_.has_value(); }
  /// Whether the thread to be stopped came that far in the last run.
  [[nodiscard]] bool froze() const { return froze_; }
  [[nodiscard]] bool stopped(unsigned thread) const { return froze_ && frozen_->first == thread; }
  /// The thread that is stopped for good, from then on.
  [[nodiscard]] std::optional<unsigned> stopped() const {
    return froze_ ? std::optional(frozen_->first) : std::nullopt;
  }
  /// Executions that end in one of these are passed over from now on, races among them are no end.
  void know(std::vector<Finding> findings) { known_ = std::move(findings); }
  /// For programs as well: why nothing in this execution, or after it, can be a proof.
  [[noreturn]] void give_up(std::string why);
  [[noreturn]] void report(FindingKind kind, std::string text, std::vector<const void*> places,
                           std::vector<Moment> moments = {});
  /// Where a thread waits that did not come to its end in the last run; none if it did, or if it
  /// was on its way.
  struct Standing {
    const void* pc = nullptr;
    std::uint32_t location = 0;  ///< of a lock or futex, plus one; 0: it loops
    bool sleeps = false;
  };
  [[nodiscard]] std::optional<Standing> standing(unsigned thread) const;
  /// Whether it came to its end, or was stopped for good.
  [[nodiscard]] bool ended(unsigned thread) const { return states_[thread].done; }

  /// Those of the code in runs to come.
  [[nodiscard]] MemoryOrders& orders() { return orders_; }
  /// Notes in `diary` what threads look at besides their events, in runs to come.
  void keep(Diary* diary) { diary_ = diary; }

  // Tenant.
  void plain_read(std::uintptr_t address, std::size_t size, const void* pc) override;
  void plain_write(std::uintptr_t address, std::size_t size, const void* pc) override;
  Value load(const virtual_cores::Access& access) override;
  void store(const virtual_cores::Access& access, Value value) override;
  Value modify(const virtual_cores::Access& access, virtual_cores::Modification operation,
               Value operand) override;
  bool compare_exchange(const virtual_cores::Access& access, Order failure, bool weak,
                        Value& expected, Value desired) override;
  void fence(Order order, const void* pc) override;
  void* allocate(std::size_t size, std::size_t alignment, const void* pc) override;
  void release(void* block, const void* pc) override;
  std::size_t block_size(void* block) override;
  bool lock(std::uintptr_t address, std::int64_t nanoseconds, const void* pc) override;
  bool try_lock(std::uintptr_t address, const void* pc) override;
  void unlock(std::uintptr_t address, const void* pc) override;
  virtual_cores::Wake wait(std::uintptr_t address, std::uint32_t expected, std::int64_t nanoseconds,
                           const void* pc) override;
  unsigned wake(std::uintptr_t address, unsigned count, const void* pc) override;
  std::int64_t now() override;
  std::uint64_t random() override;
  unsigned finished(unsigned core) override;
  void on_failure(const std::string& what, const void* pc) override;
  std::uint64_t beats() const override { return beats_; }
  bool patient(double seconds) const override;
  void spins(const void* pc, bool endless, double seconds) override;

 private:
  /// `endless`: one thread of `parallel` runs on by itself, to see whether it ever ends.
  enum class Phase : std::uint8_t { idle, ageing, prepare, parallel, endless, finish };

  /// A load that a loop may come back to.
  struct Visit {
    const void* pc = nullptr;
    EventId from = no_event;   ///< what it read, see source_of ...
    EventId store = no_event;  ///< ... and the very store
    std::uint64_t hash = 0;
    std::uint32_t effects = 0;
    std::uint32_t read = 0;     ///< its number among the reads of its thread
    std::uint32_t count = 0;    ///< in a row, of the same store
    std::uint32_t wait_at = 0;  ///< that many, beyond the limit
    bool hashed = false;
    bool refreshed = false;  ///< one round has read only the newest stores
  };

  struct ThreadState {
    bool started = false;
    bool done = false;
    bool waiting = false;
    bool assumed = false;             ///< waits only because it looked like a loop
    bool timed = false;               ///< waits with a time-out
    bool endless = false;             ///< goes on for ever if nobody stores anything
    const void* insists = nullptr;    ///< the loop that reads what it has read until it gives up
    std::uint32_t turns = 0;          ///< how often it went on because nobody else could
    std::uint32_t reads = 0;          ///< so far
    std::uint32_t round_began = 0;    ///< with this read of its own, when it waits in a loop
    std::uint32_t wait_location = 0;  ///< plus one; 0: any store
    std::uint64_t waits_since = 0;    ///< stores in the execution by then
    std::uintptr_t pending = 0;
    bool pending_writes = false;
    std::uint32_t effects = 0;
    EventId newest_read = 0;     ///< of other threads' stores
    std::size_t news_since = 0;  ///< events of its own when it read that
    std::int64_t clock_reads = 0;
    std::int64_t waited = 0;  ///< nanoseconds that passed while it waited in vain
    std::uint64_t draws = 0;  ///< random numbers it got
    unsigned failed_allocations = 0;
    std::vector<Visit> visits;
    std::uint64_t entry_hash = 0;   ///< of the core when the operation in progress began
    std::uint32_t fresh_reads = 0;  ///< that many loads must read the newest store
    const void* wait_pc = nullptr;
    bool wait_sleeps = false;  ///< in a futex, not for a lock or in a loop
  };

  /// What a read means, by the value it finds.
  enum class Meaning : std::uint8_t { load, modify, wait };
  /// A location and the part of it that an access touches.
  struct Part {
    std::uint32_t location;
    unsigned shift;
    Value mask;
  };

  struct Request {
    std::uintptr_t address;
    std::uint32_t size;
    const void* pc;
    Order success;
    Order failure;
    bool silent = false;    ///< see Event
    bool compares = false;  ///< and writes nothing if it finds another value
  };
  template <class Decide, class NewValue>
  Value read_alone(const Request& request, Decide decide, NewValue new_value);
  template <class Decide, class NewValue>
  Value read_event(const Request& request, bool may_write, Decide decide, NewValue new_value);

  void check_time() {
    if ((++asked_for_time_ & 1023U) == 0) stop_in_time();
  }
  void stop_in_time();
  void begin_aged();
  void note_unwatched();
  void note_look_outside();
  void* allocate_unwatched(std::size_t size, std::size_t alignment, const void* pc);
  void run_main(const std::function<void()>& work);
  [[noreturn]] void stop(Outcome outcome);
  [[nodiscard]] bool knows(FindingKind kind, const std::vector<const void*>& places,
                           std::string_view text) const;
  void reach(std::uintptr_t address, bool writes);
  void wait_here(std::uint32_t location, const void* pc);
  void go_elsewhere();
  Part part_at(std::uintptr_t address, std::uint32_t size);
  void widen(std::uintptr_t address, std::uint32_t size);
  void note_write(const Event& event, Value value);
  void check_touch(std::uintptr_t address, std::size_t size, bool writes, bool atomic,
                   const void* pc);
  void check_race(const Cell& cell, const Touch& touch);
  [[noreturn]] void report_unusable(std::uintptr_t eight_bytes, bool writes, bool atomic,
                                    const void* pc);
  [[nodiscard]] Moment here(const void* pc, std::string what, std::string note = "") const;
  static Moment allocation_of(const Block& block);
  static Moment free_of(const Block& block, std::string note);
  void check_loop(const void* pc);
  [[nodiscard]] bool is_loop_head(const void* pc) const;
  EventId source_of(EventId store) const;
  bool is_newest(EventId store) const;
  void note_visit(const void* pc, EventId from);
  std::uint64_t hash_of_core() const;
  bool on_own_stack(std::uintptr_t address) const {
    return address - stacks_[cores_.current()] < stack_bytes_;
  }
  void check_limit(const void* pc);
  void look_alone(const void* pc);
  void check_walk(std::uintptr_t address, std::size_t size, bool writes, bool atomic,
                  const void* pc);
  void conclude_alone(bool endless, const void* pc);
  [[nodiscard]] bool sees_newest(unsigned thread) const;
  void check_news(const void* pc);
  void note_news(EventId from);
  [[nodiscard]] std::string stalled() const;
  Outcome after_threads();
  void explain_standstill();
  unsigned other_choice(unsigned count, const void* pc);
  bool chosen(const void* pc);
  bool times_out(std::int64_t nanoseconds, const void* pc);
  void record(const Event& event, std::size_t choice);
  ThreadState& me() { return states_[cores_.current()]; }
  bool observed() const { return phase_ > Phase::ageing; }
  /// Before and after the threads, when there is no order to choose and memory holds every value.
  bool alone() const {
    return phase_ == Phase::prepare || phase_ == Phase::finish || phase_ == Phase::endless;
  }
  void step_alone(std::uintptr_t address, std::size_t size, bool writes, const void* pc);

  void note(Look::Kind kind, std::uintptr_t address, std::size_t size) {
    if (diary_ == nullptr || phase_ < Phase::parallel) return;
    const unsigned thread = cores_.current();
    const std::size_t moment = graph_.thread(thread).events.size();
    if (kind < Look::Kind::allocate)
      diary_->note(kind, thread, moment, address, size);
    else
      diary_->note_block(kind, thread, moment, address, size);
  }

  static Execution* running;
  const Program& program_;
  Limits limits_;
  unsigned main_;
  virtual_cores::Cores cores_;
  virtual_cores::SpinWatch spin_watch_{cores_};
  std::uint64_t beats_ = 0;
  Graph graph_;
  Heap heap_;
  Strategy* strategy_ = nullptr;
  Phase phase_ = Phase::idle;
  Outcome outcome_ = Outcome::complete;
  std::vector<ThreadState> states_;
  std::vector<Step> steps_;
  std::optional<Finding> finding_;
  std::vector<Finding> known_;
  std::uint64_t stores_ = 0;
  std::uint64_t walk_ = 0;  ///< accesses to memory since the last event, or since the phase began
  Deadline deadline_;
  std::uint32_t asked_for_time_ = 0;
  bool out_of_time_ = false;
  std::size_t assumed_waits_ = 0;
  std::string incomplete_;
  const void* incomplete_at_ = nullptr;
  CycleWatch alone_;         ///< of the thread that runs alone
  std::uint64_t looks_ = 0;  ///< of that thread
  std::vector<std::pair<unsigned, const void*>> failed_at_;
  bool allocates_ = false;
  std::vector<ReadOption> options_;
  std::vector<std::size_t> places_;
  std::optional<std::pair<unsigned, std::size_t>> frozen_;
  bool froze_ = false;
  /// Sixteen-byte units that are accessed in different sizes, and the size that covers them.
  std::unordered_map<std::uintptr_t, std::uint32_t> widened_;
  std::vector<const void*> loop_heads_;             ///< in order
  std::unordered_set<const void*> never_gives_up_;  ///< loops that count and do not give up
  std::vector<std::uint32_t> next_location_;  ///< by location: another one in the same eight bytes
  bool stack_locations_ = false;
  std::vector<std::uintptr_t> stacks_;  ///< of the cores: lowest addresses
  std::size_t stack_bytes_;
  Diary* diary_ = nullptr;
  MemoryOrders orders_;
};

}  // namespace irt::checker
