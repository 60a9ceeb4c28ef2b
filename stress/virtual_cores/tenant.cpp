// What a tenant does unless it says otherwise: one step at a time, in the order in which the steps
// come, on the real memory.

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <malloc.h>
#include <unistd.h>

#include "stress/virtual_cores/internal.hpp"

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace irt::virtual_cores {

namespace {

template <class Word>
Word word_at(std::uintptr_t address) {
  Word word;
  std::memcpy(&word, reinterpret_cast<const void*>(address), sizeof word);
  return word;
}

template <class Word>
void set_word(std::uintptr_t address, Value value) {
  const auto word = static_cast<Word>(value);
  std::memcpy(reinterpret_cast<void*>(address), &word, sizeof word);
}

}  // namespace

// A copy of known size needs no call, and its bytes are not read back in larger pieces.
Value read_memory(std::uintptr_t address, std::size_t size) {
  switch (size) {
    case 8:
      return word_at<std::uint64_t>(address);
    case 4:
      return word_at<std::uint32_t>(address);
    case 2:
      return word_at<std::uint16_t>(address);
    case 1:
      return word_at<std::uint8_t>(address);
    default:
      break;
  }
  Value value = 0;
  std::memcpy(&value, reinterpret_cast<const void*>(address), size);
  return value;
}

void write_memory(std::uintptr_t address, std::size_t size, Value value) {
  switch (size) {
    case 8:
      return set_word<std::uint64_t>(address, value);
    case 4:
      return set_word<std::uint32_t>(address, value);
    case 2:
      return set_word<std::uint16_t>(address, value);
    case 1:
      return set_word<std::uint8_t>(address, value);
    default:
      std::memcpy(reinterpret_cast<void*>(address), &value, size);
  }
}

void Tenant::plain_read(std::uintptr_t, std::size_t, const void*) {}
void Tenant::plain_write(std::uintptr_t, std::size_t, const void*) {}

Value Tenant::load(const Access& access) {
  return read_memory(access.address, access.size);
}

void Tenant::store(const Access& access, Value value) {
  write_memory(access.address, access.size, value);
}

Value Tenant::modify(const Access& access, Modification modification, Value operand) {
  const Value before = read_memory(access.address, access.size);
  write_memory(access.address, access.size, apply(modification, before, operand, access.size));
  return before;
}

bool Tenant::compare_exchange(const Access& access, Order, bool, Value& expected, Value desired) {
  const Value before = read_memory(access.address, access.size);
  const bool equal = before == expected;
  if (equal) write_memory(access.address, access.size, desired);
  expected = before;
  return equal;
}

void Tenant::fence(Order, const void*) {}

void* Tenant::allocate(std::size_t size, std::size_t alignment, const void*) {
  return std::aligned_alloc(
      alignment, (std::max<std::size_t>(size, 1) + alignment - 1) / alignment * alignment);
}
void Tenant::release(void* block, const void*) {
  std::free(block);
}
std::size_t Tenant::block_size(void* block) {
  return malloc_usable_size(block);
}

// A lock in terms of the rest (Drepper, "Futexes are tricky", the second mutex): 0 free, 1 held,
// 2 held and perhaps waited for.
bool Tenant::lock(std::uintptr_t address, std::int64_t nanoseconds, const void* pc) {
  if (try_lock(address, pc)) return true;
  const std::int64_t end = now() + nanoseconds;
  const auto left = [&] {
    return nanoseconds < 0 ? nanoseconds : std::max<std::int64_t>(end - now(), 0);
  };
  while (modify({address, 4, Order::acquire, pc}, Modification::exchange, 2) != 0)
    if (wait(address, 2, left(), pc) == Wake::timed_out) return false;
  return true;
}

bool Tenant::try_lock(std::uintptr_t address, const void* pc) {
  Value expected = 0;
  return compare_exchange({address, 4, Order::acquire, pc}, Order::relaxed, false, expected, 1);
}

void Tenant::unlock(std::uintptr_t address, const void* pc) {
  if (modify({address, 4, Order::release, pc}, Modification::exchange, 0) == 2)
    wake(address, 1, pc);
}

Wake Tenant::wait(std::uintptr_t address, std::uint32_t expected, std::int64_t nanoseconds,
                  const void* pc) {
  if (load({address, 4, Order::acquire, pc}) != expected) return Wake::value_differs;
  if (nanoseconds < 0) failed("a wait that nobody can end", pc);
  return Wake::timed_out;
}
unsigned Tenant::wake(std::uintptr_t, unsigned, const void*) {
  return 0;
}
void Tenant::yield(const void*) {}
void Tenant::sleep(std::int64_t, const void*) {}
void Tenant::pause() {}
std::int64_t Tenant::now() {
  return 0;
}
std::uint64_t Tenant::random() {
  static std::uint64_t last = 1;
  return last = last * 6364136223846793005U + 1442695040888963407U;  // Knuth's MMIX
}
Process* Tenant::process() {
  return nullptr;
}
void Tenant::enter_function(const void*) {}
void Tenant::leave_function(std::uintptr_t, const void*) {}
unsigned Tenant::finished(unsigned) {
  return host;
}

void Tenant::on_failure(const std::string& what, const void*) {
  std::cerr << "virtual cores: " << what << '\n';
  std::_Exit(1);
}

void Tenant::failed(const std::string& what, const void* pc) {
  on_failure(what, pc);
  std::abort();
}

int refusals_to = 2;

void refuse(const std::string& what) {
  std::cout.flush();
  dup2(refusals_to, 2);
  std::cerr << "irt: " << what << "; nothing is said about this code\n";
  std::_Exit(2);
}

}  // namespace irt::virtual_cores
// NOLINTEND(performance-no-int-to-ptr)
