#include "bench/many_core/coherence/directory.hpp"

#include <algorithm>
#include <cmath>

namespace irt::many_core {

Directory::Directory(const Profile& p, EventQueue& events, std::uint64_t seed)
    : topology_(p),
      events_(events),
      conflict_(picoseconds(p.conflict)),
      residence_(picoseconds(p.residence)),
      read_occupancy_(picoseconds(p.read_occupancy)),
      per_sharer_(picoseconds(p.invalidate_per_sharer)),
      far_(picoseconds(p.far_atomic)),
      bus_(picoseconds(p.bus_occupancy)),
      bypass_(static_cast<unsigned>(std::lround(p.bypass))),
      in_turn_(p.turns != 0),
      bus_free_(p.sockets),
      random_(seed),
      slots_(std::size_t{1} << 12U),
      shift_(64 - 12) {
  const auto parts = [&p](double ns) {
    return Way{picoseconds(p.overlap * ns), picoseconds((1 - p.overlap) * ns)};
  };
  for (unsigned i = 0; i < distances; ++i) {
    const auto distance = static_cast<Distance>(i);
    // The line's home is nearer than any other core could be.
    const double ns = p.transfer[std::max<std::size_t>(
        i, distance == Distance::self ? static_cast<std::size_t>(Distance::same_cache) : 0)];
    const bool via_home = distance == Distance::same_node || distance == Distance::same_socket;
    const double detour = via_home ? p.home_remote : 0;
    ways_[0][i] = parts(ns);
    ways_[1][i] = parts(p.shared_fetch * ns);
    ways_[2][i] = parts(ns + detour);
    ways_[3][i] = parts(p.shared_fetch * (ns + detour));
  }
  from_memory_ = parts(p.dram);
}

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
  const Time request_way = line.owner == request.core ? 0 : way_to(line, request.core).request;
  request.arrival = std::max(request.issued + vary<10>(request_way), now);
  if (line.waiting == nullptr) {
    if (unused_.empty())
      unused_.push_back(&waitings_.emplace_back(static_cast<unsigned>(bus_free_.size()), in_turn_));
    line.waiting = unused_.back();
    unused_.pop_back();
  }
  line.waiting->add(request, topology_.socket(request.core), line.available);
  const Time time = std::max(request.arrival, line.available);
  if (!line.event.scheduled) {
    events_.push(line.event, time);
  } else if (time < line.event.time) {
    events_.move(line.event, time);
  }
}

// A transfer that leaves its cache takes the front-side bus of both sockets, one after the other
// transfers there. Returns when it may start.
Time Directory::pass_bus(const Line& line, const Request& request, Time start) {
  const unsigned from = line.owner != nobody ? line.owner : line.last;
  if (from != nobody && topology_.distance(from, request.core) <= Distance::same_cache)
    return start;
  const unsigned here = topology_.socket(request.core);
  const unsigned there = from == nobody ? here : topology_.socket(from);
  start = std::max({start, bus_free_[here], bus_free_[there]});
  bus_free_[here] = bus_free_[there] = start + bus_;
  return start;
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

Directory::Served Directory::serve(Line& line, Time now) {
  const unsigned near = line.last == nobody ? nobody : topology_.socket(line.last);
  Request& request = line.waiting->take(now, near, bypass_, random_);
  const unsigned core = request.core;
  const bool contended = line.waiting->count() != 0;
  if (!contended) {
    unused_.push_back(line.waiting);
    line.waiting = nullptr;
  }
  Time done = now;
  const bool moves = line.owner != core && !(request.want == Want::copy && line.sharers.has(core));
  if (moves) {
    const Time start = bus_ == 0 ? now : pass_bus(line, request, now);
    const bool holds = line.sharer_count != 0 && line.sharers.has(core);
    const unsigned others = line.sharer_count - (holds ? 1U : 0U);
    const Time extra = contended ? conflict_ : 0;
    done = start + extra;
    if (!holds || others == 0) done += vary<10>(way_to(line, core).data);
    if (request.want != Want::copy && others != 0) {
      // Every other copy is given up; the farthest answer counts.
      const Time answer =
          vary<10>(std::max(way(line.sharers.lowest(core), core, line.home, false).data,
                            way(line.sharers.highest(core), core, line.home, false).data));
      done = std::max(done, start + extra + answer) + per_sharer_ * static_cast<Time>(others - 1);
    }
    note(line, request, done);
    line.only_mine = line.only_mine && (!line.used || line.last == core);
    line.used = true;
  }
  line.only_read = line.only_read && request.want == Want::copy;
  switch (request.want) {
    case Want::copy:
      if (line.owner != nobody && line.owner != core) {
        line.share_with(line.owner);
        line.share_with(core);
        line.owner = nobody;
        line.available = done;
      } else if (line.owner == nobody && line.sharer_count == 0 && line.only_mine) {
        line.owner = core;
        line.available = done;
      } else if (line.owner == nobody) {
        line.share_with(core);
        line.available = now + read_occupancy_;
      }
      line.read_done = std::max(line.read_done, done);
      line.last = core;
      break;
    case Want::ownership:
      done = std::max(done, line.read_done);
      line.drop_sharers();
      line.owner = line.last = core;
      line.available = done + std::max(vary<2>(residence_), request.takes);
      break;
    case Want::far:
      // The operation is done at the home as soon as the owner has given the line up; the answer
      // travels while the next one is done.
      line.available = (line.owner == nobody && line.sharer_count == 0 ? now : done) + far_;
      line.drop_sharers();
      line.owner = nobody;
      line.last = core;
      break;
  }
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
