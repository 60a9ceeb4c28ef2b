/// The programs of the scenarios: one file each, named after it; those of `parked` stand together.
#pragma once

#include "stress/scenarios/core.hpp"

namespace irt::stress {

void bulk(Core& core);
void bursts(Core& core);
void built_and_dropped(Core& core);
void full_ring(Core& core);
void left_inside(Core& core);
void mix(Core& core);
void near_empty(Core& core);
void parked(Core& core);
void parked_closed_early(Core& core);
void parked_for_a_while(Core& core);
void ping_pong(Core& core);
void renderer(Core& core);
void roles(Core& core);

}  // namespace irt::stress
