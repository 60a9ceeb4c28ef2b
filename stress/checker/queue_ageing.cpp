// One worker's pairs of a push and a pop, by which a queue is aged before anything else.

#include <fmt/format.h>

#include "stress/checker/queue_client.hpp"

namespace irt::checker {

void QueueClient::age(std::uint64_t pairs, std::shared_ptr<AgedMemory> memory) {
  if (pairs == 0) return;
  constexpr std::size_t enough = 64;
  for (std::uint64_t word = 1; word < 100'000 && ageing_words_.size() < enough; ++word)
    if (entry_.claims.allows(word)) ageing_words_.push_back(word);
  program_.age = ageing_words_.empty() ? 0 : pairs;
  program_.aged_what = fmt::format("{} for {} threads and {} elements, {} pushing, {} popping",
                                   entry_.name, shape_.threads.size(), capacity_, pusher_, popper_);
  program_.aged = memory != nullptr ? std::move(memory) : std::make_shared<AgedMemory>();
  program_.grow_older = [this](std::uint64_t n) {
    if (n == 0)
      program_.aged->made =
          entry_.make_word_queue(static_cast<unsigned>(shape_.threads.size()), capacity_).release();
    queue_ = static_cast<AnyWorkQueue<std::uint64_t>*>(program_.aged->made);
    make_pair(n);
  };
}

void QueueClient::make_pair(std::uint64_t n) {
  const std::uint64_t word = ageing_words_[n % ageing_words_.size()];
  const bool pushed = queue_->push(pusher_, word);
  std::uint64_t popped = 0;
  const bool answered = queue_->pop(popper_, popped);
  if (pushed && answered && popped == word) return;
  // Not what a queue that held nothing owes its only user; what its claims say of it is judged with
  // everything that is left inside.
  const auto main = static_cast<unsigned>(shape_.threads.size());
  operations_.clear();
  const auto note = [&](QueueCall::Kind kind, bool returned, std::uint64_t value) {
    operations_.push_back({.kind = kind,
                           .thread = main,
                           .worker = kind == QueueCall::Kind::push ? pusher_ : popper_,
                           .number = operations_.size(),
                           .phase = QueueCall::Phase::before,
                           .answered = returned,
                           .finished = true,
                           .value = value});
  };
  note(QueueCall::Kind::push, pushed, word);
  note(QueueCall::Kind::pop, answered, popped);
  for (bool more = true; more && operations_.size() < 60;) {
    popped = 0;
    more = queue_->pop(popper_, popped);
    note(QueueCall::Kind::pop, more, popped);
  }
  if (const auto opinion = judge(operations_, entry_.claims, capacity_); opinion.wrong)
    Execution::current_execution()->conclusion().report(
        FindingKind::wrong_outcome,
        fmt::format("after {} pairs of a push and a pop by one worker alone: {}", n,
                    *opinion.wrong),
        {});
}

}  // namespace irt::checker
