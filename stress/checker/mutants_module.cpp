// The mutants of stress/mutants on virtual cores.

#include "stress/mutants/mutants.hpp"

extern "C" const irt::stress::Mutant* irt_mutants(std::size_t* count);
extern "C" const irt::stress::Mutant* irt_mutants(std::size_t* count) {
  const auto all = irt::stress::mutants();
  *count = all.size();
  return all.data();
}
