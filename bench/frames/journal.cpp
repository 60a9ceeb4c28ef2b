#include "bench/frames/journal.hpp"

#include <algorithm>
#include <cerrno>
#include <fmt/format.h>
#include <fstream>
#include <string>
#include <system_error>

#include "bench/frames/usage_error.hpp"

namespace irt {

Journal Journal::begin(const std::filesystem::path& file, nlohmann::json header) {
  std::error_code error;
  if (std::filesystem::exists(file, error)) {
    std::filesystem::rename(file, file.string() + ".previous", error);
  }
  Journal journal(file);
  journal.open("wb");
  journal.header_ = std::move(header);
  journal.write(journal.header_);
  return journal;
}

Journal Journal::resume(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    throw UsageError(
        fmt::format("--resume: there is no {}; start without --resume, or name the "
                    "directory of the run to go on with by --out",
                    file.string()));
  }
  Journal journal(file);
  std::uintmax_t whole = 0;  // bytes of complete lines
  std::string line;
  for (unsigned number = 1; std::getline(in, line); ++number) {
    if (in.eof()) break;  // no newline: the process died while writing it
    try {
      const auto json = nlohmann::json::parse(line);
      if (number == 1) {
        if (json.at("format") != "irt-frames 2") throw UsageError("format");
        journal.header_ = json;
      } else {
        journal.samples_.push_back(json.get<Sample>());
      }
    } catch (const std::exception&) {
      throw UsageError(
          fmt::format("--resume: line {} of {} was not written by this program; start "
                      "without --resume",
                      number, file.string()));
    }
    whole += line.size() + 1;
  }
  if (journal.header_.is_null()) {
    throw UsageError(fmt::format("--resume: {} holds nothing to go on with; start without --resume",
                                 file.string()));
  }
  in.close();
  std::error_code error;
  std::filesystem::resize_file(file, whole, error);
  journal.open("ab");
  return journal;
}

void Journal::add(const Sample& sample) {
  samples_.push_back(sample);
  write(sample);
}

bool Journal::has(unsigned workload, std::string_view queue, unsigned threads,
                  unsigned repetition) const {
  return std::ranges::any_of(samples_, [&](const Sample& sample) {
    return sample.workload == workload && sample.queue == queue && sample.threads == threads &&
           sample.repetition == repetition;
  });
}

void Journal::open(const char* mode) {
  file_.reset(std::fopen(path_.c_str(), mode));
  if (file_) return;
  throw UsageError(fmt::format("{}: cannot be written ({}); name another directory by --out",
                               path_.string(), std::generic_category().message(errno)));
}

void Journal::write(const nlohmann::json& line) {
  const std::string text = line.dump() + '\n';
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size() ||
      std::fflush(file_.get()) != 0) {
    throw UsageError(fmt::format("{}: cannot be written ({}); what is in it can be resumed",
                                 path_.string(), std::generic_category().message(errno)));
  }
}

std::string first_difference(const nlohmann::json& stored, const nlohmann::json& now) {
  for (const auto& [name, value] : now.items()) {
    const auto before = stored.find(name);
    if (before == stored.end())
      return fmt::format("{}: nothing before, {} now", name, value.dump());
    if (*before != value) {
      return fmt::format("{}: {} before, {} now", name, before->dump(), value.dump());
    }
  }
  return {};
}

}  // namespace irt
