/// Loops that wait: known by their state, or taken for such after many rounds; and threads that
/// make steps without end.
///
/// A loop that comes back to a load with the same registers and the same stack, having written
/// nothing and read the same stores, will do so forever, until somebody writes. That is known for
/// sure. A loop that carries a counter may give up in the end. So after many rounds there is a
/// choice: it is taken to wait, and goes on when nobody else can, each in turn, until it ends or is
/// seen to be endless; or it *insists* on what it has read until it gives up. What happens if it
/// sees the news in a round between these is what happens if it sees them in one of the first, but
/// for the counter.
#pragma once

#include <cstdint>
#include <unordered_set>
#include <vector>

#include "stress/checker/alone.hpp"
#include "stress/checker/execution_state.hpp"
#include "stress/checker/turns.hpp"

namespace irt::checker {

/// A modification that puts back what was there, as of a lock that is tried again and again, is no
/// news: the store that is meant is the one before.
EventId source_of(const Graph& graph, EventId store);
bool is_newest(const Graph& graph, EventId store);

class Loops {
 public:
  Loops(ExecutionState& state, Turns& turns, Alone& alone)
      : state_(state), turns_(turns), alone_(alone), threads_(state.threads + 1) {}

  /// The next execution begins.
  void begin();

  // In the order in which an access comes by. First: at a read that a loop may come back to; the
  // thread waits if it does.
  void enter(const void* pc);
  /// Then: it is the thread's turn. False if it has made too many steps, and runs alone from here.
  bool goes_on(const void* pc);
  /// Before a read: one that has had no news for long waits.
  void expect_news(const void* pc);
  /// Which store a read at `pc` must read as long as the loop insists; none if it does not.
  [[nodiscard]] EventId insisted_on(const void* pc);
  /// The store that the loop has read too often there to read it again; none if there is none.
  [[nodiscard]] EventId worn_out(const void* pc);
  /// Whether the next read must be of the newest store.
  bool must_be_fresh();
  void stop_insisting() { mine().insists = nullptr; }
  /// Last: it has read `store`.
  void note_read(const void* pc, EventId store);
  /// The thread has changed what others may see.
  void note_effect() { ++mine().effects; }

  /// Whether the unusual happens, where it may: an event of its own.
  bool chosen(const void* pc);
  /// The same for what may happen any number of times, of which once in each thread and place is
  /// looked at.
  bool chosen_once(const void* pc);
  /// Whether a wait with a time-out ends by it. Who insists on what a loop reads until it gives up
  /// sees no wait of it end.
  bool times_out(const void* pc) { return mine().insists != nullptr || chosen(pc); }

  /// Whether the last round of the loop that `thread` waits in has read the newest stores.
  [[nodiscard]] bool sees_newest(unsigned thread) const;
  /// Loops that were taken to wait although their state changed.
  [[nodiscard]] std::size_t assumed_waits() const { return assumed_waits_; }

 private:
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

  struct Thread {
    const void* insists = nullptr;  ///< the loop that reads what it has read until it gives up
    std::uint32_t reads = 0;        ///< so far
    std::uint32_t round_began = 0;  ///< with this read of its own, when it waits in a loop
    std::uint32_t effects = 0;
    EventId newest_read = 0;       ///< of other threads' stores
    std::size_t news_since = 0;    ///< events of its own when it read that
    std::uint64_t entry_hash = 0;  ///< of the core when the operation in progress began
    std::vector<Visit> visits;
    std::vector<const void*> unusual;  ///< where `chosen_once` was true
  };

  Thread& mine() { return threads_[state_.current()]; }
  Visit* find_visit(const void* pc);
  void note_visit(const void* pc, EventId store);
  [[nodiscard]] bool is_head(const void* pc) const;
  void wait(const void* pc, bool assumed);

  ExecutionState& state_;
  Turns& turns_;
  Alone& alone_;
  std::vector<Thread> threads_;
  std::vector<const void*> heads_;                  ///< of loops, in order
  std::unordered_set<const void*> never_gives_up_;  ///< loops that count and do not give up
  std::size_t assumed_waits_ = 0;
};

}  // namespace irt::checker
