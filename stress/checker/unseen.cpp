#include "stress/checker/unseen.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <utility>

#include "stress/virtual_cores/symbols/symbols.hpp"

namespace irt::checker {

namespace {

struct Found {
  Unseen unseen;
  std::size_t stores = 0;  ///< among the instructions
};

/// Whether an instruction that nothing announces, as Symbols names it, is an atomic operation.
bool is_atomic(const std::string& instruction) {
  for (const char* name : {"lock ", "xchg", "cmpxchg", "xadd"})
    if (instruction.starts_with(name)) return true;
  return false;
}

Found find(virtual_cores::Module& module) {
  symbols::UnseenInstructions instructions = symbols::Symbols(module).unseen_instructions();
  Found found{{.calls = module.unseen_calls(), .instructions = std::move(instructions.places)},
              instructions.stores};
  Unseen& unseen = found.unseen;
  if (!unseen.calls.empty())
    unseen.unproved = "it calls compiled code";
  else if (found.stores != 0)
    unseen.unproved = fmt::format(
        "it makes {} store{} that no hook announces, so that nobody knows what was written",
        found.stores, found.stores == 1 ? "" : "s");
  else if (!unseen.instructions.empty())
    unseen.unproved = "not all that it does to memory is seen";
  const auto hidden = std::ranges::find_if(unseen.instructions, is_atomic);
  if (hidden != unseen.instructions.end())
    unseen.refused = "its atomic operations are assembly, which nothing announces (" + *hidden +
                     "): whatever was found might not be its own";
  return found;
}

const Found& found_of(virtual_cores::Module& module) {
  static std::map<std::pair<std::string, std::uintptr_t>, Found> known;
  const std::pair key{module.file(), module.load_offset()};
  auto found = known.find(key);
  if (found == known.end()) found = known.emplace(key, find(module)).first;
  return found->second;
}

}  // namespace

const Unseen& unseen_of(virtual_cores::Module& module) {
  return found_of(module).unseen;
}

Limits as_seen(Limits limits, virtual_cores::Module& module) {
  const Found& found = found_of(module);
  if (!found.unseen.calls.empty() || found.stores != 0) limits.uninitialised = false;
  return limits;
}

std::string words(const Unseen& unseen) {
  std::string text;
  if (!unseen.calls.empty())
    text += fmt::format(
        "\nNot seen by the checker, for it is compiled code, so nothing is proved: {}\n",
        fmt::join(unseen.calls, ", "));
  if (!unseen.instructions.empty())
    text += fmt::format(
        "\nNot seen by the checker, for no compiler announces it, so nothing is proved: {}\n",
        fmt::join(unseen.instructions, ", "));
  return text;
}

}  // namespace irt::checker
