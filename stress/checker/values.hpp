/// What a report calls values and the accesses that read or wrote them.
#pragma once

#include <set>
#include <string>

#include "stress/checker/execution.hpp"
#include "stress/virtual_cores/symbols/symbols.hpp"

namespace irt::checker {

using symbols::Symbols;

/// "acquire".
std::string_view name_of(Order order);

/// Blocks of the heap by their number, so that a reader can tell nodes apart.
class Values {
 public:
  explicit Values(const Heap& heap) : heap_(heap) {}

  /// "42", "&4", "&4+8", "&4*" with bits set in a pointer, "{&4, 7}".
  std::string of(Value value);
  /// Remembers `address`' block as one that was named, if it is in one.
  void mention(std::uintptr_t address) { word(address); }
  /// A line for each block that was named: its size, where it was allocated and freed. Empty if
  /// none was.
  [[nodiscard]] std::string legend(unsigned threads, Symbols& symbols) const;

 private:
  std::string word(std::uint64_t word);
  const Heap& heap_;
  std::set<std::size_t> named_;
};

/// "head_.load acquire = &4": what the event did, by its line of source. At most about `width`
/// characters where the line can be cut.
std::string describe(const Event& event, Symbols& symbols, Values& values, std::size_t width);

}  // namespace irt::checker
