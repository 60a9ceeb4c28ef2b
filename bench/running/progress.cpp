#include "bench/running/progress.hpp"

#include <cstdio>
#include <fmt/format.h>
#include <string>
#include <unistd.h>

namespace irt {

ProgressBar::ProgressBar(unsigned total, unsigned done)
    : total_(total), before_(done), done_(done), terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (terminal_) fmt::print(stderr, "\r\033[K");
}

void ProgressBar::show(std::string_view doing) {
  const Clock::time_point now = Clock::now();
  if (!terminal_ && now - last_ < quiet) return;
  last_ = now;
  const double spent = std::chrono::duration<double>(now - begin_).count();
  std::string left;
  if (done_ > before_) {
    left = fmt::format(", about {:.0f} s left", spent * (total_ - done_) / (done_ - before_));
  }
  if (!terminal_) {
    fmt::print(stderr, "{} of {} measurements{}\n", done_, total_, left);
    return;
  }
  constexpr unsigned width = 30;
  const unsigned filled = total_ == 0 ? width : done_ * width / total_;
  fmt::print(stderr, "\r[{:#<{}}{:.<{}}] {}{}\033[K", "", filled, "", width - filled, doing, left);
  std::fflush(stderr);
}

}  // namespace irt
