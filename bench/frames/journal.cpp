#include "bench/frames/journal.hpp"

#include <algorithm>

namespace irt {

Journal Journal::begin(const std::filesystem::path& file, nlohmann::json header) {
  return {JsonLines::begin(file, std::move(header)), {}};
}

Journal Journal::resume(const std::filesystem::path& file) {
  std::vector<Sample> samples;
  JsonLines lines = JsonLines::resume(file, journal_format, [&](const nlohmann::json& line) {
    samples.push_back(line.get<Sample>());
  });
  return {std::move(lines), std::move(samples)};
}

void Journal::add(const Sample& sample) {
  samples_.push_back(sample);
  lines_.add(sample);
}

bool Journal::has(unsigned workload, std::string_view queue, unsigned threads,
                  unsigned repetition) const {
  return std::ranges::any_of(samples_, [&](const Sample& sample) {
    return sample.workload == workload && sample.queue == queue && sample.threads == threads &&
           sample.repetition == repetition;
  });
}

}  // namespace irt
