#include "stress/virtual_cores/symbols/instruction.hpp"

#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "stress/virtual_cores/sanitizer_abi.hpp"

namespace irt::symbols {

namespace {

using namespace std::string_view_literals;

template <std::size_t n>
bool starts_with_any(std::string_view text, const std::array<std::string_view, n>& starts) {
  return std::ranges::any_of(starts,
                             [text](std::string_view start) { return text.starts_with(start); });
}

/// A general register, and how many bytes of it; 0 if it is none.
std::pair<std::uint8_t, std::uint8_t> register_of(std::string_view name) {
  static constexpr std::array eight{"rax"sv, "rcx"sv, "rdx"sv, "rbx"sv,
                                    "rsp"sv, "rbp"sv, "rsi"sv, "rdi"sv};
  static constexpr std::array low{"al"sv,  "cl"sv,  "dl"sv,  "bl"sv,
                                  "spl"sv, "bpl"sv, "sil"sv, "dil"sv};
  static constexpr std::array high{"ah"sv, "ch"sv, "dh"sv, "bh"sv};
  for (std::uint8_t i = 0; i < 8; ++i) {
    if (name == eight[i]) return {i, 8};
    if (name.size() == 3 && name[0] == 'e' && name.substr(1) == eight[i].substr(1)) return {i, 4};
    if (name == eight[i].substr(1)) return {i, 2};
    if (name == low[i] || (i < 4 && name == high[i])) return {i, 1};
  }
  if (name.size() < 2 || name[0] != 'r' || name[1] < '0' || name[1] > '9') return {no_register, 0};
  char* end = nullptr;
  const std::string digits(name.substr(1));
  const auto number = static_cast<std::uint8_t>(std::strtoul(digits.c_str(), &end, 10));
  const std::uint8_t bytes = *end == 'd' ? 4 : *end == 'w' ? 2 : *end == 'b' ? 1 : 8;
  return {number, bytes};
}

std::int64_t number_of(const std::string& text) {
  const bool negative = !text.empty() && text[0] == '-';
  const auto value = std::strtoull(text.c_str() + (negative ? 1 : 0), nullptr, 0);
  return static_cast<std::int64_t>(negative ? 0 - value : value);
}

Operand parse_operand(std::string text, std::int64_t commented) {
  Operand operand;
  if (text.empty()) return operand;
  if (text[0] == '*') text.erase(0, 1);
  if (text[0] == '$') {
    operand.kind = Operand::Kind::immediate;
    operand.offset = number_of(text.substr(1));
    return operand;
  }
  const std::size_t open = text.find('(');
  if (text[0] == '%' && open == std::string::npos && text.find(':') == std::string::npos) {
    operand.kind = Operand::Kind::reg;
    std::tie(operand.base, operand.bytes) = register_of(std::string_view(text).substr(1));
    return operand;
  }
  operand.kind = Operand::Kind::memory;
  if (const std::size_t colon = text.find(':'); colon != std::string::npos) {
    operand.segment = text.starts_with("%fs") || text.starts_with("%gs");
    if (operand.segment) return operand;
    return parse_operand(text.substr(colon + 1), commented);
  }
  if (open == std::string::npos) {  // a jump's address, or absolute memory
    operand.kind = Operand::Kind::other;
    return operand;
  }
  operand.offset = number_of(text.substr(0, open));
  std::string inside = text.substr(open + 1, text.find(')', open) - open - 1);
  std::array<std::string, 3> parts;
  for (std::size_t i = 0; i < 3 && !inside.empty(); ++i) {
    const std::size_t comma = inside.find(',');
    parts[i] = inside.substr(0, comma);
    inside = comma == std::string::npos ? "" : inside.substr(comma + 1);
  }
  if (parts[0] == "%rip") {
    operand.absolute = true;
    operand.offset = commented;
    return operand;
  }
  if (!parts[0].empty()) operand.base = register_of(std::string_view(parts[0]).substr(1)).first;
  if (!parts[1].empty()) operand.index = register_of(std::string_view(parts[1]).substr(1)).first;
  if (!parts[2].empty()) operand.scale = static_cast<std::uint8_t>(number_of(parts[2]));
  return operand;
}

/// Bytes that a use of memory has at least.
unsigned bytes_of(const Instruction& instruction) {
  std::string_view name = instruction.name;
  for (const Operand& operand : instruction.operands)
    if (operand.kind == Operand::Kind::reg && operand.bytes != 0 && !name.starts_with("movz") &&
        !name.starts_with("movs") && !name.starts_with("cvt") && !name.starts_with("sh") &&
        !name.starts_with("sa") && !name.starts_with("ro"))
      return operand.bytes;
  static constexpr std::array sixteen{"movups"sv, "movaps"sv, "movdqu"sv,
                                      "movdqa"sv, "movupd"sv, "movapd"sv};
  static constexpr std::array eight{"movq"sv, "movsd"sv, "movlp"sv, "movhp"sv};
  static constexpr std::array four{"movd"sv, "movss"sv};
  if (starts_with_any(name, sixteen)) return 16;
  if (starts_with_any(name, eight)) return 8;
  if (starts_with_any(name, four)) return 4;
  if (name.starts_with("movz") || (name.starts_with("movs") && name.size() == 6))
    return name[4] == 'b' ? 1 : 2;
  const bool has_immediate = std::ranges::any_of(instruction.operands, [](const Operand& operand) {
    return operand.kind == Operand::Kind::immediate;
  });
  if (!has_immediate) return 1;
  return name.ends_with('q') ? 8 : name.ends_with('l') ? 4 : name.ends_with('w') ? 2 : 1;
}

/// Compilers put other code behind such a call. Those that the runtime takes over have its prefix.
bool never_returns(std::string_view function) {
  static constexpr std::string_view prefix = "irt_vc_";
  if (function.starts_with(prefix)) function.remove_prefix(prefix.size());
  static constexpr std::array ends{"__cxa_throw"sv,
                                   "__cxa_rethrow"sv,
                                   "_Unwind_Resume"sv,
                                   "__cxa_bad_cast"sv,
                                   "_ZSt9terminatev"sv,
                                   "__assert_fail"sv,
                                   "abort"sv,
                                   "exit"sv,
                                   "_exit"sv};
  return std::ranges::find(ends, function) != ends.end() ||
         (function.starts_with("_ZSt") && function.find("__throw_") != std::string_view::npos) ||
         function == "__cxa_throw_bad_array_new_length";
}

}  // namespace

bool Instruction::falls_through() const {
  return !(is_call() && never_returns(target)) && !is("jmp") && !is("notrack jmp") && !is("ret") &&
         !is("repz ret") && !is("ud2") && !is("hlt");
}

bool Instruction::only_pads() const {
  return operands.size() == 2 && operands[0].kind == Operand::Kind::reg &&
         operands[1].kind == Operand::Kind::reg && operands[0].base == operands[1].base;
}

bool Instruction::only_reads() const {
  static constexpr std::array readers{
      "cmp"sv, "test"sv, "ucomis"sv, "comis"sv, "vucomis"sv, "vcomis"sv, "push"sv, "ptest"sv,
      "fld"sv, "fild"sv, "fadd"sv,   "fsub"sv,  "fmul"sv,    "fdiv"sv,   "fcom"sv, "ldmxcsr"sv};
  if (starts_with_any(name, readers) || is_call() || is_jump()) return true;
  if (name == "bt" || name == "btl" || name == "btq") return true;
  static constexpr std::array products{"mul"sv, "imul"sv, "div"sv, "idiv"sv};
  return operands.size() == 1 && starts_with_any(name, products);
}

std::optional<Instruction> parse_instruction(const std::string& line) {
  const std::size_t tab = line.find(":\t");
  if (tab == std::string::npos) return std::nullopt;
  Instruction result;
  result.address = std::strtoull(line.c_str(), nullptr, 16);
  std::string text = line.substr(tab + 2);
  std::int64_t commented = 0;
  if (const std::size_t comment = text.find(" # "); comment != std::string::npos) {
    commented = static_cast<std::int64_t>(std::strtoull(text.c_str() + comment + 3, nullptr, 16));
    text.erase(comment);
  }
  while (!text.empty() && text.back() == ' ') text.pop_back();
  // Prefixes are words before the name.
  std::size_t at = 0;
  for (;;) {
    const std::size_t space = text.find(' ', at);
    const std::string_view word = std::string_view(text).substr(at, space - at);
    static constexpr std::array prefixes{"lock"sv, "rep"sv,     "repz"sv,   "repnz"sv, "data16"sv,
                                         "cs"sv,   "notrack"sv, "addr32"sv, "bnd"sv};
    const bool prefix = std::ranges::find(prefixes, word) != prefixes.end();
    result.name += (result.name.empty() ? "" : " ") + std::string(word);
    at = space == std::string::npos ? text.size() : text.find_first_not_of(' ', space);
    if (at == std::string::npos) at = text.size();
    if (!prefix || at == text.size()) break;
  }
  const std::string rest = text.substr(at);
  if ((result.is_call() || result.is_jump()) && rest.find('<') != std::string::npos) {
    result.target_address = std::strtoull(rest.c_str(), nullptr, 16);
    const std::size_t open = rest.find('<');
    result.target = rest.substr(open + 1, rest.find_first_of("+@>", open) - open - 1);
    return result;
  }
  int depth = 0;
  std::string operand;
  for (const char c : rest + ",") {
    if (c == '(') ++depth;
    if (c == ')') --depth;
    if (c != ',' || depth != 0) {
      operand += c;
      continue;
    }
    if (!operand.empty()) result.operands.push_back(parse_operand(operand, commented));
    operand.clear();
  }
  return result;
}

std::vector<MemoryUse> memory_uses(const Instruction& instruction) {
  static constexpr std::array none{"lea"sv,     "nop"sv,        "prefetch"sv, "endbr"sv,
                                   "clflush"sv, "data16 nop"sv, "cs nop"sv,   "data16 cs nop"sv};
  const std::string_view name = instruction.name;
  if (starts_with_any(name, none) || name.find("nop") != std::string_view::npos) return {};
  std::vector<MemoryUse> uses;
  const std::size_t word = name.rfind(' ') == std::string_view::npos ? 0 : name.rfind(' ') + 1;
  static constexpr std::array strings{"movs"sv, "stos"sv, "cmps"sv, "scas"sv, "lods"sv};
  if (word != 0 && starts_with_any(name.substr(word), strings)) {
    for (const Operand& operand : instruction.operands)
      if (operand.kind == Operand::Kind::memory)
        uses.push_back({operand, 1,
                        &operand == &instruction.operands.back() &&
                            name.find("cmps") == std::string_view::npos &&
                            name.find("scas") == std::string_view::npos});
    return uses;
  }
  for (const Operand& operand : instruction.operands) {
    if (operand.kind != Operand::Kind::memory || operand.segment) continue;
    const bool last = &operand == &instruction.operands.back();
    uses.push_back({operand, bytes_of(instruction), last && !instruction.only_reads()});
  }
  return uses;
}

bool is_hook(const std::string& target) {
  return target.starts_with("__tsan_") && target.find("atomic") == std::string::npos;
}

bool stands_for_instruction(const std::string& target) {
  return target.starts_with("irt_vc_cpu_");
}

std::optional<Announcement> announcement_of(const std::string& target) {
  struct Hook {
    std::string_view name;
    Announcement announces;
  };
  constexpr bool read = false, write = true;
#define IRT_PLAIN(name, kind, bytes) Hook{"__tsan_" #name, {bytes, kind}},
  static constexpr std::array hooks{IRT_SANITIZER_PLAIN(IRT_PLAIN)  //
                                    Hook{"__tsan_read_range", {-1, read}},
                                    Hook{"__tsan_write_range", {-1, write}},
                                    Hook{"__tsan_vptr_read", {8, read}},
                                    Hook{"__tsan_vptr_update", {8, write}}};
#undef IRT_PLAIN
  const auto* hook = std::ranges::find(hooks, target, &Hook::name);
  return hook == hooks.end() ? std::nullopt : std::optional(hook->announces);
}

}  // namespace irt::symbols
