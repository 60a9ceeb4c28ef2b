/// What the instructions of a function do to values that are known by name.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "stress/virtual_cores/symbols/instruction.hpp"
#include "stress/virtual_cores/symbols/value_names.hpp"

namespace irt::symbols {

struct Section {
  std::uint64_t begin, end;  ///< addresses in the file
};

struct Sections {
  std::vector<Section> writable;   ///< where memory that may change lies in the file
  std::vector<Section> constants;  ///< and where that lies which never does

  [[nodiscard]] bool may_change(std::int64_t address) const;
  [[nodiscard]] bool never_changes(std::int64_t address) const;
};

/// What registers and the stack hold.
struct Frame {
  std::array<NamedValue, registers> in{};
  std::map<std::int64_t, NamedValue>
      slots{};  ///< 8 bytes of the stack each, by distance from its top
};

class Evaluation {
 public:
  explicit Evaluation(const Sections& sections) : sections_(sections) {}

  ValueNames& names() { return names_; }

  NamedValue address_of(const Frame& frame, const Operand& operand);

  /// An instruction that is no call, no jump and no return.
  void step(Frame& frame, const Instruction& at);

  /// What a call may change is known no longer.
  void call(Frame& frame, const Instruction& at);

  /// The same of a call that stands for one instruction.
  void single(Frame& frame, const Instruction& at);

 private:
  NamedValue sum(NamedValue a, NamedValue b);
  NamedValue read(Frame& frame, const Operand& operand, const Instruction& at);
  void write(Frame& frame, const Operand& operand, NamedValue value, const Instruction& at);
  void compute(Frame& frame, const Instruction& at);
  NamedValue result_of(Frame& frame, const Instruction& at, NamedValue own);

  const Sections& sections_;
  ValueNames names_;
};

}  // namespace irt::symbols
