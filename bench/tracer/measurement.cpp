#include "bench/tracer/measurement.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "bench/statistics/averages.hpp"
#include "renderer/tracing/stopwatch.hpp"

namespace irt::tracer {
namespace {

/// The lanes of one array that hold rays.
template <class T>
void copy(const LaneArray<T>& from, std::uint32_t lanes, LaneArray<T>& to) {
  std::copy_n(from.data(), lanes, to.data());
}

double milliseconds(std::uint64_t ticks) {
  return static_cast<double>(ticks) * nanoseconds_per_tick() * 1e-6;
}

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

}  // namespace

double spread(std::vector<double> values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const double low = values[values.size() / 4],
               high = values[values.size() - 1 - values.size() / 4];
  return 50 * (high - low) / statistics::median(values);
}

void trace_all(const Contestant& contestant, RayKind kind, std::span<const Rays> batches,
               std::span<Answers> answers, Executor& executor) {
  executor.for_each(batches.size(), [&](std::size_t i) {
    if (kind == RayKind::shadow) {
      contestant.accelerator->any_hit(batches[i], {answers[i].occluded.data(), batches[i].size});
    } else {
      contestant.accelerator->closest_hit(batches[i], answers[i].hits);
    }
  });
}

void trace_timed(const Contestant& contestant, RayKind kind, std::span<const Rays> batches,
                 Executor& executor, TaskTimes& times) {
  const std::span<std::uint64_t> ticks = times.add_round(batches.size());
  executor.for_each(batches.size(), [&](std::size_t i) {
    thread_local Rays rays(tile_rays);
    thread_local Answers answers(tile_rays);
    const Rays& batch = batches[i];
    rays.size = batch.size;
    copy(batch.origin_x, batch.size, rays.origin_x);
    copy(batch.origin_y, batch.size, rays.origin_y);
    copy(batch.origin_z, batch.size, rays.origin_z);
    copy(batch.direction_x, batch.size, rays.direction_x);
    copy(batch.direction_y, batch.size, rays.direction_y);
    copy(batch.direction_z, batch.size, rays.direction_z);
    copy(batch.t_max, batch.size, rays.t_max);
    const std::uint64_t start = ticks_now();
    if (kind == RayKind::shadow) {
      contestant.accelerator->any_hit(rays, {answers.occluded.data(), rays.size});
    } else {
      contestant.accelerator->closest_hit(rays, answers.hits);
    }
    ticks[i] = ticks_now() - start;
  });
}

std::span<std::uint64_t> TaskTimes::add_round(std::size_t tasks) {
  return rounds_.emplace_back(tasks);
}

double TaskTimes::busy_ms() const {
  double sum = 0;
  for (std::size_t task = 0; task < rounds_.front().size(); ++task) {
    std::vector<double> taken;
    for (const auto& round : rounds_) taken.push_back(milliseconds(round[task]));
    sum += statistics::median(std::move(taken));
  }
  return sum;
}

std::vector<double> TaskTimes::rounds_ms() const {
  std::vector<double> sums;
  for (const auto& round : rounds_) {
    sums.push_back(milliseconds(std::accumulate(round.begin(), round.end(), std::uint64_t{0})));
  }
  return sums;
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

}  // namespace irt::tracer
