/// Result files of every tool, read into one list of runs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "bench/results/fields.hpp"

namespace irt::report {

/// A file that cannot be read as results. `what()` is one line: which file, what is wrong with it.
/// Ends in exit code 2.
struct ResultError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

using results::Family;
using results::Field;
using results::Key;

/// One object of a result file, as its tool wrote it, but for the conditions.
struct Run {
  Family family;
  nlohmann::ordered_json fields;
  std::size_t environment;  ///< see `Results::environments`
  std::string time;         ///< when its conditions were taken, ISO 8601; empty where unknown

  /// The number in `key`; nothing where it is missing, null or no number.
  [[nodiscard]] std::optional<double> number(Key key) const;
  /// The field as text; empty where it is missing or null.
  [[nodiscard]] std::string text(Key key) const;
  /// The queue, or who schedules where there is none; of micro benchmarks the name.
  [[nodiscard]] std::string subject() const;
  [[nodiscard]] bool simulated() const { return text("source") == "simulated"; }
  /// "ok", "hung", "crashed", "failed", or "broken" where a queue has lost or doubled tasks.
  [[nodiscard]] std::string status() const;
};

struct ResultFile {
  std::string name;
  std::size_t runs = 0;
};

/// Runs that agree in the environment were taken under the same conditions.
struct Results {
  std::vector<Run> runs;
  std::vector<nlohmann::ordered_json> environments;  ///< machine, system and build, without times
  std::vector<ResultFile> files;
  std::vector<std::string> notes;  ///< what a reader must know about how the files fit together
};

/// The title of a field, with its unit in brackets.
std::string with_unit(const Field& field);

/// The letter or letters by which the page calls an environment: A, B ... Z, AA.
std::string environment_name(std::size_t index);

/// Reads at least one place: files, and of directories every result file in or below them. A file
/// of JSON lines, which an interrupted sweep leaves, is read as far as it goes. Throws ResultError
/// where a file that was named is no result file, and where there are no results at all; what else
/// lies in a directory becomes a note. What is measured twice counts once, the newest.
Results read_results(std::span<const std::filesystem::path> places);

}  // namespace irt::report
