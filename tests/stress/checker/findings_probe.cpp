// Small programs with one fault each, and healthy twins, compiled for virtual cores.

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <stdexcept>

#include "tests/stress/checker/findings_variables.hpp"

namespace irt::findings {

namespace {

const Program programs[] = {
    // --- Limits: no finding, and no proof
    {"more steps than are looked at",
     "not proved",
     {[] {
        for (int round = 0; round < 30; ++round)
          for (auto& cell : cells) cell.store(round, rlx);
      },
      no_work}},
    {"more memory than there is",
     "not proved",
     {[] {
        for (int i = 0; i < 200; ++i) {
          void* volatile megabyte = std::calloc(1, std::size_t{1} << 20U);
          std::free(megabyte);
        }
      },
      no_work}},

    {"thousands of seq_cst operations",
     "",
     {[] {
        for (int round = 0; round < 3; ++round)
          for (auto& cell : cells) cell.store(round);
        x.store(y.load());
      },
      [] { y.store(x.load()); }}},

    // --- The code's own words
    {"assertion", "failure", {[] { x.store(1, rlx); }, [] { assert(x.load(rlx) == 0); }}},
    {"exception",
     "failure",
     {[] {
        if (x.load(rlx) == 1) throw std::runtime_error("seen");
      },
      [] { x.store(1, rlx); }}},
    {"exception caught",
     "",
     {[] {
        try {
          if (x.load(rlx) == 1) throw std::runtime_error("seen");
        } catch (...) {
          y.store(1, rlx);
        }
      },
      [] { x.store(1, rlx); }}},
    {"abort",
     "failure",
     {[] {
        if (x.load(rlx) == 1) std::abort();
      },
      [] { x.store(1, rlx); }}},
    {"Dekker without seq_cst",
     "data race",
     {[] {
        x.store(1, rel);
        if (y.load(acq) == 0) data = 1;
      },
      [] {
        y.store(1, rel);
        if (x.load(acq) == 0) data = 2;
      }}},
    {"Dekker",
     "",
     {[] {
        x.store(1);
        if (y.load() == 0) data = 1;
      },
      [] {
        y.store(1);
        if (x.load() == 0) data = 2;
      }}},
    {"wild pointer",
     "failure",
     {[] {
        // No memory is mapped that low.
        const auto low = static_cast<std::uintptr_t>(data) + 64;
        // NOLINTNEXTLINE(performance-no-int-to-ptr): that is the fault
        if (x.load(rlx) == 1) *reinterpret_cast<volatile int*>(low) = 1;
      },
      [] { x.store(1, rlx); }}},
    {"lock tried until ready",
     "",
     {[] {
        std::unique_lock lock(m);
        while (!ready) {
          lock.unlock();
          lock.lock();
        }
      },
      [] {
        const std::lock_guard lock(m);
        ready = true;
      }}},
    {"mixed sizes",
     "",
     {[] {
        __atomic_store_n(reinterpret_cast<char*>(&x), 1, __ATOMIC_RELEASE);
        data = 0;
      },
      [] { y.store(x.load(acq) & 1, rlx); }}},
    {"memory comes back",
     "",
     {[] {
        void* const first = std::malloc(8);
        const auto place = reinterpret_cast<std::uintptr_t>(first);
        std::free(first);
        void* const second = std::malloc(8);
        assert(place != reinterpret_cast<std::uintptr_t>(second));
        std::free(second);
      },
      no_work}},
    {"memory runs out",
     "",
     {[] {
        void* const first = std::malloc(8);
        void* const second = std::malloc(8);
        assert(first != nullptr || second != nullptr);
        std::free(second);
        std::free(first);
      },
      no_work}},
};

}  // namespace

}  // namespace irt::findings

/// What no hook announces.
extern "C" void irt_findings_assembly(int* counter) {
  asm volatile("lock addl $1, %0" : "+m"(*counter));
}

extern "C" const irt::findings::Program* irt_findings_programs(unsigned* count) {
  using namespace irt::findings;
  static Program all[128];
  Program* end = all;
  for (const std::span<const Program> some :
       {memory_programs(), waiting_programs(), std::span<const Program>(programs)}) {
    assert(some.size() <= static_cast<std::size_t>(std::end(all) - end));
    end = std::copy(some.begin(), some.end(), end);
  }
  *count = static_cast<unsigned>(end - all);
  return all;
}
