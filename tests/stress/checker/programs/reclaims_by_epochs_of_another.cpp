// finds: nothing
#include <queues/reclamation/epochs.hpp>
#include <tests/stress/checker/reclaiming.hpp>
// The epoch is moved on by a third.

int main() {
  irt::reclaiming::one_reader<irt::Epochs<irt::reclaiming::Node>>(1, 3, 0, 1, 3);
  return 0;
}
