#include "stress/virtual_cores/symbols/symbols.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <set>

#include "stress/virtual_cores/symbols/unannounced.hpp"

namespace irt::symbols {

namespace {

std::vector<std::string> output_of(const std::string& command) {
  std::vector<std::string> lines;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  if (pipe == nullptr) return lines;
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe.get()) != nullptr) {
    lines.emplace_back(buffer.data());
    while (!lines.back().empty() && lines.back().back() == '\n') lines.back().pop_back();
  }
  return lines;
}

// Whether it does to memory what an instrumented access never compiles to: atomic operations and
// fences are calls there. So it was written as assembly, or as an intrinsic that is no access to
// the compiler.
bool escapes_hooks(std::string_view instruction) {
  static constexpr std::array always{
      std::string_view("lock "),    std::string_view("mfence"),    std::string_view("sfence"),
      std::string_view("lfence"),   std::string_view("movnt"),     std::string_view("vmovnt"),
      std::string_view("maskmov"),  std::string_view("vmaskmov"),  std::string_view("vpmaskmov"),
      std::string_view("vscatter"), std::string_view("vpscatter"), std::string_view("cmpxchg"),
      std::string_view("xadd"),     std::string_view("xbegin"),    std::string_view("rdtsc"),
      std::string_view("syscall")};
  const bool exchanges =
      instruction.starts_with("xchg") && instruction.find('(') != std::string_view::npos;
  return exchanges || std::ranges::any_of(always, [instruction](std::string_view name) {
           return instruction.starts_with(name);
         });
}

bool writes(std::string_view instruction) {
  return instruction.find("fence") == std::string_view::npos && !instruction.starts_with("rdtsc") &&
         !instruction.starts_with("xbegin");
}

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

}  // namespace

bool is_foreign(const std::string& file) {
  static constexpr std::array folders{"/c++/",     "/bits/",  "/catch2/",
                                      "/doctest/", "/gtest/", "/boost/test/"};
  return std::ranges::any_of(
      folders, [&file](const char* folder) { return file.find(folder) != std::string::npos; });
}

const Line& Symbols::at(const void* pc) {
  const auto known = lines_.find(pc);
  if (known == lines_.end()) look_up({pc});
  return lines_[pc];
}

void Symbols::look_up(const std::vector<const void*>& pcs) {
  std::map<std::uintptr_t, const void*> asked;
  for (const void* pc : pcs)
    if (lines_.try_emplace(pc).second && pc != nullptr)
      asked[reinterpret_cast<std::uintptr_t>(pc) - module_.load_offset() - 1] = pc;
  if (asked.empty()) return;
  std::string command = "addr2line -aCfi -e " + quoted(module_.file());
  for (const auto& [address, pc] : asked) command += fmt::format(" {:x}", address);
  // Each address as 0x..., then pairs of lines, innermost first: a function, then file:line.
  const void* current = nullptr;
  std::vector<std::string> frames;
  const auto finish = [&] {
    if (current != nullptr) lines_[current] = line_of(frames);
    frames.clear();
  };
  for (const std::string& text : output_of(command + " 2>/dev/null")) {
    if (!text.starts_with("0x") || frames.size() % 2 != 0) {
      frames.push_back(text);
      continue;
    }
    finish();
    const auto found = asked.find(std::strtoull(text.c_str(), nullptr, 16));
    current = found == asked.end() ? nullptr : found->second;
  }
  finish();
}

Line Symbols::line_of(const std::vector<std::string>& frames) {
  Line line;
  for (std::size_t i = 0; i + 1 < frames.size(); i += 2) {
    const std::string& place = frames[i + 1];
    const std::size_t colon = place.rfind(':');
    if (line.function.empty() && frames[i] != "??") line.function = frames[i];
    if (colon == std::string::npos || place.starts_with("??")) continue;
    Line frame{frames[i], place.substr(0, colon), 0, ""};
    frame.number = static_cast<unsigned>(std::strtoul(place.c_str() + colon + 1, nullptr, 10));
    const bool foreign = is_foreign(frame.file);
    if (line.file.empty() || !foreign) line = frame;
    if (!foreign) break;
  }
  if (line.number == 0) return line;
  auto [source, fresh] = sources_.try_emplace(line.file);
  if (fresh) {
    std::ifstream in(line.file);
    for (std::string text; std::getline(in, text);) source->second.push_back(text);
  }
  if (line.number <= source->second.size()) {
    line.text = source->second[line.number - 1];
    line.text.erase(0, line.text.find_first_not_of(" \t"));
  }
  return line;
}

UnseenInstructions Symbols::unseen_instructions() {
  const std::string file = quoted(module_.file());
  const std::vector<std::string> code =
      output_of("objdump -d -w --no-show-raw-insn " + file + " 2>/dev/null");
  struct Unseen {
    const void* after;
    std::string instruction;
    bool store;
  };
  std::vector<Unseen> found;
  const auto add = [&](std::uint64_t at, std::string_view instruction, bool store) {
    const std::uintptr_t address = module_.load_offset() + at;
    // NOLINTNEXTLINE(performance-no-int-to-ptr): code is known by its address here
    found.push_back({reinterpret_cast<const void*>(address + 1), std::string(instruction), store});
  };
  for (const std::string& line : code) {
    const std::size_t tab = line.find('\t');
    if (tab == std::string::npos) continue;
    const std::string_view instruction = std::string_view(line).substr(tab + 1);
    if (!escapes_hooks(instruction)) continue;
    const std::size_t words = instruction.starts_with("lock ") ? instruction.find(' ') + 1 : 0;
    const std::size_t end = instruction.find_first_of(" \t", words);
    add(std::strtoull(line.c_str(), nullptr, 16), instruction.substr(0, end), writes(instruction));
  }
  for (const Unannounced& access :
       unannounced(code, output_of("objdump -h -w " + file + " 2>/dev/null")))
    if (!escapes_hooks(access.name + " ")) add(access.address, access.name, access.writes);

  std::vector<const void*> pcs;
  pcs.reserve(found.size());
  for (const Unseen& unseen : found) pcs.push_back(unseen.after);
  look_up(pcs);
  std::set<std::string> places;
  std::set<std::string> stores;
  for (const Unseen& unseen : found) {
    const std::string place = fmt::format("{} at {}", unseen.instruction, name(unseen.after));
    places.insert(place);
    if (unseen.store) stores.insert(place);
  }
  return {{places.begin(), places.end()}, stores.size()};
}

std::string Symbols::name(const void* pc) {
  const Line& line = at(pc);
  if (pc == nullptr) return "the scenario";
  if (line.number == 0)
    return fmt::format("{} (machine code at {:#x})",
                       line.function.empty() ? "a function without lines" : line.function,
                       reinterpret_cast<std::uintptr_t>(pc) - module_.load_offset() - 1);
  return fmt::format("{}:{}", line.file.substr(line.file.rfind('/') + 1), line.number);
}

}  // namespace irt::symbols
