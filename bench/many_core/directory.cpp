#include "bench/many_core/directory.hpp"

#include <algorithm>
#include <bit>

namespace irt::many_core {

unsigned CoreSet::lowest(unsigned except) const {
  for (unsigned i = 0; i < words_.size(); ++i) {
    std::uint64_t word = words_[i];
    if (except / 64 == i) word &= ~(std::uint64_t{1} << except % 64);
    if (word != 0) return 64 * i + static_cast<unsigned>(std::countr_zero(word));
  }
  return nobody;
}

unsigned CoreSet::highest(unsigned except) const {
  for (unsigned i = static_cast<unsigned>(words_.size()); i-- > 0;) {
    std::uint64_t word = words_[i];
    if (except / 64 == i) word &= ~(std::uint64_t{1} << except % 64);
    if (word != 0) return 64 * i + static_cast<unsigned>(std::bit_width(word)) - 1;
  }
  return nobody;
}

Directory::Directory(const Profile& p, EventQueue& events, std::uint64_t seed)
    : topology_(p),
      events_(events),
      conflict_(picoseconds(p.conflict)),
      read_occupancy_(picoseconds(p.read_occupancy)),
      per_sharer_(picoseconds(p.invalidate_per_sharer)),
      far_(picoseconds(p.far_atomic)),
      bus_(picoseconds(p.bus_occupancy)),
      rmw_(picoseconds(p.rmw_hit)),
      store_(picoseconds(p.store_hit)),
      bypass_(static_cast<unsigned>(std::lround(p.bypass))),
      bus_free_(p.sockets),
      random_(seed * 2 + 1),
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
  line.event.of_line = true;
  line.event.index = static_cast<std::uint32_t>(lines_.size() - 1);
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

// Uniform within a tenth of `time`. The generator is Marsaglia's xorshift (2003).
Time Directory::vary(Time time) {
  random_ ^= random_ << 13U;
  random_ ^= random_ >> 7U;
  random_ ^= random_ << 17U;
  return time + time * (static_cast<Time>(random_ & 2047U) - 1024) / 10240;
}

const Directory::Way& Directory::way(unsigned from, unsigned to, unsigned home, bool clean) const {
  const bool remote = home != topology_.socket(to);
  return ways_[(remote ? 2U : 0U) + (clean ? 1U : 0U)]
              [static_cast<std::size_t>(topology_.distance(from, to))];
}

// What `core` pays for the line where it is now.
const Directory::Way& Directory::way_to(const Line& line, unsigned core) const {
  if (line.owner != nobody) return way(line.owner, core, line.home, false);
  return line.last == nobody ? from_memory_ : way(line.last, core, line.home, true);
}

Time Directory::earliest(const Line& line) {
  Time time = never;
  for (const Waiting& waiting : *line.queues)
    if (waiting.first != nullptr) time = std::min(time, waiting.first->arrival);
  return time;
}

void Directory::send(Line& line, Request& request, Time now) {
  const Time request_way = line.owner == request.core ? 0 : way_to(line, request.core).request;
  const Time arrival = request.issued + vary(request_way);
  request.arrival = std::max(arrival, now);
  request.next = nullptr;
  if (line.queues == nullptr)
    line.queues = &queues_.emplace_back(std::vector<Waiting>(bus_free_.size()));
  Waiting& waiting = (*line.queues)[topology_.socket(request.core)];
  if (waiting.first == nullptr) {
    waiting.first = waiting.last = &request;
  } else if (waiting.last->arrival <= request.arrival) {
    waiting.last->next = &request;
    waiting.last = &request;
  } else if (request.arrival < waiting.first->arrival) {
    request.next = waiting.first;
    waiting.first = &request;
  } else {
    Request* before = waiting.first;
    while (before->next->arrival <= request.arrival) before = before->next;
    request.next = before->next;
    before->next = &request;
  }
  ++line.waiting;
  const Time time = std::max(request.arrival, line.available);
  if (!line.event.scheduled) {
    events_.push(line.event, time);
  } else if (time < line.event.time) {
    events_.move(line.event, time);
  }
}

// The request whose turn it is: the earliest, or one of the socket that has the line.
Request& Directory::take(Line& line, Time now) {
  std::vector<Waiting>& queues = *line.queues;
  Waiting* chosen = &queues.front();
  for (Waiting& waiting : queues)
    if (waiting.first != nullptr &&
        (chosen->first == nullptr || waiting.first->arrival < chosen->first->arrival))
      chosen = &waiting;
  Waiting* near = line.last == nobody ? nullptr : &queues[topology_.socket(line.last)];
  const bool overtakes = near != nullptr && near != chosen && near->first != nullptr &&
                         near->first->arrival <= now && line.bypassed < bypass_;
  line.bypassed = overtakes ? line.bypassed + 1 : 0;
  if (overtakes) chosen = near;
  Request& request = *chosen->first;
  chosen->first = request.next;
  if (chosen->first == nullptr) chosen->last = nullptr;
  --line.waiting;
  return request;
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
void Directory::note(Line& line, const Request& request, Time done) {
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
  if (now < line.available) {
    events_.push(line.event, line.available);
    return {};
  }
  Request& request = take(line, now);
  const unsigned core = request.core;
  const bool contended = line.waiting != 0;
  Time done = now;
  const bool moves = line.owner != core && !(request.want == Want::copy && line.sharers.has(core));
  if (moves) {
    const Time start = bus_ == 0 ? now : pass_bus(line, request, now);
    const bool holds = line.sharer_count != 0 && line.sharers.has(core);
    const unsigned others = line.sharer_count - (holds ? 1U : 0U);
    const Time extra = contended ? conflict_ : 0;
    done = start + extra;
    if (!holds || others == 0) done += vary(way_to(line, core).data);
    if (request.want != Want::copy && others != 0) {
      // Every other copy is given up; the farthest answer counts.
      const Time answer =
          vary(std::max(way(line.sharers.lowest(core), core, line.home, false).data,
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
      line.available = done + (request.posted ? store_ : rmw_);
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
  if (line.waiting != 0) events_.push(line.event, std::max(earliest(line), line.available));
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
