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

  [[nodiscard]] bool bind(unsigned index) const {
    if (order_.empty()) return false;
    return hwloc_set_cpubind(topology_, order_[index % order_.size()]->cpuset,
                             HWLOC_CPUBIND_THREAD) == 0;
  }

 private:
  hwloc_topology_t topology_ = nullptr;
  std::vector<hwloc_obj_t> order_;
};

}  // namespace

bool can_pin() {
  return true;
}

bool pin_this_thread(unsigned index) {
  static const Topology topology;
  return topology.bind(index);
}

}  // namespace irt

#else

namespace irt {

bool can_pin() {
  return false;
}

bool pin_this_thread(unsigned /*index*/) {
  return false;
}

}  // namespace irt

#endif
