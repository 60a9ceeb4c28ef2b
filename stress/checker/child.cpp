#include "stress/checker/child.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace irt::checker {

namespace {

[[noreturn]] void fail(const char* call) {
  throw std::runtime_error(std::string("cannot divide the work: ") + call + ": " +
                           std::strerror(errno) + "; --jobs 1 needs no other process");
}

}  // namespace

Child::Child(const std::function<void(int pipe)>& work) {
  std::fflush(nullptr);
  int ends[2];
  const pid_t parent = getpid();
  if (::pipe(ends) != 0) fail("pipe");
  process_ = fork();
  if (process_ < 0) {
    close(ends[0]);
    close(ends[1]);
    fail("fork");
  }
  if (process_ != 0) {
    close(ends[1]);
    pipe_ = ends[0];
    return;
  }
  // Whoever ends the parent, the children go with it.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  close(ends[0]);
  [&]() noexcept { work(ends[1]); }();  // the parent's frames are not to be unwound here
  _exit(0);
}

Child::Child(Child&& other) noexcept
    : process_(std::exchange(other.process_, -1)), pipe_(std::exchange(other.pipe_, -1)) {}

Child::~Child() {
  close_pipe();
  if (process_ < 0) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

void Child::close_pipe() {
  if (pipe_ >= 0) close(std::exchange(pipe_, -1));
}

void Child::join(const std::string& name) {
  close_pipe();
  int status = 0;
  waitpid(std::exchange(process_, -1), &status, 0);
  if (WIFSIGNALED(status))
    throw std::runtime_error(name + " crashed: signal " + std::to_string(WTERMSIG(status)) + " (" +
                             strsignal(WTERMSIG(status)) +
                             "); that is a fault of the checker or of compiled code that the "
                             "queue calls; --jobs 1 runs in one process, for a debugger");
  if (WEXITSTATUS(status) == no_verdict) _exit(no_verdict);
  if (WEXITSTATUS(status) != 0)
    throw std::runtime_error(name + " ended with status " + std::to_string(WEXITSTATUS(status)) +
                             " and without a result");
}

void send_bytes(int pipe, const void* bytes, std::size_t size) {
  const char* from = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t written = write(pipe, from, size);
    if (written < 0 && errno != EINTR) _exit(1);
    from += std::max<ssize_t>(written, 0);
    size -= static_cast<std::size_t>(std::max<ssize_t>(written, 0));
  }
}

}  // namespace irt::checker
