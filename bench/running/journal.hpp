/// What a long measurement has found so far, to go on with: a file of JSON lines, written as the
/// results come.
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
#include <utility>
#include <vector>

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

  [[nodiscard]] const nlohmann::json& header() const { return header_; }

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

/// The results of a long measurement, each of which JSON can be made of and got from.
template <class Result>
class Journal {
 public:
  /// As those of `JsonLines`.
  static Journal begin(const std::filesystem::path& file, nlohmann::json header) {
    return {JsonLines::begin(file, std::move(header)), {}};
  }
  static Journal resume(const std::filesystem::path& file, const std::string& format) {
    std::vector<Result> results;
    JsonLines lines = JsonLines::resume(
        file, format, [&](const nlohmann::json& line) { results.push_back(line.get<Result>()); });
    return {std::move(lines), std::move(results)};
  }

  /// Writes `result` through to the operating system. Throws UsageError.
  void add(Result result) {
    lines_.add(result);
    results_.push_back(std::move(result));
  }

  [[nodiscard]] const nlohmann::json& header() const { return lines_.header(); }
  [[nodiscard]] const std::vector<Result>& results() const { return results_; }

 private:
  Journal(JsonLines lines, std::vector<Result> results)
      : lines_(std::move(lines)), results_(std::move(results)) {}

  JsonLines lines_;
  std::vector<Result> results_;
};

/// Makes sure that the option `name`, which the user gave again, has the value that it has in the
/// journal. Throws UsageError.
void require_same_option(const std::string& name, const nlohmann::json& before,
                         const nlohmann::json& now);

/// Makes sure that what is going to be measured fits what the journal holds, taken under the
/// conditions `before`. Throws UsageError that names what differs.
void require_same_conditions(const nlohmann::json& before, const nlohmann::json& now);

}  // namespace irt
