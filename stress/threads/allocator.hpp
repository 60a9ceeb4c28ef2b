/// The allocator, watched: who is inside it, how much is live, and failures on demand.
///
/// The program's `malloc` family passes through here on its way to glibc's. Under a sanitizer it
/// does not (the sanitizer's own must stay in place) and every function below answers "nothing".
#pragma once

#include <cstdint>

namespace irt::stress {

/// Whether the program's allocations pass through here.
bool allocator_is_watched();

/// Whether the calling thread is inside the allocator. Safe in signal handlers.
bool in_allocator();

/// What the process holds, while `Accounting` lives.
struct Live {
  std::int64_t blocks = 0;
  std::int64_t bytes = 0;  ///< usable size
};

/// Counts allocations and frees from its construction on; one at a time.
class Accounting {
 public:
  Accounting();
  Accounting(const Accounting&) = delete;
  Accounting& operator=(const Accounting&) = delete;
  ~Accounting();
  [[nodiscard]] static Live live();
};

/// While it lives, what the calling thread allocates and frees is not counted: it belongs to the
/// testbed. Whatever is allocated under it is freed under it.
class OutsideAccounting {
 public:
  OutsideAccounting();
  OutsideAccounting(const OutsideAccounting&) = delete;
  OutsideAccounting& operator=(const OutsideAccounting&) = delete;
  ~OutsideAccounting();
};

/// Lets the `k`-th allocation of the calling thread from now on fail, once; counted from 1. While
/// it lives, `seen()` counts the thread's allocations.
class FailingAllocation {
 public:
  explicit FailingAllocation(std::uint64_t k);
  FailingAllocation(const FailingAllocation&) = delete;
  FailingAllocation& operator=(const FailingAllocation&) = delete;
  ~FailingAllocation();
  [[nodiscard]] static std::uint64_t seen();
};

}  // namespace irt::stress
