/// What every reader of scenes throws.
#pragma once

#include <stdexcept>

namespace irt {

/// A scene cannot be had. `what()` is one line: what was given, what is wrong, what would be right.
struct SceneError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace irt
