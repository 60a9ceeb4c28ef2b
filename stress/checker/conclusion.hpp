/// How an execution ends: what is wrong with it, if anything, and why it does not show everything.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stress/checker/deadline.hpp"
#include "stress/checker/finding.hpp"
#include "stress/checker/strategy.hpp"
#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::checker {

class Conclusion {
 public:
  explicit Conclusion(virtual_cores::Cores& cores) : cores_(cores) {}

  /// The next execution begins.
  void begin();
  /// Executions to come are cut when that time is there.
  void until(Deadline deadline) { deadline_ = deadline; }
  [[nodiscard]] const Deadline& deadline() const { return deadline_; }
  /// Executions that end in one of these are passed over from now on, races among them are no end.
  void know(std::vector<Finding> findings) { known_ = std::move(findings); }
  [[nodiscard]] bool knows(const Finding& finding) const;

  /// From the code: leaves it.
  [[noreturn]] void stop(Outcome outcome);
  [[noreturn]] void report(FindingKind kind, std::string text, std::vector<const void*> places,
                           std::vector<Moment> moments = {});
  /// Nothing in this execution, or after it, can be a proof.
  [[noreturn]] void give_up(std::string why);
  /// Stops when it is time, once in a while: the sooner the greater the `work` since it was asked.
  void check_time(std::size_t work = 1) {
    asked_ += work;
    if (asked_ < 1024) return;
    asked_ = 0;
    stop_in_time();
  }
  /// The same for code that has only computed for so long.
  [[noreturn]] void give_up_computing(const void* pc, double seconds, std::string why);

  /// From elsewhere.
  void end(Outcome outcome) { outcome_ = outcome; }
  void find(Finding finding);
  void run_out_of_time() { out_of_time_ = true; }
  void note_incomplete(std::string why) {
    if (incomplete_.empty()) incomplete_ = std::move(why);
  }
  /// Passes over what is known.
  void forget_known();

  [[nodiscard]] Outcome outcome() const { return outcome_; }
  [[nodiscard]] const std::optional<Finding>& finding() const { return finding_; }
  /// Whether the time for the last execution was over.
  [[nodiscard]] bool out_of_time() const { return out_of_time_; }
  /// Why the executions so far do not show everything, although the search came to its end: a limit
  /// that was reached. Empty if none was.
  [[nodiscard]] const std::string& incomplete() const { return incomplete_; }
  /// The place in the code that it speaks of, or where the time went if it is empty; null if none.
  [[nodiscard]] const void* incomplete_at() const { return incomplete_at_; }

 private:
  void stop_in_time();

  virtual_cores::Cores& cores_;
  Outcome outcome_ = Outcome::complete;
  std::optional<Finding> finding_;
  std::vector<Finding> known_;
  Deadline deadline_;
  std::size_t asked_ = 0;  ///< work since time was looked at
  bool out_of_time_ = false;
  std::string incomplete_;
  const void* incomplete_at_ = nullptr;
};

}  // namespace irt::checker
