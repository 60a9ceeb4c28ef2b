/// What the code does, event by event: the tenant of the virtual cores. It decides nothing itself;
/// each event goes to the part of the execution that knows what it means.
#pragma once

#include "stress/checker/accesses.hpp"
#include "stress/checker/allocations.hpp"
#include "stress/checker/alone.hpp"
#include "stress/checker/execution_state.hpp"
#include "stress/checker/kernel.hpp"
#include "stress/checker/locations.hpp"
#include "stress/checker/loops.hpp"
#include "stress/checker/memory_watch.hpp"
#include "stress/checker/process.hpp"
#include "stress/checker/turns.hpp"

namespace irt::checker {

/// The parts of an execution, each made of those before it.
struct ExecutionParts {
  ExecutionParts(const Program& program, const Limits& limits, virtual_cores::Tenant& tenant)
      : state(program, limits, tenant) {
    if (limits.on_x86) accesses.orders().strengthen_as_x86();
  }

  /// The next execution begins.
  void begin(Strategy& strategy);

  ExecutionState state;
  Turns turns{state};
  Alone alone{state, turns};
  Loops loops{state, turns, alone};
  MemoryWatch watch{state, alone};
  Locations locations{state};
  Allocations allocations{state, alone, loops, watch};
  Accesses accesses{state, turns, alone, loops, watch, locations};
  Kernel kernel{state, turns, alone, loops, accesses};
  Process process{state, turns, accesses};
};

/// Code that runs on without an event.
class Computations final : public virtual_cores::Computing {
 public:
  explicit Computations(ExecutionParts& parts) : parts_(parts) {}

  [[nodiscard]] std::uint64_t beats() const override { return parts_.state.beats; }
  [[nodiscard]] bool patient(double seconds) const override;
  [[noreturn]] void spins(const void* pc, bool endless, double seconds) override;

 private:
  ExecutionParts& parts_;
};

class Events final : public virtual_cores::Tenant {
 public:
  Events(const Program& program, const Limits& limits) : parts(program, limits, *this) {}

  void plain_read(std::uintptr_t address, std::size_t size, const void* pc) override;
  void plain_write(std::uintptr_t address, std::size_t size, const void* pc) override;
  Value load(const virtual_cores::Access& access) override { return parts.accesses.load(access); }
  void store(const virtual_cores::Access& access, Value value) override {
    parts.accesses.store(access, value);
  }
  Value modify(const virtual_cores::Access& access, virtual_cores::Modification operation,
               Value operand) override {
    return parts.accesses.modify(access, operation, operand);
  }
  bool compare_exchange(const virtual_cores::Access& access, Order failure, bool weak,
                        Value& expected, Value desired) override {
    return parts.accesses.compare_exchange(access, failure, weak, expected, desired);
  }
  void fence(Order order, const void* pc) override { parts.accesses.fence(order, pc); }
  void* allocate(std::size_t size, std::size_t alignment, const void* pc) override;
  void release(void* block, const void* pc) override;
  std::size_t block_size(void* block) override;
  bool lock(std::uintptr_t address, std::int64_t nanoseconds, const void* pc) override;
  bool try_lock(std::uintptr_t address, const void* pc) override {
    return parts.kernel.try_lock(address, pc);
  }
  void unlock(std::uintptr_t address, const void* pc) override { parts.kernel.unlock(address, pc); }
  virtual_cores::Wake wait(std::uintptr_t address, std::uint32_t expected, std::int64_t nanoseconds,
                           const void* pc) override {
    return parts.kernel.wait(address, expected, nanoseconds, pc);
  }
  unsigned wake(std::uintptr_t address, unsigned count, const void* pc) override {
    return parts.kernel.wake(address, count, pc);
  }
  void sleep(std::int64_t nanoseconds, const void* /*pc*/) override {
    parts.kernel.sleep(nanoseconds);
  }
  std::int64_t now() override { return parts.kernel.now(); }
  std::uint64_t random() override { return parts.kernel.random(); }
  virtual_cores::Process* process() override {
    return parts.state.program.own_threads != 0 ? &parts.process : nullptr;
  }
  void leave_function(std::uintptr_t frame_end, const void* pc) override;
  unsigned finished(unsigned core) override;
  void on_failure(const std::string& what, const void* pc) override;

  ExecutionParts parts;
};

}  // namespace irt::checker
