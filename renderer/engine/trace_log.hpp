/// What each render thread did when.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/engine/activity.hpp"
#include "renderer/engine/task.hpp"

namespace irt {

struct Span {
  std::chrono::steady_clock::time_point begin, end;
  Activity activity = Activity::task;
  TaskKind kind = TaskKind::primary;  ///< of a task
  std::uint32_t count = 1;            ///< pushes, or pops, that are one span
};

/// A row of spans for each render thread, and one for the thread that runs the frames. Memory is
/// taken once, 32 bytes a span; what does not fit is counted and dropped.
///
/// Each row is written by one thread at a time. The log is read between frames.
class TraceLog {
 public:
  TraceLog(unsigned threads, std::size_t spans_per_thread) : rows_(threads + 1) {
    for (Row& row : rows_) row.spans.reserve(spans_per_thread);
  }

  /// Row number `threads` is that of the frames. Pushes that follow one another without a gap
  /// become one span, and so does idling.
  void add(std::size_t row, const Span& span) {
    std::vector<Span>& spans = rows_[row].spans;
    const bool joins = span.activity == Activity::add || span.activity == Activity::idle;
    if (joins && !spans.empty() && spans.back().activity == span.activity &&
        spans.back().end == span.begin) {
      spans.back().end = span.end;
      spans.back().count += span.count;
    } else if (spans.size() < spans.capacity()) {
      spans.push_back(span);
    } else {
      ++rows_[row].dropped;
    }
  }

  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  /// By their ends; a span that holds others comes after them.
  [[nodiscard]] std::span<const Span> spans(std::size_t row) const { return rows_[row].spans; }
  [[nodiscard]] std::uint64_t dropped(std::size_t row) const { return rows_[row].dropped; }
  void clear() {
    for (Row& row : rows_) {
      row.spans.clear();
      row.dropped = 0;
    }
  }

 private:
  struct alignas(128) Row {  // no two threads write to one cache line
    std::vector<Span> spans;
    std::uint64_t dropped = 0;
  };
  std::vector<Row> rows_;
};

}  // namespace irt
