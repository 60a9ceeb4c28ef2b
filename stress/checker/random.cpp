#include "stress/checker/random.hpp"

#include <algorithm>

#include "stress/checker/execution_state.hpp"

namespace irt::checker {

bool RandomBase::begin() {
  generator_ = Generator(Generator(next_).next());
  next_ += shards_;
  return true;
}

std::uint32_t RandomBase::choose(ChoiceKind kind, std::uint32_t count) {
  switch (kind) {
    case ChoiceKind::thread:
      return generator_.below(count);
    case ChoiceKind::read:
      return generator_.below(4) != 0 ? 0 : generator_.below(count);
    case ChoiceKind::place:
      return generator_.below(16) != 0 ? 0 : generator_.below(count);
    case ChoiceKind::other:
      return generator_.below(4) != 0 ? 0 : generator_.below(count);
  }
  return 0;
}

namespace {

unsigned highest(const std::vector<std::uint64_t>& priority, std::uint32_t runnable) {
  unsigned best = virtual_cores::host;
  for (unsigned thread = 0; thread < max_threads; ++thread)
    if ((runnable >> thread & 1U) != 0 &&
        (best == virtual_cores::host || priority[thread] > priority[best]))
      best = thread;
  return best;
}

}  // namespace

bool PriorityChanges::begin() {
  longest_ = std::max(longest_, step_);
  RandomBase::begin();
  step_ = 0;
  priority_.resize(max_threads);
  for (std::uint64_t& p : priority_) p = generator_.next() | 1ULL << 63U;
  changes_.resize(depth_ - 1);
  for (std::uint32_t& change : changes_) change = 1 + generator_.below(longest_);
  return true;
}

unsigned PriorityChanges::choose_thread(ExecutionState&, std::uint32_t runnable, unsigned) {
  ++step_;
  const unsigned best = highest(priority_, runnable);
  const auto change = std::ranges::find(changes_, step_);
  if (change == changes_.end()) return best;
  priority_[best] = static_cast<std::uint64_t>(change - changes_.begin());
  return highest(priority_, runnable);
}

bool OrderSampling::begin() {
  RandomBase::begin();
  priority_.resize(max_threads);
  for (std::uint64_t& p : priority_) p = generator_.next();
  return true;
}

unsigned OrderSampling::choose_thread(ExecutionState& state, std::uint32_t runnable, unsigned) {
  const unsigned best = highest(priority_, runnable);
  const std::uintptr_t address = state.pending[best].address;
  for (unsigned thread = 0; thread < state.threads; ++thread)
    if (thread != best && address != 0 && state.pending[thread].address == address &&
        (state.pending[best].writes || state.pending[thread].writes))
      priority_[thread] = generator_.next();
  priority_[best] = generator_.next();
  return best;
}

}  // namespace irt::checker
