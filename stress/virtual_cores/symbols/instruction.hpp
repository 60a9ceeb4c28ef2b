/// x86-64 instructions as objdump(1) prints them (AT&T syntax): what they do to memory.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace irt::symbols {

/// Numbers of the general registers, of any width.
enum Register : std::uint8_t { rax, rcx, rdx, rbx, rsp, rbp, rsi, rdi, r8 };
inline constexpr unsigned registers = 16;  ///< r8 to r15 follow
inline constexpr std::uint8_t no_register = 255;

struct Operand {
  enum class Kind : std::uint8_t { reg, memory, immediate, other } kind = Kind::other;
  std::uint8_t base = no_register;  ///< or the register itself
  std::uint8_t index = no_register;
  std::uint8_t scale = 1;
  std::uint8_t bytes = 0;   ///< of a register; 0: no general one
  bool absolute = false;    ///< `offset` is an address in the file (rip-relative)
  bool segment = false;     ///< of the thread's own block, or another segment
  std::int64_t offset = 0;  ///< or the immediate itself
};

struct Instruction {
  std::uint64_t address = 0;  ///< in the file
  std::string name;           ///< with its prefixes
  std::vector<Operand> operands;
  std::string target;                ///< of a call or jump: the symbol, without offset and `@plt`
  std::uint64_t target_address = 0;  ///< 0: not known

  [[nodiscard]] bool is(std::string_view start) const { return name.starts_with(start); }
  [[nodiscard]] bool is_call() const { return is("call"); }
  [[nodiscard]] bool is_jump() const { return is("j") || is("notrack jmp"); }
  /// Whether the next instruction can follow.
  [[nodiscard]] bool falls_through() const;
  /// `xchg %ax,%ax`, which is written for `nop`.
  [[nodiscard]] bool only_pads() const;
  /// Writes none of its operands.
  [[nodiscard]] bool only_reads() const;
};

/// What an instruction does to memory that is named by an operand, or by rdi and rsi.
struct MemoryUse {
  Operand place;
  unsigned bytes = 1;  ///< at least
  bool writes = false;
};

/// Parses "  1139:\tmov    %rdi,0x8(%rax)".
std::optional<Instruction> parse_instruction(const std::string& line);

/// No use of it: `lea`, `nop`, prefetches, pushes and pops.
std::vector<MemoryUse> memory_uses(const Instruction& instruction);

/// Whether a call of `target` is the sanitizer's, and no atomic operation.
bool is_hook(const std::string& target);

/// A plain access that a hook announces.
struct Announcement {
  std::int64_t bytes;  ///< -1: rsi says it
  bool writes;
};
std::optional<Announcement> announcement_of(const std::string& target);

/// Whether a call stands for one instruction (prelude.hpp), across which compilers move accesses.
bool stands_for_instruction(const std::string& target);

}  // namespace irt::symbols
