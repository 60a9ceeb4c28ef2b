/// What `compare` has measured so far: a file of JSON lines, written as the results come.
///
/// The first line says what is being measured, under which conditions; each further line is a
/// sample. A process may be killed at any moment: only the line being written can be lost.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "bench/frames/sample.hpp"

namespace irt {

class Journal {
 public:
  /// Begins a new file. One that is there is kept under the name `FILE.previous`. Throws
  /// UsageError.
  static Journal begin(const std::filesystem::path& file, nlohmann::json header);

  /// Opens a file to go on with it. A torn last line is cut off. Throws UsageError where the file
  /// is missing or is no journal.
  static Journal resume(const std::filesystem::path& file);

  /// Writes `sample` through to the operating system. Throws UsageError.
  void add(const Sample& sample);

  const nlohmann::json& header() const { return header_; }
  const std::vector<Sample>& samples() const { return samples_; }
  bool has(unsigned workload, std::string_view queue, unsigned threads, unsigned repetition) const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  explicit Journal(std::filesystem::path path) : path_(std::move(path)) {}
  void open(const char* mode);
  void write(const nlohmann::json& line);

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
  nlohmann::json header_;
  std::vector<Sample> samples_;
};

/// Where two headers differ in what must not differ between samples that are reported together: the
/// name of the first such field with both values, or nothing.
std::string first_difference(const nlohmann::json& stored, const nlohmann::json& now);

}  // namespace irt
