// finds: nothing
#include <queues/reclamation/hyaline.hpp>
#include <tests/stress/checker/reclaiming.hpp>
// A third retires, too, and batches are of two nodes.

int main() {
  irt::reclaiming::one_reader<irt::Hyaline<irt::reclaiming::Node>>(1, 0, 2, 1, 2);
  return 0;
}
