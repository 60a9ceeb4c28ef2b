#include "stress/checker/queue_client.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <new>
#include <numeric>
#include <stdexcept>

#include "stress/checker/publication.hpp"
#include "stress/history/specification.hpp"

namespace irt::checker {

namespace {

/// A queue that leaves so few words as to refuse that many in a row is not for this tool.
constexpr std::uint64_t most_tries = 100'000;

/// A queue that grows is told to expect that many where somebody waits. One that gives memory back
/// by the batch then does not in so small a shape: others look at that.
constexpr std::size_t expected_by_those_who_wait = 64;

// Of two who have a role one after the other, the first signals.
std::optional<unsigned> first_with(std::string_view letters, const Shape& shape) {
  std::optional<unsigned> first;
  for (unsigned thread = 0; thread < shape.threads.size(); ++thread) {
    const std::string& word = shape.threads[thread];
    if (word.find_first_of(letters) == std::string::npos) continue;
    if (!first || word.find('S') != std::string::npos) first = thread;
  }
  return first;
}

}  // namespace

QueueClient::QueueClient(const QueueEntry& entry, Shape shape, std::size_t capacity,
                         virtual_cores::Module* module, bool real_time,
                         std::shared_ptr<AgedMemory> aged)
    : entry_(entry), shape_(std::move(shape)), capacity_(capacity), real_time_(real_time) {
  if (shape_.capacity != 0) capacity_ = shape_.capacity;
  if (capacity_ == 0) {
    const bool waits = to_string(shape_).find('P') != std::string::npos;
    if (entry.claims.bounded)
      capacity_ = waits ? pushes_of(shape_) : most_held(shape_);
    else if (waits)
      capacity_ = expected_by_those_who_wait;
  }
  capacity_ = std::max<std::size_t>(capacity_, 1);
  const auto count = static_cast<unsigned>(shape_.threads.size());
  if (!entry.claims.allows_workers(count))
    throw std::invalid_argument("shape \"" + to_string(shape_) + "\": " + std::to_string(count) +
                                " threads, and the queue claims to be made for at most " +
                                std::to_string(entry.claims.max_workers));
  if (entry.claims.one_producer()) pusher_ = first_with(pushing, shape_).value_or(0);
  if (entry.claims.one_consumer()) popper_ = first_with(popping, shape_).value_or(count - 1);
  age(shape_.age, std::move(aged));
  program_.module = module;
  program_.prepare = [this, count] {
    operations_.clear();
    phase_ = QueueCall::Phase::before;
    pushed_.assign(count + 1, 0);
    queue_ = program_.age != 0 ? static_cast<AnyWorkQueue<std::uint64_t>*>(program_.aged->made)
                               : entry_.make_word_queue(count, capacity_).release();
    run_letters(shape_.prologue, count);
    if (entry_.methods.leave) leave_all(*queue_, count);
    phase_ = QueueCall::Phase::during;
  };
  for (unsigned thread = 0; thread < count; ++thread)
    program_.threads.emplace_back([this, thread] {
      run_letters(shape_.threads[thread], thread);
      leave(thread, false);
    });
  program_.finish = [this, count] {
    phase_ = QueueCall::Phase::after;
    const std::optional<unsigned> stopped = Execution::current_execution()->stopped();
    if (stopped && entry_.claims.pop == Progress::blocking) return;
    run_letters(shape_.epilogue, count);
    if (!leaves_inside(shape_) || stopped) drain(count, stopped);
    // A queue with a call in the middle of it cannot be destroyed.
    if (!stopped) delete queue_;
  };
  for (const std::string& word : shape_.threads)
    program_.roles.push_back(
        static_cast<unsigned>(std::ranges::find(shape_.threads, word) - shape_.threads.begin()));
  program_.outcome = [this] { return histories_.last(); };
  program_.judge = [this](const Execution& execution) { return judge_history(execution); };
  program_.histories = [this] { return histories_.hashes(); };
}

// Who pops in the shape empties the queue, until all of them find nothing. Everybody does if nobody
// pops there, where each has a queue of its own, and where the others must do without a stopped
// thread. Nobody acts for that one. Where a worker may miss what others find, everybody does as
// well.
void QueueClient::drain(unsigned main, std::optional<unsigned> stopped) {
  std::vector<unsigned> poppers;
  for (unsigned worker = 0; worker < main; ++worker)
    if (entry_.claims.one_consumer()
            ? worker == popper_
            : shape_.threads[worker].find_first_of(popping) != std::string::npos ||
                  (worker == popper_ &&
                   shape_.prologue.find_first_of(popping) != std::string::npos))
      poppers.push_back(worker);
  if (poppers.empty() || entry_.claims.own_queues() ||
      (!entry_.claims.one_consumer() && (stopped || entry_.claims.empty == Answer::this_worker))) {
    poppers.resize(main);
    std::iota(poppers.begin(), poppers.end(), 0U);
  }
  // More than was pushed is wrong, and may have no end.
  const auto pushes = static_cast<std::size_t>(
      std::ranges::count(operations_, QueueCall::Kind::push, &QueueCall::kind));
  std::size_t popped = 0;
  for (bool found = true; found;) {
    found = false;
    for (const unsigned worker : poppers)
      while (worker != stopped && popped <= pushes && pop(main, worker)) {
        found = true;
        ++popped;
      }
    if (popped > pushes) return;
  }
}

void QueueClient::run_letters(const std::string& letters, unsigned thread) {
  // What comes before and after the threads is done by the workers whose part it is.
  const bool alone = thread == shape_.threads.size();
  const unsigned pusher = alone || entry_.claims.one_producer() ? pusher_ : thread;
  const unsigned popper = alone || entry_.claims.one_consumer() ? popper_ : thread;
  const std::optional<unsigned> stopped = Execution::current_execution()->stopped();
  if (alone && (pusher == stopped || popper == stopped)) return;
  for (const char letter : letters) {
    // Who takes a role over waits for this.
    if (letter == 'S' && !alone) leave(thread, true);
    make_step(letter, thread, pusher, popper);
  }
}

void QueueClient::make_step(char step, unsigned thread, unsigned pusher, unsigned popper) {
  switch (step) {
    case 'E':
      push(thread, pusher);
      break;
    case 'D':
      pop(thread, popper);
      break;
    case 'P':
      pop_wait(thread, popper);
      break;
    case 'L':
      pop_until(thread, popper);
      break;
    case 'C':
      close(thread, pusher);
      break;
    case 'B':
      push_two(thread, pusher);
      break;
    case 'G':
      pop_two(thread, popper);
      break;
    case 'R':
      if (pop(thread, popper)) {
        push(thread, pusher);
        push(thread, pusher);
      }
      break;
    case 'T':
      work_until_over(thread, popper);
      break;
    case 'F':
      for (std::size_t i = 0; i < 2 * capacity_ + 2 && push(thread, pusher); ++i) {
      }
      pop(thread, popper);
      push(thread, pusher);
      break;
    case 'S':
      Execution::current_execution()->kernel().signal();
      break;
    case 'W':
      Execution::current_execution()->kernel().await_signal();
      break;
    default:
      break;
  }
}

bool QueueClient::push(unsigned thread, unsigned worker) {
  const std::uint64_t value = next_value(thread);
  const std::size_t number = call(QueueCall::Kind::push, thread, worker);
  operations_[number].value = value;
  return finish(number, [&] { return queue_->push(worker, value); });
}

// 101, 102, ... for thread 0, 201 for thread 1; from the hundredth on with more room between them.
// What the queue keeps for itself is left out.
std::uint64_t QueueClient::next_value(unsigned thread) {
  for (std::uint64_t tries = 0; tries < most_tries; ++tries) {
    const std::uint64_t n = ++pushed_[thread];
    const std::uint64_t value = (n < 100 ? 100 : 10'000'000) * (std::uint64_t{thread} + 1) + n;
    if (entry_.claims.allows(value)) return value;
  }
  Execution::current_execution()->conclusion().report(
      FindingKind::failure, "the queue's claims leave no words that could be elements", {});
}

bool QueueClient::pop(unsigned thread, unsigned worker) {
  const std::size_t number = call(QueueCall::Kind::pop, thread, worker);
  std::uint64_t value = 0;
  const bool answered = finish(number, [&] { return queue_->pop(worker, value); });
  if (answered) note_popped(number, value);
  return answered;
}

void QueueClient::note_popped(std::size_t number, std::uint64_t value) {
  operations_[number].value = value;
  const auto push = std::find_if(operations_.rbegin(), operations_.rend(), [&](const QueueCall& o) {
    return o.kind == QueueCall::Kind::push && o.value == value;
  });
  if (push == operations_.rend()) return;
  const std::uint16_t called = push->called.count[push->thread];
  if (!sees_what_precedes(push->thread, called))
    report_unpublished(std::to_string(value), push->thread, called);
}

void QueueClient::pop_wait(unsigned thread, unsigned worker) {
  const std::size_t number = call(QueueCall::Kind::pop, thread, worker);
  operations_[number].waits = true;
  std::uint64_t value = 0;
  if (finish(number, [&] { return queue_->pop_wait(worker, value); }))
    note_popped(number, value);
  else
    operations_[number].closed = !operations_[number].no_memory;
}

void QueueClient::pop_until(unsigned thread, unsigned worker) {
  constexpr std::int64_t patience = 10'000;  // nanoseconds of virtual time: ten looks at the clock
  Execution& execution = *Execution::current_execution();
  const std::int64_t deadline = execution.kernel().time() + patience;
  const std::size_t number = call(QueueCall::Kind::pop, thread, worker);
  operations_[number].waits = true;
  std::uint64_t value = 0;
  PopStatus status = PopStatus::timed_out;
  const bool found = finish(number, [&] {
    status = queue_->pop_wait(worker, value, irt::Deadline(std::chrono::nanoseconds(deadline)));
    return status == PopStatus::success;
  });
  if (found) return note_popped(number, value);
  operations_[number].closed = status == PopStatus::closed;
  operations_[number].timed_out = status == PopStatus::timed_out;
  if (status == PopStatus::timed_out && execution.kernel().time() < deadline)
    execution.conclusion().report(
        FindingKind::wrong_outcome,
        "thread " + std::to_string(thread) +
            "'s pop_wait answered that its deadline has passed, and it had not",
        {});
}

void QueueClient::close(unsigned thread, unsigned worker) {
  const std::size_t number = call(QueueCall::Kind::close, thread, worker);
  finish(number, [&] {
    queue_->close();
    return true;
  });
}

// Those for whom the thread has acted since they left; or only if another one will.
void QueueClient::leave(unsigned thread, bool hands_over) {
  if (!entry_.methods.leave) return;
  for (unsigned worker = 0; worker < shape_.threads.size(); ++worker) {
    if (hands_over && worker == thread && entry_.claims.many_to_many()) continue;
    const auto last =
        std::ranges::find_if(operations_.rbegin(), operations_.rend(), [&](const auto& o) {
          return o.phase == phase_ && o.thread == thread && o.worker == worker &&
                 o.kind != QueueCall::Kind::close;
        });
    if (last == operations_.rend() || last->kind == QueueCall::Kind::leave) continue;
    const std::size_t number = call(QueueCall::Kind::leave, thread, worker);
    finish(number, [&] {
      queue_->leave(worker);
      return true;
    });
  }
}

void QueueClient::push_two(unsigned thread, unsigned worker) {
  std::array<std::size_t, 2> numbers{};
  std::array<std::uint64_t, 2> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    values.at(i) = next_value(thread);
    numbers.at(i) = call(QueueCall::Kind::push, thread, worker);
    operations_[numbers.at(i)].value = values.at(i);
  }
  std::size_t accepted = 0;
  finish(numbers.back(), [&] {
    accepted = queue_->push_bulk(worker, values);
    return accepted == values.size();
  });
  finish_two(numbers, accepted, "push_bulk says that it took more elements than it was given");
  operations_[numbers.back()].untried = accepted == 0;
}

void QueueClient::pop_two(unsigned thread, unsigned worker) {
  std::array<std::size_t, 2> numbers{};
  std::array<std::uint64_t, 2> values{};
  for (std::size_t& number : numbers) number = call(QueueCall::Kind::pop, thread, worker);
  std::size_t found = 0;
  finish(numbers.back(), [&] {
    found = queue_->pop_bulk(worker, values);
    return found == values.size();
  });
  finish_two(numbers, found, "pop_bulk says that it found more elements than there is room for");
  // It may stop after the first.
  operations_[numbers.back()].untried = found < values.size();
  for (std::size_t i = 0; i < found; ++i) note_popped(numbers.at(i), values.at(i));
}

// The second call is finished, and has what is common to both.
void QueueClient::finish_two(const std::array<std::size_t, 2>& numbers, std::size_t made,
                             const char* too_many) {
  if (made > numbers.size())
    Execution::current_execution()->conclusion().report(FindingKind::wrong_outcome, too_many, {});
  note_return(numbers.front(), made > 0);
  operations_[numbers.front()].no_memory = operations_[numbers.back()].no_memory && made == 0;
}

std::size_t QueueClient::call(QueueCall::Kind kind, unsigned thread, unsigned worker) {
  Execution& execution = *Execution::current_execution();
  const std::size_t number = operations_.size();
  operations_.push_back({.kind = kind,
                         .thread = thread,
                         .worker = worker,
                         .number = number,
                         .phase = phase_,
                         .called = execution.clock_of(thread),
                         .first_step = execution.steps().size()});
  if (real_time_) {
    const std::uint64_t now = execution.kernel().tick();
    operations_[number].called_at = now;
  }
  return number;
}

template <class Work>
bool QueueClient::finish(std::size_t number, Work work) {
  Execution& execution = *Execution::current_execution();
  const unsigned thread = operations_[number].thread;
  const unsigned failed = execution.allocations().failed(thread);
  bool answered = false;
  bool thrown = false;
  try {
    answered = work();
  } catch (const std::bad_alloc&) {
    if (execution.allocations().failed(thread) == failed) throw;
    thrown = true;
  }
  note_return(number, answered);
  // Some libraries answer "full" for want of memory; a queue that is empty has no need to.
  operations_[number].no_memory =
      thrown || (!answered && operations_[number].kind == QueueCall::Kind::push &&
                 execution.allocations().failed(thread) != failed);
  if (!answered && operations_[number].kind == QueueCall::Kind::push)
    note_refused(operations_[number]);
  return answered;
}

void QueueClient::note_refused(const QueueCall& push) const {
  const stress::Specification specification(entry_.claims, capacity_);
  const bool excused =
      push.no_memory || (entry_.claims.bounded && specification.full() != Answer::exact);
  if (!excused || to_string(shape_).find('P') == std::string::npos || closes_for_certain(shape_) ||
      std::ranges::any_of(operations_,
                          [](const QueueCall& o) { return o.kind == QueueCall::Kind::close; }))
    return;
  Execution::current_execution()->conclusion().give_up(
      "a push was refused, as it may be, for whose element somebody might wait");
}

void QueueClient::note_return(std::size_t number, bool answered) {
  Execution& execution = *Execution::current_execution();
  const std::uint64_t now = real_time_ ? execution.kernel().tick() : 0;
  QueueCall& done = operations_[number];
  done.answered = answered;
  done.finished = true;
  done.returned_at = now;
  done.returned =
      static_cast<std::uint16_t>(execution.clock_of(done.thread).count[done.thread] + 1);
  done.last_step = execution.steps().size();
}

void QueueClient::work_until_over(unsigned thread, unsigned worker) {
  for (;;) {
    const std::size_t number = operations_.size();
    if (!pop(thread, worker)) {
      operations_[number].ends_frame = true;
      operations_[number].before_return = Execution::current_execution()->clock_of(thread);
      return;
    }
    // A task of the prologue has two children; they have none.
    const bool root = std::ranges::any_of(operations_, [&](const QueueCall& o) {
      return o.kind == QueueCall::Kind::push && o.phase == QueueCall::Phase::before &&
             o.value == operations_[number].value;
    });
    for (int child = 0; root && child < 2; ++child) push(thread, worker);
  }
}

std::optional<std::string> QueueClient::judge_history(const Execution& execution) {
  if (const auto stopped = execution.stopped())
    return entry_.claims.one_consumer() && popper_ == *stopped
               ? std::nullopt
               : judge_stalled(operations_, entry_.claims, capacity_, *stopped);
  for (QueueCall& push : operations_)
    push.closed |= push.kind == QueueCall::Kind::push && !push.answered && !push.untried &&
                   std::ranges::any_of(operations_, [&](const QueueCall& c) {
                     return c.kind == QueueCall::Kind::close && !precedes(push, c);
                   });
  Opinion opinion = histories_.judge(operations_, entry_.claims, capacity_, !leaves_inside(shape_));
  if (!opinion.decided)
    Execution::current_execution()->conclusion().note_incomplete(
        "the answers of an execution fit more orders than can be tried");
  return std::move(opinion.wrong);
}

}  // namespace irt::checker
