/// Clients of a queue, written as shapes.
///
///     EE|D|DE      three threads: two pushes; a pop; a pop and a push
///     EE:D|D       before the threads start, two pushes are made
///
///     E  push the next element           R  the renderer's task: pop one; if there was one, push
///     D  pop                                two, once per letter
///     EE|D|D;C     after the threads and before the queue is emptied, it is closed
///
///     S  signal: whoever waits ...       W  ... goes on, and everything before S happens before
///
///     T  the renderer's worker on a queue whose pop waits for tasks and answers "empty" when the
///        frame is over: pop until then; a task of the prologue pushes two
///
///     F  fill: push until it is full, at most twice its capacity; then pop one and push again
///
///     EE|DD@2      the queue is made for two elements
///
///     C  close: push `close_word`, for queues whose pop waits until they are closed
///
/// Each element stands for something that its thread writes just before the push, and that is read
/// just after the pop, as tasks are: a queue that does not publish it is accused of a data race.
///
/// After the threads the queue is emptied and destroyed. Thread t works for worker t; what comes
/// before and after is done on behalf of worker 0.
#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "queues/work_queue.hpp"
#include "stress/checker/checker.hpp"
#include "stress/checker/operations.hpp"

namespace irt::checker {

struct Shape {
  std::string prologue;
  std::vector<std::string> threads;
  std::string epilogue;
  std::size_t capacity = 0;  ///< of the queue, in elements; 0: left open
};

/// What C pushes; no element.
inline constexpr std::uint64_t close_word = ~std::uint64_t{1};

/// Throws std::invalid_argument that says what is wrong with `text`.
Shape parse_shape(std::string_view text);
std::string to_string(const Shape& shape);

/// The shapes that a queue with these claims is tried with, small ones first.
std::vector<std::string> battery(const Claims& claims);

/// A shape over one queue. The functions of `scenario()` refer to this object.
class QueueClient {
 public:
  /// `capacity` is used where the shape leaves it open; 0 makes it one element, or for a bounded
  /// queue as many as the prologue pushes, so that rings are full and go round. With `real_time`
  /// calls are ordered by a clock as well, which is what `fifo_real_time` promises to agree with.
  QueueClient(const QueueEntry& entry, Shape shape, std::size_t capacity,
              virtual_cores::Module* module, bool real_time = false);
  QueueClient(const QueueClient&) = delete;
  QueueClient& operator=(const QueueClient&) = delete;

  [[nodiscard]] const Scenario& scenario() const { return scenario_; }
  [[nodiscard]] const std::vector<Operation>& operations() const { return operations_; }
  [[nodiscard]] const Shape& shape() const { return shape_; }
  /// Executions whose operations the claims were asked about; the others were known already.
  [[nodiscard]] std::size_t histories() const { return judged_.size(); }

 private:
  void run_letters(const std::string& letters, unsigned thread, unsigned worker);
  void work_until_over(unsigned thread, unsigned worker);
  bool push(unsigned thread, unsigned worker);
  bool pop(unsigned thread, unsigned worker);
  void take_payload(const Operation& pop) const;
  std::size_t call(Operation::Kind kind, unsigned thread, unsigned worker);
  template <class Work>
  bool finish(std::size_t number, Work work);
  std::optional<std::string> judge_history(const Execution& execution);
  [[nodiscard]] std::optional<std::string> judge_stalled() const;

  QueueEntry entry_;
  Shape shape_;
  std::size_t capacity_;
  bool real_time_;
  Scenario scenario_;
  AnyWorkQueue<std::uint64_t>* queue_ = nullptr;
  std::vector<Operation> operations_;
  Operation::Phase phase_ = Operation::Phase::before;
  std::vector<std::uint64_t> pushed_;  ///< by thread: elements so far
  std::unordered_map<std::string, bool> judged_;
};

}  // namespace irt::checker
