/// Depth-first search over all choices, within a budget of deviations.
///
/// The dullest choice is free: the running thread goes on, the newest store is read. Every other
/// one costs one unit: a preemption (Musuvathi and Qadeer 2007, "Iterative Context Bounding"), a
/// stale read, a store put before another. When the running thread cannot go on, any other one is
/// free. With budgets 0, 1, 2, ... the first counterexample found has the fewest deviations.
///
/// No reduction: equivalent orders are explored each on their own. To complete a search, use
/// Dpor; this strategy is its judge in tests, and finds shallow bugs in large programs.
#pragma once

#include <cstdint>
#include <vector>

#include "stress/checker/strategy.hpp"

namespace irt::checker {

class DepthFirst final : public Strategy {
 public:
  explicit DepthFirst(unsigned budget) : budget_(budget) {}

  bool begin() override;
  unsigned choose_thread(ExecutionState& state, std::uint32_t runnable, unsigned current) override;
  [[nodiscard]] Books books() const override { return {.differs = differs_}; }
  [[nodiscard]] double explored() const override;

 protected:
  std::uint32_t choose(ChoiceKind kind, std::uint32_t count) override;

 private:
  struct Branch {
    std::uint32_t count;
    std::uint32_t chosen;
    bool costs;
  };

  std::vector<Branch> path_;
  std::size_t position_ = 0;
  unsigned spent_ = 0;
  unsigned budget_;
  bool forced_ = false;
  bool first_ = true;
  bool differs_ = false;
};

}  // namespace irt::checker
