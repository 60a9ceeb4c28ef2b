#include "stress/running/shard.hpp"

#include <cstdio>

#include "stress/running/usage_error.hpp"

namespace irt {

Shard parse_shard(const std::string& text) {
  Shard shard;
  char rest = 0;
  // NOLINTNEXTLINE(cert-err34-c): nine digits fit
  if (std::sscanf(text.c_str(), "%9u/%9u%c", &shard.index, &shard.count, &rest) != 2 ||
      shard.index >= shard.count) {
    throw UsageError("--shard " + text + ": it is i/n with i from 0 to n - 1, as 0/4");
  }
  return shard;
}

}  // namespace irt
