/// A file of JSON lines, written as the results of a long measurement come.
///
/// The first line, the header, says what is being measured, under which conditions; each further
/// line is a result. A process may be killed at any moment: only the line being written can be
/// lost.
#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

namespace irt {

class JsonLines {
 public:
  /// Begins a new file. One that is there is kept under the name `FILE.previous`. Throws
  /// UsageError.
  static JsonLines begin(const std::filesystem::path& file, nlohmann::json header);

  /// Opens a file to go on with it and gives `take` each line but the header, whose "format" must
  /// be `format`. A torn last line is cut off. Throws UsageError where the file is missing, is of
  /// another format or has a line that `take` throws at.
  static JsonLines resume(const std::filesystem::path& file, const std::string& format,
                          const std::function<void(const nlohmann::json&)>& take);

  /// Writes a line through to the operating system. Throws UsageError.
  void add(const nlohmann::json& line);

  const nlohmann::json& header() const { return header_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  explicit JsonLines(std::filesystem::path path) : path_(std::move(path)) {}
  void open(const char* mode);

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
  nlohmann::json header_;
};

/// Where two headers differ in what must not differ between results that are reported together: the
/// name of the first such field with both values, or nothing.
std::string first_difference(const nlohmann::json& stored, const nlohmann::json& now);

}  // namespace irt
