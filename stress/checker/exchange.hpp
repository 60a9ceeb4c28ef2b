/// Whether threads that seem to do the same may be exchanged for each other: made sure of natively,
/// never assumed.
///
/// What a thread does next is a function of its *history*: the events it has made with the values
/// it read, and what it found in memory when it looked there (diary.hpp). Code on a core has
/// nothing else to go by. For each history that comes up in an explored execution, the execution is
/// made once more for each exchange, with the threads' names exchanged in its schedule, and
/// compared look by look: the exchanged thread, after the exchanged history, must do the exchanged
/// thing. What it means to exchange a history is learned on the way. For each exchange there is one
/// map of places and, for each place, one of what is found there; all must stay one-to-one
/// functions for as long as the search lasts, whatever thread and execution they are asked about.
/// Two things are fixed beforehand: a thread's own blocks become those of the other in the same
/// order, as do pointers to them, and all other blocks stay what they are.
///
/// If that holds, the program cannot be told from one that is the same under each exchange. Let an
/// execution of the program be given, and let its events so far be the exchange of an explored
/// execution's. Who goes on has the exchange of a known history, so it makes the exchange of the
/// known next step. If that reads, it reads what an earlier step has left there (or what was there
/// before the threads began, of which all is known): the exchange of what is read in the explored
/// execution, for each place has one map. So its events after the step are those of an exchange,
/// too, and the explored graphs (symmetry.hpp) have an exchange of every graph.
///
/// The judge may tell workers apart that the code does not. So an execution with answers that it
/// was not asked about before is also made under each exchange, and judged. What is accused of
/// races, use after free and leaks follows from events, looks and pointers, which are exchanged.
///
/// Given up, and the search begun anew without, as soon as anything differs; also where threads
/// look into each other's stacks, wait in loops that count, or reach a limit.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "stress/checker/execution.hpp"

namespace irt::checker {

/// What one exchange makes of places and values.
class Bijection {
 public:
  /// `target` has the new name of each thread.
  explicit Bijection(std::vector<unsigned> target) : target_(std::move(target)) {}

  [[nodiscard]] unsigned name(unsigned thread) const {
    return thread < target_.size() ? target_[thread] : thread;
  }

  /// Whether `to` may be the exchange of `from`, now and from now on: addresses, and what is at the
  /// eight bytes at `from`.
  bool place(ExecutionState& state, unsigned thread, std::uintptr_t from, std::uintptr_t to,
             bool writes);
  bool word(ExecutionState& state, std::uintptr_t from, std::uint8_t bytes, std::uint64_t value,
            std::uint64_t other);
  /// Looks at what is in the places that have come up since the last time. To be called before the
  /// threads begin; false if that does not fit.
  bool look_at_first(ExecutionState& state);
  /// Whether there are none such.
  [[nodiscard]] bool all_seen() const { return unseen_.empty(); }

 private:
  struct Key {
    std::uintptr_t address;
    std::uint64_t value;
    std::uint8_t bytes;
    bool operator==(const Key&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  struct Word {
    std::uint8_t masks[4] = {};  ///< of bytes that were looked at together; 0: none
    bool differs = false;        ///< some value is not its own exchange
    bool overlaps = false;       ///< some of these have bytes in common
  };
  struct Unseen {
    std::uintptr_t from;
    std::uint8_t bytes;
  };
  [[nodiscard]] bool pointer(const Heap& heap, std::uint64_t value, std::uint64_t other) const;

  std::vector<unsigned> target_;
  std::unordered_map<std::uintptr_t, std::uintptr_t> places_, places_back_;
  std::unordered_map<Key, std::uint64_t, Hash> words_, words_back_;
  std::unordered_map<std::uintptr_t, Word> known_;
  std::vector<Unseen> unseen_;
};

class Exchange {
 public:
  enum class Answer : std::uint8_t { holds, fails, found, restart };

  Exchange(const Program& program, Execution& execution);
  ~Exchange();
  Exchange(const Exchange&) = delete;
  Exchange& operator=(const Exchange&) = delete;

  /// Those of the program, as far as their exchanges are few enough to be tried; empty: none.
  [[nodiscard]] const std::vector<unsigned>& roles() const { return roles_; }

  /// Asked after each execution of the search that ended with `outcome`. `found`: the execution,
  /// now another one, has a finding. `restart`: it has learnt something, or its time is up.
  Answer check(Outcome outcome);

  /// Why exchanges fail.
  [[nodiscard]] const std::string& why() const { return why_; }
  /// Identity included.
  [[nodiscard]] std::size_t orders() const { return exchanges_.size() + 1; }
  [[nodiscard]] std::size_t histories() const { return histories_.size(); }
  [[nodiscard]] std::uint64_t executions() const { return executions_; }

 private:
  /// An event as it is compared.
  struct Made {
    EventKind kind;
    Order order;
    bool blocked, failed, reads, writes, from_initial;
    std::uint8_t from_thread;
    std::uint16_t from_index;
    std::uint32_t option, size;
    std::uint64_t place;  ///< in modification order at the end, plus one
    std::uintptr_t address;
    const void* pc;
    Value read, written;
  };

  /// What is kept of an execution to be compared with another one.
  struct Past {
    std::vector<std::vector<Made>> events;
    std::vector<std::vector<Look>> looks;
    std::vector<const void*> waits;
  };
  [[nodiscard]] bool is_new(Outcome outcome);
  [[nodiscard]] std::uint64_t history_of(unsigned thread) const;
  [[nodiscard]] const void* waits(unsigned thread) const;
  [[nodiscard]] Made made(const Event& event) const;
  Answer make(Bijection& exchange, Outcome outcome, const std::vector<Step>& steps,
              const Past& past);
  bool agrees(Bijection& exchange, const Past& past) const;
  bool agree(Bijection& exchange, unsigned thread, const Look& a, const Look& b) const;
  bool agree(Bijection& exchange, unsigned thread, const Made& a, const Made& b) const;
  Answer fail(std::string why);

  const Program& program_;
  Execution& execution_;
  Diary diary_;
  std::vector<unsigned> roles_;
  std::vector<Bijection> exchanges_;
  std::unordered_set<std::uint64_t> histories_;
  std::unordered_set<std::uint64_t> outcomes_;
  std::uint64_t executions_ = 0;
  std::string why_;
};

}  // namespace irt::checker
