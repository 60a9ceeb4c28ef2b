// Stands in for embree.cpp where the library is missing.
#include "bench/tracer/contestant.hpp"

namespace irt::tracer {

Contestants embree_contestants(const Mesh& /*mesh*/, std::span<const std::string> /*wanted*/) {
  return {};
}

std::vector<TimedBuild> time_embree_builds(const Mesh& /*mesh*/, unsigned /*threads*/) {
  return {};
}

std::vector<std::string> embree_names() {
  return {};
}

void flush_denormals() {}

}  // namespace irt::tracer
