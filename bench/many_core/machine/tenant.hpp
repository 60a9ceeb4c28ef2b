/// The tenant of the virtual cores: hands every event of the instrumented code to the part of the
/// machine that it is about. Outside of simulated time nothing costs anything, and all is as the
/// default has it, but for the heap.
#pragma once

#include "bench/many_core/machine/c_library.hpp"

namespace irt::many_core {

class MachineTenant final : public virtual_cores::Tenant {
 public:
  MachineTenant(EventLoop& loop, Accesses& accesses, Kernel& kernel, CLibrary& library, Heap& heap)
      : state_(loop.state()),
        loop_(loop),
        accesses_(accesses),
        kernel_(kernel),
        library_(library),
        heap_(heap) {}

  void plain_read(std::uintptr_t address, std::size_t size, const void* pc) override;
  void plain_write(std::uintptr_t address, std::size_t size, const void* pc) override;
  virtual_cores::Value load(const virtual_cores::Access& access) override;
  void store(const virtual_cores::Access& access, virtual_cores::Value value) override;
  virtual_cores::Value modify(const virtual_cores::Access& access,
                              virtual_cores::Modification operation,
                              virtual_cores::Value operand) override;
  bool compare_exchange(const virtual_cores::Access& access, virtual_cores::Order failure,
                        bool weak, virtual_cores::Value& expected,
                        virtual_cores::Value desired) override;
  void fence(virtual_cores::Order order, const void* pc) override;
  void* allocate(std::size_t size, std::size_t alignment, const void* pc) override;
  void release(void* block, const void* pc) override;
  std::size_t block_size(void* block) override;
  bool lock(std::uintptr_t address, std::int64_t nanoseconds, const void* pc) override;
  bool try_lock(std::uintptr_t address, const void* pc) override;
  void unlock(std::uintptr_t address, const void* pc) override;
  virtual_cores::Wake wait(std::uintptr_t address, std::uint32_t expected, std::int64_t nanoseconds,
                           const void* pc) override;
  unsigned wake(std::uintptr_t address, unsigned count, const void* pc) override;
  void yield(const void* pc) override;
  void sleep(std::int64_t nanoseconds, const void* pc) override;
  void pause() override;
  std::int64_t now() override;
  unsigned finished(unsigned core) override;
  void on_failure(const std::string& what, const void* pc) override;

 private:
  State& state_;
  EventLoop& loop_;
  Accesses& accesses_;
  Kernel& kernel_;
  CLibrary& library_;
  Heap& heap_;
};

}  // namespace irt::many_core
