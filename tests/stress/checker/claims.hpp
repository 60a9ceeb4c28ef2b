/// Claims that decide which clients a queue may have.
#pragma once

#include "queues/work_queue.hpp"

namespace irt::checker {

inline constexpr Claims anything{.bounded = true};
inline constexpr Claims single{
    .bounded = true, .producers = Callers::one, .consumers = Callers::one};

}  // namespace irt::checker
