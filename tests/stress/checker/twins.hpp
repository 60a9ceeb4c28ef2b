/// Little programs of equal threads as data.
#pragma once

namespace irt::twins {

inline constexpr unsigned max_threads = 5;
inline constexpr unsigned max_steps = 4;
inline constexpr unsigned variables = 3;

enum Kind : int {
  load,
  store,
  exchange,
  add,
  fence,
  compare,        ///< from 0 to `value`
  store_number,   ///< the thread's number plus one
  swap_number,    ///< likewise
  slot_store,     ///< to the thread's own slot
  slot_load,      ///< of the slot of the thread whose number plus one was read last, if any
  publish,        ///< a block of the thread's own, in which `value` stands
  follow,         ///< what the block that was published holds
  locked_add,     ///< plain, under a mutex
  await,          ///< until the variable is not 0
  odd_one,        ///< store `value`, unless this is thread `thread` and `seen` was read last
  odd_slot,       ///< as slot_store, but thread `thread` uses the slot of the next one
  scan,           ///< all slots, in the order of their numbers
  last_one_stops  ///< what comes next is left out by thread `thread` if `seen` was read last
};

struct Step {
  Kind kind;
  int order;  ///< std::memory_order's number, one that the kind may have
  int variable;
  int value;
  int thread = 0;
  int seen = 0;
};

}  // namespace irt::twins
