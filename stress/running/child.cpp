#include "stress/running/child.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <poll.h>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace irt {
namespace {

[[noreturn]] void be_the_child(pid_t parent, int line, const std::function<void(int)>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it has died meanwhile, and sends no signal any more
  setpgid(0, 0);                      // Ctrl-C is for the caller to deal with
  int code = 0;
  try {
    work(line);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    code = 1;
  }
  std::fflush(stdout);
  _exit(code);  // what the caller has to do at its end is not the copy's
}

}  // namespace

Child::Child(const std::function<void(int line)>& work) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::runtime_error(
        "no line to a child process: out of files; raise the limit that ulimit -n shows");
  }
  std::fflush(nullptr);  // or the copy would write what waits there once more
  const pid_t self = getpid();
  process_ = fork();
  if (process_ == 0) {
    close(ends[0]);
    be_the_child(self, ends[1], work);
  }
  close(ends[1]);
  line_ = ends[0];
  if (process_ > 0) return;
  close(line_);
  throw std::runtime_error(
      "no child process: the system refuses to fork; end others, or raise the limit that ulimit -u "
      "shows");
}

Child::Child(Child&& other) noexcept
    : process_(std::exchange(other.process_, -1)),
      line_(std::exchange(other.line_, -1)),
      status_(other.status_) {}

Child::~Child() {
  if (line_ >= 0) close(line_);
  if (process_ < 0 || status_) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

bool Child::signal(int number) const {
  return !status_ && kill(process_, number) == 0;
}

// Whether it has ended; `options` are those of waitpid.
bool Child::has_ended(int options) {
  for (int status = 0; !status_;) {
    const pid_t found = waitpid(process_, &status, options);
    if (found == 0) return false;
    if (found == process_) status_ = status;
    if (found < 0 && errno != EINTR) throw std::runtime_error("a child process got lost");
  }
  if (line_ >= 0) close(std::exchange(line_, -1));
  return true;
}

std::optional<int> Child::wait(double seconds) {
  if (has_ended(WNOHANG)) return status_;
  // A descriptor that becomes readable when the child ends, so that nobody polls beside it.
  const int ended = static_cast<int>(syscall(SYS_pidfd_open, process_, 0));
  pollfd end{.fd = ended, .events = POLLIN, .revents = 0};
  poll(&end, 1, static_cast<int>(1000 * seconds));
  if (ended >= 0) close(ended);
  has_ended(WNOHANG);
  return status_;
}

int Child::wait() {
  has_ended(0);
  return *status_;
}

void Child::stop() {
  if (status_) return;
  kill(process_, SIGSTOP);
  int status = 0;
  while (waitpid(process_, &status, WUNTRACED) < 0 && errno == EINTR) {
  }
  if (!WIFSTOPPED(status)) status_ = status;
}

void become(std::vector<std::string> words) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execvp(arguments[0], arguments.data());
  throw std::runtime_error(words[0] + " cannot be started");
}

void say(int line, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(line, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) _exit(1);
    bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
  }
}

}  // namespace irt
