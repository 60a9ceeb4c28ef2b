/// Linearizability by trying every order: the oracle of the oracles. For a dozen operations.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <vector>

#include "stress/history/operation.hpp"

namespace irt::stress {

/// Whether some total order of `operations` that respects `precedes` is a run of a FIFO queue.
inline bool linearizable(const std::vector<Operation>& operations,
                         const std::function<bool(std::size_t, std::size_t)>& precedes) {
  std::vector<bool> done(operations.size(), false);
  std::deque<Element> queue;
  const std::function<bool(std::size_t)> search = [&](std::size_t left) {
    if (left == 0) return true;
    for (std::size_t i = 0; i < operations.size(); ++i) {
      if (done[i]) continue;
      bool minimal = true;
      for (std::size_t j = 0; j < operations.size() && minimal; ++j) {
        minimal = done[j] || j == i || !precedes(j, i);
      }
      if (!minimal) continue;
      const Operation& operation = operations[i];
      const std::deque<Element> saved = queue;
      if (operation.kind == Kind::push) {
        queue.push_back(operation.value);
      } else if (operation.kind == Kind::empty) {
        if (!queue.empty()) continue;
      } else {
        if (queue.empty() || queue.front() != operation.value) continue;
        queue.pop_front();
      }
      done[i] = true;
      const bool found = search(left - 1);
      done[i] = false;
      queue = saved;
      if (found) return true;
    }
    return false;
  };
  return search(operations.size());
}

}  // namespace irt::stress
