// The litmus programs as the host finds them, compiled for virtual cores.

#include "tests/stress/checker/litmus_variables.hpp"

/// Those of the `part`-th group of paragraphs; none beyond the last.
extern "C" const irt::litmus::Program* irt_litmus_programs(unsigned part, unsigned* count) {
  using namespace irt::litmus;
  constexpr std::span<const Program> (*parts[])() = {races, order_and_fences, seq_cst};
  if (part >= std::size(parts)) return nullptr;
  const std::span<const Program> programs = parts[part]();
  *count = static_cast<unsigned>(programs.size());
  return programs.data();
}
extern "C" const int* irt_litmus_results() {
  return irt::litmus::r;
}
extern "C" int irt_litmus_final(unsigned variable) {
  const std::atomic<int>* variables[] = {&irt::litmus::x, &irt::litmus::y, &irt::litmus::z};
  return variables[variable]->load(std::memory_order_relaxed);
}
