/// How far a long measurement is: a bar on a terminal, a line now and then elsewhere; on stderr.
#pragma once

#include <chrono>
#include <string_view>

namespace irt {

class ProgressBar {
 public:
  /// `total` steps of equal weight, of which `done` were done before.
  ProgressBar(unsigned total, unsigned done);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Shows that `doing` begins.
  void show(std::string_view doing);

  /// One step is done.
  void step() { ++done_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds quiet{10};  ///< between lines where there is no terminal

  unsigned total_, before_, done_;
  bool terminal_;
  Clock::time_point begin_ = Clock::now(), last_ = begin_;
};

}  // namespace irt
