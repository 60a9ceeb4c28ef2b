// finds: nothing
#include <queues/reclamation/hazard_eras.hpp>
#include <tests/stress/checker/reclaiming.hpp>
// The second node is of a later era than the first.

int main() {
  irt::reclaiming::next_node<irt::HazardEras<irt::reclaiming::Node, 2>>(1, 2);
  return 0;
}
