#include "stress/checker/worker_pool.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <poll.h>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "stress/checker/parts.hpp"

namespace irt::checker {

namespace {

/// What a message is: a result, an error in words, or nothing more.
enum class Tag : char { result, error, end };

void put(int pipe, const void* bytes, std::size_t size) {
  const char* from = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t written = write(pipe, from, size);
    if (written < 0 && errno != EINTR) _exit(1);
    from += std::max<ssize_t>(written, 0);
    size -= static_cast<std::size_t>(std::max<ssize_t>(written, 0));
  }
}

void send(int pipe, Tag tag, const std::string& bytes) {
  const std::size_t size = bytes.size();
  put(pipe, &tag, sizeof tag);
  put(pipe, &size, sizeof size);
  put(pipe, bytes.data(), size);
}

[[noreturn]] void work_through(int pipe, std::uint64_t first, std::uint64_t step,
                               const WorkerPool::Work& work) {
  try {
    for (std::uint64_t number = first;; number += step) {
      const std::optional<std::string> result = work(number);
      if (!result) break;
      send(pipe, Tag::result, *result);
    }
    send(pipe, Tag::end, "");
  } catch (const std::exception& error) {
    send(pipe, Tag::error, error.what());
  }
  _exit(0);
}

[[noreturn]] void fail(const char* call) {
  throw std::runtime_error(std::string("cannot divide the work: ") + call + ": " +
                           std::strerror(errno) + "; --jobs 1 needs no other process");
}

}  // namespace

WorkerPool::WorkerPool(unsigned workers, double patience, const Work& work) : patience_(patience) {
  std::fflush(nullptr);
  for (unsigned worker = 0; worker < workers; ++worker) start(worker, workers, work);
}

WorkerPool::~WorkerPool() {
  for (const Worker& worker : workers_) {
    close(worker.pipe);
    if (worker.process < 0) continue;
    kill(worker.process, SIGKILL);
    waitpid(worker.process, nullptr, 0);
  }
}

void WorkerPool::start(std::uint64_t first, std::uint64_t step, const Work& work) {
  int ends[2];
  const pid_t parent = getpid();
  if (pipe(ends) != 0) fail("pipe");
  const pid_t child = fork();
  if (child < 0) fail("fork");
  if (child != 0) {
    close(ends[1]);
    workers_.push_back({child, ends[0]});
    return;
  }
  // Whoever ends the parent, the children go with it.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  close(ends[0]);
  work_through(ends[1], first, step, work);
}

std::optional<std::string> WorkerPool::next() {
  Worker& worker = workers_[next_++ % workers_.size()];
  Tag tag{};
  std::size_t size = 0;
  take(worker, &tag, sizeof tag);
  take(worker, &size, sizeof size);
  std::string bytes(size, '\0');
  take(worker, bytes.data(), size);
  if (tag == Tag::error) throw std::runtime_error(bytes);
  return tag == Tag::result ? std::optional(std::move(bytes)) : std::nullopt;
}

void WorkerPool::take(Worker& worker, void* bytes, std::size_t size) const {
  for (char* to = static_cast<char*>(bytes); size > 0;) {
    pollfd open{worker.pipe, POLLIN, 0};
    const int ready = poll(&open, 1, static_cast<int>(patience_ * 1000));
    if (ready < 0 && errno != EINTR) fail("poll");
    if (ready == 0)
      throw std::runtime_error("a search hangs: code that the checker does not see loops for ever");
    if (ready < 0) continue;
    const ssize_t count = read(worker.pipe, to, size);
    if (count == 0) ended(worker);
    if (count < 0 && errno != EINTR) fail("read");
    to += std::max<ssize_t>(count, 0);
    size -= static_cast<std::size_t>(std::max<ssize_t>(count, 0));
  }
}

void WorkerPool::ended(Worker& worker) {
  int status = 0;
  waitpid(worker.process, &status, 0);
  worker.process = -1;
  if (WIFEXITED(status) && WEXITSTATUS(status) == no_verdict) _exit(no_verdict);
  throw std::runtime_error(
      "a search ended without a result, " +
      (WIFSIGNALED(status) ? "by signal " + std::to_string(WTERMSIG(status)) + " (" +
                                 strsignal(WTERMSIG(status)) + ")"
                           : "with status " + std::to_string(WEXITSTATUS(status))) +
      "; that is a fault of the checker or of compiled code that the queue calls; --jobs 1 runs in "
      "one process, for a debugger");
}

}  // namespace irt::checker
