#include "stress/checker/fold.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace irt::checker {

namespace {

constexpr std::size_t longest_round = 40;

// How often the `length` rows from `at` on come in a row.
template <class Same>
std::size_t rounds(const std::vector<Row>& rows, std::size_t at, std::size_t length, Same same) {
  std::size_t end = at + length;
  while (end < rows.size() && same(rows[end], rows[end - length])) ++end;
  return (end - at) / length;
}

}  // namespace

std::vector<Row> fold(const std::vector<Row>& rows) {
  const auto equal = [](const Row& a, const Row& b) {
    return a.thread == b.thread && a.text == b.text;
  };
  const auto alike = [](const Row& a, const Row& b) {
    return a.thread == b.thread && a.what == b.what;
  };
  std::vector<Row> folded;
  const auto copy = [&](std::size_t from, std::size_t count) {
    for (std::size_t i = from; i < from + count; ++i) folded.push_back(rows[i]);
  };
  for (std::size_t at = 0; at < rows.size();) {
    std::size_t length = 1;
    std::size_t count = 1;
    bool exact = true;
    const std::size_t longest = std::min(longest_round, (rows.size() - at) / 3);
    for (; length <= longest; ++length) {
      count = rounds(rows, at, length, equal);
      exact = count >= 3;
      if (exact) break;
      count = rounds(rows, at, length, alike);
      if (count >= 8) break;
      count = 1;
    }
    if (count == 1) {
      copy(at++, 1);
      continue;
    }
    copy(at, length);
    const std::string times =
        exact ? fmt::format("    ... {}{} times",
                            length == 1 ? "" : fmt::format("these {} lines ", length), count)
              : fmt::format("    ... {} more like {}, with other values, then", count - 2,
                            length == 1 ? "this" : fmt::format("these {} lines", length));
    folded.push_back({rows[at].thread, times, times});
    if (!exact) copy(at + (count - 1) * length, length);
    at += count * length;
  }
  return folded;
}

}  // namespace irt::checker
