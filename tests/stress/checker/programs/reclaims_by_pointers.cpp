// finds: nothing
#include <queues/reclamation/hazard_pointers.hpp>
#include <tests/stress/checker/reclaiming.hpp>
// A reader, and one who replaces what it reads.

int main() {
  irt::reclaiming::one_reader<irt::HazardPointers<irt::reclaiming::Node, 2>>(2, 0, 2, 0, 0);
  return 0;
}
