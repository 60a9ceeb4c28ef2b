/// An order that is the same for the same seed, everywhere.
#pragma once

#include <span>
#include <utility>

#include "queues/split_mix.hpp"

namespace irt::contention {

/// Puts `values` into an order drawn from `random` (Fisher and Yates).
template <class T>
void shuffle(std::span<T> values, SplitMix& random) {
  for (std::size_t left = values.size(); left > 1; --left) {
    std::swap(values[left - 1], values[random.below(left)]);
  }
}

}  // namespace irt::contention
