#include "bench/many_core/sweeps/children.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fmt/format.h>
#include <poll.h>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace irt::many_core {

namespace {

using Clock = std::chrono::steady_clock;

struct Child {
  std::size_t job;
  pid_t process;
  int pipe;
  Clock::time_point deadline;
  std::string text;
};

// The child's side: the result goes through the pipe, what went wrong to it, too, after a mark.
[[noreturn]] void work(const std::function<std::string(std::size_t)>& job, std::size_t index,
                       int pipe) {
  std::signal(SIGINT, SIG_IGN);  // Ctrl-C goes to all of the terminal's processes
  std::string text;
  int code = 0;
  try {
    text = job(index);
  } catch (const std::exception& error) {
    text = error.what();
    code = 1;
  }
  const char* at = text.data();
  for (std::size_t left = text.size(); left > 0;) {
    const ssize_t written = write(pipe, at, left);
    if (written <= 0) std::_Exit(2);
    at += written;
    left -= static_cast<std::size_t>(written);
  }
  std::_Exit(code);
}

Child start(const std::function<std::string(std::size_t)>& job, std::size_t index, double seconds) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0)
    throw std::runtime_error(fmt::format("pipe: {}", std::strerror(errno)));
  const pid_t process = fork();
  if (process < 0) throw std::runtime_error(fmt::format("fork: {}", std::strerror(errno)));
  if (process == 0) {
    close(ends[0]);
    work(job, index, ends[1]);
  }
  close(ends[1]);
  const auto time =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  return {index, process, ends[0], Clock::now() + time, {}};
}

// Reads what is there; false at the end.
bool read_some(Child& child) {
  std::array<char, 65536> buffer{};
  const ssize_t size = read(child.pipe, buffer.data(), buffer.size());
  if (size < 0 && errno == EINTR) return true;
  if (size <= 0) return false;
  child.text.append(buffer.data(), static_cast<std::size_t>(size));
  return true;
}

ChildResult result_of(const Child& child, int status, bool hung, double seconds) {
  if (hung) return {{}, "hung", fmt::format("not done after {:.0f} s and stopped", seconds)};
  if (WIFSIGNALED(status))
    return {{},
            "crashed",
            fmt::format("ended by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))};
  if (WEXITSTATUS(status) != 0) return {{}, "failed", child.text};
  return {child.text, "ok", {}};
}

}  // namespace

void run_in_children(std::size_t count, unsigned parallel, double seconds,
                     const std::function<std::string(std::size_t)>& job,
                     const std::function<void(std::size_t, const ChildResult&)>& done,
                     const std::atomic<bool>& interrupted) {
  std::vector<Child> children;
  std::size_t next = 0;
  while ((next < count || !children.empty()) && !interrupted) {
    while (next < count && children.size() < parallel)
      children.push_back(start(job, next++, seconds));
    std::vector<pollfd> pipes;
    pipes.reserve(children.size());
    for (const Child& child : children) pipes.push_back({child.pipe, POLLIN, 0});
    poll(pipes.data(), pipes.size(), 200);
    for (std::size_t i = children.size(); i-- > 0;) {
      Child& child = children[i];
      const bool hung = Clock::now() > child.deadline;
      if (hung) kill(child.process, SIGKILL);
      if (!hung && (pipes[i].revents == 0 || read_some(child))) continue;
      close(child.pipe);
      int status = 0;
      waitpid(child.process, &status, 0);
      done(child.job, result_of(child, status, hung, seconds));
      children.erase(children.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  for (const Child& child : children) {
    kill(child.process, SIGKILL);
    waitpid(child.process, nullptr, 0);
    close(child.pipe);
  }
}

}  // namespace irt::many_core
