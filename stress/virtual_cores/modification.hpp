/// What read-modify-writes compute, by the names of std::atomic's members.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace irt::virtual_cores {

enum class Modification : std::uint8_t {
  exchange,
  fetch_add,
  fetch_sub,
  fetch_and,
  fetch_or,
  fetch_xor,
  fetch_nand
};

/// The result of `modification` on `size` bytes; `Word` is unsigned and has as many at least.
template <class Word>
Word apply(Modification modification, Word old_value, Word operand, std::size_t size) {
  const Word mask = size == sizeof(Word) ? ~Word{0} : (Word{1} << (8 * size)) - 1;
  switch (modification) {
    case Modification::exchange:
      return operand & mask;
    case Modification::fetch_add:
      return (old_value + operand) & mask;
    case Modification::fetch_sub:
      return (old_value - operand) & mask;
    case Modification::fetch_and:
      return old_value & operand;
    case Modification::fetch_or:
      return old_value | operand;
    case Modification::fetch_xor:
      return old_value ^ operand;
    case Modification::fetch_nand:
      return ~(old_value & operand) & mask;
  }
  std::abort();
}

}  // namespace irt::virtual_cores
