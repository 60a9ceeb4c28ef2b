// Enough of x86-64's encoding to tell what an instruction reads (Intel's manual, volume 2, 2.1 and
// appendix A).

#include "stress/virtual_cores/pure.hpp"

#include <array>
#include <cstring>
#include <string_view>

#include "stress/virtual_cores/internal.hpp"

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace irt::virtual_cores {

namespace {

/// What an opcode is followed by, if it is one of those that only compute.
enum class Form : char {
  unknown = '.',
  bare = 'b',     ///< nothing that touches memory
  stack = 's',    ///< it pushes or pops
  operand = 'm',  ///< a register or memory
  address = 'a',  ///< memory that is named and not touched: lea, nop
};

// A letter for each opcode, 16 in a row.
constexpr std::string_view one_byte =
    "mmmmbb..mmmmbb.."
    "mmmmbb..mmmmbb.."
    "mmmmbb..mmmmbb.."
    "mmmmbb..mmmmbb.."
    "................"
    "ssssssssssssssss"
    "...m....smsm...."
    "bbbbbbbbbbbbbbbb"
    "mm.mmmmmmmmm.a.m"
    "bbbbbbbbbb......"
    "........bb......"
    "bbbbbbbbbbbbbbbb"
    "mmss..mm.s......"
    "mmmm....mmmmmmmm"
    "bbbb....sb.b...."
    "......mm......mm";
constexpr std::string_view two_bytes =
    "................"
    "mmmmmmmmaaaaaaaa"
    "........mmmmmmmm"
    "................"
    "mmmmmmmmmmmmmmmm"
    "mmmmmmmmmmmmmmmm"
    "mmmmmmmmmmmmmmmm"
    "mmmmmmm.....mmmm"
    "bbbbbbbbbbbbbbbb"
    "mmmmmmmmmmmmmmmm"
    "....mm......mm.m"
    "......mmm.m.mmmm"
    "..m.mmm.bbbbbbbb"
    "mmmmmmmmmmmmmmmm"
    "mmmmmmmmmmmmmmmm"
    "mmmmmmm.mmmmmmm.";
static_assert(one_byte.size() == 256 && two_bytes.size() == 256);

constexpr bool is_prefix(std::uint8_t byte) {
  return byte == 0x66 || byte == 0xF2 || byte == 0xF3 || byte == 0x2E || byte == 0x3E;
}

std::uintptr_t register_of(const ucontext_t& context, unsigned number) {
  static constexpr std::array<int, 16> names{REG_RAX, REG_RCX, REG_RDX, REG_RBX, REG_RSP, REG_RBP,
                                             REG_RSI, REG_RDI, REG_R8,  REG_R9,  REG_R10, REG_R11,
                                             REG_R12, REG_R13, REG_R14, REG_R15};
  return static_cast<std::uintptr_t>(context.uc_mcontext.gregs[names.at(number)]);
}

/// Where the operand after an opcode is. The bytes of an immediate operand, which an address
/// relative to the next instruction needs, are not counted: up to four more.
std::uintptr_t address_of_operand(const ucontext_t& context, const std::uint8_t* at, unsigned rex) {
  const unsigned mode = *at >> 6U;
  const unsigned low = *at++ & 7U;
  std::uintptr_t address = 0;
  bool wide = mode == 2;
  bool relative = false;
  if (low == 4) {
    const unsigned index = (*at >> 3U & 7U) | (rex & 2U) << 2U;
    const unsigned base = *at & 7U;
    if (index != 4) address += register_of(context, index) << (*at >> 6U);
    ++at;
    if (base == 5 && mode == 0)
      wide = true;
    else
      address += register_of(context, base | (rex & 1U) << 3U);
  } else if (low == 5 && mode == 0) {
    wide = relative = true;
  } else {
    address += register_of(context, low | (rex & 1U) << 3U);
  }
  std::int32_t offset = 0;
  if (wide)
    std::memcpy(&offset, at, sizeof offset);
  else if (mode == 1)
    offset = static_cast<std::int8_t>(*at);  // NOLINT(bugprone-signed-char-misuse): it is signed
  if (relative) address += reinterpret_cast<std::uintptr_t>(at) + sizeof offset;
  return address + static_cast<std::uintptr_t>(std::intptr_t{offset});
}

}  // namespace

bool only_computes(const ucontext_t& context, Range stack) {
  constexpr std::uintptr_t red_zone = 128;
  constexpr std::uintptr_t widest = 64;
  const auto top = static_cast<std::uintptr_t>(context.uc_mcontext.gregs[REG_RSP]);
  if (top < stack.begin + red_zone || top > stack.end) return false;
  const auto* at = reinterpret_cast<const std::uint8_t*>(context.uc_mcontext.gregs[REG_RIP]);
  while (is_prefix(*at)) ++at;
  const unsigned rex = (*at & 0xF0U) == 0x40 ? *at++ : 0;
  const bool two = *at == 0x0F;
  if (two) ++at;
  const std::uint8_t opcode = *at++;
  Form form{two ? two_bytes[opcode] : one_byte[opcode]};
  if (two && (opcode == 0x38 || opcode == 0x3A)) {  // SSE in three bytes
    ++at;
    form = Form::operand;
  }
  if (form == Form::unknown) return false;
  if (form != Form::operand || *at >> 6U == 3) return true;
  const std::uintptr_t address = address_of_operand(context, at, rex);
  return (address >= top - red_zone && address + 8 <= stack.end) ||
         is_constant_of_a_module({address, address + widest});
}

}  // namespace irt::virtual_cores
// NOLINTEND(performance-no-int-to-ptr)
