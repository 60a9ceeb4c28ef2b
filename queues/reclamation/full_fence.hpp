/// The fence that reclaimers need between two steps of which the processor might do the second
/// first.
#pragma once

#include <atomic>

namespace irt {

/// A seq_cst fence. GCC warns that ThreadSanitizer does not model fences. It need not: a
/// reclaimer's fences decide what it reads; that what others did happens before a node is freed
/// comes from the atomic variables.
inline void full_fence() {
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wtsan"
#endif
  std::atomic_thread_fence(std::memory_order_seq_cst);
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif
}

}  // namespace irt
