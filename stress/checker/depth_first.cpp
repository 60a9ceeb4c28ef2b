#include "stress/checker/depth_first.hpp"

namespace irt::checker {

bool DepthFirst::begin() {
  if (!first_) {
    while (!path_.empty() && path_.back().chosen + 1 == path_.back().count) path_.pop_back();
    if (path_.empty()) return false;
    ++path_.back().chosen;
  }
  first_ = false;
  position_ = 0;
  spent_ = 0;
  return true;
}

double DepthFirst::explored() const {
  double done = 0;
  double weight = 1;
  for (const Branch& branch : path_) {
    weight /= branch.count;
    done += weight * branch.chosen;
  }
  return done;
}

unsigned DepthFirst::choose_thread(ExecutionState& state, std::uint32_t runnable,
                                   unsigned current) {
  forced_ = current >= 32 || (runnable >> current & 1U) == 0;
  return Strategy::choose_thread(state, runnable, current);
}

std::uint32_t DepthFirst::choose(ChoiceKind kind, std::uint32_t count) {
  const bool costs = kind != ChoiceKind::thread || !forced_;
  if (costs && spent_ == budget_) return 0;
  if (position_ == path_.size()) path_.push_back({count, 0, costs});
  const Branch& branch = path_[position_++];
  if (branch.count != count) {
    differs_ = true;
    return 0;
  }
  if (branch.costs && branch.chosen != 0) ++spent_;
  return branch.chosen;
}

}  // namespace irt::checker
