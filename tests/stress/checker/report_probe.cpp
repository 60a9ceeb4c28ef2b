// Programs whose reports must show what went wrong, compiled for virtual cores.

#include <atomic>
#include <cassert>
#include <cstdlib>
#include <mutex>

#include "tests/stress/checker/findings.hpp"

namespace {

using std::atomic;
constexpr auto rlx = std::memory_order_relaxed;
constexpr auto acq = std::memory_order_acquire;
constexpr auto rel = std::memory_order_release;

atomic<int> x, y;
atomic<int*> shared;
int data;
int* block;
std::mutex m, n;

void no_work() {}

const irt::findings::Program programs[] = {
    {"orders",
     "failure",
     {[] {
        int expected = 0;
        x.compare_exchange_strong(expected, 1, std::memory_order_acq_rel, acq);
        y.store(2, rel);
        std::atomic_thread_fence(std::memory_order_seq_cst);
      },
      [] {
        if (y.load(acq) != 2) return;
        int expected = 7;
        x.compare_exchange_strong(expected, 9, std::memory_order_acq_rel, rlx);
        assert(expected != 1);
      }}},
    {"rounds",
     "failure",
     {[] {
        y.load(rlx);
        x.store(1, rlx);
      },
      [] {
        int seen = 0;
        for (int i = 0; i < 15; ++i) {
          seen += x.load(acq);
          seen += y.load(rlx);
        }
        assert(seen != 15);
      }}},
    {"rounds with other values",
     "failure",
     {[] {
        for (int i = 0; i < 15; ++i) x.fetch_add(1, rlx);
      },
      [] { assert(x.load(rlx) != 15); }}},
    {"modification order",
     "failure",
     {[] {
        x.store(1, rlx);
        y.store(2, rlx);
      },
      [] {
        y.store(1, rlx);
        x.store(2, rlx);
      }},
     no_work,
     [] { assert(x.load(rlx) != 1 || y.load(rlx) != 1); }},
    {"race",
     "data race",
     {[] {
        data = 1;
        x.store(1, rlx);
      },
      [] {
        if (x.load(acq) == 1) y.store(data, rlx);
      }}},
    {"race with an atomic access",
     "data race",
     {[] { x.store(1, rlx); }, [] { *reinterpret_cast<volatile int*>(&x) = 2; }}},
    {"double free",
     "double free",
     {[] {
        std::free(block);
        x.store(1, rel);
      },
      [] {
        if (x.load(acq) == 1) std::free(block);
      }},
     [] { block = static_cast<int*>(std::malloc(4)); }},
    {"use after free",
     "use after free",
     {[] {
        int* const mine = new int(5);
        shared.store(mine, rel);
        delete mine;
        x.store(1, rel);
      },
      [] {
        if (x.load(acq) != 1) return;
        const int* const theirs = shared.load(acq);
        y.store(*theirs, rlx);
      }}},
    {"deadlock",
     "deadlock",
     {[] {
        const std::lock_guard a(m);
        const std::lock_guard b(n);
      },
      [] {
        const std::lock_guard b(n);
        const std::lock_guard a(m);
      }}},
    {"livelock",
     "livelock",
     {[] { x.store(3, rel); },
      [] {
        while (x.load(acq) != 4) {
        }
      }}},
};

}  // namespace

extern "C" const irt::findings::Program* irt_report_programs(unsigned* count) {
  *count = sizeof programs / sizeof *programs;
  return programs;
}
