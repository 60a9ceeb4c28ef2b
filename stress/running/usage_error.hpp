/// What the user asked for cannot be done.
#pragma once

#include <stdexcept>

namespace irt {

/// `what()` is one line: what was given, what is wrong, what would be right. Ends in exit code 2.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace irt
