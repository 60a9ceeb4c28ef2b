/// Reads the headers of queues/ and holds their comments to the rule: every order weaker than
/// seq_cst is explained where it stands, and numbered comments name each other in pairs.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace irt {
namespace {

namespace fs = std::filesystem;

/// A comment that begins with `// (number) order:`, up to the next such comment or to the code.
struct Numbered {
  std::string order;
  std::set<int> partners;  // numbers it mentions
  std::vector<std::string> files;
};

struct Findings {
  std::vector<std::string> lines;
  void add(std::size_t line, const std::string& what) {
    lines.push_back("line " + std::to_string(line + 1) + ": " + what);
  }
};

std::string comment_of(const std::string& line) {
  const std::size_t start = line.find("//");
  return start == std::string::npos ? "" : line.substr(start);
}

bool only_comment(const std::string& line) {
  const std::size_t start = line.find_first_not_of(' ');
  return start != std::string::npos && line.compare(start, 2, "//") == 0;
}

std::string in_brackets(int number) {
  return "(" + std::to_string(number) + ")";
}

/// What is wrong with the comments of `lines`. `files` are the names of all headers.
Findings check(const std::vector<std::string>& lines, const std::set<std::string>& files) {
  static const std::regex start(R"(// \((\d+)\) (relaxed|acquire|release|acq_rel|seq_cst):)");
  static const std::regex mention(R"(\((\d\d?)\))");
  static const std::regex file_name(R"((\w+\.hpp))");
  static const std::regex use(R"(memory_order(?:_|::)(relaxed|acquire|release|acq_rel|consume))");
  Findings findings;
  std::map<int, Numbered> numbered;

  int current = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::smatch match;
    const std::string comment = comment_of(lines[i]);
    if (std::regex_search(comment, match, start)) {
      current = std::stoi(match[1]);
      if (!numbered.emplace(current, Numbered{.order = match[2], .partners = {}, .files = {}})
               .second)
        findings.add(i, "(" + match[1].str() + ") stands twice");
    } else if (!only_comment(lines[i])) {
      current = 0;
    }
    if (current == 0) continue;
    for (std::sregex_iterator found(comment.begin(), comment.end(), mention), end; found != end;
         ++found)
      if (const int number = std::stoi((*found)[1]); number != current)
        numbered[current].partners.insert(number);
    for (std::sregex_iterator found(comment.begin(), comment.end(), file_name), end; found != end;
         ++found)
      numbered[current].files.push_back((*found)[1]);
  }

  for (const auto& [number, entry] : numbered) {
    const std::string name = in_brackets(number);
    if (entry.partners.empty() && entry.files.empty() && entry.order != "relaxed")
      findings.add(0, name + " names no partner");
    for (const int partner : entry.partners)
      if (!numbered.contains(partner))
        findings.add(0, name + " names a partner that does not exist");
      else if (!numbered[partner].partners.contains(number))
        findings.add(0, name + " is not named back by a partner");
    for (const std::string& file : entry.files)
      if (!files.contains(file)) findings.add(0, name + " names a file that does not exist");
  }

  // The comment of a use stands on its line or close above, in the same statement or before it.
  constexpr std::size_t reach = 6;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string code = lines[i].substr(0, lines[i].find("//"));
    for (std::sregex_iterator found(code.begin(), code.end(), use), end; found != end; ++found) {
      const std::string order = (*found)[1];
      // relaxed synchronises nothing and has no partner, but must have a reason.
      const std::regex explained(order == "relaxed" ? R"(\brelaxed\b)"
                                                    : R"(\(\d+\) )" + order + ":");
      bool is_explained = false;
      for (std::size_t back = 0; back <= std::min(i, reach); ++back)
        is_explained |= std::regex_search(comment_of(lines[i - back]), explained);
      if (!is_explained) findings.add(i, order + " without a comment that says why");
    }
  }
  return findings;
}

std::vector<fs::path> headers() {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(IRT_QUEUES_ROOM))
    if (entry.path().extension() == ".hpp") found.push_back(entry.path());
  return found;
}

TEST(MemoryOrders, are_explained_in_every_header_of_the_room) {
  std::set<std::string> names;
  for (const fs::path& header : headers()) names.insert(header.filename());
  ASSERT_GE(names.size(), 10U);
  for (const fs::path& header : headers()) {
    std::ifstream file(header);
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    for (const std::string& finding : check(lines, names).lines)
      ADD_FAILURE() << header.string() << ": " << finding;
  }
}

// The reader itself must notice what it is here for.
TEST(MemoryOrders, the_reader_finds_each_kind_of_slip) {
  const auto findings = [](const std::vector<std::string>& lines) {
    return check(lines, {"other.hpp"}).lines.size();
  };
  EXPECT_EQ(findings({"// (1) release: pairs with (2)", "x.store(1, std::memory_order_release);",
                      "// (2) acquire: pairs with (1)", "x.load(std::memory_order_acquire);"}),
            0U);
  EXPECT_EQ(findings({"// (1) release: pairs with the load in other.hpp", "x.store(1);"}), 0U);
  EXPECT_EQ(findings({"x.store(1, std::memory_order_release);"}), 1U) << "no comment";
  EXPECT_EQ(findings({"x.load(std::memory_order::relaxed);"}), 1U) << "no reason";
  EXPECT_EQ(findings({"// (1) acquire: pairs with (2)", "// (2) release: pairs with nothing"}), 2U)
      << "(1) is not named back, (2) names nobody";
  EXPECT_EQ(findings({"// (1) acquire: pairs with (7)"}), 1U) << "no such number";
  EXPECT_EQ(findings({"// (1) acquire: pairs with the store in gone.hpp"}), 1U) << "no such file";
  EXPECT_EQ(findings({"// (1) acquire: see other.hpp", "f();", "// (1) release: see other.hpp"}),
            1U)
      << "the same number twice";
}

}  // namespace
}  // namespace irt
