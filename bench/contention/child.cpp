#include "bench/contention/child.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <iostream>
#include <iterator>
#include <poll.h>
#include <stdexcept>
#include <string>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bench/contention/measurement.hpp"

namespace irt::contention {
namespace {

using Clock = std::chrono::steady_clock;

/// A file in memory.
class Scratch {
 public:
  Scratch() : descriptor_(memfd_create("irt-contention", 0)) {
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

[[noreturn]] void become(const std::filesystem::path& program, const Scratch& orders,
                         const Scratch& answer, const Scratch& errors) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // Ctrl-C is for the sweep to deal with.
  setpgid(0, 0);
  dup2(orders.descriptor(), STDIN_FILENO);
  dup2(answer.descriptor(), STDOUT_FILENO);
  dup2(errors.descriptor(), STDERR_FILENO);
  execl(program.c_str(), program.c_str(), child_command, nullptr);
  _exit(127);
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

Sample ended_badly(const std::string& status, const std::string& message,
                   const std::string& errors) {
  const std::string said = last_line(errors);
  Sample sample;
  sample.status = status;
  sample.message = said.empty() ? message : message + ": " + said;
  return sample;
}

}  // namespace

Sample measure_in_child(const std::filesystem::path& program, const Job& job,
                        const std::atomic<bool>& cancel) {
  const Scratch orders, answer, errors;
  orders.fill(nlohmann::json(job).dump());
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no child process: the system refuses to fork");
  if (child == 0) become(program, orders, answer, errors);

  // The child looks after its threads itself; this is for when it cannot.
  const double allowed =
      job.seconds + job.warmup_seconds + 3 * job.patience_seconds + 0.05 * job.threads + 5;
  const auto deadline = Clock::now() + std::chrono::milliseconds(static_cast<long>(allowed * 1e3));
  int status = 0;
  if (outlived(child, deadline, cancel, status)) {
    return ended_badly("hung", fmt::format("silent for {:.0f} s", allowed), errors.contents());
  }
  if (WIFSIGNALED(status)) {
    return ended_badly("crashed", strsignal(WTERMSIG(status)), errors.contents());
  }
  const std::string text = answer.contents();
  if (WEXITSTATUS(status) != 0 || text.empty()) {
    return ended_badly("failed", fmt::format("exit code {}", WEXITSTATUS(status)),
                       errors.contents());
  }
  return nlohmann::json::parse(text).get<Sample>();
}

int run_as_child() {
  const std::string orders(std::istreambuf_iterator<char>(std::cin), {});
  const auto job = nlohmann::json::parse(orders).get<Job>();
  QueueRegistry queues;
  for (const std::string& plugin : job.plugins) queues.open(plugin);
  const auto answer = [](const Sample& sample) {
    const std::string text =
        nlohmann::json(sample).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
  };
  const Sample sample = measure(job, subject_maker(queues, job.queue), [&](const Sample& hung) {
    answer(hung);
    _exit(0);  // without waiting for threads that do not end
  });
  answer(sample);
  return 0;
}

}  // namespace irt::contention
