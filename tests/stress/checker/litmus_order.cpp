// Programs of [atomics.order] and [atomics.fences]: modifications, fences, values out of thin air.

#include "tests/stress/checker/litmus_variables.hpp"

namespace irt::litmus {
namespace {

constexpr Program programs[] = {
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

std::span<const Program> order_and_fences() {
  return programs;
}

}  // namespace irt::litmus
