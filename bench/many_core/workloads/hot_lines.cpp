#include "bench/many_core/workloads/hot_lines.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <vector>

#include "stress/virtual_cores/symbols/symbols.hpp"

namespace irt::many_core {

namespace {

constexpr std::size_t most_lines = 8, most_sites = 4;

// The block that the line is part of; one that begins at 0 where there is none.
Heap::Block block_of(const Line& line, const Heap& heap) {
  const std::uintptr_t address = line.number * line_bytes;
  // A block may begin in the middle of its first line.
  for (const std::uintptr_t at : {address, address + line_bytes - 1}) {
    const Heap::Block block = heap.describe(at);
    if (block.begin != 0 && at < block.begin + block.size) return block;
  }
  return {};
}

std::string describe(const Line& line, const Machine& machine, const virtual_cores::Module& module,
                     symbols::Symbols& symbols) {
  const std::uintptr_t address = line.number * line_bytes;
  if (const Heap::Block block = block_of(line, machine.heap()); block.begin != 0) {
    const std::intptr_t offset =
        static_cast<std::intptr_t>(address) - static_cast<std::intptr_t>(block.begin);
    return fmt::format("{:+} bytes in the {} bytes allocated at {}", offset, block.size,
                       symbols.name(block.allocated_at));
  }
  if (machine.heap().owns(address))
    return fmt::format("the allocator's lock, arena {}", machine.heap().arena_of(address));
  return module.owns_global(address) ? "a global variable" : "memory of a library or the kernel";
}

// The sites that waited most for the line, the worst first.
std::vector<Site> worst_sites(const Line& line) {
  std::vector<Site> sites = line.sites;
  std::ranges::sort(sites, [](const Site& a, const Site& b) { return a.waited > b.waited; });
  if (sites.size() > most_sites) sites.resize(most_sites);
  return sites;
}

nlohmann::json describe(const Site& site, Time all, symbols::Symbols& symbols) {
  return {{"place", symbols.name(site.pc)},
          {"source", symbols.at(site.pc).text},
          {"requests", site.requests},
          {"share_of_waiting", static_cast<double>(site.waited) / static_cast<double>(all)},
          {"writes", site.writes}};
}

}  // namespace

nlohmann::json hot_lines(const Machine& machine, const virtual_cores::Module& module) {
  std::vector<const Line*> lines;
  Time all = 1;
  for (const Line& line : machine.directory().lines()) {
    all += line.waited;
    if (line.transfers != 0) lines.push_back(&line);
  }
  const std::size_t count = std::min(lines.size(), most_lines);
  std::ranges::partial_sort(lines, lines.begin() + static_cast<std::ptrdiff_t>(count),
                            [](const Line* a, const Line* b) { return a->waited > b->waited; });
  lines.resize(count);

  std::vector<const void*> pcs;
  for (const Line* line : lines) {
    pcs.push_back(block_of(*line, machine.heap()).allocated_at);
    for (const Site& site : worst_sites(*line)) pcs.push_back(site.pc);
  }
  symbols::Symbols symbols(module);
  symbols.look_up(pcs);

  nlohmann::json result = nlohmann::json::array();
  for (const Line* line : lines) {
    nlohmann::json places = nlohmann::json::array();
    for (const Site& site : worst_sites(*line)) places.push_back(describe(site, all, symbols));
    result.push_back(
        {{"what", describe(*line, machine, module, symbols)},
         {"transfers", line->transfers},
         {"share_of_waiting", static_cast<double>(line->waited) / static_cast<double>(all)},
         {"false_sharing",
          static_cast<double>(line->false_transfers) / static_cast<double>(line->transfers)},
         {"sites", places}});
  }
  return result;
}

}  // namespace irt::many_core
