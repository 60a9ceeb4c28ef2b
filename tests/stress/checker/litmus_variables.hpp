/// What litmus programs are written with. The globals start at zero in every execution; each thread
/// writes what it saw into results of its own.
#pragma once

#include <atomic>
#include <span>

#include "tests/stress/checker/litmus.hpp"

namespace irt::litmus {

using std::atomic;
constexpr auto rlx = std::memory_order_relaxed;
constexpr auto acq = std::memory_order_acquire;
constexpr auto rel = std::memory_order_release;
constexpr auto acq_rel = std::memory_order_acq_rel;
constexpr auto sc = std::memory_order_seq_cst;

inline atomic<int> x, y, z;
inline int data;
inline int r[8];

inline void fence(std::memory_order order) {
  std::atomic_thread_fence(order);
}
/// What `a` held.
inline int cas(atomic<int>& a, int from, int to, std::memory_order order) {
  a.compare_exchange_strong(from, to, order, rlx);
  return from;
}

/// The programs, by paragraphs of the standard (C++20).
std::span<const Program> races();
std::span<const Program> order_and_fences();
std::span<const Program> seq_cst();

}  // namespace irt::litmus
