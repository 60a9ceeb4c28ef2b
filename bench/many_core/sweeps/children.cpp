#include "bench/many_core/sweeps/children.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fmt/format.h>
#include <list>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "stress/running/child.hpp"

namespace irt::many_core {

namespace {

using Clock = std::chrono::steady_clock;

struct Job {
  std::size_t number;
  Child child;
  Clock::time_point deadline;
  std::string text;
};

// The child's side: the result goes through the line, what went wrong, too, with an exit code.
void work(const std::function<std::string(std::size_t)>& job, std::size_t number, int line) {
  std::string text;
  int code = 0;
  try {
    text = job(number);
  } catch (const std::exception& error) {
    text = error.what();
    code = 1;
  }
  say(line, text);
  std::_Exit(code);
}

Job start(const std::function<std::string(std::size_t)>& job, std::size_t number, double seconds) {
  const auto time =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  return {number, Child([&](int line) { work(job, number, line); }), Clock::now() + time, {}};
}

// Reads what is there; false at the end.
bool read_some(Job& job) {
  std::array<char, 65536> buffer{};
  const ssize_t size = read(job.child.line(), buffer.data(), buffer.size());
  if (size < 0 && errno == EINTR) return true;
  if (size <= 0) return false;
  job.text.append(buffer.data(), static_cast<std::size_t>(size));
  return true;
}

ChildResult result_of(const Job& job, int status, bool hung, double seconds) {
  if (hung) return {{}, "hung", fmt::format("not done after {:.0f} s and stopped", seconds)};
  if (WIFSIGNALED(status))
    return {{},
            "crashed",
            fmt::format("ended by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))};
  if (WEXITSTATUS(status) != 0) return {{}, "failed", job.text};
  return {job.text, "ok", {}};
}

}  // namespace

void run_in_children(std::size_t count, unsigned parallel, double seconds,
                     const std::function<std::string(std::size_t)>& job,
                     const std::function<void(std::size_t, const ChildResult&)>& done,
                     const std::atomic<bool>& interrupted) {
  std::list<Job> jobs;
  std::size_t next = 0;
  while ((next < count || !jobs.empty()) && !interrupted) {
    while (next < count && jobs.size() < parallel) jobs.push_back(start(job, next++, seconds));
    std::vector<pollfd> lines;
    lines.reserve(jobs.size());
    for (const Job& one : jobs) lines.push_back({one.child.line(), POLLIN, 0});
    poll(lines.data(), lines.size(), 200);
    auto line = lines.begin();
    std::erase_if(jobs, [&](Job& one) {
      const bool said = line++->revents != 0;
      const bool hung = Clock::now() > one.deadline;
      if (hung) one.child.signal(SIGKILL);
      if (!hung && (!said || read_some(one))) return false;
      done(one.number, result_of(one, one.child.wait(), hung, seconds));
      return true;
    });
  }
}

}  // namespace irt::many_core
