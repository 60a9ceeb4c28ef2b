#include "stress/running/child_process.hpp"

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
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace irt {
namespace {

using Clock = std::chrono::steady_clock;

Clock::time_point in(double seconds) {
  return Clock::now() +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

[[noreturn]] void be_the_child(pid_t parent, int socket, int errors,
                               const std::function<void()>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it has died meanwhile, and sends no signal any more
  setpgid(0, 0);                      // Ctrl-C is for the caller to deal with
  dup2(socket, STDIN_FILENO);
  dup2(socket, STDOUT_FILENO);
  dup2(errors, STDERR_FILENO);
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

std::string contents(int file) {
  std::string text;
  std::array<char, 65536> part{};
  lseek(file, 0, SEEK_SET);
  for (ssize_t n = 0; (n = read(file, part.data(), part.size())) > 0;) {
    text.append(part.data(), static_cast<std::size_t>(n));
  }
  return text;
}

/// The last line that says something, without the end of the line.
std::string last_line(const std::string& text) {
  const auto end = text.find_last_not_of("\n ");
  if (end == std::string::npos) return {};
  const auto before = text.find_last_of('\n', end);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  return text.substr(begin, end - begin + 1);
}

}  // namespace

ChildProcess::ChildProcess(const std::function<void()>& work) {
  std::array<int, 2> ends{};
  errors_ = memfd_create("irt-child", MFD_CLOEXEC);
  if (errors_ < 0 || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    if (errors_ >= 0) close(errors_);
    throw std::runtime_error("no file for a child process: out of files");
  }
  std::fflush(stdout);  // or the copy would write what waits there once more
  const pid_t self = getpid();
  process_ = fork();
  if (process_ == 0) be_the_child(self, ends[1], errors_, work);
  close(ends[1]);
  socket_ = ends[0];
  if (process_ > 0) return;
  close(socket_);
  close(errors_);
  throw std::runtime_error("no child process: the system refuses to fork");
}

ChildProcess::~ChildProcess() {
  if (!status_) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  close(socket_);
  close(errors_);
}

void ChildProcess::tell(std::string_view text) const {
  while (!text.empty()) {
    const ssize_t n = send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
}

void ChildProcess::kill_for_silence(double seconds) {
  if (silent_ || status_) return;
  silent_ = seconds;
  kill(process_, SIGKILL);
}

/// Takes what the child has written meanwhile; false once there will be nothing more.
bool ChildProcess::read_more(double seconds, const std::atomic<bool>& cancel) {
  const Clock::time_point deadline = in(seconds);
  for (;;) {
    if (cancel || Clock::now() > deadline) {
      kill_for_silence(seconds);
      return false;
    }
    pollfd wait{.fd = socket_, .events = POLLIN, .revents = 0};
    if (poll(&wait, 1, 200) <= 0) continue;
    std::array<char, 65536> part{};
    const ssize_t n = read(socket_, part.data(), part.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    text_.append(part.data(), static_cast<std::size_t>(n));
    return true;
  }
}

std::optional<std::string> ChildProcess::line(double seconds, const std::atomic<bool>& cancel) {
  std::size_t end = 0;
  while ((end = text_.find('\n')) == std::string::npos) {
    if (!read_more(seconds, cancel)) return std::nullopt;
  }
  std::string one = text_.substr(0, end);
  text_.erase(0, end + 1);
  return one;
}

Ending ChildProcess::end(double seconds, const std::atomic<bool>& cancel) {
  while (read_more(seconds, cancel)) {
  }
  // A descriptor that becomes readable when the child ends, so that nobody polls beside it.
  const int ended = static_cast<int>(syscall(SYS_pidfd_open, process_, 0));
  const Clock::time_point deadline = in(seconds);
  for (int status = 0; !status_;) {
    const pid_t found = waitpid(process_, &status, WNOHANG);
    if (found == process_) status_ = status;
    if (found < 0 && errno != EINTR) throw std::runtime_error("a child process got lost");
    if (cancel || Clock::now() > deadline) kill_for_silence(seconds);
    pollfd wait{.fd = ended, .events = POLLIN, .revents = 0};
    if (!status_) poll(&wait, 1, 200);
  }
  if (ended >= 0) close(ended);

  Ending ending{.status = "ok", .message = {}, .answer = std::move(text_)};
  if (silent_) {
    ending = {
        .status = "hung", .message = fmt::format("silent for {:.0f} s", *silent_), .answer = {}};
  } else if (WIFSIGNALED(*status_)) {
    ending = {.status = "crashed", .message = strsignal(WTERMSIG(*status_)), .answer = {}};
  } else if (WEXITSTATUS(*status_) != 0 || ending.answer.empty()) {
    ending = {.status = "failed",
              .message = fmt::format("exit code {}", WEXITSTATUS(*status_)),
              .answer = {}};
  }
  const std::string said = last_line(contents(errors_));
  if (ending.status != "ok" && !said.empty()) ending.message += ": " + said;
  return ending;
}

void ChildProcess::stop() {
  if (status_) return;
  kill(process_, SIGSTOP);
  int status = 0;
  while (waitpid(process_, &status, WUNTRACED) < 0 && errno == EINTR) {
  }
  if (!WIFSTOPPED(status)) status_ = status;
}

void ChildProcess::go_on() const {
  if (!status_) kill(process_, SIGCONT);
}

Ending in_child(double seconds, const std::atomic<bool>& cancel,
                const std::function<void()>& work) {
  ChildProcess child(work);
  return child.end(seconds, cancel);
}

}  // namespace irt
