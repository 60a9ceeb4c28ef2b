// finds: nothing
#include <queues/reclamation/quiescent_states.hpp>
#include <tests/stress/checker/reclaiming.hpp>
// A reader, and one who replaces what it reads.

int main() {
  irt::reclaiming::one_reader<irt::QuiescentStates<irt::reclaiming::Node>>(2, 0, 3, 0, 0);
  return 0;
}
