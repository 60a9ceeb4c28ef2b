#include "stress/running/child_process.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fmt/format.h>
#include <poll.h>
#include <stdexcept>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace irt {
namespace {

using Clock = std::chrono::steady_clock;

Clock::time_point in(double seconds) {
  return Clock::now() +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
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

ChildProcess::File::File() : descriptor(memfd_create("irt-child", MFD_CLOEXEC)) {
  if (descriptor < 0)
    throw std::runtime_error(
        "no file for a child process: out of files; raise the limit that "
        "ulimit -n shows");
}

ChildProcess::File::~File() {
  close(descriptor);
}

ChildProcess::ChildProcess(const std::function<void(int line)>& work)
    : child_([&](int line) {
        dup2(errors_.descriptor, STDERR_FILENO);
        work(line);
      }) {}

void ChildProcess::tell(std::string_view text) const {
  while (!text.empty()) {
    const ssize_t n = send(child_.line(), text.data(), text.size(), MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
}

void ChildProcess::kill_for_silence(double seconds) {
  if (!silent_ && child_.signal(SIGKILL)) silent_ = seconds;
}

/// Takes what the child has said meanwhile; false once there will be nothing more.
bool ChildProcess::read_more(double seconds, const std::atomic<bool>& cancel) {
  const Clock::time_point deadline = in(seconds);
  for (;;) {
    if (cancel || Clock::now() > deadline) {
      kill_for_silence(seconds);
      return false;
    }
    pollfd wait{.fd = child_.line(), .events = POLLIN, .revents = 0};
    if (poll(&wait, 1, 200) <= 0) continue;
    std::array<char, 65536> part{};
    const ssize_t n = read(child_.line(), part.data(), part.size());
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
  const Clock::time_point deadline = in(seconds);
  std::optional<int> status;
  while (!(status = child_.wait(0.2))) {
    if (cancel || Clock::now() > deadline) kill_for_silence(seconds);
  }
  Ending ending{.status = "ok",
                .message = {},
                .answer = std::move(text_),
                .signal = WIFSIGNALED(*status) ? WTERMSIG(*status) : 0,
                .code = WIFEXITED(*status) ? WEXITSTATUS(*status) : 0,
                .errors = contents(errors_.descriptor)};
  if (silent_) {
    ending.status = "hung";
    ending.message = fmt::format("silent for {:.0f} s", *silent_);
  } else if (ending.signal != 0) {
    ending.status = "crashed";
    ending.message = strsignal(ending.signal);
  } else if (ending.code != 0 || ending.answer.empty()) {
    ending.status = "failed";
    ending.message = fmt::format("exit code {}", ending.code);
  }
  if (ending.status == "ok") return ending;
  ending.answer.clear();
  if (const std::string said = last_line(ending.errors); !said.empty()) {
    ending.message += ": " + said;
  }
  return ending;
}

void speak_by_standard_streams(int line) {
  dup2(line, STDIN_FILENO);
  dup2(line, STDOUT_FILENO);
}

Ending in_child(double seconds, const std::atomic<bool>& cancel,
                const std::function<std::string()>& work) {
  ChildProcess child([&](int line) {
    dup2(STDERR_FILENO, STDOUT_FILENO);
    say(line, work());
  });
  return child.end(seconds, cancel);
}

}  // namespace irt
