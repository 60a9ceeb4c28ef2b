#include "stress/checker/execution_state.hpp"

#include <algorithm>
#include <array>

namespace irt::checker {

namespace {

// What Linux gives one.
constexpr std::size_t stack_of_a_thread = std::size_t{8} << 20U;

}  // namespace

ExecutionState::ExecutionState(const Program& checked, const Limits& bounds,
                               virtual_cores::Tenant& tenant)
    : program(checked),
      limits(bounds),
      threads(static_cast<unsigned>(checked.threads.size()) + checked.own_threads),
      cores(tenant, threads + 1, stack_of_a_thread),
      stack_bytes(cores.stack_bytes()),
      graph(threads + 1, bounds.on_x86),
      heap(threads + 1),
      pending(threads + 1) {
  for (unsigned core = 0; core <= threads; ++core) stacks.push_back(cores.stack_of(core));
}

void ExecutionState::begin(Strategy& decides) {
  strategy = &decides;
  graph.clear();
  heap.clear();
  steps.clear();
  std::ranges::fill(pending, Pending{});
  stores = walk = 0;
  conclusion.begin();
  if (diary != nullptr) diary->clear();
  if (program.module != nullptr) program.module->reset_globals();
  if (program.afresh) program.afresh();
}

void ExecutionState::arm(unsigned core, const std::function<void()>& work) {
  const auto enter = [](void* w) { (*static_cast<const std::function<void()>*>(w))(); };
  cores.arm(core, enter, const_cast<std::function<void()>*>(&work));
}

unsigned ExecutionState::choose(unsigned count, const void* pc) {
  if (phase != Phase::parallel) return 0;
  Event& event = graph.begin(EventKind::choice, current(), Order::relaxed, pc);
  const unsigned option = strategy->choose_other(*this, event, count);
  graph.finish_choice(event, option);
  add_step(event, option);
  return option;
}

void ExecutionState::take_down(Look::Kind kind, std::uintptr_t address, std::size_t size) {
  const std::size_t moment = events_of(current());
  if (kind < Look::Kind::allocate)
    diary->note(kind, current(), moment, address, size);
  else
    diary->note_block(kind, current(), moment, address, size);
}

std::size_t ExecutionState::owner_of_stack(std::uintptr_t address) const {
  if (address < stacks.front()) return stacks.size();
  const auto after = std::ranges::upper_bound(stacks, address);
  const auto owner = static_cast<std::size_t>(after - stacks.begin()) - 1;
  return address - stacks[owner] < stack_bytes ? owner : stacks.size();
}

bool ExecutionState::is_global(std::uintptr_t address) const {
  return program.module != nullptr && program.module->owns_global(address);
}

std::uint64_t ExecutionState::hash_of_core() const {
  const virtual_cores::Registers& r = virtual_cores::registers();
  if (r.stack_pointer == 0) return steps.size();  // not known: like no other
  const auto mix = [](std::uint64_t hash, std::uint64_t word) {
    hash = (hash ^ word) * 0xFF51AFD7ED558CCD;
    return hash ^ hash >> 32U;
  };
  // Four at a time, each by itself, for a processor waits for the multiplication before.
  constexpr std::uint64_t seed = 0x9E3779B97F4A7C15;
  std::array<std::uint64_t, 4> hashes{mix(mix(seed, r.rbx), r.rbp), mix(mix(seed, r.r12), r.r13),
                                      mix(mix(seed, r.r14), r.r15), mix(seed, r.stack_pointer)};
  const auto word_at = [](std::uintptr_t at) {
    return *reinterpret_cast<const std::uint64_t*>(at);  // NOLINT(performance-no-int-to-ptr)
  };
  const std::uintptr_t end = stacks[current()] + stack_bytes;
  std::uintptr_t at = r.stack_pointer;
  for (; at + 32 <= end; at += 32)
#pragma GCC unroll 4
    for (unsigned i = 0; i < 4; ++i) hashes[i] = mix(hashes[i], word_at(at + 8 * i));
  for (; at < end; at += 8) hashes[0] = mix(hashes[0], word_at(at));
  std::uint64_t hash = seed;
  for (const std::uint64_t part : hashes) hash = mix(hash, part);
  return hash;
}

}  // namespace irt::checker
