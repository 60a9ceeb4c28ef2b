#include "bench/many_core/coherence/arbitration.hpp"

namespace irt::many_core {

void Waiting::set_out(Request& request, unsigned socket) {
  std::size_t at = under_way_.size();
  under_way_.push_back({&request, socket});
  for (; at > 0 && under_way_[at - 1].request->arrival > request.arrival; --at)
    under_way_[at] = under_way_[at - 1];
  under_way_[at] = {&request, socket};
}

void Waiting::admit(Time now) {
  std::size_t there = 0;
  while (there < under_way_.size() && under_way_[there].request->arrival <= now) {
    arrive(*under_way_[there].request, under_way_[there].socket);
    ++there;
  }
  under_way_.erase(under_way_.begin(), under_way_.begin() + static_cast<std::ptrdiff_t>(there));
}

void Waiting::begin_round() {
  served_.clear();
  bypassed_ = ~0U;  // nobody is preferred: else the socket with more cores would win every round
  due_ = arrived_;
  for (Socket& socket : sockets_) socket.due.swap(socket.served);
}

Request& Waiting::take(Time now, unsigned near, unsigned bypass, Random& random) {
  if (count_ == 1 && arrived_ == 0) {  // alone; what was noted of rounds no longer matters
    count_ = 0;
    Request& request = *under_way_.front().request;
    under_way_.clear();
    return request;
  }
  if (!under_way_.empty()) admit(now);
  if (due_ == 0) begin_round();
  Socket* from = near == nobody ? nullptr : &sockets_[near];
  const bool rivals = from != nullptr && !from->due.empty() && from->due.size() < due_;
  const auto draw = [&random](std::size_t of) {
    return of == 1 ? 0 : static_cast<std::size_t>((random.next() >> 32U) * of >> 32U);
  };
  std::size_t index = 0;
  if (rivals && bypassed_ < bypass) {
    ++bypassed_;
    index = draw(from->due.size());
  } else {
    bypassed_ = 0;
    index = draw(due_);
    for (from = sockets_.data(); index >= from->due.size(); ++from) index -= from->due.size();
  }
  Request& request = *from->due[index];
  from->due[index] = from->due.back();
  from->due.pop_back();
  --due_;
  --arrived_;
  --count_;
  if (in_turn_) served_.add(request.core);
  return request;
}

}  // namespace irt::many_core
