// Programs that touch memory as they should, and as they should not: races, lifetimes, bounds.

#include <atomic>
#include <cstdint>
#include <cstdlib>

#include "tests/stress/checker/findings_variables.hpp"

namespace irt::findings {

namespace {

const Program programs[] = {
    {"race", "data race", {[] { data = 1; }, [] { data = 2; }}},
    {"race read", "data race", {[] { data = 1; }, [] { x.store(data, rlx); }}},
    {"race of atomic and plain",
     "data race",
     {[] { x.store(1, rlx); }, [] { *reinterpret_cast<volatile int*>(&x) = 2; }}},
    {"message passed",
     "",
     {[] {
        data = 1;
        x.store(1, rel);
      },
      [] {
        if (x.load(acq) == 1) data = 2;
      }}},
    {"use after free",
     "use after free",
     {[] { delete block; }, [] { x.store(*block, rlx); }},
     [] { block = new int(3); }},
    {"free while used",
     "use after free",
     {[] {
        if (y.load(acq) == 1) delete block;
      },
      [] {
        y.store(1, rel);
        *block = 4;
      }},
     [] { block = new int(3); }},
    {"free after use",
     "",
     {[] {
        while (y.load(acq) != 1) {
        }
        delete block;
      },
      [] {
        *block = 4;
        y.store(1, rel);
      }},
     [] { block = new int(3); }},
    {"double free",
     "double free",
     {[] { std::free(block); },
      [] {
        if (x.exchange(1, std::memory_order_acq_rel) == 0) no_work();
      }},
     [] { block = static_cast<int*>(std::malloc(4)); },
     [] { std::free(block); }},
    {"free in the middle",
     "invalid free",
     {[] {
        int* volatile middle = block + 1;
        std::free(middle);
      },
      no_work},
     [] { block = static_cast<int*>(std::malloc(8)); }},
    {"leak",
     "memory leak",
     {[] { *static_cast<int* volatile*>(&block) = new int(1); }, no_work},
     no_work,
     [] { block = nullptr; }},
    {"no leak", "", {[] { block = new int(1); }, no_work}, no_work, [] { delete block; }},
    {"kept by a global",
     "",
     {[] {
        auto* list = new Node{nullptr};
        registry.store(new Node{list}, rlx);
      },
      no_work},
     no_work,
     no_work},
    {"kept with marks in the pointer",
     "",
     {[] { marked = reinterpret_cast<std::uintptr_t>(new Node{new Node{nullptr}}) | 1U << 2U; },
      [] { shifted = reinterpret_cast<std::uintptr_t>(new Node{nullptr}) << 16U | 7U; }},
     no_work,
     no_work},
    {"a lost circle",
     "memory leak",
     {[] {
        auto* first = new Node{nullptr};
        registry.store(first, rlx);
        first->next = new Node{first};
        registry.store(nullptr, rlx);
      },
      no_work},
     no_work,
     no_work},
    {"dropped from the registry",
     "memory leak",
     {[] {
        registry.store(new Node{new Node{nullptr}}, rlx);
        registry.store(nullptr, rlx);
      },
      no_work},
     no_work,
     no_work},
    {"kept by a thread that has ended",
     "memory leak",
     {[] { mine = new Node{nullptr}; }, no_work},
     no_work,
     no_work},
    {"past the end",
     "access out of bounds",
     {[] { static_cast<volatile int*>(block)[2] = 1; }, no_work},
     [] { block = new int[2]{}; }},
    {"before the beginning",
     "access out of bounds",
     {[] { static_cast<volatile int*>(block)[-1] = 1; }, no_work},
     [] { block = new int[2]{}; }},
    {"uninitialised",
     "read of uninitialised memory",
     {[] { x.store(*block, rlx); }, no_work},
     [] { block = new int; }},
    {"publish without release",
     "data race",
     {[] { shared.store(new int(5), rlx); },
      [] {
        if (int* p = shared.load(acq)) x.store(*p, rlx);
      }}},
    {"publish with release",
     "",
     {[] { shared.store(new int(5), rel); },
      [] {
        if (int* p = shared.load(acq)) x.store(*p, rlx);
      }}},
};

}  // namespace

std::span<const Program> memory_programs() {
  return programs;
}

}  // namespace irt::findings
