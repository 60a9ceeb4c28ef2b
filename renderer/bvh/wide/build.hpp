/// Builds the wide hierarchy.
#pragma once

#include "renderer/bvh/executor.hpp"
#include "renderer/bvh/wide/wide_bvh.hpp"
#include "renderer/scene/scene.hpp"

namespace irt {

/// Builds over all triangles of `mesh` by binned surface area heuristic (Wald 2007, "On fast
/// construction of SAH-based bounding volume hierarchies"), straight to eight children per node:
/// of a node's children the one with the largest surface is split until there are eight (Wald,
/// Benthin and Boulos 2008, "Getting rid of packets").
///
/// Large nodes are split by all threads together, the subtrees below are built side by side. The
/// result depends on the mesh only: not on the executor, its number of threads, or the CPU.
WideBvh build_wide(const Mesh& mesh, Executor& executor);

}  // namespace irt
