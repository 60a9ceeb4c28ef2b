/// Optimal dynamic partial order reduction (DPOR), by graphs: every execution graph of the program,
/// each once. Kokologiannakis, Marmanis, Gladstein and Vafeiadis 2022, "Truly Stateless, Optimal
/// Dynamic Partial Order Reduction" (TruSt).
///
/// Executions that differ only in the order of steps that do not touch each other have the same
/// graph (program order, reads-from, modification order), so it is graphs that are enumerated, not
/// schedules. Threads run one after the other, the lowest first. A read branches over the stores
/// that exist; a store branches over its places and, when it could be read by a read that came
/// earlier, over taking back what depended on that read (a *revisit*). A revisit is made only from
/// the one graph in which what is taken back was chosen dullest; this is what makes each graph come
/// up once.
///
/// A thread that waits stays where it is: the store it waits for will revisit its read.
///
/// Here, unlike in the paper, a read-modify-write is one event with two stamps, one for each part;
/// and code runs natively, so that each graph costs a new run, with its prefix replayed.
#pragma once

#include <cstdint>
#include <vector>

#include "stress/checker/frontier.hpp"
#include "stress/checker/strategy.hpp"
#include "stress/checker/symmetry.hpp"

namespace irt::checker {

class Dpor final : public Strategy {
 public:
  /// All of the work, or the `shard`-th of `shards` parts of it. Each part makes the first few
  /// executions, which all share; only the first part counts them.
  /// With `roles`, one of all graphs that differ in which of several equal threads does what: see
  /// symmetry.hpp.
  explicit Dpor(unsigned shard = 0, unsigned shards = 1, std::vector<unsigned> roles = {})
      : frontier_(shard, shards), symmetry_(std::move(roles)) {}

  bool begin() override;
  unsigned choose_thread(ExecutionState& state, std::uint32_t runnable, unsigned current) override;
  std::size_t choose_read(ExecutionState& state, Event& event, std::uint32_t location,
                          std::span<const ReadOption> options) override;
  std::size_t choose_place(ExecutionState& state, Event& event, std::uint32_t location,
                           std::span<const std::size_t> places) override;
  unsigned choose_other(ExecutionState& state, Event& event, unsigned count) override;
  void added(ExecutionState& state, const Event& event) override;
  std::optional<std::size_t> planned_place(ExecutionState& state, Event& event,
                                           std::uint32_t location) override;
  [[nodiscard]] bool expects_more(unsigned thread) const override;
  [[nodiscard]] bool expects_choice(unsigned thread, const void* pc) const override;
  [[nodiscard]] bool resumes_waiting() const override { return false; }
  [[nodiscard]] Books books() const override {
    return {.left_out = frontier_.left_out(),
            .elsewhere = frontier_.elsewhere(),
            .gives_up = cut_,
            .differs = differs_,
            .loses_symmetry = symmetry_.broken()};
  }
  [[nodiscard]] double explored() const override { return frontier_.explored(); }

 private:
  struct Revisit;
  void revisit(const ExecutionState& state, const Event& store, std::uint32_t location,
               std::size_t after);
  void push(const Planned& last, bool verify);
  [[nodiscard]] bool forbids(const ExecutionState& state, const Event& event,
                             std::uint32_t location, std::size_t at, bool reads) const;

  Frontier frontier_;
  Work current_;
  std::size_t position_ = 0;
  std::uint32_t stamp_ = 0;
  std::vector<Planned> trace_;  ///< of this execution, in the order of execution
  std::vector<EventId> events_;
  std::vector<std::uint32_t> remaining_;  ///< planned events by thread
  bool cut_ = false;
  bool differs_ = false;
  Symmetry symmetry_;
};

}  // namespace irt::checker
