/// What counted code (bench/counted/counted_queue.hpp) did to shared memory, thread by thread.
#pragma once

#include <cstdint>

namespace irt {

/// Counts of one thread. Only the thread itself writes them, so counting shares nothing.
struct AtomicEvents {
  std::uint64_t compare_exchanges = 0;         ///< tried
  std::uint64_t failed_compare_exchanges = 0;  ///< of these, found another value
  std::uint64_t other_modifications = 0;       ///< fetch-and-add and its like, exchanges
  std::uint64_t loads = 0;                     ///< atomic ones
  std::uint64_t stores = 0;                    ///< atomic ones

  AtomicEvents& operator+=(const AtomicEvents& other) {
    compare_exchanges += other.compare_exchanges;
    failed_compare_exchanges += other.failed_compare_exchanges;
    other_modifications += other.other_modifications;
    loads += other.loads;
    stores += other.stores;
    return *this;
  }
};

/// Those of the calling thread since it started, or since it last set them to {}.
AtomicEvents& atomic_events();

}  // namespace irt
