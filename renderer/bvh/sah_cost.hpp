/// The surface area heuristic's price of a finished binary tree.
#pragma once

#include <type_traits>
#include <vector>

#include "renderer/tracing/intersection.hpp"

namespace irt {

/// In double precision, where the areas of huge and tiny boxes neither overflow nor vanish.
inline double half_area(const Box& box) {
  const double x = double{box.hi.x} - box.lo.x, y = double{box.hi.y} - box.lo.y,
               z = double{box.hi.z} - box.lo.z;
  return x * y + y * z + z * x;
}

/// How many boxes of `nodes`, the root first, a ray that enters the root's is expected to enter: a
/// box is entered in proportion to its surface (MacDonald and Booth 1990). 1 where there is no
/// surface to speak of.
template <class Node>
double expected_boxes(const std::vector<Node>& nodes) {
  double sum = 0, root = 0;
  for (const Node& node : nodes) {
    Box box;
    if constexpr (std::is_member_function_pointer_v<decltype(&Node::box)>) {
      box = node.box();
    } else {
      box = node.box;
    }
    const double area = half_area(box);
    if (&node == nodes.data()) root = area;
    sum += area;
  }
  return root > 0 ? sum / root : 1;
}

}  // namespace irt
