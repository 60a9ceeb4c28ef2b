// Programs of [atomics.order]/3 and /4: the total order of seq_cst.

#include "tests/stress/checker/litmus_variables.hpp"

namespace irt::litmus {
namespace {

constexpr Program programs[] = {
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
};

}  // namespace

std::span<const Program> seq_cst() {
  return programs;
}

}  // namespace irt::litmus
