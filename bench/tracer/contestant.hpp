/// What the tracer bench compares: any way to trace a batch of rays through a scene.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/bvh/accelerator.hpp"

namespace irt::tracer {

struct Contestant {
  std::string name;
  bool ours;
  /// Whether it answers to the bit like this project's structures with their default kernel.
  bool same_bits;
  std::unique_ptr<Accelerator> accelerator;
};

using Contestants = std::vector<Contestant>;

/// This project's structures by width and kernel over `mesh`, which outlives them. Only those that
/// are `wanted` by name; "all" wants every one.
Contestants our_contestants(const Mesh& mesh, std::span<const std::string> wanted);

/// Embree's packets and streams, likewise. Empty where the build has no Embree.
Contestants embree_contestants(const Mesh& mesh, std::span<const std::string> wanted);

/// The names of those that are compared unless others are named, and of all there are.
std::span<const std::string_view> usual_contestants();
std::vector<std::string> our_names();
std::vector<std::string> embree_names();

/// Lets the calling thread, and threads that it starts from now on, take denormal numbers for zero.
/// Embree asks for that; ours traces the same either way. Does nothing where the build has no
/// Embree.
void flush_denormals();

/// Whether `name` is in `wanted`, or `wanted` holds "all".
bool is_wanted(std::string_view name, std::span<const std::string> wanted);

/// A structure whose construction is timed.
struct TimedBuild {
  std::string name;
  double milliseconds;
  double sah_cost;  ///< 0 where it is not known
};

/// Builds the wide hierarchy once on `threads` threads.
TimedBuild time_our_build(const Mesh& mesh, unsigned threads);
/// Builds Embree's of medium and of high quality. Empty where the build has no Embree.
std::vector<TimedBuild> time_embree_builds(const Mesh& mesh, unsigned threads);

}  // namespace irt::tracer
