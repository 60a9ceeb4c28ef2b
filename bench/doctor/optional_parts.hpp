/// Which parts that rest on an optional library this build has.
#pragma once

#include <span>
#include <string_view>

namespace irt::doctor {

struct OptionalPart {
  std::string_view name;
  std::string_view package;  ///< the Debian package that switches it on
  bool on;
};

/// As found when the build was configured.
std::span<const OptionalPart> optional_parts();

}  // namespace irt::doctor
