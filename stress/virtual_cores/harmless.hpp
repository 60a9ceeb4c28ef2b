/// Which compiled functions cannot touch memory that the code shares.
#pragma once

#include <string_view>

namespace irt::virtual_cores {

/// Whether `name`, a symbol that a module leaves to others, is one of these: the runtime's own, the
/// machinery of exceptions and types, pure functions, and what asks for a property of the machine.
/// Everything else may touch shared memory, and nobody sees it.
bool is_harmless(std::string_view name);

}  // namespace irt::virtual_cores
