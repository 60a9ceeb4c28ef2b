// finds: nothing
#include <queues/reclamation/hazard_pointers.hpp>
#include <tests/stress/checker/reclaiming.hpp>
// Both nodes that a reader has in hand are taken out.

int main() {
  irt::reclaiming::next_node<irt::HazardPointers<irt::reclaiming::Node, 2>>(1, 2);
  return 0;
}
