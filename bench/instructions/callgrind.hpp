/// Reads what valgrind's callgrind wrote.
#pragma once

#include <cstdint>
#include <istream>
#include <map>
#include <string>
#include <vector>

namespace irt::instructions {

/// Events by callgrind's names: Ir instructions, Dr and Dw data reads and writes, D1mr and D1mw
/// those that missed the first-level cache, DLmr and DLmw the last-level one, Ge locked operations.
using Events = std::map<std::string, std::uint64_t>;

struct Function {
  std::string name;
  Events own;  ///< without what it calls
};

/// The functions of a profile that was written with --compress-strings=no --compress-pos=no, those
/// with most instructions first. Throws std::runtime_error for anything else.
std::vector<Function> read_profile(std::istream& file);

/// Of all functions together.
Events total(const std::vector<Function>& functions);

}  // namespace irt::instructions
