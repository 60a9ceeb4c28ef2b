#include "stress/checker/worker_pool.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <poll.h>
#include <stdexcept>
#include <string_view>
#include <unistd.h>

namespace irt::checker {

namespace {

/// What a message is: a result, an error in words, or nothing more.
enum class Tag : char { result, error, end };

template <class T>
std::string_view bytes_of(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

void send(int line, Tag tag, const std::string& bytes) {
  irt::say(line, bytes_of(tag));
  irt::say(line, bytes_of(bytes.size()));
  irt::say(line, bytes);
}

void work_through(int line, std::uint64_t first, std::uint64_t step, const WorkerPool::Work& work) {
  try {
    for (std::uint64_t number = first;; number += step) {
      const std::optional<std::string> result = work(number);
      if (!result) break;
      send(line, Tag::result, *result);
    }
    send(line, Tag::end, "");
  } catch (const std::exception& error) {
    send(line, Tag::error, error.what());
  }
}

}  // namespace

WorkerPool::WorkerPool(unsigned workers, double patience, const Work& work) : patience_(patience) {
  for (unsigned first = 0; first < workers; ++first)
    workers_.emplace_back([&](int line) { work_through(line, first, workers, work); });
}

std::optional<std::string> WorkerPool::next() {
  Child& worker = workers_[next_++ % workers_.size()];
  Tag tag{};
  std::size_t size = 0;
  take(worker, &tag, sizeof tag);
  take(worker, &size, sizeof size);
  std::string bytes(size, '\0');
  take(worker, bytes.data(), size);
  if (tag == Tag::error) throw std::runtime_error(bytes);
  return tag == Tag::result ? std::optional(std::move(bytes)) : std::nullopt;
}

void WorkerPool::take(Child& worker, void* bytes, std::size_t size) const {
  for (char* to = static_cast<char*>(bytes); size > 0;) {
    pollfd open{worker.line(), POLLIN, 0};
    const int ready = poll(&open, 1, static_cast<int>(patience_ * 1000));
    if (ready < 0 && errno != EINTR)
      throw std::runtime_error(std::string("cannot listen to a search: ") + std::strerror(errno));
    if (ready == 0)
      throw std::runtime_error("a search hangs: code that the checker does not see loops for ever");
    if (ready < 0) continue;
    const ssize_t count = read(worker.line(), to, size);
    if (count == 0) {
      worker.join("a search");
      throw std::runtime_error("a search ended without a result");
    }
    if (count < 0 && errno != EINTR)
      throw std::runtime_error(std::string("cannot read from a search: ") + std::strerror(errno));
    to += std::max<ssize_t>(count, 0);
    size -= static_cast<std::size_t>(std::max<ssize_t>(count, 0));
  }
}

}  // namespace irt::checker
