#include "stress/threads/report.hpp"

#include <fmt/format.h>
#include <map>

namespace irt::stress {
namespace {

std::string indent(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = text.find('\n', at);
    if (end == std::string::npos) end = text.size();
    out += fmt::format("      {}\n", text.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

std::string escape(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        // XML 1.0 has no other control characters.
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') out += c;
    }
  }
  return out;
}

std::string label(const Result& result) {
  return result.scenario.empty() ? result.suite : result.suite + " " + result.scenario;
}

}  // namespace

std::string to_text(const Result& result) {
  const double rate =
      result.seconds > 0 ? static_cast<double>(result.operations) / result.seconds : 0;
  std::string text = fmt::format("{:<7} {:<16} {:<30} {:>11} operations {:>9.0f}/s {:>6.1f} s\n",
                                 result.findings.empty() ? "ok" : "FINDING", result.queue,
                                 label(result), result.operations, rate, result.seconds);
  for (const std::string& note : result.notes) text += fmt::format("    {}\n", note);
  for (const std::string& limit : result.limits) text += fmt::format("    limit: {}\n", limit);
  for (const BrokenClaim& finding : result.findings) {
    text += fmt::format("    broken{}: {} (after {:.2f} s)\n",
                        result.third_party ? " (third-party)" : "", finding.claim, finding.seconds);
    text += indent(finding.evidence);
    text += fmt::format("    repeat: {}\n", finding.repeat);
  }
  return text;
}

std::string to_junit(const std::vector<Result>& results) {
  std::map<std::string, std::vector<const Result*>> queues;
  for (const Result& result : results) queues[result.queue].push_back(&result);
  std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  for (const auto& [queue, cases] : queues) {
    std::size_t failures = 0;
    for (const Result* result : cases) failures += result->findings.empty() ? 0 : 1;
    xml += fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\">\n", escape(queue),
                       cases.size(), failures);
    for (const Result* result : cases) {
      xml += fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"{:.3f}\">\n",
                         escape(queue), escape(label(*result)), result->seconds);
      for (const BrokenClaim& finding : result->findings) {
        xml += fmt::format("      <failure message=\"{}\">{}\nrepeat: {}</failure>\n",
                           escape(finding.claim), escape(finding.evidence), escape(finding.repeat));
      }
      xml += "    </testcase>\n";
    }
    xml += "  </testsuite>\n";
  }
  return xml + "</testsuites>\n";
}

}  // namespace irt::stress
