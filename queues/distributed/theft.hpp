/// How an attempt to steal ended.
#pragma once

#include <cstdint>

namespace irt {

enum class Theft : std::uint8_t {
  taken,  ///< with a word
  empty,  ///< no word was there
  lost,   ///< another call took the word that was there
};

}  // namespace irt
