#include "bench/many_core/coherence/directory.hpp"

#include <algorithm>
#include <cmath>

namespace irt::many_core {

Directory::Directory(const Profile& profile, EventQueue& events, std::uint64_t seed)
    : events_(events),
      mesi_(profile, seed),
      sockets_(profile.sockets),
      bypass_(static_cast<unsigned>(std::lround(profile.bypass))),
      in_turn_(profile.turns != 0),
      slots_(std::size_t{1} << 12U),
      shift_(64 - 12) {}

Line& Directory::make(std::uint64_t number) {
  if (2 * lines_.size() >= slots_.size()) grow();
  Line& line = lines_.emplace_back();
  line.number = number;
  line.event.line = &line;
  std::size_t at = slot_of(number);
  while (slots_[at].line != nullptr) at = (at + 1) & (slots_.size() - 1);
  slots_[at] = {number, &line};
  return line;
}

void Directory::grow() {
  slots_.assign(slots_.size() * 2, {});
  --shift_;
  for (Line& line : lines_) {
    std::size_t at = slot_of(line.number);
    while (slots_[at].line != nullptr) at = (at + 1) & (slots_.size() - 1);
    slots_[at] = {line.number, &line};
  }
}

void Directory::send(Line& line, Request& request, Time now) {
  request.arrival = std::max(request.issued + mesi_.request_time(line, request.core), now);
  if (line.waiting == nullptr) {
    if (unused_.empty()) unused_.push_back(&waitings_.emplace_back(sockets_, in_turn_));
    line.waiting = unused_.back();
    unused_.pop_back();
  }
  line.waiting->add(request, topology().socket(request.core), line.available);
  const Time time = std::max(request.arrival, line.available);
  if (!line.event.scheduled) {
    events_.push(line.event, time);
  } else if (time < line.event.time) {
    events_.move(line.event, time);
  }
}

// Statistics of a transfer. It is false sharing where nothing that made it necessary is wanted.
inline void Directory::note(Line& line, const Request& request, Time done) {
  ++line.transfers;
  const bool writes = request.want != Want::copy;
  const std::uint64_t theirs = writes ? line.written | line.read : line.written;
  if (theirs != 0 && (theirs & request.bytes) == 0) ++line.false_transfers;
  if (writes) line.written = line.read = 0;
  const Time waited = request.posted ? 0 : done - request.issued;
  line.waited += waited;
  const auto site = std::ranges::find(line.sites, request.pc, &Site::pc);
  Site& mine = site != line.sites.end() ? *site : line.sites.emplace_back(Site{.pc = request.pc});
  ++mine.requests;
  mine.waited += waited;
  mine.writes |= writes;
}

// Whose turn it is.
inline Request& Directory::take_next(Line& line, Time now) {
  const unsigned near = line.last == nobody ? nobody : topology().socket(line.last);
  Request& request = line.waiting->take(now, near, bypass_, mesi_.random());
  if (line.waiting->count() == 0) {
    unused_.push_back(line.waiting);
    line.waiting = nullptr;
  }
  return request;
}

Directory::Served Directory::serve(Line& line, Time now) {
  Request& request = take_next(line, now);
  const bool contended = line.waiting != nullptr;
  const bool moves = Mesi::moves(line, request);
  Time done = now;
  if (moves) {
    done = mesi_.transfer(line, request, now, contended);
    note(line, request, done);
    line.note_user(request.core);
  }
  line.only_read = line.only_read && request.want == Want::copy;
  done = mesi_.transition(line, request, now, done);
  if (contended) events_.push(line.event, std::max(line.waiting->earliest(), line.available));
  return {&request, done, moves};
}

void Directory::reset_statistics() {
  for (Line& line : lines_) {
    line.transfers = line.false_transfers = 0;
    line.waited = 0;
    line.sites.clear();
  }
}

}  // namespace irt::many_core
