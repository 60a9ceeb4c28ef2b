// finds: nothing
#include <queues/reclamation/hazard_eras.hpp>
#include <tests/stress/checker/reclaiming.hpp>
// The era is moved on by a third.

int main() {
  irt::reclaiming::one_reader<irt::HazardEras<irt::reclaiming::Node, 2>>(1, 0, 1, 1, 1);
  return 0;
}
