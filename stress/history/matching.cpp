#include "stress/history/matching.hpp"

#include <fmt/format.h>
#include <utility>

namespace irt::stress {

Matching::Matching(const History& history) : history_(&history) {
  for (const auto& log : history.logs) {
    for (const Operation& operation : log) {
      if (operation.kind != Kind::push) continue;
      const unsigned producer = producer_of(operation.value);
      const std::uint64_t sequence = sequence_of(operation.value);
      if (producer >= lives_.size()) lives_.resize(producer + 1);
      auto& lives = lives_[producer];
      if (lives.empty()) lives.reserve(log.size());
      if (sequence >= lives.size()) lives.resize(sequence + 1);
      lives[sequence].push = &operation;
    }
  }
  for (const auto& log : history.logs) {
    for (const Operation& operation : log) {
      if (operation.kind == Kind::pop) note_pop(operation);
    }
  }
  for (const Operation& operation : history.drain) {
    if (operation.kind == Kind::pop) note_pop(operation);
  }
  if (history.emptied) report_lost();
}

const Life* Matching::find(Element e) const {
  const std::uint64_t producer = e >> sequence_bits;
  if (producer >= lives_.size() || sequence_of(e) >= lives_[producer].size()) return nullptr;
  const Life& life = lives_[producer][sequence_of(e)];
  return life.push != nullptr ? &life : nullptr;
}

void Matching::note_pop(const Operation& pop) {
  auto* life = const_cast<Life*>(find(pop.value));
  if (life == nullptr) {
    if (!std::exchange(invented_, true)) {
      violations_.push_back(
          {Pattern::fresh,
           fmt::format("pop returned {}, which nobody pushed", element_name(pop.value)),
           {culprit(pop)}});
    }
  } else if (life->pop != nullptr) {
    if (!std::exchange(repeated_, true)) {
      violations_.push_back({Pattern::repeat,
                             fmt::format("{} was popped twice", element_name(pop.value)),
                             {culprit(*life->push), culprit(*life->pop), culprit(pop)}});
    }
  } else {
    life->pop = &pop;
  }
}

void Matching::report_lost() {
  std::uint64_t lost = 0;
  const Life* first = nullptr;
  for (const auto& lives : lives_) {
    for (const Life& life : lives) {
      if (life.push == nullptr || life.pop != nullptr) continue;
      if (lost++ == 0) first = &life;
    }
  }
  if (lost == 0) return;
  violations_.push_back(
      {Pattern::lost,
       fmt::format("{} was accepted and never came out, not even when the queue was drained "
                   "({} such)",
                   element_name(first->push->value), lost),
       {culprit(*first->push)}});
}

Culprit Matching::culprit(const Operation& operation) const {
  for (unsigned worker = 0; worker < history_->logs.size(); ++worker) {
    const auto& log = history_->logs[worker];
    if (&operation >= log.data() && &operation < log.data() + log.size()) {
      return {worker, operation};
    }
  }
  return {drain_worker, operation};
}

}  // namespace irt::stress
