/// What a render thread's time goes into.
#pragma once

#include <cstddef>
#include <cstdint>

namespace irt {

enum class Activity : std::uint8_t {
  task,     ///< everything that is done for a task; holds trace, shade and add
  trace,    ///< traversal and intersection
  shade,    ///< the application
  add,      ///< pushes, one after the other
  get,      ///< a pop that found a task
  idle,     ///< pops that found nothing, and waiting between them
  barrier,  ///< until the frame begins, or ends, for all
  frame,    ///< all of a frame; holds the phases below
  generate,
  render,
  output,
};

inline constexpr std::size_t activities = 11;

}  // namespace irt
