#include "renderer/engine/placement.hpp"

#ifdef IRT_HAS_HWLOC

#include <hwloc.h>
#include <vector>

namespace irt {
namespace {

/// The machine, read once: hardware threads in the order in which they are filled.
class Topology {
 public:
  Topology() {
    if (hwloc_topology_init(&topology_) != 0) return;
    if (hwloc_topology_load(topology_) != 0) return;
    const int cores = hwloc_get_nbobjs_by_type(topology_, HWLOC_OBJ_CORE);
    // Round r takes the r-th hardware thread of every core, until no core has one.
    std::size_t before = 0;
    unsigned round = 0;
    do {
      before = order_.size();
      for (int i = 0; i < cores; ++i) {
        const hwloc_obj_t core =
            hwloc_get_obj_by_type(topology_, HWLOC_OBJ_CORE, static_cast<unsigned>(i));
        const hwloc_obj_t unit =
            hwloc_get_obj_inside_cpuset_by_type(topology_, core->cpuset, HWLOC_OBJ_PU, round);
        if (unit != nullptr) order_.push_back(unit);
      }
      ++round;
    } while (order_.size() > before);
  }
  ~Topology() {
    if (topology_ != nullptr) hwloc_topology_destroy(topology_);
  }
  Topology(const Topology&) = delete;
  Topology& operator=(const Topology&) = delete;

  static const Topology& of_this_machine() {
    static const Topology topology;
    return topology;
  }

  [[nodiscard]] bool bind(unsigned index) const {
    return !order_.empty() && bind(order_[index % order_.size()]->cpuset);
  }
  bool bind(hwloc_const_cpuset_t where) const {
    return hwloc_set_cpubind(topology_, where, HWLOC_CPUBIND_THREAD) == 0;
  }
  /// Where this thread may run.
  void read(hwloc_cpuset_t where) const {
    hwloc_get_cpubind(topology_, where, HWLOC_CPUBIND_THREAD);
  }

 private:
  hwloc_topology_t topology_ = nullptr;
  std::vector<hwloc_obj_t> order_;
};

}  // namespace

bool can_pin() {
  return true;
}

Pinned::Pinned(bool wanted, unsigned index) {
  if (!wanted) return;
  hwloc_bitmap_t before = hwloc_bitmap_alloc();
  Topology::of_this_machine().read(before);
  before_ = before;
  holds_ = Topology::of_this_machine().bind(index);
}

Pinned::~Pinned() {
  const auto before = static_cast<hwloc_bitmap_t>(before_);
  if (holds_) Topology::of_this_machine().bind(before);
  hwloc_bitmap_free(before);
}

}  // namespace irt

#else

namespace irt {

bool can_pin() {
  return false;
}

Pinned::Pinned(bool /*wanted*/, unsigned /*index*/) {}
Pinned::~Pinned() = default;

}  // namespace irt

#endif
