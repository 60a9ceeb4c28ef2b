/// A part of a measurement or a search that several programs share.
#pragma once

#include <string>

namespace irt {

/// The part `index`, from 0, of `count`.
struct Shard {
  unsigned index = 0, count = 1;
};

/// "0/4": the first of four, of which the user said `--shard 0/4`. Throws UsageError.
Shard parse_shard(const std::string& text);

}  // namespace irt
