#include "stress/checker/exchange.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "stress/checker/coherence.hpp"
#include "stress/checker/replay.hpp"

namespace irt::checker {

namespace {

constexpr std::uint8_t whole = 0xFF;
std::uint64_t mix(std::uint64_t hash, std::uint64_t word) {
  hash = (hash ^ word) * 0xFF51AFD7ED558CCD;
  return hash ^ hash >> 32U;
}

/// Every way to give the threads of each role each other's names, but the one that changes nothing.
std::vector<std::vector<unsigned>> all_exchanges(const std::vector<unsigned>& roles) {
  std::vector<unsigned> names(roles.size());
  std::iota(names.begin(), names.end(), 0U);
  std::vector<std::vector<unsigned>> result;
  while (std::ranges::next_permutation(names).found) {
    bool fits = true;
    for (std::size_t i = 0; i < names.size(); ++i) fits = fits && roles[names[i]] == roles[i];
    if (fits) result.push_back(names);
  }
  return result;
}

/// `roles`, with threads that are one too many for `most` orders taken out of theirs.
std::vector<unsigned> limited(std::vector<unsigned> roles, std::size_t most) {
  std::size_t orders = 1;
  auto alone = static_cast<unsigned>(roles.size());
  for (std::size_t i = 0; i < roles.size(); ++i) {
    const auto before = static_cast<std::size_t>(
        std::count(roles.begin(), roles.begin() + static_cast<std::ptrdiff_t>(i), roles[i]));
    if (orders * (before + 1) > most)
      roles[i] = ++alone;
    else
      orders *= before + 1;
  }
  return orders == 1 ? std::vector<unsigned>{} : roles;
}

/// Makes an execution once more, with the threads' names exchanged.
class Mirror final : public Replay {
 public:
  Mirror(Schedule schedule, Bijection& exchange)
      : Replay(std::move(schedule)), exchange_(exchange) {}

  unsigned choose_thread(ExecutionState& state, std::uint32_t runnable, unsigned current) override {
    if (current == virtual_cores::host && state.steps.empty())
      fits_first_ = exchange_.look_at_first(state);
    return Replay::choose_thread(state, runnable, current);
  }
  [[nodiscard]] bool fits_first() const { return fits_first_; }

 private:
  Bijection& exchange_;
  bool fits_first_ = true;
};

}  // namespace

// --- What an exchange makes of places and values ----------------------------------------------

std::size_t Bijection::Hash::operator()(const Key& key) const {
  return mix(mix(mix(0, key.address), key.value), key.bytes);
}

bool Bijection::place(ExecutionState& state, unsigned thread, std::uintptr_t from,
                      std::uintptr_t to, bool writes) {
  Heap& heap = state.heap;
  const unsigned region = heap.region_of(from);
  if (region < target_.size()) return to == Heap::twin(from, region, target_[region]);
  const auto [there, fresh] = places_.try_emplace(from, to);
  if (there->second != to || (fresh && !places_back_.try_emplace(to, from).second)) return false;
  // Thread-local memory and the like must be looked at by nobody else, or be the same for all and
  // never change.
  if (region == Heap::no_region && !is_made_up(from) && !state.is_global(from))
    return (from == to && !writes) || heap.toucher(to) == name(thread) + 1;
  if (from == to) return true;
  // Others may be exchanged for one of the same block, or of the module's variables.
  if (is_made_up(from)) return is_made_up(to);
  if (region == Heap::no_region) return state.is_global(to);
  const Block* block = heap.find(from);
  return block != nullptr && block == heap.find(to);
}

bool Bijection::pointer(const Heap& heap, std::uint64_t value, std::uint64_t other) const {
  // As leaks.cpp takes words for pointers.
  constexpr std::uint64_t address_bits = (std::uint64_t{1} << 48U) - 1;
  const auto agree = [&](std::uint64_t a, std::uint64_t b) {
    const unsigned region = heap.region_of(a);
    if (region == Heap::no_region) return heap.region_of(b) == Heap::no_region;
    return b == (region < target_.size() ? Heap::twin(a, region, target_[region]) : a);
  };
  return agree(value, other) && agree(value & address_bits, other & address_bits) &&
         agree(value >> 16U, other >> 16U);
}

bool Bijection::word(ExecutionState& state, std::uintptr_t from, std::uint8_t bytes,
                     std::uint64_t value, std::uint64_t other) {
  const Heap& heap = state.heap;
  const auto [there, fresh] = words_.try_emplace({from, value, bytes}, other);
  if (!fresh) return there->second == other;
  if (!words_back_.try_emplace({from, other, bytes}, value).second) return false;
  if (bytes == whole && !pointer(heap, value, other)) return false;
  Word& known = known_[from];
  if (std::find(std::begin(known.masks), std::end(known.masks), bytes) == std::end(known.masks)) {
    auto* const free = std::find(std::begin(known.masks), std::end(known.masks), 0);
    known.overlaps = known.overlaps || free == std::end(known.masks) ||
                     std::any_of(std::begin(known.masks), free,
                                 [bytes](std::uint8_t m) { return (m & bytes) != 0; });
    if (free != std::end(known.masks)) *free = bytes;
    unseen_.push_back({from, bytes});
  }
  known.differs = known.differs || value != other;
  // Parts of a word could be exchanged in one way and the whole in another.
  return !(known.overlaps && known.differs);
}

// Nothing is there yet where threads allocate.
bool Bijection::look_at_first(ExecutionState& state) {
  Heap& heap = state.heap;
  const std::vector<Unseen> unseen = std::exchange(unseen_, {});
  return std::ranges::all_of(unseen, [&](const Unseen& u) {
    if (is_made_up(u.from)) return word(state, u.from, u.bytes, 0, 0);
    const Block* block = heap.find(u.from);
    const bool there =
        block != nullptr ? u.from < block->address + block->size : state.is_global(u.from);
    return !there || word(state, u.from, u.bytes, masked_word(u.from, u.bytes),
                          masked_word(places_.at(u.from), u.bytes));
  });
}

// --- Executions made once more ----------------------------------------------------------------

Exchange::Exchange(const Program& program, Execution& execution)
    : program_(program), execution_(execution), diary_(execution.threads() + 1) {
  constexpr std::size_t most = 24;
  roles_ = limited(program.roles, most);
  for (std::vector<unsigned>& target : all_exchanges(roles_)) exchanges_.emplace_back(target);
  execution.state().diary = &diary_;
}

Exchange::~Exchange() {
  execution_.state().diary = nullptr;
}

Exchange::Answer Exchange::fail(std::string why) {
  why_ = std::move(why);
  return Answer::fails;
}

const void* Exchange::waits(unsigned thread) const {
  const Turns::Thread* standing = execution_.standing(thread);
  return standing != nullptr ? standing->wait_pc : nullptr;
}

Exchange::Made Exchange::made(const Event& event) const {
  const Graph& graph = execution_.graph();
  Made made{};
  made.kind = event.kind;
  made.order = event.order;
  made.blocked = event.blocked;
  made.failed = event.failed;
  made.reads = event.reads;
  made.writes = event.writes;
  made.option = event.option;
  made.pc = event.pc;
  made.read = event.read;
  made.written = event.written;
  if (event.reads || event.writes) {
    made.address = graph.location(event.location).address;
    made.size = graph.location(event.location).size;
  }
  if (event.reads) {
    const Event& from = graph.event(event.from);
    made.from_initial = from.kind == EventKind::initial;
    made.from_thread = from.thread;
    made.from_index = made.from_initial ? 0 : from.index;
  }
  if (event.writes)
    if (const auto place = find_place(graph, event.location, graph.id_of(event)))
      made.place = *place + 1;
  return made;
}

std::uint64_t Exchange::history_of(unsigned thread) const {
  std::uint64_t hash = mix(0x9E3779B97F4A7C15, thread);
  for (const Look& look : diary_.of(thread)) {
    hash = mix(hash, look.address << 8U | look.bytes);
    hash = mix(hash, std::uint64_t{look.moment} << 8U | static_cast<std::uint64_t>(look.kind));
    hash = mix(hash, look.found);
    if (look.kind == Look::Kind::write) hash = mix(hash, look.left);
  }
  const Graph& graph = execution_.graph();
  for (const EventId id : graph.thread(thread).events) {
    const Event& event = graph.event(id);
    hash = mix(hash, reinterpret_cast<std::uintptr_t>(event.pc));
    hash = mix(hash, std::uint64_t{event.option} << 32U |
                         static_cast<std::uint64_t>(event.kind) << 16U |
                         static_cast<std::uint64_t>(event.order) << 8U | (event.blocked ? 2U : 0U) |
                         (event.failed ? 1U : 0U));
    if (!event.reads && !event.writes) continue;
    hash = mix(hash, graph.location(event.location).address);
    for (const Value value : {event.read, event.written}) {
      hash = mix(hash, static_cast<std::uint64_t>(value));
      hash = mix(hash, static_cast<std::uint64_t>(value >> 64U));
    }
  }
  hash = mix(hash, execution_.ended(thread) ? 1 : 0);
  return mix(hash, reinterpret_cast<std::uintptr_t>(waits(thread)));
}

bool Exchange::is_new(Outcome outcome) {
  bool fresh = false;
  for (unsigned thread = 0; thread <= execution_.threads(); ++thread)
    fresh = histories_.insert(history_of(thread)).second || fresh;
  if (outcome == Outcome::complete && program_.outcome)
    fresh = outcomes_.insert(program_.outcome()).second || fresh;
  return fresh;
}

Exchange::Answer Exchange::check(Outcome outcome) {
  if (outcome == Outcome::cut) return Answer::holds;
  if (execution_.assumed_waits() != 0) return fail("a loop that counts waits");
  if (!execution_.conclusion().incomplete().empty())
    return fail(execution_.conclusion().incomplete());
  if (!diary_.peculiar().empty()) return fail(diary_.peculiar());
  for (unsigned thread = 0; thread <= execution_.threads(); ++thread) diary_.settle(thread);
  if (!is_new(outcome)) return Answer::holds;
  Past past;
  for (unsigned thread = 0; thread <= execution_.threads(); ++thread) {
    past.events.emplace_back();
    for (const EventId id : execution_.graph().thread(thread).events)
      past.events.back().push_back(made(execution_.graph().event(id)));
    past.looks.push_back(diary_.of(thread));
    past.waits.push_back(waits(thread));
  }
  const std::vector<Step> steps = execution_.steps();
  for (Bijection& exchange : exchanges_) {
    Answer answer = make(exchange, outcome, steps, past);
    // The second time it looks at what was first at places that it has met the first time.
    if (answer == Answer::holds && !exchange.all_seen())
      answer = make(exchange, outcome, steps, past);
    if (answer != Answer::holds) return answer;
  }
  return Answer::holds;
}

Exchange::Answer Exchange::make(Bijection& exchange, Outcome outcome,
                                const std::vector<Step>& steps, const Past& past) {
  Schedule schedule{steps, false};
  for (Step& step : schedule.steps)
    step.thread = static_cast<std::uint8_t>(exchange.name(step.thread));
  Mirror mirror(std::move(schedule), exchange);
  mirror.begin();
  ++executions_;
  const Outcome other = execution_.run(mirror);
  if (other == Outcome::restart || execution_.conclusion().out_of_time()) return Answer::restart;
  if (other == Outcome::found) return Answer::found;
  for (unsigned thread = 0; thread <= execution_.threads(); ++thread) diary_.settle(thread);
  if (!diary_.peculiar().empty()) return fail(diary_.peculiar());
  if (other != outcome || !mirror.fits() || !mirror.fits_first() ||
      execution_.steps().size() != steps.size() || !agrees(exchange, past))
    return fail("equal threads do not do the same");
  return Answer::holds;
}

bool Exchange::agrees(Bijection& exchange, const Past& past) const {
  const unsigned main = execution_.threads();
  for (unsigned thread = 0; thread <= main; ++thread) {
    const unsigned other = exchange.name(thread);
    const std::vector<Look>& looks = diary_.of(other);
    const std::vector<EventId>& events = execution_.graph().thread(other).events;
    if (looks.size() != past.looks[thread].size() || events.size() != past.events[thread].size() ||
        waits(other) != past.waits[thread])
      return false;
    for (std::size_t i = 0; i < looks.size(); ++i)
      if (!agree(exchange, thread, past.looks[thread][i], looks[i])) return false;
    for (std::size_t i = 0; i < events.size(); ++i)
      if (!agree(exchange, thread, past.events[thread][i],
                 made(execution_.graph().event(events[i]))))
        return false;
  }
  return true;
}

bool Exchange::agree(Bijection& exchange, unsigned thread, const Look& a, const Look& b) const {
  if (a.kind != b.kind || a.bytes != b.bytes || a.moment != b.moment ||
      execution_.state().is_stack(a.address) || execution_.state().is_stack(b.address) ||
      !exchange.place(execution_.state(), thread, a.address, b.address,
                      a.kind == Look::Kind::write))
    return false;
  if (a.kind == Look::Kind::allocate || a.kind == Look::Kind::release) return a.found == b.found;
  return exchange.word(execution_.state(), a.address, a.bytes, a.found, b.found) &&
         (a.kind == Look::Kind::read ||
          exchange.word(execution_.state(), a.address, a.bytes, a.left, b.left));
}

bool Exchange::agree(Bijection& exchange, unsigned thread, const Made& a, const Made& b) const {
  if (a.kind != b.kind || a.order != b.order || a.blocked != b.blocked || a.failed != b.failed ||
      a.reads != b.reads || a.writes != b.writes || a.from_initial != b.from_initial ||
      a.from_index != b.from_index ||
      (a.reads && !a.from_initial && exchange.name(a.from_thread) != b.from_thread) ||
      a.option != b.option || a.size != b.size || a.place != b.place || a.pc != b.pc)
    return false;
  if (a.size == 0) return true;
  if (execution_.state().is_stack(a.address) || execution_.state().is_stack(b.address))
    return false;
  const std::uintptr_t low = is_made_up(a.address) ? 0 : a.address & 7U;
  if (!is_made_up(a.address) && low != (b.address & 7U)) return false;
  const auto part = [&](std::uintptr_t from, std::uintptr_t to, std::uint8_t bytes, unsigned shift,
                        unsigned up) {
    const auto word = [&](Value value) { return static_cast<std::uint64_t>(value >> shift) << up; };
    return exchange.place(execution_.state(), thread, from, to, a.writes) &&
           (!a.reads ||
            exchange.word(execution_.state(), from, bytes, word(a.read), word(b.read))) &&
           (!a.writes ||
            exchange.word(execution_.state(), from, bytes, word(a.written), word(b.written)));
  };
  const std::uintptr_t from = a.address - low;
  const std::uintptr_t to = b.address - low;
  if (a.size == 16) return part(from, to, whole, 0, 0) && part(from + 8, to + 8, whole, 64, 0);
  return part(from, to, static_cast<std::uint8_t>(((1U << a.size) - 1) << low), 0,
              static_cast<unsigned>(8 * low));
}

}  // namespace irt::checker
