/// What `compare` has measured so far: JSON lines of samples.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "bench/frames/sample.hpp"
#include "bench/running/json_lines.hpp"

namespace irt {

/// Says what is in such a file.
inline constexpr const char* journal_format = "irt-frames 3";

class Journal {
 public:
  /// As those of `JsonLines`.
  static Journal begin(const std::filesystem::path& file, nlohmann::json header);
  static Journal resume(const std::filesystem::path& file);

  /// Writes `sample` through to the operating system. Throws UsageError.
  void add(const Sample& sample);

  const nlohmann::json& header() const { return lines_.header(); }
  const std::vector<Sample>& samples() const { return samples_; }
  bool has(unsigned workload, std::string_view queue, unsigned threads, unsigned repetition) const;

 private:
  Journal(JsonLines lines, std::vector<Sample> samples)
      : lines_(std::move(lines)), samples_(std::move(samples)) {}

  JsonLines lines_;
  std::vector<Sample> samples_;
};

}  // namespace irt
