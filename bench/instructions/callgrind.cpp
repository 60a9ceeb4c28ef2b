#include "bench/instructions/callgrind.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace irt::instructions {
namespace {

bool take_prefix(std::string& line, std::string_view prefix) {
  if (!line.starts_with(prefix)) return false;
  line.erase(0, prefix.size());
  return true;
}

/// A line of costs is a position and a number for each event; zeros at the end may be missing.
void add_costs(const std::string& line, const std::vector<std::string>& events, Events& sum) {
  std::istringstream words(line);
  std::string position;
  words >> position;
  std::uint64_t cost = 0;
  for (const std::string& event : events)
    if (words >> cost) sum[event] += cost;
}

}  // namespace

std::vector<Function> read_profile(std::istream& file) {
  std::vector<std::string> events;
  std::map<std::string, Events> by_name;
  Events* current = nullptr;
  bool of_a_call = false;
  for (std::string line; std::getline(file, line);) {
    if (line.empty()) continue;
    if (take_prefix(line, "events:")) {
      std::istringstream words(line);
      for (std::string event; words >> event;) events.push_back(event);
    } else if (take_prefix(line, "fn=")) {
      current = &by_name[line];
    } else if (line.starts_with("calls=")) {
      of_a_call = true;  // what follows is the cost of the callee
    } else if (std::string_view("0123456789+-*").find(line.front()) != std::string_view::npos) {
      if (events.empty() || current == nullptr)
        throw std::runtime_error("callgrind's profile has costs of no function");
      if (!of_a_call) add_costs(line, events, *current);
      of_a_call = false;
    }
  }
  if (events.empty()) throw std::runtime_error("not a profile of callgrind: it names no events");
  std::vector<Function> functions;
  for (auto& [name, own] : by_name)
    if (own["Ir"] != 0) functions.push_back({name, own});
  std::ranges::sort(functions, [](const Function& a, const Function& b) {
    return a.own.at("Ir") > b.own.at("Ir");
  });
  return functions;
}

Events total(const std::vector<Function>& functions) {
  Events sum;
  for (const Function& function : functions)
    for (const auto& [event, count] : function.own) sum[event] += count;
  return sum;
}

}  // namespace irt::instructions
