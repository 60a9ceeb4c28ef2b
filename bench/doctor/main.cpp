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

namespace irt::doctor {
namespace {

constexpr std::string_view word(Severity severity) {
  switch (severity) {
    case Severity::good:
      return "good";
    case Severity::note:
      return "note";
    case Severity::caution:
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

void print(std::span<const Diagnosis> diagnoses) {
  unsigned cautions = 0;
  for (const Diagnosis& diagnosis : diagnoses) {
    fmt::print("{:<8} {:<21} {}\n", word(diagnosis.severity), diagnosis.subject, diagnosis.found);
    fmt::print("{}", wrapped(diagnosis.meaning, 31, 69));
    if (diagnosis.severity == Severity::caution) ++cautions;
  }
  if (cautions == 0) {
    fmt::print("\nA good place to measure.\n");
  } else {
    fmt::print("\n{} of these bend{} the figures: see 'caution' above.\n", cautions,
               cautions == 1 ? "s" : "");
  }
}

void print_json(std::span<const Diagnosis> diagnoses) {
  nlohmann::json list = nlohmann::json::array();
  for (const Diagnosis& diagnosis : diagnoses) {
    list.push_back({{"subject", diagnosis.subject},
                    {"found", diagnosis.found},
                    {"verdict", word(diagnosis.severity)},
                    {"meaning", diagnosis.meaning}});
  }
  fmt::print("{}\n", nlohmann::json{{"conditions", conditions()}, {"findings", list}}.dump(2));
}

int run(int argc, char** argv) {
  CLI::App app("What this machine has, and what that means for the figures.", "irt doctor");
  bool json = false;
  app.add_flag("--json", json, "machine, build and findings as JSON");
  if (const auto code = parse(app, argc, argv)) return *code;
  const auto diagnoses = diagnose(examine(), optional_parts());
  if (json) {
    print_json(diagnoses);
  } else {
    print(diagnoses);
  }
  return 0;
}

}  // namespace
}  // namespace irt::doctor

int main(int argc, char** argv) {
  return irt::run_program("irt doctor", [&] { return irt::doctor::run(argc, argv); });
}
