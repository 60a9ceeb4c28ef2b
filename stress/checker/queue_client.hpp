/// A client of one queue: a shape, and the judgement of what the queue answered.
///
/// After the threads the queue is emptied and destroyed, or destroyed as it is. Thread t works for
/// worker t; what comes before and after is done on behalf of worker 0 or, where the queue is for
/// one producer or one consumer, of the worker that is it; who takes such a role over acts for that
/// worker, too. The workers that pop in the shape empty the queue, all workers if none does. Nobody
/// acts for a thread that was stopped.
///
/// Where somebody waits a bounded queue has room for all elements, so that there is one to wait
/// for, and an unbounded one is made for 64. A push that is refused although the queue keeps its
/// word ends an execution in which somebody might wait for its element.
///
/// Each element stands for something that its thread writes just before the push, and that is read
/// just after the pop, as tasks are: a queue that does not publish it is accused of a data race.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "queues/work_queue.hpp"
#include "stress/checker/checker.hpp"
#include "stress/checker/queue_calls.hpp"
#include "stress/checker/shapes.hpp"
#include "stress/scenarios/core.hpp"

namespace irt::checker {

/// A shape over one queue. The functions of `program()` refer to this object.
class QueueClient {
 public:
  /// `capacity` is used where the shape leaves it open; 0 makes it one element, or for a bounded
  /// queue as many as the prologue pushes, so that rings are full and go round. With `real_time`
  /// calls are ordered by a clock as well, which is what `fifo_real_time` promises to agree with.
  /// Clients of one queue may share `aged`, so that its ageing is made once.
  QueueClient(const QueueEntry& entry, Shape shape, std::size_t capacity,
              virtual_cores::Module* module, bool real_time = false,
              std::shared_ptr<AgedMemory> aged = nullptr);
  QueueClient(const QueueClient&) = delete;
  QueueClient& operator=(const QueueClient&) = delete;

  [[nodiscard]] const Program& program() const { return program_; }
  [[nodiscard]] const std::vector<QueueCall>& operations() const { return operations_; }
  [[nodiscard]] const Shape& shape() const { return shape_; }

 private:
  void run_letters(const std::string& letters, unsigned thread);
  void drain(unsigned main, std::optional<unsigned> stopped);
  std::uint64_t next_value(unsigned thread);
  void make_step(char step, unsigned thread, unsigned pusher, unsigned popper);
  void work_until_over(unsigned thread, unsigned worker);
  bool push(unsigned thread, unsigned worker);
  bool pop(unsigned thread, unsigned worker);
  void pop_wait(unsigned thread, unsigned worker);
  void pop_until(unsigned thread, unsigned worker);
  void close(unsigned thread, unsigned worker);
  void leave(unsigned thread, bool hands_over);
  void push_two(unsigned thread, unsigned worker);
  void pop_two(unsigned thread, unsigned worker);
  void note_popped(std::size_t number, std::uint64_t value);
  std::size_t call(QueueCall::Kind kind, unsigned thread, unsigned worker);
  template <class Work>
  bool finish(std::size_t number, Work work);
  void note_return(std::size_t number, bool answered);
  void note_refused(const QueueCall& push) const;
  void finish_two(const std::array<std::size_t, 2>& numbers, std::size_t made,
                  const char* too_many);
  void age(std::uint64_t pairs, std::shared_ptr<AgedMemory> memory);
  void make_pair(std::uint64_t n);
  std::optional<std::string> judge_history(const Execution& execution);

  QueueEntry entry_;
  Shape shape_;
  std::size_t capacity_;
  bool real_time_;
  Program program_;
  AnyWorkQueue<std::uint64_t>* queue_ = nullptr;
  std::vector<QueueCall> operations_;
  QueueCall::Phase phase_ = QueueCall::Phase::before;
  std::vector<std::uint64_t> ageing_words_;
  std::vector<std::uint64_t> pushed_;  ///< by thread: elements so far
  Histories histories_;
  unsigned pusher_ = 0;  ///< the worker that pushes before and after the threads
  unsigned popper_ = 0;  ///< and the one that pops
};

}  // namespace irt::checker
