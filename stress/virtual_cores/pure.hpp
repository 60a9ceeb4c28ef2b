/// Whether an instruction does nothing but compute: it takes nothing from memory but from the stack
/// and from constants, and nothing from outside, such as a clock.
#pragma once

#include <ucontext.h>

#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::virtual_cores {

/// The instruction that `context` comes to next, on a core whose stack is `stack`. Only what is
/// known for sure is true: not what AVX encodes, string operations, or locked ones.
bool only_computes(const ucontext_t& context, Range stack);

}  // namespace irt::virtual_cores
