/// What the tracer bench compares: any way to trace a batch of rays through a scene.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/scene/scene.hpp"
#include "renderer/tracing/rays.hpp"

namespace irt::bench {

/// Queries are const and may run on several threads at once.
class Contestant {
 public:
  Contestant() = default;
  Contestant(const Contestant&) = delete;
  Contestant& operator=(const Contestant&) = delete;
  virtual ~Contestant() = default;

  virtual std::string_view name() const = 0;
  virtual bool is_ours() const = 0;
  /// Whether it answers to the bit like this project's structures with their default kernel.
  virtual bool same_bits() const = 0;
  /// As irt::Accelerator, with this scene's triangle numbers.
  virtual void closest_hit(const Rays& rays, Hits& hits) const = 0;
  virtual void any_hit(const Rays& rays, std::span<std::uint8_t> occluded) const = 0;
};

using Contestants = std::vector<std::unique_ptr<Contestant>>;

/// This project's structures with their widths over `mesh`, which outlives them. Only those that
/// are `wanted` by name; "all" wants every one.
Contestants our_contestants(const Mesh& mesh, std::span<const std::string> wanted);

/// Embree's packets and streams, likewise. Empty where the build has no Embree.
Contestants embree_contestants(const Mesh& mesh, std::span<const std::string> wanted);

/// The names of those that are compared unless others are named.
std::span<const std::string_view> usual_contestants();

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

}  // namespace irt::bench
