/// A litmus program: a few threads over shared variables, and what of its end is looked at.
#pragma once

namespace irt::litmus {

struct Program {
  const char* name;
  void (*threads[4])();
  unsigned results;     ///< of r[], from the first
  unsigned finals = 0;  ///< of x, y, z, from the first: their last values
};

}  // namespace irt::litmus
