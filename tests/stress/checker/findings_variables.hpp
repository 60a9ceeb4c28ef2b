/// What the programs share, and where each file has its own.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <pthread.h>
#include <semaphore.h>
#include <span>

#include "tests/stress/checker/findings.hpp"

namespace irt::findings {

std::span<const Program> memory_programs();
std::span<const Program> waiting_programs();

using std::atomic;
inline constexpr auto rlx = std::memory_order_relaxed;
inline constexpr auto acq = std::memory_order_acquire;
inline constexpr auto rel = std::memory_order_release;

inline atomic<int> x, y;
inline atomic<int*> shared;
inline int data;
inline int* block;
inline std::mutex m, n;
inline std::condition_variable condition;
inline bool ready;
inline sem_t semaphore;
inline pthread_barrier_t barrier;
inline pthread_rwlock_t rw_lock;
inline std::atomic_flag flag;

struct Node {
  Node* next;
};
inline atomic<Node*> registry;
inline thread_local Node* volatile mine;
inline std::uintptr_t marked, shifted;

inline Node circle;
inline atomic<int> cells[2000];
inline int data2;

inline void no_work() {}

}  // namespace irt::findings
