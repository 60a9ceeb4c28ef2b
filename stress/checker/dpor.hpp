/// Every execution graph of the program, each once: Kokologiannakis, Marmanis, Gladstein and
/// Vafeiadis 2022, "Truly Stateless, Optimal Dynamic Partial Order Reduction" (TruSt).
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
#include <deque>
#include <vector>

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
      : work_(1),
        shard_(shard),
        shards_(shards),
        shared_(shards > 1),
        symmetry_(std::move(roles)) {}

  bool begin() override;
  unsigned choose_thread(Execution& execution, std::uint32_t runnable, unsigned current) override;
  std::size_t choose_read(Execution& execution, Event& event, std::uint32_t location,
                          std::span<const ReadOption> options) override;
  std::size_t choose_place(Execution& execution, Event& event, std::uint32_t location,
                           std::span<const std::size_t> places) override;
  unsigned choose_other(Execution& execution, Event& event, unsigned count) override;
  void added(Execution& execution, const Event& event) override;
  std::optional<std::size_t> planned_place(Execution& execution, Event& event,
                                           std::uint32_t location) override;
  [[nodiscard]] bool expects_more(unsigned thread) const override;
  [[nodiscard]] bool expects_choice(unsigned thread, const void* pc) const override;
  [[nodiscard]] bool left_out() const override { return left_out_; }
  [[nodiscard]] bool differs() const override { return differs_; }
  [[nodiscard]] double explored() const override { return explored_ / (explored_ + open_); }
  [[nodiscard]] bool counted_elsewhere() const override { return shared_ && shard_ != 0; }
  [[nodiscard]] bool gives_up() const override { return cut_; }
  [[nodiscard]] bool resumes_waiting() const override { return false; }
  [[nodiscard]] bool loses_symmetry() const override { return symmetry_.broken(); }

 private:
  /// An event to be made again.
  struct Planned {
    const void* choice = nullptr;  ///< where it is, if it is one
    Ref from = initial_ref;        ///< what it reads or, for a store, what it comes after
    std::uint32_t option = 0;
    std::uint32_t read_stamp = 0;
    std::uint32_t write_stamp = 0;  ///< 0: to be given when it is made
    std::uint8_t thread = 0;
    bool fresh = false;  ///< its store has not yet been offered to earlier reads
  };
  struct Work {
    std::vector<Planned> plan;
    bool verify = false;  ///< the model has not yet been asked about the whole
    double weight = 1;    ///< part of all executions that it is taken to lead to
  };

  struct Revisit;
  void revisit(const Execution& execution, const Event& store, std::uint32_t location,
               std::size_t after);
  void push(const Planned& last, bool verify);
  void weigh();
  [[nodiscard]] bool forbids(const Execution& execution, const Event& event, std::uint32_t location,
                             std::size_t at, bool reads) const;
  void add(Work work);

  std::deque<Work> work_;
  unsigned shard_;
  unsigned shards_;
  std::size_t planned_ = 0;  ///< events in all plans, which bounds memory
  bool left_out_ = false;
  bool differs_ = false;
  std::size_t offspring_ = 0;  ///< pieces of work that the execution in progress has added
  double explored_ = 0;        ///< weight of what is done ...
  double open_ = 1;            ///< ... and of what is not
  bool started_ = false;
  bool shared_;  ///< the work has not been divided yet
  Work current_;
  std::size_t position_ = 0;
  std::uint32_t stamp_ = 0;
  std::vector<Planned> trace_;  ///< of this execution, in the order of execution
  std::vector<EventId> events_;
  std::vector<std::uint32_t> remaining_;  ///< planned events by thread
  bool cut_ = false;
  Symmetry symmetry_;
};

}  // namespace irt::checker
