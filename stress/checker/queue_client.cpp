#include "stress/checker/queue_client.hpp"

#include <algorithm>
#include <stdexcept>

namespace irt::checker {

Shape parse_shape(std::string_view text) {
  Shape shape;
  std::string_view rest = text;
  const auto check = [text](std::string_view part) {
    for (const char letter : part)
      if (std::string_view("EDRSWC").find(letter) == std::string_view::npos)
        throw std::invalid_argument(
            "shape \"" + std::string(text) + "\": '" + letter +
            "' is no step; steps are E D R S W C, threads are parted by '|', "
            "a prologue ends with ':'");
    return std::string(part);
  };
  if (const auto colon = rest.find(':'); colon != std::string_view::npos) {
    shape.prologue = check(rest.substr(0, colon));
    rest.remove_prefix(colon + 1);
  }
  if (const auto semicolon = rest.find(';'); semicolon != std::string_view::npos) {
    shape.epilogue = check(rest.substr(semicolon + 1));
    rest = rest.substr(0, semicolon);
  }
  for (;;) {
    const auto bar = rest.find('|');
    shape.threads.push_back(check(rest.substr(0, bar)));
    if (shape.threads.back().empty())
      throw std::invalid_argument("shape \"" + std::string(text) + "\": a thread without steps");
    if (bar == std::string_view::npos) break;
    rest.remove_prefix(bar + 1);
  }
  if (shape.threads.size() + 1 > max_threads)
    throw std::invalid_argument("shape \"" + std::string(text) + "\": at most " +
                                std::to_string(max_threads - 1) + " threads");
  return shape;
}

std::string to_string(const Shape& shape) {
  std::string text = shape.prologue.empty() ? "" : shape.prologue + ":";
  for (const std::string& thread : shape.threads)
    text += (&thread == shape.threads.data() ? "" : "|") + thread;
  return shape.epilogue.empty() ? text : text + ";" + shape.epilogue;
}

std::vector<std::string> battery(const Claims& claims) {
  // Pure consumers matter: a thread that has pushed before it pops has synchronised by that. The
  // middle ones are libvsync's for its unbounded queue; S and W stand for its message passing.
  static const std::vector<std::string> all{
      "E|D",    "E:D|D", "ES|WD",    "ED|ED",   "E|E|D",    "E|D|D",
      "EE|DD",  "E:R|R", "EES|D|WD", "EE:DE|D", "EE:DD|D",  "E:E|D|E",
      "EE|D|D", "EDD|E", "E|E|DD",   "EEE|DD",  "EE:DD|ED", "EEEE|DDDD"};
  std::vector<std::string> fitting;
  for (const std::string& text : all) {
    const Shape shape = parse_shape(text);
    const auto users = [&shape](std::string_view letters) {
      return std::count_if(shape.threads.begin(), shape.threads.end(), [&](const std::string& t) {
        return t.find_first_of(letters) != std::string::npos;
      });
    };
    if (claims.producers == Callers::one && users("ER") > 1) continue;
    if (claims.consumers == Callers::one && users("DR") > 1) continue;
    fitting.push_back(text);
  }
  return fitting;
}

QueueClient::QueueClient(const QueueEntry& entry, Shape shape, std::size_t capacity,
                         virtual_cores::Module* module)
    : entry_(entry), shape_(std::move(shape)), capacity_(capacity) {
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
    run_letters(shape_.epilogue, count, 0);
    for (unsigned worker = 0; worker < count; ++worker)
      while (pop(count, worker)) {
      }
    // A queue with a call in the middle of it cannot be destroyed.
    if (!Execution::current_execution()->freezes()) delete queue_;
  };
  scenario_.judge = [this](const Execution& execution) { return judge_history(execution); };
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
  const Execution& execution = *Execution::current_execution();
  const std::size_t number = operations_.size();
  const std::uint64_t value = 100 * (thread + 1) + ++pushed_[thread];
  operations_.push_back({.kind = Operation::Kind::push,
                         .thread = thread,
                         .worker = worker,
                         .number = number,
                         .phase = phase_,
                         .value = value,
                         .called = execution.clock_of(thread),
                         .first_step = execution.steps().size()});
  const bool answered = queue_->push(worker, value);
  Operation& done = operations_[number];
  done.answered = answered;
  done.finished = true;
  done.returned = static_cast<std::uint16_t>(execution.clock_of(thread).count[thread] + 1);
  done.last_step = execution.steps().size();
  return answered;
}

bool QueueClient::pop(unsigned thread, unsigned worker) {
  const Execution& execution = *Execution::current_execution();
  const std::size_t number = operations_.size();
  operations_.push_back({.kind = Operation::Kind::pop,
                         .thread = thread,
                         .worker = worker,
                         .number = number,
                         .phase = phase_,
                         .called = execution.clock_of(thread),
                         .first_step = execution.steps().size()});
  std::uint64_t value = 0;
  const bool answered = queue_->pop(worker, value);
  Operation& done = operations_[number];
  done.answered = answered;
  done.finished = true;
  done.value = answered ? value : 0;
  done.returned = static_cast<std::uint16_t>(execution.clock_of(thread).count[thread] + 1);
  done.last_step = execution.steps().size();
  return answered;
}

std::optional<std::string> QueueClient::judge_stalled() const {
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
    key += b->answered ? 'y' : 'n';
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
