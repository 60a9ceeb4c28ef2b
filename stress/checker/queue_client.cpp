#include "stress/checker/queue_client.hpp"

#include <algorithm>
#include <new>

namespace irt::checker {

QueueClient::QueueClient(const QueueEntry& entry, Shape shape, std::size_t capacity,
                         virtual_cores::Module* module, bool real_time)
    : entry_(entry), shape_(std::move(shape)), capacity_(capacity), real_time_(real_time) {
  if (shape_.capacity != 0) capacity_ = shape_.capacity;
  if (capacity_ == 0)
    capacity_ = entry.claims.bounded ? std::max<std::size_t>(most_held(shape_), 1) : 1;

  const auto count = static_cast<unsigned>(shape_.threads.size());
  scenario_.module = module;
  scenario_.prepare = [this, count] {
    operations_.clear();
    phase_ = Operation::Phase::before;
    pushed_.assign(count + 1, 0);
    queue_ = entry_.make_word_queue(count, capacity_).release();
    run_letters(shape_.prologue, count, 0);
    phase_ = Operation::Phase::during;
  };
  for (unsigned thread = 0; thread < count; ++thread)
    scenario_.threads.emplace_back(
        [this, thread] { run_letters(shape_.threads[thread], thread, thread); });
  scenario_.finish = [this, count] {
    phase_ = Operation::Phase::after;
    const bool stalled = Execution::current_execution()->freezes();
    if (stalled && entry_.claims.pop == Progress::blocking) return;
    run_letters(shape_.epilogue, count, 0);
    for (unsigned worker = 0; worker < count; ++worker)
      while (pop(count, worker)) {
      }
    // A queue with a call in the middle of it cannot be destroyed.
    if (!stalled) delete queue_;
  };
  scenario_.judge = [this](const Execution& execution) { return judge_history(execution); };
  scenario_.histories = [this] {
    std::vector<std::uint64_t> result;
    for (const auto& [key, fine] : judged_) result.push_back(std::hash<std::string>{}(key));
    return result;
  };
}

void QueueClient::run_letters(const std::string& letters, unsigned thread, unsigned worker) {
  for (const char letter : letters) {
    switch (letter) {
      case 'E':
        push(thread, worker);
        break;
      case 'D':
        pop(thread, worker);
        break;
      case 'R':
        if (pop(thread, worker)) {
          push(thread, worker);
          push(thread, worker);
        }
        break;
      case 'T':
        work_until_over(thread, worker);
        break;
      case 'F':
        for (std::size_t i = 0; i < 2 * capacity_ + 2 && push(thread, worker); ++i) {
        }
        pop(thread, worker);
        push(thread, worker);
        break;
      case 'C':
        queue_->push(worker, close_word);
        break;
      case 'S':
        Execution::current_execution()->signal();
        break;
      case 'W':
        Execution::current_execution()->await_signal();
        break;
      default:
        break;
    }
  }
}

bool QueueClient::push(unsigned thread, unsigned worker) {
  const std::uint64_t value = 100 * (thread + 1) + ++pushed_[thread];
  const std::size_t number = call(Operation::Kind::push, thread, worker);
  operations_[number].value = value;
  return finish(number, [&] { return queue_->push(worker, value); });
}

bool QueueClient::pop(unsigned thread, unsigned worker) {
  const std::size_t number = call(Operation::Kind::pop, thread, worker);
  std::uint64_t value = 0;
  const bool answered = finish(number, [&] { return queue_->pop(worker, value); });
  if (!answered) return false;
  operations_[number].value = value;
  take_payload(operations_[number]);
  return true;
}

// What an element points to is plain memory that nothing else touches: it was written when the
// thread had made the events that the push was called after, and is read now. So there is a race
// exactly if the push's first event does not happen before here, and no memory is needed to tell.
void QueueClient::take_payload(const Operation& pop) const {
  Execution& execution = *Execution::current_execution();
  if (!execution.limits().races) return;
  const auto push =
      std::find_if(operations_.rbegin(), operations_.rend(), [&pop](const Operation& o) {
        return o.kind == Operation::Kind::push && o.value == pop.value;
      });
  if (push == operations_.rend() || push->thread == pop.thread) return;
  if (execution.clock_of(pop.thread).count[push->thread] > push->called.count[push->thread]) return;
  execution.report(FindingKind::data_race,
                   "what thread " + std::to_string(push->thread) + " wrote before push " +
                       std::to_string(push->value) + " and what thread " +
                       std::to_string(pop.thread) +
                       " read after the pop that returned it: the queue does not publish its "
                       "elements",
                   {});
}

std::size_t QueueClient::call(Operation::Kind kind, unsigned thread, unsigned worker) {
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
    const std::uint64_t now = execution.tick();
    operations_[number].called_at = now;
  }
  return number;
}

template <class Work>
bool QueueClient::finish(std::size_t number, Work work) {
  Execution& execution = *Execution::current_execution();
  const unsigned thread = operations_[number].thread;
  const unsigned failed = execution.failed_allocations(thread);
  bool answered = false;
  bool thrown = false;
  try {
    answered = work();
  } catch (const std::bad_alloc&) {
    if (execution.failed_allocations(thread) == failed) throw;
    thrown = true;
  }
  const std::uint64_t now = real_time_ ? execution.tick() : 0;
  Operation& done = operations_[number];
  done.answered = answered;
  done.finished = true;
  // Some libraries answer "full" for want of memory; a queue that is empty has no need to.
  done.no_memory = thrown || (!answered && done.kind == Operation::Kind::push &&
                              execution.failed_allocations(thread) != failed);
  done.returned_at = now;
  done.returned = static_cast<std::uint16_t>(execution.clock_of(thread).count[thread] + 1);
  done.last_step = execution.steps().size();
  return answered;
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
    const bool root = operations_[number].value / 100 == shape_.threads.size() + 1;
    for (int child = 0; root && child < 2; ++child) push(thread, worker);
  }
}

std::optional<std::string> QueueClient::judge_stalled() const {
  if (entry_.claims.pop == Progress::blocking) return std::nullopt;
  for (const Operation& push : operations_) {
    if (push.kind != Operation::Kind::push || !push.answered) continue;
    const bool out = std::any_of(operations_.begin(), operations_.end(), [&](const Operation& o) {
      return o.kind == Operation::Kind::pop && o.value == push.value && (o.answered || !o.finished);
    });
    const bool taken = std::any_of(operations_.begin(), operations_.end(), [](const Operation& o) {
      return o.kind == Operation::Kind::pop && !o.finished;
    });
    if (!out && !taken)
      return "element " + std::to_string(push.value) +
             ", whose push has returned, does not come out while a thread is stopped";
  }
  return std::nullopt;
}

std::optional<std::string> QueueClient::judge_history(const Execution& execution) {
  if (execution.freezes()) return judge_stalled();
  if (operations_.size() > 64) return judge(operations_, entry_.claims, capacity_);
  // Few histories differ in what matters: the answers and the order. Each is judged once.
  std::vector<const Operation*> sorted;
  for (const Operation& operation : operations_) sorted.push_back(&operation);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Operation* a, const Operation* b) { return a->thread < b->thread; });
  std::string key;
  for (const Operation* b : sorted) {
    std::uint64_t before = 0;
    for (std::size_t a = 0; a < sorted.size(); ++a)
      before |= std::uint64_t{precedes(*sorted[a], *b)} << a;
    key += b->no_memory ? 'm' : b->answered ? 'y' : 'n';
    key.append(reinterpret_cast<const char*>(&b->value), sizeof b->value);
    key.append(reinterpret_cast<const char*>(&before), sizeof before);
  }
  const auto known = judged_.find(key);
  if (known != judged_.end() && known->second) return std::nullopt;
  auto wrong = judge(operations_, entry_.claims, capacity_);
  judged_[key] = !wrong;
  return wrong;
}

}  // namespace irt::checker
