/// Adapts the wide hierarchy to triangles that have moved.
#pragma once

#include "renderer/bvh/executor.hpp"
#include "renderer/bvh/wide/wide_bvh.hpp"
#include "renderer/scene/scene.hpp"

namespace irt {

/// Gives every block of `bvh` the corners and every node the boxes of `mesh`, which has the
/// triangles that `bvh` was built over at other places. The tree stays as it is: cheap, and the
/// answers are right, but boxes overlap more the further triangles have moved against each other;
/// `sah_cost` says by how much (Wald, Boulos and Shirley 2007, "Ray tracing deformable scenes using
/// dynamic bounding volume hierarchies").
///
/// The result does not depend on the executor.
void refit_wide(WideBvh& bvh, const Mesh& mesh, Executor& executor);

}  // namespace irt
