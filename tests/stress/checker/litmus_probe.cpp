// Litmus programs, compiled for virtual cores. The globals start at zero in every execution; each
// thread writes what it saw into results of its own. By the paragraph of the standard (C++20).

#include <atomic>

#include "tests/stress/checker/litmus.hpp"

namespace {

using std::atomic;
using std::atomic_thread_fence;
constexpr auto rlx = std::memory_order_relaxed;
constexpr auto acq = std::memory_order_acquire;
constexpr auto rel = std::memory_order_release;
constexpr auto acq_rel = std::memory_order_acq_rel;
constexpr auto sc = std::memory_order_seq_cst;

atomic<int> x, y, z;
int data;
int r[8];

void fence(std::memory_order order) {
  atomic_thread_fence(order);
}
int cas(atomic<int>& a, int from, int to, std::memory_order order) {
  a.compare_exchange_strong(from, to, order, rlx);
  return from;
}

const irt::litmus::Program programs[] = {
    // --- [intro.races] coherence -----------------------------------------------------------
    {"CoRR",
     {[] {
        x.store(1, rlx);
        x.store(2, rlx);
      },
      [] {
        r[0] = x.load(rlx);
        r[1] = x.load(rlx);
      }},
     2},
    {"CoWW",
     {[] {
        x.store(1, rlx);
        x.store(2, rlx);
      },
      [] { r[0] = x.load(rlx); }},
     1},
    {"CoRW",
     {[] {
        r[0] = x.load(rlx);
        x.store(1, rlx);
      },
      [] {
        x.store(2, rlx);
        r[1] = x.load(rlx);
      }},
     2},
    {"CoWR",
     {[] {
        x.store(1, rlx);
        r[0] = x.load(rlx);
      },
      [] {
        x.store(2, rlx);
        r[1] = x.load(rlx);
      }},
     2},
    {"CoRR2",
     {[] { x.store(1, rlx); }, [] { x.store(2, rlx); },
      [] {
        r[0] = x.load(rlx);
        r[1] = x.load(rlx);
      },
      [] {
        r[2] = x.load(rlx);
        r[3] = x.load(rlx);
      }},
     4},

    // --- [intro.races] synchronizes-with ---------------------------------------------------
    {"MP+rlx",
     {[] {
        x.store(1, rlx);
        y.store(1, rlx);
      },
      [] {
        r[0] = y.load(rlx);
        r[1] = x.load(rlx);
      }},
     2},
    {"MP+rel+acq",
     {[] {
        x.store(1, rlx);
        y.store(1, rel);
      },
      [] {
        r[0] = y.load(acq);
        r[1] = x.load(rlx);
      }},
     2},
    {"MP+rel+rlx",
     {[] {
        x.store(1, rlx);
        y.store(1, rel);
      },
      [] {
        r[0] = y.load(rlx);
        r[1] = x.load(rlx);
      }},
     2},
    {"MP+data",
     {[] {
        data = 1;
        y.store(1, rel);
      },
      [] {
        r[0] = y.load(acq);
        if (r[0] == 1) r[1] = data;
      }},
     2},
    {"MP+data+race",
     {[] {
        data = 1;
        y.store(1, rlx);
      },
      [] {
        r[0] = y.load(acq);
        if (r[0] == 1) r[1] = data;
      }},
     2},
    {"SB+rlx",
     {[] {
        x.store(1, rlx);
        r[0] = y.load(rlx);
      },
      [] {
        y.store(1, rlx);
        r[1] = x.load(rlx);
      }},
     2},
    {"SB+rel+acq",
     {[] {
        x.store(1, rel);
        r[0] = y.load(acq);
      },
      [] {
        y.store(1, rel);
        r[1] = x.load(acq);
      }},
     2},
    {"LB+rlx",
     {[] {
        r[0] = x.load(rlx);
        y.store(1, rlx);
      },
      [] {
        r[1] = y.load(rlx);
        x.store(1, rlx);
      }},
     2},
    {"LB+acq+rel",
     {[] {
        r[0] = x.load(acq);
        y.store(1, rel);
      },
      [] {
        r[1] = y.load(acq);
        x.store(1, rel);
      }},
     2},
    {"WRC+rel+acq",
     {[] { x.store(1, rlx); },
      [] {
        r[0] = x.load(rlx);
        y.store(1, rel);
      },
      [] {
        r[1] = y.load(acq);
        r[2] = x.load(rlx);
      }},
     3},
    {"WRC+rlx",
     {[] { x.store(1, rlx); },
      [] {
        r[0] = x.load(rlx);
        y.store(1, rlx);
      },
      [] {
        r[1] = y.load(rlx);
        r[2] = x.load(rlx);
      }},
     3},
    {"ISA2",
     {[] {
        x.store(1, rlx);
        y.store(1, rel);
      },
      [] {
        r[0] = y.load(acq);
        z.store(r[0], rel);
      },
      [] {
        r[1] = z.load(acq);
        r[2] = x.load(rlx);
      }},
     3},
    {"S+rel+acq",
     {[] {
        x.store(2, rlx);
        y.store(1, rel);
      },
      [] {
        r[0] = y.load(acq);
        x.store(1, rlx);
      }},
     1,
     1},
    {"2+2W+rlx",
     {[] {
        x.store(1, rlx);
        y.store(2, rlx);
      },
      [] {
        y.store(1, rlx);
        x.store(2, rlx);
      }},
     0,
     2},
    {"2+2W+sc",
     {[] {
        x.store(1, sc);
        y.store(2, sc);
      },
      [] {
        y.store(1, sc);
        x.store(2, sc);
      }},
     0,
     2},
    {"R+rlx",
     {[] {
        x.store(1, rlx);
        y.store(1, rlx);
      },
      [] {
        y.store(2, rlx);
        r[0] = x.load(rlx);
      }},
     1,
     2},
    {"R+sc",
     {[] {
        x.store(1, sc);
        y.store(1, sc);
      },
      [] {
        y.store(2, sc);
        r[0] = x.load(sc);
      }},
     1,
     2},
    {"IRIW+rel+acq",
     {[] { x.store(1, rel); }, [] { y.store(1, rel); },
      [] {
        r[0] = x.load(acq);
        r[1] = y.load(acq);
      },
      [] {
        r[2] = y.load(acq);
        r[3] = x.load(acq);
      }},
     4},

    // --- [intro.races]/5: release sequences are made of modifications only -------------------
    {"RS+modify",
     {[] {
        data = 1;
        x.store(1, rel);
      },
      [] { r[0] = x.fetch_add(1, rlx); },
      [] {
        r[1] = x.load(acq);
        if (r[1] == 2) r[2] = data;
      }},
     3},
    {"RS+two",
     {[] {
        data = 1;
        x.store(4, rel);
      },
      [] { r[0] = x.fetch_add(1, rlx); }, [] { r[1] = x.fetch_add(1, rlx); },
      [] {
        r[2] = x.load(acq);
        if (r[2] == 6) r[3] = data;
      }},
     4},
    {"RS+own+store",
     {[] {
        data = 1;
        x.store(1, rel);
        x.store(2, rlx);
      },
      [] {
        r[0] = x.load(acq);
        if (r[0] == 2) r[1] = data;
      }},
     2},
    {"RS+other+store",
     {[] {
        y.store(1, rlx);
        x.store(1, rel);
      },
      [] { x.store(2, rlx); },
      [] {
        r[0] = x.load(acq);
        r[1] = y.load(rlx);
      }},
     2},

    // --- [atomics.order]/10: modifications read the last value -------------------------------
    {"RMW+two", {[] { r[0] = x.fetch_add(1, rlx); }, [] { r[1] = x.fetch_add(1, rlx); }}, 2, 1},
    {"RMW+three",
     {[] { r[0] = x.fetch_add(1, rlx); }, [] { r[1] = x.fetch_add(1, rlx); },
      [] { r[2] = x.fetch_add(1, rlx); }},
     3,
     1},
    {"RMW+store", {[] { r[0] = x.fetch_add(1, rlx); }, [] { x.store(5, rlx); }}, 1, 1},
    {"CAS+two", {[] { r[0] = cas(x, 0, 1, rlx); }, [] { r[1] = cas(x, 0, 2, rlx); }}, 2, 1},
    {"CAS+chain",
     {[] { r[0] = cas(x, 0, 1, rlx); }, [] { r[1] = cas(x, 1, 2, rlx); },
      [] { r[2] = cas(x, 2, 3, rlx); }},
     3,
     1},
    {"CAS+stale+failure",
     {[] {
        x.store(1, rlx);
        x.store(2, rlx);
        y.store(1, rlx);
      },
      [] {
        r[0] = y.load(rlx);
        r[1] = cas(x, 7, 8, rlx);
      }},
     2},
    {"SB+modify",
     {[] {
        x.exchange(1, acq_rel);
        r[0] = y.fetch_add(0, acq_rel);
      },
      [] {
        y.exchange(1, acq_rel);
        r[1] = x.fetch_add(0, acq_rel);
      }},
     2},

    // --- [atomics.fences] -------------------------------------------------------------------
    {"MP+fences",
     {[] {
        x.store(1, rlx);
        fence(rel);
        y.store(1, rlx);
      },
      [] {
        r[0] = y.load(rlx);
        fence(acq);
        r[1] = x.load(rlx);
      }},
     2},
    {"MP+fence+acq",
     {[] {
        x.store(1, rlx);
        fence(rel);
        y.store(1, rlx);
      },
      [] {
        r[0] = y.load(acq);
        r[1] = x.load(rlx);
      }},
     2},
    {"MP+rel+fence",
     {[] {
        x.store(1, rlx);
        y.store(1, rel);
      },
      [] {
        r[0] = y.load(rlx);
        fence(acq);
        r[1] = x.load(rlx);
      }},
     2},
    {"MP+fence+misplaced",
     {[] {
        fence(rel);
        x.store(1, rlx);
        y.store(1, rlx);
      },
      [] {
        r[0] = y.load(rlx);
        fence(acq);
        r[1] = x.load(rlx);
      }},
     2},
    {"MP+fences+data",
     {[] {
        data = 1;
        fence(rel);
        y.store(1, rlx);
      },
      [] {
        r[0] = y.load(rlx);
        if (r[0] == 1) {
          fence(acq);
          r[1] = data;
        }
      }},
     2},
    {"SB+acq_rel+fences",
     {[] {
        x.store(1, rlx);
        fence(acq_rel);
        r[0] = y.load(rlx);
      },
      [] {
        y.store(1, rlx);
        fence(acq_rel);
        r[1] = x.load(rlx);
      }},
     2},

    // --- [atomics.order]/3, /4: the total order of seq_cst -----------------------------------
    {"SB+sc",
     {[] {
        x.store(1, sc);
        r[0] = y.load(sc);
      },
      [] {
        y.store(1, sc);
        r[1] = x.load(sc);
      }},
     2},
    {"SB+sc+fences",
     {[] {
        x.store(1, rlx);
        fence(sc);
        r[0] = y.load(rlx);
      },
      [] {
        y.store(1, rlx);
        fence(sc);
        r[1] = x.load(rlx);
      }},
     2},
    {"SB+sc+one+fence",
     {[] {
        x.store(1, rlx);
        fence(sc);
        r[0] = y.load(rlx);
      },
      [] {
        y.store(1, rlx);
        r[1] = x.load(rlx);
      }},
     2},
    {"SB+sc+fence+access",
     {[] {
        x.store(1, sc);
        r[0] = y.load(sc);
      },
      [] {
        y.store(1, rlx);
        fence(sc);
        r[1] = x.load(rlx);
      }},
     2},
    {"SB+sc+rlx+load",
     {[] {
        x.store(1, sc);
        r[0] = y.load(rlx);
      },
      [] {
        y.store(1, sc);
        r[1] = x.load(sc);
      }},
     2},
    {"MP+sc+store+rlx",
     {[] {
        x.store(1, sc);
        y.store(1, sc);
      },
      [] {
        r[0] = y.load(rlx);
        r[1] = x.load(sc);
      }},
     2},
    {"IRIW+sc",
     {[] { x.store(1, sc); }, [] { y.store(1, sc); },
      [] {
        r[0] = x.load(sc);
        r[1] = y.load(sc);
      },
      [] {
        r[2] = y.load(sc);
        r[3] = x.load(sc);
      }},
     4},
    {"IRIW+sc+fences",
     {[] { x.store(1, rlx); }, [] { y.store(1, rlx); },
      [] {
        r[0] = x.load(rlx);
        fence(sc);
        r[1] = y.load(rlx);
      },
      [] {
        r[2] = y.load(rlx);
        fence(sc);
        r[3] = x.load(rlx);
      }},
     4},
    {"WRC+sc+fences",
     {[] { x.store(1, rlx); },
      [] {
        r[0] = x.load(rlx);
        fence(sc);
        y.store(1, rlx);
      },
      [] {
        r[1] = y.load(rlx);
        fence(sc);
        r[2] = x.load(rlx);
      }},
     3},
    {"RWC+sc+fences",
     {[] { x.store(1, rlx); },
      [] {
        r[0] = x.load(rlx);
        fence(sc);
        r[1] = y.load(rlx);
      },
      [] {
        y.store(1, rlx);
        fence(sc);
        r[2] = x.load(rlx);
      }},
     3},
    {"W+RWC",
     {[] {
        x.store(1, rlx);
        z.store(1, rel);
      },
      [] {
        r[0] = z.load(acq);
        fence(sc);
        r[1] = y.load(rlx);
      },
      [] {
        y.store(1, rlx);
        fence(sc);
        r[2] = x.load(rlx);
      }},
     3},
    {"Z6.U",
     {[] {
        x.store(1, sc);
        y.store(1, rel);
      },
      [] {
        r[0] = y.fetch_add(1, sc);
        r[1] = y.load(rlx);
      },
      [] {
        y.store(3, sc);
        r[2] = x.load(sc);
      }},
     3},
    {"2+2W+sc+fences",
     {[] {
        x.store(1, rlx);
        fence(sc);
        y.store(2, rlx);
      },
      [] {
        y.store(1, rlx);
        fence(sc);
        x.store(2, rlx);
      }},
     0,
     2},
    {"R+sc+fences",
     {[] {
        x.store(1, rlx);
        fence(sc);
        y.store(1, rlx);
      },
      [] {
        y.store(2, rlx);
        fence(sc);
        r[0] = x.load(rlx);
      }},
     1,
     2},
    {"SB+sc+modify",
     {[] {
        x.fetch_add(1, sc);
        r[0] = y.load(rlx);
      },
      [] {
        y.fetch_add(1, sc);
        r[1] = x.load(rlx);
      }},
     2},
    {"SB+rmw+same",
     {[] {
        x.store(1, rlx);
        z.fetch_add(1, acq_rel);
        r[0] = y.load(rlx);
      },
      [] {
        y.store(1, rlx);
        z.fetch_add(1, acq_rel);
        r[1] = x.load(rlx);
      }},
     2},

    // --- [atomics.order]/8: no value out of thin air -----------------------------------------
    {"OOTA",
     {[] {
        r[0] = x.load(rlx);
        y.store(r[0], rlx);
      },
      [] {
        r[1] = y.load(rlx);
        x.store(r[1], rlx);
      }},
     2},
    {"OOTA+if",
     {[] {
        r[0] = x.load(rlx);
        if (r[0] == 42) y.store(42, rlx);
      },
      [] {
        r[1] = y.load(rlx);
        if (r[1] == 42) x.store(42, rlx);
      }},
     2},
};

}  // namespace

extern "C" const irt::litmus::Program* irt_litmus_programs(unsigned* count) {
  *count = sizeof programs / sizeof *programs;
  return programs;
}
extern "C" const int* irt_litmus_results() {
  return r;
}
extern "C" int irt_litmus_final(unsigned variable) {
  const std::atomic<int>* variables[] = {&x, &y, &z};
  return variables[variable]->load(rlx);
}
