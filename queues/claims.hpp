/// What a queue promises: its claims, word by word. docs/claims.md says what each means to whom.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>

namespace irt {

/// The order in which elements leave, from the weakest promise to the strongest.
enum class Ordering : std::uint8_t {
  unordered,          ///< every element leaves exactly once, in any order
  per_producer_fifo,  ///< elements that one worker pushed leave in the order it pushed them
  k_relaxed_fifo,     ///< an element leaves among the `Claims::relaxation` + 1 oldest
  /// Linearizable to a FIFO queue if only happens-before orders the calls: `pop` may answer
  /// *empty* while a push that has returned is not yet visible to this thread.
  fifo_happens_before,
  /// Linearizable to a FIFO queue in real time: `pop` answers *empty* only if at some moment
  /// between its call and its return the queue held nothing (Herlihy and Wing 1990).
  fifo_real_time,
};

/// What a stalled thread can do to the others (Herlihy and Shavit, chapter 3).
enum class Progress : std::uint8_t {
  blocking,          ///< a stalled thread may stop the others
  obstruction_free,  ///< a thread that runs alone finishes
  lock_free,         ///< some thread always finishes
  wait_free,         ///< every thread finishes in a bounded number of its own steps
};

/// Who may call a method at the same time.
enum class Callers : std::uint8_t {
  one,   ///< one thread at a time over all workers
  many,  ///< any number of workers at once
  /// Any number of workers at once, each on a queue of its own: what is pushed for worker `w`
  /// is popped only by worker `w`.
  own_worker,
};

/// When the memory of an element that has left is used again or returned.
enum class Reclamation : std::uint8_t {
  immediate,         ///< at once, under a lock or by the only owner
  hazard_pointers,   ///< when no thread's hazard pointer names it (Michael 2004)
  epochs,            ///< when every thread has passed the epoch in which it was retired
  free_list,         ///< kept for reuse, returned when the queue is destroyed
  preallocated,      ///< a fixed array: nothing is allocated after construction
  at_destruction,    ///< never reused before the queue is destroyed: memory grows with every push
  library,           ///< the library's own scheme, taken as it comes
  quiescent_states,  ///< when every worker has been between two operations (QSBR)
  hazard_eras,       ///< when no thread holds an era in which it was inside
  last_reader,       ///< by the last of those who were inside an operation (Hyaline)
};

/// What *full* or *empty* speaks of. A call is *in flight* during another if neither happens before
/// the other; for `fifo_real_time`, if neither returned before the other was called.
enum class Answer : std::uint8_t {
  by_ordering,  ///< `exact` for the FIFO orderings, `calls_in_flight` for the others
  /// The state of the queue: in some order of all calls that agrees with the ordering claimed, no
  /// element is inside (*empty*), or `capacity` are (*full*), when the call has its turn.
  exact,
  /// The state as far as nobody is about to change it. *full* counts a place for each push in
  /// flight, and may be answered whenever a pop that takes an element is, whose place is not free
  /// yet. *empty* may be answered whenever a push or pop that hands over an element is in flight.
  /// Where no such call explains it, it is as wrong as elsewhere.
  calls_in_flight,
  /// Of *empty* alone: this worker found nothing where it looks; others may find something. Wrong
  /// if the same worker then finds what had been inside, though nobody else did anything meanwhile.
  this_worker,
};

/// Words that a queue keeps for itself, so that they cannot be elements: at most four.
struct ReservedWords {
  std::array<std::uint64_t, 4> words{};
  std::uint8_t count = 0;

  constexpr ReservedWords() = default;
  // Not explicit, so that claims can say `.reserved = {0, 1}`.
  constexpr ReservedWords(std::initializer_list<std::uint64_t> list)
      : count(static_cast<std::uint8_t>(list.size())) {
    for (std::size_t i = 0; i < list.size(); ++i) words.at(i) = std::data(list)[i];
  }
};

/// Elements beyond words that a queue takes.
struct Elements {
  bool large = false;  ///< trivially copyable ones of up to 64 bytes
  bool owner = false;  ///< those that move and cannot be copied, with a destructor
  /// Those whose copy may throw. A push that throws has had no effect.
  bool copied = false;
};

/// What the author of a queue promises. The suites test each line; none is taken on trust.
struct Claims {
  Ordering ordering = Ordering::unordered;
  std::uint64_t relaxation = 0;  ///< k of `k_relaxed_fifo`, in elements; 0 for other orderings
  Progress push = Progress::blocking;
  Progress pop = Progress::blocking;
  bool bounded = false;                ///< `push` answers false when `capacity` elements are held
  Answer full = Answer::by_ordering;   ///< what that says; not `this_worker`
  Answer empty = Answer::by_ordering;  ///< what it says that `pop` answers false
  Callers producers = Callers::many;
  Callers consumers = Callers::many;
  unsigned max_workers = 0;  ///< the constructor takes at most so many; 0: any number
  Reclamation reclamation = Reclamation::immediate;
  bool needs_cas2 = false;         ///< uses a 16-byte compare-and-swap
  bool all_ones_reserved = false;  ///< the word with all bits set cannot be an element
  ReservedWords reserved{};        ///< further words that cannot be elements
  std::uint64_t unused_bits = 0;   ///< bits that must be 0 in every element
  Elements elements{};             ///< that it takes besides words
  /// A call that finds no memory throws std::bad_alloc or answers false, and has had no effect.
  /// Without this promise no tool lets an allocation fail.
  bool survives_no_memory = true;
  /// False for a baseline that only counts: as many pops succeed as pushes did, or any number, and
  /// `pop` leaves its argument alone. Only benchmarks can use it.
  bool carries_elements = true;

  /// Whether `word` may be pushed.
  [[nodiscard]] constexpr bool allows(std::uint64_t word) const {
    if ((word & unused_bits) != 0 || (all_ones_reserved && word == ~std::uint64_t{0})) return false;
    for (std::size_t i = 0; i < reserved.count; ++i)
      if (reserved.words.at(i) == word) return false;
    return true;
  }

  /// The least word above 0 that may be pushed; 0 if there is none.
  [[nodiscard]] constexpr std::uint64_t some_word() const {
    std::uint64_t word = 0;
    // The next one without unused bits: after all reserved words one is free, or all are used up.
    do word = ((word | unused_bits) + 1) & ~unused_bits;
    while (word != 0 && !allows(word));
    return word;
  }

  /// Whether one thread at a time pushes, over all workers; whether one pops. Who that is, `Roles`
  /// says (roles.hpp).
  [[nodiscard]] constexpr bool one_producer() const { return producers == Callers::one; }
  [[nodiscard]] constexpr bool one_consumer() const { return consumers == Callers::one; }
  /// Whether any number of workers push and any number pop, all of one queue.
  [[nodiscard]] constexpr bool many_to_many() const {
    return producers == Callers::many && consumers == Callers::many;
  }
  /// Whether each worker has a queue of its own.
  [[nodiscard]] constexpr bool own_queues() const {
    return producers == Callers::own_worker || consumers == Callers::own_worker;
  }

  /// Whether the queue may be made for so many workers.
  [[nodiscard]] constexpr bool allows_workers(unsigned workers) const {
    return max_workers == 0 || workers <= max_workers;
  }
};

}  // namespace irt
