#include "stress/checker/events.hpp"

#include <fmt/format.h>

namespace irt::checker {

namespace {

constexpr double longest_computation = 5;

}  // namespace

void ExecutionParts::begin(Strategy& strategy) {
  state.begin(strategy);
  turns.begin();
  loops.begin();
  watch.begin();
  allocations.begin();
  kernel.begin();
  process.begin();
}

void Events::plain_read(std::uintptr_t address, std::size_t size, const void* pc) {
  // Of a queue's client only its own calls are on its stack, which is nobody else's.
  if (parts.state.on_own_stack(address) && parts.state.program.own_threads == 0) return;
  if (!parts.state.observed()) return parts.alone.pass_unwatched();
  parts.state.note(Look::Kind::read, address, size);
  parts.watch.touch(address, size, false, false, pc);
}

void Events::plain_write(std::uintptr_t address, std::size_t size, const void* pc) {
  if (!parts.state.observed()) return void(++parts.state.beats);
  if (parts.state.on_own_stack(address)) {
    // No effect to a loop, which is known by what is on its stack.
    parts.locations.end_on_stack(address, size);
    if (parts.state.program.own_threads != 0) parts.watch.touch(address, size, true, false, pc);
    return;
  }
  parts.loops.note_effect();
  parts.state.note(Look::Kind::write, address, size);
  if (parts.state.phase == Phase::endless) parts.alone.note_write(address, size);
  parts.watch.touch(address, size, true, false, pc);
}

void* Events::allocate(std::size_t size, std::size_t alignment, const void* pc) {
  return parts.state.phase != Phase::idle ? parts.allocations.allocate(size, alignment, pc)
                                          : Tenant::allocate(size, alignment, pc);
}

void Events::release(void* block, const void* pc) {
  const auto address = reinterpret_cast<std::uintptr_t>(block);
  ++parts.state.beats;
  if (parts.state.heap.owns(address)) return parts.allocations.release(address, pc);
  // What was allocated when the code was loaded is there again in the next execution.
  if (!parts.state.is_global(address)) Tenant::release(block, pc);
}

std::size_t Events::block_size(void* pointer) {
  const Block* block = parts.state.heap.find(reinterpret_cast<std::uintptr_t>(pointer));
  return block == nullptr ? Tenant::block_size(pointer) : block->size;
}

bool Events::lock(std::uintptr_t address, std::int64_t nanoseconds, const void* pc) {
  return parts.state.observed() ? parts.kernel.lock(address, nanoseconds, pc)
                                : Tenant::lock(address, nanoseconds, pc);
}

void Events::leave_function(std::uintptr_t frame_end, const void* pc) {
  const ExecutionState& state = parts.state;
  // Code may have stacks of its own making, on which nobody knows what is left.
  if (state.program.own_threads != 0 && state.phase == Phase::parallel &&
      state.on_own_stack(frame_end - 1))
    parts.watch.leave(frame_end, pc);
}

unsigned Events::finished(unsigned core) {
  if (parts.state.diary != nullptr) parts.state.diary->settle(core);
  parts.alone.move_on(nullptr);
  return parts.state.phase == Phase::parallel ? parts.turns.after(core) : virtual_cores::host;
}

void Events::on_failure(const std::string& what, const void* pc) {
  Conclusion& conclusion = parts.state.conclusion;
  if (pc == nullptr) conclusion.report(FindingKind::failure, what, {});
  conclusion.report(FindingKind::failure, what + " at {0}", {pc});
}

bool Computations::patient(double seconds) const {
  return seconds < longest_computation && !parts_.state.conclusion.deadline().passed();
}

void Computations::spins(const void* pc, bool endless, double seconds) {
  if (!endless)
    parts_.state.conclusion.give_up_computing(
        pc, seconds, fmt::format("{} s in one call without an event", longest_computation));
  parts_.turns.mine().waiting = true;
  parts_.turns.mine().wait_pc = pc;
  parts_.state.conclusion.report(
      FindingKind::livelock,
      fmt::format("{} loops at {{0}} for ever: it looks at no memory but its stack, and that and "
                  "its registers have come back to what they were",
                  parts_.state.phase == Phase::parallel
                      ? fmt::format("thread {}", parts_.state.current())
                      : "the only thread"),
      {pc});
}

}  // namespace irt::checker
