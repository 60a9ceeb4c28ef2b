/// Rounds of a loop in a report, shown once with their number.
#pragma once

#include <string>
#include <vector>

namespace irt::checker {

/// A line of a report.
struct Row {
  unsigned thread = 0;  ///< its column
  std::string text;
  std::string what;  ///< the same for lines that differ only in the values they show
};

/// `rows` with each group of lines that comes at least three times in a row shown once, and how
/// often it came. Of rounds that differ in their values, at least eight of them, the first and the
/// last are shown.
std::vector<Row> fold(const std::vector<Row>& rows);

}  // namespace irt::checker
