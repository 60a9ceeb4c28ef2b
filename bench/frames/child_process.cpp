#include "bench/frames/child_process.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fmt/format.h>
#include <poll.h>
#include <stdexcept>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace irt {
namespace {

using Clock = std::chrono::steady_clock;

/// A file in memory.
class Scratch {
 public:
  Scratch() : descriptor_(memfd_create("irt-child", 0)) {
    if (descriptor_ < 0) throw std::runtime_error("no file for a child process: out of files");
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() { close(descriptor_); }

  int descriptor() const { return descriptor_; }
  void fill(const std::string& text) const {
    if (write(descriptor_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
      throw std::runtime_error("no room for a child process' orders: out of memory");
    }
    lseek(descriptor_, 0, SEEK_SET);
  }
  std::string contents() const {
    std::string text;
    std::array<char, 65536> part{};
    lseek(descriptor_, 0, SEEK_SET);
    for (ssize_t n = 0; (n = read(descriptor_, part.data(), part.size())) > 0;) {
      text.append(part.data(), static_cast<std::size_t>(n));
    }
    return text;
  }

 private:
  int descriptor_;
};

[[noreturn]] void be_the_child(const Scratch& input, const Scratch& answer, const Scratch& errors,
                               const std::function<void()>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setpgid(0, 0);  // Ctrl-C is for the caller to deal with
  dup2(input.descriptor(), STDIN_FILENO);
  dup2(answer.descriptor(), STDOUT_FILENO);
  dup2(errors.descriptor(), STDERR_FILENO);
  int code = 0;
  try {
    work();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    code = 1;
  }
  std::fflush(stdout);
  _exit(code);  // what the caller has to do at its end is not the copy's
}

/// Waits for `child`; kills it at `deadline` or when `cancel` is set. Whether it was killed.
bool outlived(pid_t child, Clock::time_point deadline, const std::atomic<bool>& cancel,
              int& status) {
  // A descriptor that becomes readable when the child ends, so that nobody polls beside it.
  const int end = static_cast<int>(syscall(SYS_pidfd_open, child, 0));
  bool killed = false;
  for (;;) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) break;
    if (ended < 0 && errno != EINTR) throw std::runtime_error("a child process got lost");
    if (!killed && (cancel || Clock::now() > deadline)) {
      killed = true;
      kill(child, SIGKILL);
    }
    pollfd wait{.fd = end, .events = POLLIN, .revents = 0};
    poll(&wait, 1, 200);
  }
  if (end >= 0) close(end);
  return killed;
}

/// The last line that says something, without the end of the line.
std::string last_line(const std::string& text) {
  const auto end = text.find_last_not_of("\n ");
  if (end == std::string::npos) return {};
  const auto before = text.find_last_of('\n', end);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  return text.substr(begin, end - begin + 1);
}

Ending ended_badly(const std::string& status, const std::string& message, const Scratch& errors) {
  const std::string said = last_line(errors.contents());
  return {
      .status = status, .message = said.empty() ? message : message + ": " + said, .answer = {}};
}

}  // namespace

Ending in_child(const std::string& input, double seconds, const std::atomic<bool>& cancel,
                const std::function<void()>& work) {
  const Scratch orders, answer, errors;
  orders.fill(input);
  std::fflush(stdout);  // or the copy would write what waits there once more
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no child process: the system refuses to fork");
  if (child == 0) be_the_child(orders, answer, errors, work);

  const auto deadline = Clock::now() + std::chrono::milliseconds(static_cast<long>(seconds * 1e3));
  int status = 0;
  if (outlived(child, deadline, cancel, status)) {
    return ended_badly("hung", fmt::format("silent for {:.0f} s", seconds), errors);
  }
  if (WIFSIGNALED(status)) return ended_badly("crashed", strsignal(WTERMSIG(status)), errors);
  Ending ending;
  ending.answer = answer.contents();
  if (WEXITSTATUS(status) != 0 || ending.answer.empty()) {
    return ended_badly("failed", fmt::format("exit code {}", WEXITSTATUS(status)), errors);
  }
  return ending;
}

}  // namespace irt
