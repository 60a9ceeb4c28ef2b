#include "renderer/scene/readers/ply.hpp"

#include "tests/renderer/scene/fuzz/verdict.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  return irt::fuzz::verdict(
      [&] { irt::fuzz::demand_sound(irt::parse_ply(irt::fuzz::text_of(data, size)), 1); });
}
