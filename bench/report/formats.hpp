/// The formats of single result files.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace irt::report {

/// What one file holds: an array of runs as the tools write them, each with its `conditions`.
/// Google Benchmark's and the journals of interrupted sweeps are turned into such. Throws
/// ResultError.
struct FileContents {
  nlohmann::ordered_json runs;
  std::string note;  ///< empty, or in which way the file is incomplete
};
FileContents read_result_file(const std::filesystem::path& file);

}  // namespace irt::report
