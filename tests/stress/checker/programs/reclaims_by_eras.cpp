// finds: nothing
#include <queues/reclamation/hazard_eras.hpp>
#include <tests/stress/checker/reclaiming.hpp>
// A reader, and one who replaces what it reads.

int main() {
  irt::reclaiming::one_reader<irt::HazardEras<irt::reclaiming::Node, 2>>(2, 0, 2, 0, 0);
  return 0;
}
