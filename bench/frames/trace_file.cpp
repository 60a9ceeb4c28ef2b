#include "bench/frames/trace_file.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/frames/files.hpp"

namespace irt::frames {
namespace {

using Clock = std::chrono::steady_clock;

std::string name_of(const Span& span) {
  constexpr std::array kinds{"primary task", "shadow task", "specular task"};
  constexpr std::array names{"task",    "trace", "shade",    "add",    "get",   "idle",
                             "barrier", "frame", "generate", "render", "output"};
  if (span.activity == Activity::task) return kinds.at(static_cast<std::size_t>(span.kind));
  return names.at(static_cast<std::size_t>(span.activity));
}

double microseconds(Clock::duration time) {
  return std::chrono::duration<double, std::micro>(time).count();
}

// What holds others comes before them.
std::vector<Span> by_begin(std::span<const Span> spans) {
  std::vector<Span> sorted(spans.begin(), spans.end());
  std::ranges::stable_sort(sorted, [](const Span& a, const Span& b) {
    if (a.begin != b.begin) return a.begin < b.begin;
    return a.end != b.end ? a.end > b.end : a.activity == Activity::task;
  });
  return sorted;
}

}  // namespace

void write_trace(const std::filesystem::path& file, const TraceLog& log, nlohmann::json about) {
  Clock::time_point origin = Clock::time_point::max();
  std::uint64_t dropped = 0;
  for (std::size_t row = 0; row < log.rows(); ++row) {
    for (const Span& span : log.spans(row)) origin = std::min(origin, span.begin);
    dropped += log.dropped(row);
  }
  about["dropped_spans"] = dropped;
  std::string text =
      fmt::format("{{\"otherData\": {}, \"displayTimeUnit\": \"ns\",\n", about.dump()) +
      "\"traceEvents\": [\n";
  for (std::size_t row = 0; row < log.rows(); ++row) {
    const bool frames = row + 1 == log.rows();
    const std::string title = frames ? "frames" : fmt::format("render thread {}", row);
    text += fmt::format(
        "{}{{\"name\": \"thread_name\", \"ph\": \"M\", \"pid\": 0, \"tid\": {}, "
        "\"args\": {{\"name\": \"{}\"}}}}",
        row == 0 ? "" : ",\n", row, title);
    for (const Span& span : by_begin(log.spans(row))) {
      text += fmt::format(
          ",\n{{\"name\": \"{}\", \"ph\": \"X\", \"pid\": 0, \"tid\": {}, \"ts\": {:.3f}, "
          "\"dur\": {:.3f}",
          name_of(span), row, microseconds(span.begin - origin),
          microseconds(span.end - span.begin));
      if (span.count > 1) text += fmt::format(", \"args\": {{\"count\": {}}}", span.count);
      text += '}';
    }
  }
  write_text(file, text + "\n]}\n");
}

}  // namespace irt::frames
