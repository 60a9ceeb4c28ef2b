// What <mutex>, <memory> and <future> keep in libstdc++'s compiled code and a core must
// not be sent into: it would lock and sleep for all cores at once, and not be seen.

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <future>
#include <linux/futex.h>
#include <memory>
#include <mutex>
#include <sys/syscall.h>
#include <unistd.h>

// The names are libstdc++'s.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming,cert-dcl58-cpp)

extern "C" void __once_proxy() {
  std::__once_call();
}

namespace std {

// Operations on a shared_ptr as if it were atomic lock one of these, by the pointer's address.
// There are many, for two pointers with one lock would be ordered by accident.
namespace {

std::array<std::mutex, 256> locks;

unsigned char key_of(const void* pointer) {
  const auto word = reinterpret_cast<std::uintptr_t>(pointer) / alignof(void*);
  return static_cast<unsigned char>(word ^ word >> 8U ^ word >> 16U);
}

}  // namespace

_Sp_locker::_Sp_locker(const void* pointer) noexcept : _M_key1(key_of(pointer)), _M_key2(_M_key1) {
  locks[_M_key1].lock();
}
_Sp_locker::_Sp_locker(const void* a, const void* b) noexcept
    : _M_key1(key_of(a)), _M_key2(key_of(b)) {
  if (_M_key2 < _M_key1) std::swap(_M_key1, _M_key2);
  locks[_M_key1].lock();
  if (_M_key2 != _M_key1) locks[_M_key2].lock();
}
_Sp_locker::~_Sp_locker() {
  locks[_M_key1].unlock();
  if (_M_key2 != _M_key1) locks[_M_key2].unlock();
}

__future_base::_Result_base::_Result_base() = default;
__future_base::_Result_base::~_Result_base() = default;

namespace {

timespec time_of(chrono::seconds seconds, chrono::nanoseconds nanoseconds) {
  return {seconds.count(), nanoseconds.count()};
}

// False if the deadline came.
bool wait(const unsigned* word, unsigned expected, const timespec* deadline) {
  return syscall(SYS_futex, word, FUTEX_WAIT_BITSET_PRIVATE, expected, deadline, nullptr,
                 FUTEX_BITSET_MATCH_ANY) == 0 ||
         errno != ETIMEDOUT;
}

}  // namespace

bool __atomic_futex_unsigned_base::_M_futex_wait_until(unsigned* word, unsigned expected,
                                                       bool has_deadline, chrono::seconds s,
                                                       chrono::nanoseconds ns) {
  const timespec deadline = time_of(s, ns);
  return wait(word, expected, has_deadline ? &deadline : nullptr);
}
bool __atomic_futex_unsigned_base::_M_futex_wait_until_steady(unsigned* word, unsigned expected,
                                                              bool has_deadline, chrono::seconds s,
                                                              chrono::nanoseconds ns) {
  const timespec deadline = time_of(s, ns);
  return wait(word, expected, has_deadline ? &deadline : nullptr);
}
void __atomic_futex_unsigned_base::_M_futex_notify_all(unsigned* word) {
  syscall(SYS_futex, word, FUTEX_WAKE_PRIVATE, ~0U >> 1U);
}

}  // namespace std
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming,cert-dcl58-cpp)
