// irt doctor: what this machine has, and what that means for the figures.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bench/conditions/conditions.hpp"
#include "bench/doctor/diagnosis.hpp"
#include "stress/running/arguments.hpp"
#include "stress/running/program.hpp"

namespace {

constexpr std::string_view word(irt::Verdict verdict) {
  switch (verdict) {
    case irt::Verdict::good:
      return "good";
    case irt::Verdict::note:
      return "note";
    case irt::Verdict::caution:
      return "caution";
  }
  return "";
}

/// `text` in lines of at most `width` characters, each indented.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
  std::istringstream words(text);
  std::string out, line;
  const auto flush = [&] {
    out += fmt::format("{:{}}{}\n", "", indent, line);
    line.clear();
  };
  for (std::string next; words >> next;) {
    if (!line.empty() && line.size() + 1 + next.size() > width) flush();
    if (!line.empty()) line += ' ';
    line += next;
  }
  if (!line.empty()) flush();
  return out;
}

void print(std::span<const irt::Finding> findings) {
  unsigned cautions = 0;
  for (const irt::Finding& finding : findings) {
    fmt::print("{:<8} {:<21} {}\n", word(finding.verdict), finding.subject, finding.found);
    fmt::print("{}", wrapped(finding.meaning, 31, 69));
    if (finding.verdict == irt::Verdict::caution) ++cautions;
  }
  if (cautions == 0) {
    fmt::print("\nA good place to measure.\n");
  } else {
    fmt::print("\n{} of these bend{} the figures: see 'caution' above.\n", cautions,
               cautions == 1 ? "s" : "");
  }
}

void print_json(std::span<const irt::Finding> findings) {
  nlohmann::json list = nlohmann::json::array();
  for (const irt::Finding& finding : findings) {
    list.push_back({{"subject", finding.subject},
                    {"found", finding.found},
                    {"verdict", word(finding.verdict)},
                    {"meaning", finding.meaning}});
  }
  fmt::print("{}\n", nlohmann::json{{"conditions", irt::conditions()}, {"findings", list}}.dump(2));
}

int run(int argc, char** argv) {
  CLI::App app("What this machine has, and what that means for the figures.", "irt doctor");
  bool json = false;
  app.add_flag("--json", json, "machine, build and findings as JSON");
  if (const auto code = irt::parse(app, argc, argv)) return *code;
  const auto findings = irt::diagnose(irt::examine(), irt::optional_parts());
  if (json) {
    print_json(findings);
  } else {
    print(findings);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return irt::run_program("irt doctor", [&] { return run(argc, argv); });
}
