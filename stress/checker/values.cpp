#include "stress/checker/values.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>

namespace irt::checker {

namespace {

std::string fitted(std::string text, std::size_t width) {
  if (text.size() > width) text = text.substr(0, width - 1) + "~";
  return text;
}

bool fits(std::string_view member, const Event& event) {
  if (member.starts_with("compare_exchange"))
    return event.kind == EventKind::modify || event.failed;
  if (member == "load" || member == "test") return event.kind == EventKind::load && !event.failed;
  if (member == "store" || member == "clear") return event.kind == EventKind::store;
  return event.kind == EventKind::modify;
}

// Where the expression ends at `end` begins: `slots_[i & mask].turn` before `.load`.
std::size_t begin_of_object(std::string_view line, std::size_t end) {
  int depth = 0;
  while (end > 0) {
    const char c = line[end - 1];
    if (c == ']' || c == ')') {
      ++depth;
    } else if (c == '[' || c == '(') {
      if (depth == 0) break;
      --depth;
    } else if (depth == 0 && std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' &&
               c != '.' && c != ':' && !(c == '>' && end > 1 && line[end - 2] == '-') &&
               !(c == '-' && end < line.size() && line[end] == '>')) {
      break;
    }
    --end;
  }
  return end;
}

// The call of an atomic object's member that `event` must be; empty if the line leaves a doubt.
std::string call_in(std::string_view line, const Event& event) {
  static constexpr std::array<std::string_view, 14> members{"load",
                                                            "store",
                                                            "exchange",
                                                            "compare_exchange_weak",
                                                            "compare_exchange_strong",
                                                            "fetch_add",
                                                            "fetch_sub",
                                                            "fetch_and",
                                                            "fetch_or",
                                                            "fetch_xor",
                                                            "test_and_set",
                                                            "test",
                                                            "clear",
                                                            "wait"};
  std::string found;
  for (const std::string_view member : members) {
    if (!fits(member, event)) continue;
    for (auto at = line.find(member); at != std::string_view::npos;
         at = line.find(member, at + 1)) {
      const std::size_t end = at + member.size();
      if (at == 0 || (line[at - 1] != '.' && line[at - 1] != '>') || end >= line.size() ||
          line[end] != '(')
        continue;
      if (!found.empty()) return "";
      const std::size_t begin = begin_of_object(line, at);
      found = line.substr(begin, end - begin);
    }
  }
  return found;
}

}  // namespace

std::string_view name_of(Order order) {
  static constexpr std::string_view names[] = {"relaxed", "consume", "acquire",
                                               "release", "acq_rel", "seq_cst"};
  return names[static_cast<unsigned>(order)];
}

std::string Values::of(Value value) {
  if (value >> 64 != 0)
    return fmt::format("{{{}, {}}}", word(static_cast<std::uint64_t>(value)),
                       word(static_cast<std::uint64_t>(value >> 64)));
  return word(static_cast<std::uint64_t>(value));
}

std::string Values::word(std::uint64_t word) {
  // Some algorithms keep marks in the bits that a pointer leaves unused.
  const std::uint64_t address = word & 0xFFFF'FFFF'FFF8U;
  const std::vector<Block>& blocks = heap_.blocks();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (address < blocks[i].address || address >= blocks[i].address + blocks[i].size) continue;
    named_.insert(i);
    std::string text = fmt::format("&{}", i + 1);
    if (address != blocks[i].address) text += fmt::format("+{}", address - blocks[i].address);
    if (word != address) text += "*";
    return text;
  }
  return word < 1'000'000 ? std::to_string(word) : fmt::format("{:#x}", word);
}

std::string Values::legend(unsigned threads, Symbols& symbols) const {
  const auto by = [threads](unsigned thread, std::uint16_t after) {
    if (thread < threads) return fmt::format("by thread {}", thread);
    return std::string(after == 0 ? "before the threads" : "after them");
  };
  std::string text;
  for (const std::size_t i : named_) {
    const Block& block = heap_.blocks()[i];
    text += fmt::format("  &{:<3} {} bytes, allocated at {} {}", i + 1, block.size,
                        symbols.name(block.allocated_at),
                        by(block.allocated_by, block.allocated_after));
    if (block.freed)
      text += fmt::format(", freed at {} {}", symbols.name(block.freed_at),
                          by(block.freed_by, block.freed_after));
    text += "\n";
  }
  return text;
}

std::string describe(const Event& event, Symbols& symbols, Values& values, std::size_t width) {
  if (event.kind == EventKind::choice) return event.option == 0 ? "as usual" : "by chance";
  const std::string order(name_of(event.order));
  if (event.kind == EventKind::fence) return "fence " + order;
  std::string result = (event.failed ? " fails, " : " ") + order;
  if (event.reads) result += (event.blocked ? " waits, sees " : " = ") + values.of(event.read);
  if (event.writes) result += " <- " + values.of(event.written);
  if (event.pc == nullptr) return (event.silent ? "clock" : "signal") + result;
  const std::string& line = symbols.at(event.pc).text;
  std::string code = call_in(line, event);
  if (code.empty()) code = line;
  if (code.empty())
    code = event.kind == EventKind::load    ? "load"
           : event.kind == EventKind::store ? "store"
                                            : "read-modify-write";
  return fitted(code, width - std::min(width / 2, result.size())) + result;
}

}  // namespace irt::checker
