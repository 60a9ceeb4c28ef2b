// Programs of [intro.races]: coherence, synchronizes-with, release sequences.

#include "tests/stress/checker/litmus_variables.hpp"

namespace irt::litmus {
namespace {

constexpr Program programs[] = {
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
};

}  // namespace

std::span<const Program> races() {
  return programs;
}

}  // namespace irt::litmus
