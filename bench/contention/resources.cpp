#include "bench/contention/resources.hpp"

#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <malloc.h>
#include <pthread.h>
#include <string_view>
#include <sys/resource.h>

#include "bench/running/clocks.hpp"

namespace irt::contention {
namespace {

namespace fs = std::filesystem;

std::optional<std::uint64_t> number_in(const fs::path& file) {
  std::ifstream in(file);
  std::uint64_t number = 0;
  return in >> number ? std::optional(number) : std::nullopt;
}

/// A field of /proc/self/status that is given in kB.
std::uint64_t status_bytes(std::string_view key) {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(key)) return std::stoull(line.substr(key.size())) * 1024;
  }
  return 0;
}

std::uint64_t allocated_bytes() {
  const struct mallinfo2 books = mallinfo2();
  return books.uordblks + books.hblkhd;
}

/// Whether it is the C library that allocates, and not what stands in for it.
bool allocator_keeps_books() {
  const std::uint64_t before = allocated_bytes();
  void* volatile block = std::malloc(std::size_t{1} << 16U);  // volatile: not to be left out
  const bool noted = allocated_bytes() > before;
  std::free(block);
  return noted;
}

}  // namespace

Usage usage_so_far(std::span<std::thread> threads) {
  Usage usage;
  for (std::thread& thread : threads) {
    // Not from getrusage(2), which knows of threads that run only what they had used at the last
    // tick, some milliseconds ago.
    clockid_t clock{};
    if (pthread_getcpuclockid(thread.native_handle(), &clock) != 0) continue;
    usage.cpu_seconds += seconds_by(clock);
  }
  rusage all{}, own{};
  getrusage(RUSAGE_SELF, &all);
  getrusage(RUSAGE_THREAD, &own);
  usage.context_switches =
      static_cast<std::uint64_t>(all.ru_nvcsw + all.ru_nivcsw - own.ru_nvcsw - own.ru_nivcsw);
  return usage;
}

MemoryUse::MemoryUse() {
  std::ofstream("/proc/self/clear_refs") << 5;
  resident_before_ = status_bytes("VmRSS:");
  if (allocator_keeps_books()) allocated_before_ = allocated_bytes();
}

std::uint64_t MemoryUse::peak_bytes() const {
  const std::uint64_t peak = status_bytes("VmHWM:");
  return peak > resident_before_ ? peak - resident_before_ : 0;
}

std::optional<std::uint64_t> MemoryUse::held_bytes() const {
  if (!allocated_before_) return std::nullopt;
  const std::uint64_t now = allocated_bytes();
  return now > *allocated_before_ ? now - *allocated_before_ : 0;
}

EnergyMeter::EnergyMeter(const fs::path& root) {
  std::error_code error;
  bool found = false;
  for (const auto& entry : fs::directory_iterator(root, error)) {
    // A package is "intel-rapl:0"; "intel-rapl:0:0" is a part of it.
    const std::string name = entry.path().filename();
    if (!name.starts_with("intel-rapl:") || name.find(':', 11) != std::string::npos) continue;
    found = true;
    if (!number_in(entry.path() / "energy_uj")) continue;
    packages_.push_back({.counter = entry.path() / "energy_uj",
                         .range = number_in(entry.path() / "max_energy_range_uj").value_or(0)});
  }
  if (!packages_.empty()) return;
  missing_ = found ? "energy: not readable by this user (" + root.string() + ")"
                   : "energy: no RAPL counters on this machine (" + root.string() + ")";
}

void EnergyMeter::start() {
  for (Package& one : packages_) one.begin = number_in(one.counter).value_or(0);
}

std::optional<double> EnergyMeter::joules() const {
  if (packages_.empty()) return std::nullopt;
  double sum = 0;
  for (const Package& one : packages_) {
    const std::uint64_t end = number_in(one.counter).value_or(one.begin);
    const std::uint64_t used = end >= one.begin ? end - one.begin : end + one.range - one.begin;
    sum += static_cast<double>(used) * 1e-6;
  }
  return sum;
}

}  // namespace irt::contention
