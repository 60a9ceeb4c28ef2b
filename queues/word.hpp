/// An element as a 64-bit word and back, for queues that store one kind of thing only.
#pragma once

#include <cstdint>
#include <cstring>

namespace irt {

/// The bits of `element`, zeros above them.
template <class T>
std::uint64_t word_of(T element) {
  std::uint64_t word = 0;
  std::memcpy(&word, &element, sizeof element);
  return word;
}

/// The element whose bits `word` has.
template <class T>
T element_of(std::uint64_t word) {
  T element;
  std::memcpy(&element, &word, sizeof element);
  return element;
}

}  // namespace irt
