/// The contract of a work queue: what it does, what it claims, and the face the renderer sees.
///
/// A work queue is a class template over its element. It has a constructor and two methods:
///
///     template <class T>
///     class MyQueue {
///      public:
///       static constexpr std::string_view summary = "one line for `irt list`";
///       static constexpr irt::Claims claims{.ordering = irt::Ordering::fifo_real_time, ...};
///
///       MyQueue(unsigned workers, std::size_t capacity);
///       bool push(unsigned worker, T task);    // false only where a bounded queue is full
///       bool pop(unsigned worker, T& task);    // false for empty; `task` is then unchanged
///     };
///
/// What happened before a push happens before what follows the pop that returns its element: an
/// element may point to memory that its pusher wrote and its popper reads, as the renderer's tasks
/// do, without a further word between the two. That holds for every queue, whatever it claims.
///
/// `worker`, in [0, workers), says on whose behalf the call is made. At any moment at most one
/// thread acts for a worker, and when another thread takes over, the hand-over happens-before its
/// first call. A queue may therefore keep unsynchronised state per worker.
///
/// `capacity` is a hint in elements: a bounded queue holds at least that many, an unbounded one
/// may ignore it.
///
/// Further methods are optional, and found by their names. Their semantics are those of the
/// standard's proposal P0260R20 where it has them (`queues/conqueue.hpp` takes its queues as they
/// are).
///
///       bool pop_wait(unsigned worker, T& task);  // waits; false once closed and nothing inside
///       PopStatus pop_wait(unsigned worker, T& task, Deadline deadline);
///       void close();                             // by any thread, as often as it likes
///
/// Who has one waiting pop has `close`. From then on a push answers false, which says nothing about
/// places; elements inside can still be popped, and who waits is told. A push that overlaps with
/// `close` may be accepted, and then no waiting pop may answer that the queue is closed and empty
/// before this element is out. What is pushed wakes one of those that wait, unless somebody else
/// pops it. A waiting pop may block other calls in no other way than `pop` may.
///
///       std::size_t push_bulk(unsigned worker, std::span<const T> tasks);  // how many were taken
///       std::size_t pop_bulk(unsigned worker, std::span<T> tasks);         // how many were found
///
/// As so many calls of `push` or `pop` one after the other, in the order of the span, up to the
/// first that answers false. `pop_bulk` may also stop earlier, but not before the first element.
///
///       void leave(unsigned worker);
///
/// The worker makes no call from now on, until perhaps another thread acts for it; called by the
/// thread that did, which may end then.
///
/// A queue that wants an object of its own for each who calls it has a class `Handle`, which is
/// made of the queue, and takes it in place of the worker in all methods; it has no `leave`. A
/// worker's handle is made by its first call and destroyed when it leaves, each time in the thread
/// that acts for it (`handles.hpp`).
///
///       struct Handle { explicit Handle(MyQueue& queue); };
///       bool push(Handle& handle, T task);
///
/// Elements are trivially copyable words of at most eight bytes, and what else the queue claims to
/// take (`Claims::elements`). Construction and destruction are single-threaded; a queue may be
/// destroyed while it still holds elements.
#pragma once

#include <array>
#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "queues/claims.hpp"
#include "queues/elements.hpp"
#include "queues/handles.hpp"

namespace irt {

/// How a pop with a deadline ended.
enum class PopStatus : std::uint8_t {
  success,    ///< with an element
  closed,     ///< the queue is closed, and nothing was inside
  timed_out,  ///< nothing was found before the deadline, which has passed
};

/// Until when a pop waits, at most.
using Deadline = std::chrono::steady_clock::time_point;

/// Which of the optional methods a queue has.
struct Methods {
  bool pop_wait = false;  ///< and `close`
  bool deadline = false;  ///< `pop_wait` takes one
  bool bulk = false;      ///< `push_bulk` and `pop_bulk`
  bool leave = false;     ///< workers leave, or have handles
};

// clang-format 14 does not know how to lay out a concept.
// clang-format off

/// `Q` is a work queue of `T`.
template <class Q, class T>
concept WorkQueueOf =
    std::is_trivially_copyable_v<T> && sizeof(T) <= sizeof(std::uint64_t) &&
    std::constructible_from<Q, unsigned, std::size_t> &&
    requires(Q& queue, unsigned worker, T task) {
      { queue.push(worker, task) } -> std::same_as<bool>;
      { queue.pop(worker, task) } -> std::same_as<bool>;
      { Q::claims } -> std::convertible_to<const Claims&>;
      { Q::summary } -> std::convertible_to<std::string_view>;
    };

/// `Q` is a work queue for every element the testbed uses: tasks (pointers) and tagged integers.
template <template <class> class Q>
concept WorkQueue =
    WorkQueueOf<ByWorker<Q<void*>, void*>, void*> &&
    WorkQueueOf<ByWorker<Q<std::uint64_t>, std::uint64_t>, std::uint64_t>;

/// `Q` has a pop that waits, and can be closed.
template <class Q, class T>
concept PopsWaiting = requires(Q& queue, unsigned worker, T& task) {
  { queue.pop_wait(worker, task) } -> std::same_as<bool>;
  { queue.close() } -> std::same_as<void>;
};

/// The waiting pop of `Q` takes a deadline as well.
template <class Q, class T>
concept PopsUntil = PopsWaiting<Q, T> &&
    requires(Q& queue, unsigned worker, T& task, Deadline deadline) {
      { queue.pop_wait(worker, task, deadline) } -> std::same_as<PopStatus>;
    };

/// `Q` takes and gives several elements in a call.
template <class Q, class T>
concept HasBulk = requires(Q& queue, unsigned worker, std::span<const T> in, std::span<T> out) {
  { queue.push_bulk(worker, in) } -> std::same_as<std::size_t>;
  { queue.pop_bulk(worker, out) } -> std::same_as<std::size_t>;
};

/// The workers of `Q` say when they make no further call.
template <class Q>
concept HasLeave = requires(Q& queue, unsigned worker) {
  { queue.leave(worker) } -> std::same_as<void>;
};

/// `Q` has nothing that looks like an optional method and is none.
template <class Q, class T>
concept HasWholeMethods =
    (PopsWaiting<Q, T> ||
     !(requires(Q& queue, unsigned worker, T& task) { queue.pop_wait(worker, task); } ||
       requires(Q& queue) { queue.close(); })) &&
    (PopsUntil<Q, T> ||
     !requires(Q& queue, unsigned worker, T& task, Deadline deadline) {
       queue.pop_wait(worker, task, deadline);
     }) &&
    (HasLeave<Q> || !requires(Q& queue, unsigned worker) { queue.leave(worker); }) &&
    (HasBulk<Q, T> ||
     !(requires(Q& queue, unsigned worker, std::span<const T> in) { queue.push_bulk(worker, in); } ||
       requires(Q& queue, unsigned worker, std::span<T> out) { queue.pop_bulk(worker, out); }));

// clang-format on

/// The optional methods of `Q`.
template <class Q, class T>
constexpr Methods methods_of() {
  return {.pop_wait = PopsWaiting<Q, T>,
          .deadline = PopsUntil<Q, T>,
          .bulk = HasBulk<Q, T>,
          .leave = HasLeave<Q>};
}

/// `worker` leaves `queue`, where workers do.
template <class Queue>
void leave(Queue& queue, unsigned worker) {
  if constexpr (HasLeave<Queue>) queue.leave(worker);
}

/// The type-erased face of a queue of `T`: one virtual call per operation. What a queue does not
/// have (`QueueEntry::methods`) throws std::logic_error, but for `leave`, which does nothing.
template <class T>
class AnyWorkQueue {
 public:
  AnyWorkQueue() = default;
  AnyWorkQueue(const AnyWorkQueue&) = delete;
  AnyWorkQueue& operator=(const AnyWorkQueue&) = delete;
  virtual ~AnyWorkQueue() = default;

  /// Adds `task` on behalf of `worker`. False only where a bounded queue is full.
  virtual bool push(unsigned worker, T task) = 0;

  /// Takes a task on behalf of `worker`. False for *empty*, in the sense of the queue's claims.
  virtual bool pop(unsigned worker, T& task) = 0;

  /// The same, waiting for a task. False where the queue is closed and nothing is inside.
  virtual bool pop_wait(unsigned /*worker*/, T& /*task*/) { lacks("pop_wait"); }
  virtual PopStatus pop_wait(unsigned /*worker*/, T& /*task*/, Deadline /*deadline*/) {
    lacks("pop_wait with a deadline");
  }
  /// Ends all waiting for good.
  virtual void close() { lacks("close"); }

  /// How many of `tasks`, from the first on, were taken; and found.
  virtual std::size_t push_bulk(unsigned /*worker*/, std::span<const T> /*tasks*/) {
    lacks("push_bulk");
  }
  virtual std::size_t pop_bulk(unsigned /*worker*/, std::span<T> /*tasks*/) { lacks("pop_bulk"); }

  /// The worker makes no further call for now. By the thread that acted for it.
  virtual void leave(unsigned /*worker*/) {}

 private:
  [[noreturn]] static void lacks(const char* method) {
    throw std::logic_error(std::string("this queue has no ") + method);
  }
};

/// The face of the concrete queue `Q`, whose elements are those of the face or carry one each
/// (elements.hpp).
template <class T, class Q, class Element = T>
class WorkQueueFace final : public AnyWorkQueue<T> {
 public:
  WorkQueueFace(unsigned workers, std::size_t capacity) : queue_(workers, capacity) {}

  bool push(unsigned worker, T task) override {
    Element element(task);
    if constexpr (std::is_copy_constructible_v<Element>)
      return queue_.push(worker, element);
    else
      return queue_.push(worker, std::move(element));
  }
  bool pop(unsigned worker, T& task) override {
    return taken(task, [&](Element& element) { return queue_.pop(worker, element); });
  }

  bool pop_wait(unsigned worker, T& task) override {
    if constexpr (PopsWaiting<Q, Element>)
      return taken(task, [&](Element& element) { return queue_.pop_wait(worker, element); });
    return AnyWorkQueue<T>::pop_wait(worker, task);
  }
  PopStatus pop_wait(unsigned worker, T& task, Deadline deadline) override {
    if constexpr (PopsUntil<Q, Element>) {
      PopStatus status = PopStatus::closed;
      taken(task, [&](Element& element) {
        status = queue_.pop_wait(worker, element, deadline);
        return status == PopStatus::success;
      });
      return status;
    }
    return AnyWorkQueue<T>::pop_wait(worker, task, deadline);
  }
  void close() override {
    if constexpr (PopsWaiting<Q, Element>) return queue_.close();
    AnyWorkQueue<T>::close();
  }

  std::size_t push_bulk(unsigned worker, std::span<const T> tasks) override {
    if constexpr (has_bulk) return queue_.push_bulk(worker, tasks);
    return AnyWorkQueue<T>::push_bulk(worker, tasks);
  }
  std::size_t pop_bulk(unsigned worker, std::span<T> tasks) override {
    if constexpr (has_bulk) return queue_.pop_bulk(worker, tasks);
    return AnyWorkQueue<T>::pop_bulk(worker, tasks);
  }

  void leave(unsigned worker) override { irt::leave(queue_, worker); }

 private:
  static constexpr bool is_same = std::same_as<T, Element>;
  static_assert(!is_same || WorkQueueOf<Q, T>);
  static constexpr bool has_bulk = is_same && HasBulk<Q, T>;

  template <class Pop>
  static bool taken(T& task, Pop pop) {
    if constexpr (is_same) {
      return pop(task);
    } else {
      Element element;
      if (!pop(element)) return false;
      task = element.word();
      return true;
    }
  }

  Q queue_;
};

/// While it lives a thread acts for `worker`, which leaves the queue then.
template <class Queue>
class ActsFor {
 public:
  ActsFor(Queue& queue, unsigned worker) : queue_(queue), worker_(worker) {}
  ActsFor(const ActsFor&) = delete;
  ActsFor& operator=(const ActsFor&) = delete;
  ~ActsFor() { leave(queue_, worker_); }

 private:
  Queue& queue_;
  unsigned worker_;
};

/// All workers leave `queue`, for which one thread has acted.
template <class Queue>
void leave_all(Queue& queue, unsigned workers) {
  for (unsigned worker = 0; worker < workers; ++worker) leave(queue, worker);
}

using WordQueueMaker = std::unique_ptr<AnyWorkQueue<std::uint64_t>> (*)(unsigned workers,
                                                                        std::size_t capacity);

/// Queues of words that go through elements of another kind; null where the queue does not claim to
/// take those.
struct ElementQueueMakers {
  WordQueueMaker large = nullptr;
  WordQueueMaker owner = nullptr;
  WordQueueMaker copied = nullptr;
};

/// A queue by name, as the tools see it.
struct QueueEntry {
  std::string_view name;     ///< on the command line: lower case, words joined by '-'
  std::string_view summary;  ///< one line
  Claims claims;
  Methods methods;  ///< the optional ones that it has
  std::unique_ptr<AnyWorkQueue<void*>> (*make_task_queue)(unsigned workers, std::size_t capacity);
  WordQueueMaker make_word_queue;
  ElementQueueMakers make_element_queue{};
};

/// A kind of elements that are no words, as the tools name it.
struct ElementKind {
  std::string_view name;
  std::string_view words;     ///< after "elements"
  WordQueueMaker make_queue;  ///< of this queue; null where it does not claim to take them
};

constexpr std::array<ElementKind, 3> element_kinds(const QueueEntry& entry) {
  return {{{"large", "of 64 bytes", entry.make_element_queue.large},
           {"owner", "that own memory and move", entry.make_element_queue.owner},
           {"copied", "that own memory and are copied", entry.make_element_queue.copied}}};
}

/// The queue of `entry` as one whose words go through elements of `kind`.
constexpr QueueEntry through_elements(QueueEntry entry, const ElementKind& kind) {
  entry.make_word_queue = kind.make_queue;
  entry.methods.bulk = false;
  return entry;
}

/// Throws std::invalid_argument, with one line for the user, where `Q` may not be made for so many.
template <class Q>
void require_workers(unsigned workers) {
  if (Q::claims.allows_workers(workers)) return;
  throw std::invalid_argument("this queue (" + std::string(Q::summary) + ") is for at most " +
                              std::to_string(Q::claims.max_workers) + " workers, and " +
                              std::to_string(workers) + " were asked for; use fewer threads");
}

/// Makes queues of `Element` if they are `claimed`.
template <template <class> class Q, class Element, bool claimed>
constexpr WordQueueMaker element_queue_maker() {
  if constexpr (claimed)
    return [](unsigned workers,
              std::size_t capacity) -> std::unique_ptr<AnyWorkQueue<std::uint64_t>> {
      require_workers<Q<Element>>(workers);
      return std::make_unique<WorkQueueFace<std::uint64_t, ByWorker<Q<Element>, Element>, Element>>(
          workers, capacity);
    };
  return nullptr;
}

/// The entry of `Q` under `name`. Its factories throw std::invalid_argument for more workers than
/// the queue claims to be for.
template <template <class> class Q>
constexpr QueueEntry queue_entry(std::string_view name) {
  static_assert(WorkQueue<Q>,
                "this class template is no work queue: queues/work_queue.hpp says what "
                "it must have (constructor, push, pop, claims, summary)");
  using Tasks = ByWorker<Q<void*>, void*>;
  using Words = ByWorker<Q<std::uint64_t>, std::uint64_t>;
  static_assert(HasWholeMethods<Tasks, void*>,
                "pop_wait returns bool, with a deadline irt::PopStatus, and comes with "
                "void close(); push_bulk and pop_bulk return std::size_t and come together; "
                "leave returns void: "
                "queues/work_queue.hpp says how they are declared");
  return {
      .name = name,
      .summary = Q<void*>::summary,
      .claims = Q<void*>::claims,
      .methods = methods_of<Tasks, void*>(),
      .make_task_queue = [](unsigned workers,
                            std::size_t capacity) -> std::unique_ptr<AnyWorkQueue<void*>> {
        require_workers<Q<void*>>(workers);
        return std::make_unique<WorkQueueFace<void*, Tasks>>(workers, capacity);
      },
      .make_word_queue = [](unsigned workers,
                            std::size_t capacity) -> std::unique_ptr<AnyWorkQueue<std::uint64_t>> {
        require_workers<Q<std::uint64_t>>(workers);
        return std::make_unique<WorkQueueFace<std::uint64_t, Words>>(workers, capacity);
      },
      .make_element_queue =
          {.large = element_queue_maker<Q, LargeElement, Q<void*>::claims.elements.large>(),
           .owner = element_queue_maker<Q, OwnerElement, Q<void*>::claims.elements.owner>(),
           .copied = element_queue_maker<Q, CopiedElement, Q<void*>::claims.elements.copied>()},
  };
}

}  // namespace irt
