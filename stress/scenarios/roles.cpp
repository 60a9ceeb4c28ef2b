// Producers become consumers and back, each in its own rhythm.
#include "stress/scenarios/bodies.hpp"

void irt::stress::roles(Core& core) {
  bool producer = core.self().worker % 2 == 0;
  while (core.more()) {
    for (std::uint64_t left = 1 + core.random(48); left > 0 && core.more(); --left) {
      const bool moved = producer ? core.push() : core.pop().has_value();
      if (!moved) core.idle();
    }
    producer = !producer;
  }
}
