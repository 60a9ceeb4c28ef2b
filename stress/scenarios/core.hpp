/// What a scenario's worker stands on: a real thread or a virtual core.
///
/// Scenarios never touch threads, clocks or the queue themselves; whoever runs them derives from
/// `Core` and says how to stamp, wait and meet. So the same file runs on real threads
/// (`threads/thread_core.hpp`) and on the virtual cores of the checker
/// (`checker/virtual_core.hpp`).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "queues/roles.hpp"
#include "queues/split_mix.hpp"
#include "queues/work_queue.hpp"
#include "stress/history/operation.hpp"

namespace irt::stress {

/// A queue of elements behind the type-erased face.
using ElementQueue = AnyWorkQueue<Element>;

/// Thrown by `Core::complain`: a scenario saw the queue break a promise that no log records.
class Complaint : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The bits that elements of runs with up to 32 workers have.
inline constexpr Element element_bits = element(32, 0) - 1;

/// Whether a queue with these claims takes elements of each of 32 workers, billions of them.
inline bool has_elements(const Claims& claims) {
  constexpr Element numbers = element(1, 0) - 1;
  const Element unused = claims.unused_bits & element_bits;
  return (unused & ~numbers) == 0 && std::popcount(numbers & ~unused) >= 32;
}

/// The next element of `worker` from its `sequence`-th on that a queue with these claims takes.
inline Element next_element(const Claims& claims, unsigned worker, std::uint64_t& sequence) {
  while (!claims.allows(element(worker, sequence))) ++sequence;
  return element(worker, sequence);
}

/// No element of any run.
inline constexpr Element no_element = ~Element{0};

/// What elements point to: a word for each, written before its push and read after its pop, as the
/// renderer's tasks are. Plain memory, each word of one element alone, so that ThreadSanitizer
/// reports a queue that does not publish what it carries. Nothing here synchronises.
class Payloads {
 public:
  /// Makes room for `elements` elements of each of `workers` producers, for a run in which words
  /// differ from those of runs with another `salt`. Not while workers run.
  void prepare(unsigned workers, std::size_t elements, std::uint64_t salt) {
    words_.resize(workers);
    for (auto& words : words_) words.resize(std::max(words.size(), elements));
    salt_ = salt;
  }
  void write(Element e) {
    if (std::uint64_t* word = find(e)) *word = e ^ salt_;
  }
  /// Whether the word is there. True for what is no element: others judge that.
  [[nodiscard]] bool holds(Element e) {
    const std::uint64_t* word = find(e);
    return word == nullptr || *word == (e ^ salt_);
  }

 private:
  std::uint64_t* find(Element e) {
    const std::uint64_t producer = e >> sequence_bits;
    if (producer >= words_.size() || sequence_of(e) >= words_[producer].size()) return nullptr;
    return &words_[producer][sequence_of(e)];
  }

  std::vector<std::vector<std::uint64_t>> words_;  ///< by producer and sequence
  std::uint64_t salt_ = 0;
};

/// What lasts from one thread to the next in the role of a worker.
struct WorkerState {
  unsigned worker = 0;
  unsigned workers = 1;          ///< in this run; the queue was built for as many
  unsigned pushers = 1;          ///< how many of them may push: the first
  unsigned poppers = 1;          ///< how many of them may pop: the last
  bool pushes = true;            ///< may call `push`
  bool pops = true;              ///< may call `pop`
  std::size_t capacity = 0;      ///< what the queue was built with
  Claims claims{};               ///< of the queue: which words may be elements
  SplitMix random{1};            ///< any seed
  std::uint64_t operations = 0;  ///< how many `Core::more` grants to each thread
  std::uint64_t next_sequence = 0;
  std::uint64_t barriers = 0;
  std::vector<Operation> log;        ///< reserve `log_size()` so that recording never allocates
  Payloads* payloads = nullptr;      ///< of all workers; null: elements point to nothing
  Element unpublished = no_element;  ///< the first that was popped without its payload

  /// Enough for `generations` threads, each with its operations and some barriers.
  [[nodiscard]] std::size_t log_size(unsigned generations) const {
    return (operations + operations / 2 + 64) * generations;
  }
};

/// Of `worker` in a run with these roles; the rest is the run's to fill in.
inline WorkerState state_of(const Roles& roles, unsigned worker) {
  return {.worker = worker,
          .workers = roles.workers,
          .pushers = roles.producers,
          .poppers = roles.consumers,
          .pushes = roles.pushes(worker),
          .pops = roles.pops(worker),
          .log = {}};
}

/// One worker of a run. Not thread-safe; each thread has its own.
class Core {
 public:
  Core(WorkerState& state, ElementQueue& queue)
      : state_(state), queue_(queue), left_(state.operations) {}
  Core(const Core&) = delete;
  Core& operator=(const Core&) = delete;
  virtual ~Core() = default;

  [[nodiscard]] const WorkerState& self() const { return state_; }

  /// Whether this thread's share of operations is not used up.
  [[nodiscard]] bool more() const { return left_ > 0; }

  /// Pushes this worker's next element and records it. False for *full*; the next push then offers
  /// the same element.
  bool push() {
    const Element e = next_element(state_.claims, state_.worker, state_.next_sequence);
    if (left_ > 0) --left_;
    write_payload(e);
    const Stamp invoked = enter(Kind::push);
    const bool accepted = queue_.push(state_.worker, e);
    const Stamp returned = leave();
    state_.log.push_back({invoked, returned, e, accepted ? Kind::push : Kind::full});
    if (accepted) ++state_.next_sequence;
    return accepted;
  }

  /// The same with an element whose number leaves the rest `rest` when divided by `divisor`, unless
  /// the queue does not take that one.
  bool push_at(std::uint64_t divisor, std::uint64_t rest) {
    while (state_.next_sequence % divisor != rest) ++state_.next_sequence;
    return push();
  }

  /// Pops and records.
  std::optional<Element> pop() {
    Element e = no_element;
    if (left_ > 0) --left_;
    const Stamp invoked = enter(Kind::pop);
    const bool found = queue_.pop(state_.worker, e);
    return found_or(found, Kind::empty, invoked, e);
  }

  /// The same, waiting for an element; none if the queue is closed.
  std::optional<Element> pop_wait() {
    Element e = no_element;
    if (left_ > 0) --left_;
    const Stamp invoked = enter(Kind::pop);
    const bool found = queue_.pop_wait(state_.worker, e);
    return found_or(found, Kind::closed, invoked, e);
  }

  /// The same for so many nanoseconds, at most; complains of giving up before.
  PopStatus pop_wait(std::int64_t nanoseconds) {
    Element e = no_element;
    if (left_ > 0) --left_;
    const Deadline deadline = now() + std::chrono::nanoseconds(nanoseconds);
    const Stamp invoked = enter(Kind::pop);
    const PopStatus status = queue_.pop_wait(state_.worker, e, deadline);
    const bool closed = status == PopStatus::closed;
    found_or(status == PopStatus::success, closed ? Kind::closed : Kind::timed_out, invoked, e);
    if (status == PopStatus::timed_out && now() < deadline)
      complain("a waiting pop gave up before its deadline");
    return status;
  }

  /// Closes the queue, and records that.
  void close() {
    const Stamp invoked = enter(Kind::close);
    queue_.close();
    state_.log.push_back({invoked, leave(), 0, Kind::close});
  }

  /// This worker leaves the queue, which is recorded.
  void leave_queue() {
    const Stamp invoked = enter(Kind::leave);
    queue_.leave(state_.worker);
    state_.log.push_back({invoked, leave(), 0, Kind::leave});
  }

  /// Elements in a call, at most.
  static constexpr std::size_t most_in_bulk = 64;

  /// Pushes this worker's next `count` elements in one call, and records each; returns how many
  /// were accepted. The next push offers the first that was not.
  std::size_t push_bulk(std::size_t count) {
    std::array<Element, most_in_bulk> elements{};
    count = std::min(count, elements.size());
    std::uint64_t sequence = state_.next_sequence;
    for (std::size_t i = 0; i < count; ++i, ++sequence) {
      elements[i] = next_element(state_.claims, state_.worker, sequence);
      write_payload(elements[i]);
    }
    left_ -= std::min<std::uint64_t>(left_, count);
    const Stamp invoked = enter(Kind::push);
    const std::size_t accepted = queue_.push_bulk(state_.worker, std::span(elements).first(count));
    const Stamp returned = leave();
    if (accepted > count) complain("push_bulk says that it took more elements than it was given");
    for (std::size_t i = 0; i < std::min(accepted + 1, count); ++i)
      state_.log.push_back(
          {invoked, returned, elements[i], i < accepted ? Kind::push : Kind::full});
    if (accepted > 0) state_.next_sequence = sequence_of(elements[accepted - 1]) + 1;
    return accepted;
  }

  /// Pops up to `count` elements in one call and records each, or that there were none; returns how
  /// many.
  std::size_t pop_bulk(std::size_t count) {
    std::array<Element, most_in_bulk> elements{};
    count = std::min(count, elements.size());
    left_ -= std::min<std::uint64_t>(left_, count);
    const Stamp invoked = enter(Kind::pop);
    const std::size_t found = queue_.pop_bulk(state_.worker, std::span(elements).first(count));
    const Stamp returned = leave();
    if (found > count) complain("pop_bulk says that it found more elements than there is room for");
    for (std::size_t i = 0; i < found; ++i) note_pop(invoked, returned, elements[i]);
    if (found == 0 && count > 0) state_.log.push_back({invoked, returned, no_element, Kind::empty});
    return found;
  }

  /// Waits until every worker of the run is here. All must call it equally often.
  void meet() {
    wait_for_all();
    const Stamp now = stamp();
    state_.log.push_back({now, now, state_.barriers++, Kind::meet});
  }

  /// A random number below `bound`, from the run's seed.
  std::uint64_t random(std::uint64_t bound) { return state_.random.below(bound); }

  /// Ends the run with a finding.
  [[noreturn]] void complain(const std::string& text) const { throw Complaint(text); }

  /// Nothing to do just now: lets others run.
  virtual void idle() = 0;

  /// The moment, on the clock of the logs.
  virtual Stamp stamp() = 0;

  /// The moment, on the clock that the queue sees.
  virtual Deadline now() = 0;

  /// A second queue of the same kind.
  virtual std::unique_ptr<ElementQueue> another_queue(unsigned workers, std::size_t capacity) = 0;

 protected:
  /// An operation is about to start; returns the moment.
  virtual Stamp enter(Kind kind) = 0;
  /// It has ended; returns the moment.
  virtual Stamp leave() = 0;
  /// What `e` points to is written, before its push; it is read, after its pop: whether it is
  /// there.
  virtual void write_payload(Element e) {
    if (state_.payloads != nullptr) state_.payloads->write(e);
  }
  virtual bool sees_payload(Element e) {
    return state_.payloads == nullptr || state_.payloads->holds(e);
  }
  /// The barrier of all workers.
  virtual void wait_for_all() = 0;
  /// Ends the share of operations early.
  void stop_here() { left_ = 0; }

 private:
  std::optional<Element> found_or(bool found, Kind otherwise, Stamp invoked, Element e) {
    const Stamp returned = leave();
    if (found) {
      note_pop(invoked, returned, e);
      return e;
    }
    state_.log.push_back({invoked, returned, e, otherwise});
    return std::nullopt;
  }
  void note_pop(Stamp invoked, Stamp returned, Element e) {
    state_.log.push_back({invoked, returned, e, Kind::pop});
    if (!sees_payload(e) && state_.unpublished == no_element) state_.unpublished = e;
  }

  WorkerState& state_;
  ElementQueue& queue_;
  std::uint64_t left_;
};

}  // namespace irt::stress
