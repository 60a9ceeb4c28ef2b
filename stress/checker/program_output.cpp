#include "stress/checker/program_output.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <sys/mman.h>
#include <unistd.h>

#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::checker {

namespace {

void flush() {
  std::cout.flush();
  std::fflush(nullptr);
}

/// Behind all that this process has open.
unsigned first_free_file() {
  unsigned last = 2;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd"))
    last = std::max(last, static_cast<unsigned>(std::stoul(entry.path().filename().string())));
  return last + 1;
}

}  // namespace

ProgramOutput::ProgramOutput() {
  kept_ = memfd_create("output", MFD_CLOEXEC);
  for (int stream = 0; stream < 3; ++stream) saved_[stream] = fcntl(stream, F_DUPFD_CLOEXEC, 3);
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (kept_ < 0 || nothing < 0)
    throw std::runtime_error(std::string("cannot keep what the program writes: ") +
                             std::strerror(errno));
  dup2(nothing, 0);
  close(nothing);
  virtual_cores::refusals_to = saved_[2];
  take();
}

ProgramOutput::~ProgramOutput() {
  give_back();
  virtual_cores::refusals_to = 2;
  if (saved_[0] >= 0) dup2(saved_[0], 0);
  for (const int saved : saved_)
    if (saved >= 0) close(saved);
  close(kept_);
}

void ProgramOutput::take() const {
  flush();
  for (const int stream : {1, 2}) dup2(kept_, stream);
}

void ProgramOutput::give_back() const {
  flush();
  for (const int stream : {1, 2}) dup2(saved_[stream], stream);
}

void ProgramOutput::afresh() {
  flush();
  if (process_ != getpid()) {
    process_ = getpid();
    first_of_program_ = first_free_file();
  }
  if (ftruncate(kept_, 0) == 0) lseek(kept_, 0, SEEK_SET);
  close_range(first_of_program_, ~0U, 0);
}

std::string ProgramOutput::text() const {
  flush();
  std::string text(static_cast<std::size_t>(std::max<off_t>(lseek(kept_, 0, SEEK_END), 0)), '\0');
  const ssize_t count = pread(kept_, text.data(), text.size(), 0);
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  return text;
}

ProgramOutput::Pause::Pause(ProgramOutput& output) : output_(output) {
  output_.give_back();
}
ProgramOutput::Pause::~Pause() {
  output_.take();
}

}  // namespace irt::checker
