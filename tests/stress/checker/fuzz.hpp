/// Little concurrent programs as data.
#pragma once

namespace irt::fuzz {

inline constexpr unsigned max_threads = 3;
inline constexpr unsigned max_steps = 3;

enum Kind { load, store, exchange, add, fence, compare };

struct Step {
  Kind kind;
  int order;  ///< std::memory_order's number, one that the kind may have
  int variable;
  int value;
};

}  // namespace irt::fuzz
