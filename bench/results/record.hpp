/// How tools write a run.
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/results/fields.hpp"

namespace irt::results {

struct Entry {
  Key key;
  nlohmann::ordered_json value;
};

/// Puts the entries into `run`, behind what is there.
inline void add(nlohmann::ordered_json& run, std::initializer_list<Entry> entries) {
  for (const Entry& entry : entries) run[std::string(entry.key.name)] = entry.value;
}

inline nlohmann::ordered_json record(std::initializer_list<Entry> entries) {
  nlohmann::ordered_json run = nlohmann::ordered_json::object();
  add(run, entries);
  return run;
}

}  // namespace irt::results
