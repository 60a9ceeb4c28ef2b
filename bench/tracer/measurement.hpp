/// Timing several contestants in turn, and whether they agree.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/tracer/contestant.hpp"
#include "bench/tracer/scene_rays.hpp"
#include "renderer/bvh/executor.hpp"

namespace irt::bench {

/// How long something took, each in milliseconds.
struct Times {
  std::vector<double> wall;
  std::vector<double>
      cpu;  ///< of all threads; what other programs take of the machine is not in it
};

double median(std::vector<double> values);

/// Calls `run` and adds what it takes.
template <class Run>
void time(Times& times, const Run& run);

/// What becomes of a batch.
struct Answers {
  explicit Answers(std::uint32_t lanes) : hits(lanes), occluded(lanes) {}
  Hits hits;
  LaneArray<std::uint8_t> occluded;
};

/// Traces every batch once on the executor's threads.
void trace_all(const Contestant& contestant, RayKind kind, std::span<const Rays> batches,
               std::span<Answers> answers, Executor& executor);

/// How the answers of a contestant differ from those of another.
struct Disagreement {
  std::uint64_t rays = 0;
  std::uint64_t bits = 0;       ///< not the same triangle and bits of t, u and v
  std::uint64_t missed = 0;     ///< hit by one and not by the other
  std::uint64_t elsewhere = 0;  ///< another triangle, and not at the same distance (1e-4 relative)
};

Disagreement compare(RayKind kind, std::span<const Rays> batches,
                     std::span<const Answers> reference, std::span<const Answers> answers);

double wall_ms();
double cpu_ms();

template <class Run>
void time(Times& times, const Run& run) {
  const double wall = wall_ms(), cpu = cpu_ms();
  run();
  times.cpu.push_back(cpu_ms() - cpu);
  times.wall.push_back(wall_ms() - wall);
}

}  // namespace irt::bench
