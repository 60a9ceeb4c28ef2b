#include "bench/running/journal.hpp"

#include <cerrno>
#include <fmt/format.h>
#include <fstream>
#include <system_error>

#include "bench/conditions/conditions.hpp"
#include "stress/running/usage_error.hpp"

namespace irt {

JsonLines JsonLines::begin(const std::filesystem::path& file, nlohmann::json header) {
  std::error_code error;
  if (std::filesystem::exists(file, error)) {
    std::filesystem::rename(file, file.string() + ".previous", error);
  }
  JsonLines lines(file);
  lines.open("wb");
  lines.header_ = std::move(header);
  lines.add(lines.header_);
  return lines;
}

JsonLines JsonLines::resume(const std::filesystem::path& file, const std::string& format,
                            const std::function<void(const nlohmann::json&)>& take) {
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    throw UsageError(
        fmt::format("--resume: there is no {}; start without --resume, or name the "
                    "directory of the run to go on with by --out",
                    file.string()));
  }
  JsonLines lines(file);
  std::uintmax_t whole = 0;  // bytes of complete lines
  std::string line;
  for (unsigned number = 1; std::getline(in, line); ++number) {
    if (in.eof()) break;  // no newline: the process died while writing it
    try {
      const auto json = nlohmann::json::parse(line);
      if (number == 1) {
        if (json.at("format") != format) throw UsageError("format");
        lines.header_ = json;
      } else {
        take(json);
      }
    } catch (const std::exception&) {
      throw UsageError(
          fmt::format("--resume: line {} of {} was not written by this program; start "
                      "without --resume",
                      number, file.string()));
    }
    whole += line.size() + 1;
  }
  if (lines.header_.is_null()) {
    throw UsageError(fmt::format("--resume: {} holds nothing to go on with; start without --resume",
                                 file.string()));
  }
  in.close();
  std::error_code error;
  std::filesystem::resize_file(file, whole, error);
  lines.open("ab");
  return lines;
}

void JsonLines::open(const char* mode) {
  file_.reset(std::fopen(path_.c_str(), mode));
  if (file_) return;
  throw UsageError(fmt::format("{}: cannot be written ({}); name another directory by --out",
                               path_.string(), std::generic_category().message(errno)));
}

void JsonLines::add(const nlohmann::json& line) {
  const std::string text = line.dump() + '\n';
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size() ||
      std::fflush(file_.get()) != 0) {
    throw UsageError(fmt::format("{}: cannot be written ({}); what is in it can be resumed",
                                 path_.string(), std::generic_category().message(errno)));
  }
}

void require_same_option(const std::string& name, const nlohmann::json& before,
                         const nlohmann::json& now) {
  if (before == now) return;
  throw UsageError(
      fmt::format("--resume: {}: {} before, {} now; start without --resume, or with the options of "
                  "before",
                  name, before.dump(), now.dump()));
}

void require_same_conditions(const nlohmann::json& before, const nlohmann::json& now) {
  const nlohmann::json stored = lasting_conditions(before);
  const nlohmann::json lasting = lasting_conditions(now);
  for (const auto& [name, value] : lasting.items()) {
    const auto found = stored.find(name);
    if (found != stored.end() && *found == value) continue;
    throw UsageError(
        fmt::format("--resume: {}: {} before, {} now; figures taken under other conditions do not "
                    "mix, start without --resume",
                    name, found == stored.end() ? "nothing" : found->dump(), value.dump()));
  }
}

}  // namespace irt
