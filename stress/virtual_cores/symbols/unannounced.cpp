#include "stress/virtual_cores/symbols/unannounced.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "stress/virtual_cores/symbols/evaluation.hpp"
#include "stress/virtual_cores/symbols/instruction.hpp"
#include "stress/virtual_cores/symbols/value_names.hpp"

namespace irt::symbols {

namespace {

struct Announced {
  NamedValue begin;
  std::int64_t bytes = 0;
  bool writes = false;
  bool used = false;  ///< an access has followed
  friend bool operator==(const Announced&, const Announced&) = default;
};

struct State : Frame {
  bool reached = false;
  std::vector<Announced> announced{};
};

struct Block {
  std::size_t first = 0, end = 0;  ///< instructions
  std::vector<std::size_t> next{};
  bool entered = false;  ///< by a jump or from above; if not, by the unwinder or a table
  State before{};
};

class Function {
 public:
  Function(std::vector<Instruction> code, const Sections& sections, bool results_on_stack)
      : code_(std::move(code)),
        sections_(sections),
        results_on_stack_(results_on_stack),
        evaluation_(sections),
        names_(evaluation_.names()) {}

  std::vector<Unannounced> run() {
    divide();
    State entry;
    entry.reached = true;
    for (std::uint8_t r = 0; r < registers; ++r) entry.in[r] = names_.of("entry", {0, r});
    entry.in[rsp] = {stack_root, 0};
    entry.in[rdi] = {argument_root, 0};
    std::set<std::size_t> found = interpret_from(0, entry);
    // The unwinder and tables of jumps enter other blocks, each in the state of one of the calls or
    // jumps. An access that is announced is so in one of these at least.
    std::vector<State> entries = std::move(left_);
    for (std::size_t block = 1; block < blocks_.size(); ++block) {
      if (blocks_[block].entered || is_padding(blocks_[block])) continue;
      std::optional<std::set<std::size_t>> in_all;
      for (std::size_t i = 0; i < entries.size() && (!in_all || !in_all->empty()); ++i) {
        left_.clear();
        const std::set<std::size_t> here = interpret_from(block, entries[i]);
        if (in_all)
          std::erase_if(*in_all, [&](std::size_t access) { return !here.contains(access); });
        else
          in_all = here;
        // Handlers call, too, and what they call may throw.
        if (in_all->empty() || i == 0) std::ranges::move(left_, std::back_inserter(entries));
      }
      if (in_all) found.insert(in_all->begin(), in_all->end());
    }
    std::vector<Unannounced> result;
    for (const std::size_t i : found) {
      const bool writes = writes_[i];
      if (returns_argument_ && results_on_stack_ && to_argument_.contains(i)) continue;
      result.push_back({code_[i].address, code_[i].name, writes});
    }
    return result;
  }

 private:
  void divide() {
    std::set<std::uint64_t> starts;
    std::map<std::uint64_t, std::size_t> at;
    for (std::size_t i = 0; i < code_.size(); ++i) {
      const Instruction& instruction = code_[i];
      at[instruction.address] = i;
      if (!instruction.is_jump() && instruction.falls_through()) continue;
      if (instruction.is_jump()) starts.insert(instruction.target_address);
      if (i + 1 < code_.size()) starts.insert(code_[i + 1].address);
    }
    std::map<std::size_t, std::size_t> block_at;
    for (std::size_t i = 0; i < code_.size(); ++i) {
      if (i == 0 || starts.contains(code_[i].address)) {
        block_at[i] = blocks_.size();
        blocks_.push_back({.first = i, .end = i});
      }
      blocks_.back().end = i + 1;
    }
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Instruction& last = code_[blocks_[b].end - 1];
      if (last.falls_through() && b + 1 < blocks_.size()) blocks_[b].next.push_back(b + 1);
      const auto target = at.find(last.target_address);
      if (last.is_jump() && target != at.end())
        blocks_[b].next.push_back(block_at.at(target->second));
    }
    for (const Block& block : blocks_)
      for (const std::size_t next : block.next) blocks_[next].entered = true;
  }

  [[nodiscard]] bool is_padding(const Block& block) const {
    for (std::size_t i = block.first; i < block.end; ++i) {
      const Instruction& at = code_[i];
      if (at.name.find("nop") == std::string::npos && !(at.is("xchg") && at.only_pads()))
        return false;
    }
    return true;
  }

  /// Which accesses are not announced on the paths from block `first`.
  std::set<std::size_t> interpret_from(std::size_t first, const State& entry) {
    ++run_;
    for (Block& block : blocks_) block.before = {};
    blocks_[first].before = entry;
    collect_ = false;
    changed_ = true;
    // Names are never forgotten, so this ends; the number is for code that nobody has thought of.
    for (int round = 0; round < 50 && changed_; ++round) {
      changed_ = false;
      for (std::size_t block = 0; block < blocks_.size(); ++block) interpret(block);
    }
    collect_ = true;
    found_.clear();
    for (std::size_t block = 0; block < blocks_.size(); ++block) interpret(block);
    return std::move(found_);
  }

  /// Paths meet at block `number`: what they agree on stays.
  void meet(State& to, const State& from, std::size_t number) {
    if (!from.reached) return;
    if (!to.reached) {
      to = from;
      changed_ = true;
      return;
    }
    // Places that differ by the same on both paths go on doing so: they get one new value.
    struct Place {
      NamedValue& mine;
      NamedValue other;
      std::int64_t number;
    };
    std::vector<Place> places;
    for (std::uint8_t r = 0; r < registers; ++r) places.push_back({to.in[r], from.in[r], r});
    for (const auto& [place, value] : from.slots) {
      // A slot that one path has not written yet is not read before it is.
      const auto [slot, fresh] = to.slots.try_emplace(place, value);
      changed_ = changed_ || fresh;
      places.push_back({slot->second, value, registers + place});
    }
    std::map<std::tuple<std::uint32_t, std::uint32_t, std::int64_t>, NamedValue> joined;
    for (Place& place : places) {
      NamedValue& mine = place.mine;
      const NamedValue other = place.other;
      if (mine == other) continue;
      const auto [known, fresh] =
          joined.try_emplace({mine.root, other.root, mine.offset - other.offset});
      if (fresh)
        known->second = names_.of("join", {0, static_cast<std::int64_t>(number)}, {0, run_},
                                  place.number, true);
      const NamedValue value = known->second;
      if (names_.on_stack(value) && (!names_.on_stack(mine) || !names_.on_stack(other))) {
        changed_ = true;
        names_.leave_stack(value);
      }
      if (mine.root == value.root) continue;
      mine.root = value.root;
      changed_ = true;
    }
    std::vector<Announced> kept;
    for (Announced mine : to.announced) {
      const auto& others = from.announced;
      // What is announced may have a new name, too.
      if (std::ranges::find(others, mine) != others.end() ||
          std::ranges::any_of(others, [&](const Announced& other) {
            const auto known = joined.find(
                {mine.begin.root, other.begin.root, mine.begin.offset - other.begin.offset});
            Announced renamed = mine;
            renamed.begin = other.begin;
            if (known == joined.end() || renamed != other) return false;
            mine.begin.root = known->second.root;
            return true;
          }))
        kept.push_back(mine);
    }
    changed_ = changed_ || kept != to.announced;
    to.announced = std::move(kept);
  }

  void interpret(std::size_t number) {
    if (!blocks_[number].before.reached) return;
    State state = blocks_[number].before;
    for (std::size_t i = blocks_[number].first; i < blocks_[number].end; ++i) step(state, i);
    if (collect_) return;
    for (const std::size_t next : blocks_[number].next) meet(blocks_[next].before, state, next);
  }

  /// Whether an element of a table of constants is read: compilers make such of a `switch`.
  [[nodiscard]] bool reads_table(const State& state, const MemoryUse& use) const {
    if (use.writes || use.place.absolute || use.place.base == no_register) return false;
    const NamedValue table = state.in[use.place.base];
    return table.root == 0 && sections_.never_changes(table.offset + use.place.offset);
  }

  void check(State& state, NamedValue place, const MemoryUse& use, std::size_t at) {
    if (names_.on_stack(place) || (place.root == 0 && !sections_.may_change(place.offset))) return;
    const auto fits = [&](const Announced& a) {
      return a.bytes >= use.bytes && (a.writes || !use.writes);
    };
    for (Announced& a : state.announced) {
      if (a.begin.root != place.root || place.offset < a.begin.offset || !fits(a) ||
          place.offset + use.bytes > a.begin.offset + a.bytes)
        continue;
      a.used = true;
      return;
    }
    // A compiler knows of equal values that have two names here (it has compared them, say). So a
    // hook that no access has followed yet, for a place that may be this one, is taken for its own.
    for (auto a = state.announced.rbegin(); a != state.announced.rend(); ++a) {
      if (a->used || !fits(*a) || a->begin.root == place.root || a->begin.root == 0 ||
          place.root == 0 || names_.on_stack(a->begin))
        continue;
      a->used = true;
      state.announced.push_back({place, a->bytes, a->writes, true});
      return;
    }
    found_.insert(at);
    writes_[at] = use.writes;
    if (place.root == argument_root) to_argument_.insert(at);
  }

  void call(State& state, const Instruction& at) {
    if (stands_for_instruction(at.target)) {
      evaluation_.single(state, at);
      return;
    }
    if (!is_hook(at.target)) {
      // The address of a thread's own variables stays what it is.
      const bool own = at.target.find("tls_get_addr") != std::string::npos;
      const NamedValue asked = state.in[rdi];
      if (!own) state.announced.clear();
      evaluation_.call(state, at);
      if (own) state.in[rax] = names_.of("thread", asked);
    } else {
      if (auto access = announcement_of(at.target)) {
        const NamedValue said = state.in[rsi];
        if (access->bytes < 0)
          access->bytes = said.root == 0 ? said.offset : std::numeric_limits<std::int32_t>::max();
        state.announced.push_back({state.in[rdi], access->bytes, access->writes});
      }
      evaluation_.call(state, at);
    }
    if (collect_) leave(state);
  }

  /// The unwinder, or a table of jumps, may go on from here.
  void leave(State state) {
    state.announced.clear();
    left_.push_back(std::move(state));
  }

  void step(State& state, std::size_t number) {
    const Instruction& at = code_[number];
    if (collect_)
      for (const MemoryUse& use : memory_uses(at))
        if (!reads_table(state, use))
          check(state, evaluation_.address_of(state, use.place), use, number);
    if (at.is_call()) return call(state, at);
    if (at.is("ret") || at.is("repz ret")) {
      returns_argument_ = returns_argument_ || state.in[rax] == NamedValue{argument_root, 0};
      return;
    }
    if (at.is_jump()) {
      if (at.target_address == 0 && collect_) leave(state);
      return;
    }
    evaluation_.step(state, at);
  }

  std::vector<Instruction> code_;
  const Sections& sections_;
  bool results_on_stack_;
  std::vector<Block> blocks_;
  Evaluation evaluation_;
  ValueNames& names_;
  std::int64_t run_ = 0;
  bool changed_ = false;
  bool collect_ = false;
  bool returns_argument_ = false;
  std::vector<State> left_;  ///< after calls and at indirect jumps
  std::set<std::size_t> found_, to_argument_;
  std::map<std::size_t, bool> writes_;
};

/// The C runtime's own, which the linker puts into every module.
bool is_start_up(const std::string& name) {
  static const std::set<std::string> names{"deregister_tm_clones", "register_tm_clones",
                                           "__do_global_dtors_aux", "frame_dummy"};
  return names.contains(name);
}

}  // namespace

std::vector<Unannounced> unannounced(const std::vector<std::string>& disassembly,
                                     const std::vector<std::string>& sections) {
  Sections kinds;
  bool results_on_stack = false;
  for (const std::string& line : sections) {
    char name[64] = "";
    unsigned long size = 0;
    unsigned long begin = 0;
    if (std::sscanf(line.c_str(), " %*d %63s %lx %lx", name, &size, &begin) != 3) continue;
    const std::string_view section = name;
    if (section == ".data" || section == ".bss") kinds.writable.push_back({begin, begin + size});
    if (section == ".rodata" || section == ".data.rel.ro")
      kinds.constants.push_back({begin, begin + size});
    results_on_stack = results_on_stack || section == "irt_announced";
  }
  // A function and its unlikely part, NAME.cold, are one.
  std::map<std::string, std::array<std::vector<Instruction>, 2>> functions;
  std::string function;
  bool is_cold = false;
  bool is_text = false;
  for (const std::string& line : disassembly) {
    if (line.starts_with("Disassembly of section"))
      is_text = line.find(" .text") != std::string::npos;
    if (const std::size_t open = line.find(" <"); line.ends_with(">:") && open == 16) {
      function = line.substr(open + 2, line.size() - open - 4);
      const std::size_t cold = function.rfind(".cold");
      is_cold = cold != std::string::npos;
      if (is_cold) function.erase(cold);
      continue;
    }
    if (!is_text || is_start_up(function)) continue;
    if (auto instruction = parse_instruction(line))
      functions[function][is_cold ? 1 : 0].push_back(std::move(*instruction));
  }
  std::vector<Unannounced> result;
  for (auto& [name, parts] : functions) {
    std::vector<Instruction> code = std::move(parts[0]);
    std::ranges::move(parts[1], std::back_inserter(code));
    for (Unannounced& found : Function(std::move(code), kinds, results_on_stack).run())
      result.push_back(std::move(found));
  }
  std::ranges::sort(result, [](const auto& a, const auto& b) { return a.address < b.address; });
  return result;
}

}  // namespace irt::symbols
