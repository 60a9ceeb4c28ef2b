#include "stress/checker/frontier.hpp"

#include <algorithm>

namespace irt::checker {

// An execution and what it led to share its weight.
void Frontier::weigh() {
  const double share = *weight_ / static_cast<double>(offspring_ + 1);
  for (std::size_t i = work_.size() - offspring_; i < work_.size(); ++i) work_[i].weight = share;
  offspring_ = 0;
  explored_ += share;
  open_ -= share;
}

void Frontier::divide() {
  shared_ = false;
  std::deque<Work> mine;
  for (std::size_t i = shard_; i < work_.size(); i += shards_) mine.push_back(std::move(work_[i]));
  work_ = std::move(mine);
  open_ = 0;
  for (const Work& work : work_) open_ += work.weight;
}

std::optional<Work> Frontier::next() {
  if (weight_) weigh();
  // While the parts share the work they take the oldest piece, so that many arise; once there are
  // enough, each keeps its own and takes the newest, so that few do.
  // Some lead to a thousand times as many executions as others, which only their number evens out.
  const std::size_t enough = std::min<std::size_t>(
      std::size_t{256} * shards_, std::max<std::size_t>(std::size_t{32} * shards_, 65'536));
  if (shared_ && work_.size() >= enough) divide();
  if (work_.empty()) return std::nullopt;
  Work work = std::move(shared_ ? work_.front() : work_.back());
  if (shared_)
    work_.pop_front();
  else
    work_.pop_back();
  planned_ -= std::min(planned_, work.plan.size());
  weight_ = work.weight;
  return work;
}

void Frontier::add(Work work) {
  constexpr std::size_t most = 20'000'000;  // half a gigabyte
  if (planned_ > most) {
    left_out_ = true;
    return;
  }
  planned_ += work.plan.size();
  ++offspring_;
  work_.push_back(std::move(work));
}

}  // namespace irt::checker
