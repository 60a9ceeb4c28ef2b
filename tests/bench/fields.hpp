/// That a tool writes what the table of fields says.
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "bench/results/fields.hpp"

namespace irt {

template <class Json>
std::set<std::string> keys_of(const Json& run) {
  std::set<std::string> keys;
  for (const auto& [key, value] : run.items()) keys.insert(key);
  return keys;
}

/// The keys of what `tool` writes.
inline std::set<std::string> fields_by(results::Tools tool) {
  std::set<std::string> keys;
  for (const results::Field& field : results::fields) {
    if ((field.by & tool) != 0) keys.emplace(field.key);
  }
  return keys;
}

}  // namespace irt
