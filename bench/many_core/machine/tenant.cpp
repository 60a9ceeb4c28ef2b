#include "bench/many_core/machine/tenant.hpp"

namespace irt::many_core {

using virtual_cores::Access;
using virtual_cores::Modification;
using virtual_cores::Order;
using virtual_cores::Value;
using virtual_cores::Wake;

void MachineTenant::plain_read(std::uintptr_t address, std::size_t size, const void* pc) {
  if (state_.timed) accesses_.plain_read(*state_.current, address, size, pc);
}

void MachineTenant::plain_write(std::uintptr_t address, std::size_t size, const void* pc) {
  if (state_.timed) accesses_.plain_write(*state_.current, address, size, pc);
}

Value MachineTenant::load(const Access& access) {
  return state_.timed ? accesses_.load(*state_.current, access) : Tenant::load(access);
}

void MachineTenant::store(const Access& access, Value value) {
  if (state_.timed) {
    accesses_.store(*state_.current, access, value);
  } else {
    Tenant::store(access, value);
  }
}

Value MachineTenant::modify(const Access& access, Modification operation, Value operand) {
  return state_.timed ? accesses_.modify(*state_.current, access, operation, operand)
                      : Tenant::modify(access, operation, operand);
}

bool MachineTenant::compare_exchange(const Access& access, Order failure, bool weak,
                                     Value& expected, Value desired) {
  return state_.timed ? accesses_.compare_exchange(*state_.current, access, expected, desired)
                      : Tenant::compare_exchange(access, failure, weak, expected, desired);
}

void MachineTenant::fence(Order order, const void* /*pc*/) {
  if (state_.timed && order == Order::seq_cst) accesses_.fence(*state_.current);
}

void* MachineTenant::allocate(std::size_t size, std::size_t alignment, const void* pc) {
  if (state_.timed) return library_.allocate(*state_.current, size, alignment, pc);
  Heap::Traffic costs_nothing;
  return heap_.allocate(0, size, alignment, pc, costs_nothing);
}

void MachineTenant::release(void* block, const void* pc) {
  if (!heap_.owns(reinterpret_cast<std::uintptr_t>(block))) {
    Tenant::release(block, pc);  // a library that nobody sees may have allocated it
  } else if (state_.timed) {
    library_.release(*state_.current, block, pc);
  } else {
    Heap::Traffic costs_nothing;
    heap_.release(0, block, costs_nothing);
  }
}

std::size_t MachineTenant::block_size(void* block) {
  return heap_.owns(reinterpret_cast<std::uintptr_t>(block)) ? heap_.size_of(block)
                                                             : Tenant::block_size(block);
}

bool MachineTenant::lock(std::uintptr_t address, std::int64_t nanoseconds, const void* pc) {
  return state_.timed ? library_.lock(*state_.current, address, nanoseconds, pc)
                      : Tenant::lock(address, nanoseconds, pc);
}

bool MachineTenant::try_lock(std::uintptr_t address, const void* pc) {
  return state_.timed ? library_.try_lock(*state_.current, address, pc)
                      : Tenant::try_lock(address, pc);
}

void MachineTenant::unlock(std::uintptr_t address, const void* pc) {
  if (state_.timed) {
    library_.unlock(*state_.current, address, pc);
  } else {
    Tenant::unlock(address, pc);
  }
}

Wake MachineTenant::wait(std::uintptr_t address, std::uint32_t expected, std::int64_t nanoseconds,
                         const void* pc) {
  return state_.timed ? kernel_.wait(*state_.current, address, expected, nanoseconds, pc)
                      : Tenant::wait(address, expected, nanoseconds, pc);
}

unsigned MachineTenant::wake(std::uintptr_t address, unsigned count, const void* pc) {
  return state_.timed ? kernel_.wake(*state_.current, address, count, pc) : 0;
}

void MachineTenant::yield(const void* /*pc*/) {
  if (state_.timed) kernel_.yield(*state_.current);
}

void MachineTenant::sleep(std::int64_t nanoseconds, const void* /*pc*/) {
  if (state_.timed) kernel_.sleep(*state_.current, nanoseconds);
}

void MachineTenant::pause() {
  if (state_.timed) state_.current->clock += state_.current->costs->pause;
}

std::int64_t MachineTenant::now() {
  return state_.timed ? state_.current->clock / nanosecond : 0;
}

unsigned MachineTenant::finished(unsigned /*core*/) {
  return loop_.finish(*state_.current);
}

void MachineTenant::on_failure(const std::string& what, const void* /*pc*/) {
  loop_.fail(what);
}

}  // namespace irt::many_core
