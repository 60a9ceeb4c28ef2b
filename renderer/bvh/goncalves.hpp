/// The hierarchy of thesis 5.1.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/bvh/single_ray.hpp"

namespace irt {

/// A binary bounding volume hierarchy with one triangle per leaf and nodes linked by pointers
/// (thesis 5.1, listing 5.1, there after A. Gonçalves).
///
/// The thesis' baseline for everything later; quick to build, twice the memory of `wald`, and every
/// ray walks alone.
///
/// Built top-down with the surface area heuristic over binned candidates. As in Shevtsov's min-max
/// binning (Shevtsov, Soupikov, Kapustin 2007) the lower and the upper edges of the boxes are
/// binned apart; a plane splits the triangles by either edge, and each bin keeps the exact box of
/// its triangles, so both costs are exact. Where no plane separates, or the tree gets deeper than
/// any useful one, the list is halved: coincident triangles and meshes of exponential spacing end
/// in a balanced tree, and the depth is bounded.
///
/// Differs from the thesis: traversal is iterative, the nearer child goes first, and boxes beyond
/// the nearest hit are skipped.
class Goncalves final : public SingleRayAccelerator<Goncalves> {
 public:
  Goncalves(const Mesh& mesh, const AcceleratorOptions& options);

  template <class Kernel, bool any, class Probe>
  Hit trace(const KernelRay<Kernel>& ray, Probe& probe) const;

  [[nodiscard]] std::size_t memory_bytes() const override {
    return nodes_.size() * sizeof(Node) + triangles_.size() * sizeof(Triangle);
  }
  bool refit(const Mesh& mesh, Executor& executor) override;
  [[nodiscard]] double sah_cost() const override { return sah_cost_; }

 private:
  struct Node {
    Box box;
    const Node* child1 = nullptr;  ///< null in a leaf
    const Node* child2 = nullptr;
    std::uint32_t triangle = no_triangle;
  };
  struct Builder;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;  ///< parents first; never resized once pointers are taken
  double sah_cost_ = 1;      ///< boxes that a ray which enters the root is expected to enter
};

}  // namespace irt
