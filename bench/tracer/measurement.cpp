#include "bench/tracer/measurement.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <ctime>

namespace irt::bench {
namespace {

double milliseconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

}  // namespace

double wall_ms() {
  return milliseconds(CLOCK_MONOTONIC);
}
double cpu_ms() {
  return milliseconds(CLOCK_PROCESS_CPUTIME_ID);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const std::size_t middle = values.size() / 2;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle),
                   values.end());
  if (values.size() % 2 == 1) return values[middle];
  return (values[middle] +
          *std::max_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle))) /
         2;
}

void trace_all(const Contestant& contestant, RayKind kind, std::span<const Rays> batches,
               std::span<Answers> answers, Executor& executor) {
  executor.for_each(batches.size(), [&](std::size_t i) {
    if (kind == RayKind::shadow) {
      contestant.any_hit(batches[i], {answers[i].occluded.data(), batches[i].size});
    } else {
      contestant.closest_hit(batches[i], answers[i].hits);
    }
  });
}

Disagreement compare(RayKind kind, std::span<const Rays> batches,
                     std::span<const Answers> reference, std::span<const Answers> answers) {
  Disagreement found;
  for (std::size_t i = 0; i < batches.size(); ++i) {
    for (std::uint32_t lane = 0; lane < batches[i].size; ++lane) {
      ++found.rays;
      if (kind == RayKind::shadow) {
        const bool differs = reference[i].occluded[lane] != answers[i].occluded[lane];
        found.bits += differs;
        found.missed += differs;
        continue;
      }
      const Hits &a = reference[i].hits, &b = answers[i].hits;
      const bool a_hit = a.triangle[lane] != no_triangle, b_hit = b.triangle[lane] != no_triangle;
      if (!a_hit && !b_hit) continue;
      if (a_hit != b_hit) {
        ++found.bits;
        ++found.missed;
        continue;
      }
      const bool same = a.triangle[lane] == b.triangle[lane];
      found.bits += !(same && same_bits(a.t[lane], b.t[lane]) && same_bits(a.u[lane], b.u[lane]) &&
                      same_bits(a.v[lane], b.v[lane]));
      found.elsewhere += !same && !(std::abs(a.t[lane] - b.t[lane]) <= 1e-4f * std::abs(a.t[lane]));
    }
  }
  return found;
}

}  // namespace irt::bench
