#include "bench/report/page.hpp"

#include <fmt/format.h>

#include "bench/conditions/build_info.hpp"
#include "bench/report/facts.hpp"
#include "bench/report/page_files.hpp"
#include "bench/report/tables.hpp"

namespace irt::report {
namespace {

using Json = nlohmann::ordered_json;

Json or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}

Json points_of(const std::vector<Point>& line) {
  Json points = Json::array();
  for (const Point& point : line) {
    points.push_back({{"x", point.x},
                      {"y", point.y},
                      {"low", or_null(point.low)},
                      {"high", or_null(point.high)},
                      {"samples", point.samples}});
  }
  return points;
}

Json plot_of(const Plot& plot) {
  Json lines = Json::array();
  for (const auto& line : plot.lines) lines.push_back(points_of(line));
  Json marks = Json::array();
  for (const Mark& mark : plot.marks) marks.push_back({{"x", mark.x}, {"name", mark.name}});
  return {{"title", plot.title},
          {"xTitle", plot.x_title},
          {"logX", plot.log_x},
          {"logY", plot.log_y},
          {"dots", plot.dots},
          {"lines", lines},
          {"categories", plot.categories},
          {"marks", marks}};
}

Json panel_of(const Panel& panel) {
  constexpr const char* families[] = {"frames", "operations", "micro"};
  Json series = Json::array(), plots = Json::array(), facts = Json::array();
  for (const Series& one : panel.series) {
    series.push_back({{"name", one.name},
                      {"simulated", one.simulated},
                      {"baseline", one.baseline},
                      {"colour", one.colour},
                      {"facts", one.facts}});
  }
  for (const Plot& plot : panel.plots) plots.push_back(plot_of(plot));
  for (const Fact& fact : panel.facts) facts.push_back({fact.name, fact.value});
  return {{"family", families[static_cast<std::size_t>(panel.family)]},
          {"title", panel.title},
          {"variant", panel.variant},
          {"name", panel.name},
          {"series", series},
          {"plots", plots},
          {"facts", facts}};
}

// Inside a script element the parser knows nothing but "</script" and "<!--".
std::string data_text(const Json& data) {
  std::string text;
  for (const char c : data.dump()) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

void fill(std::string& page, std::string_view mark, std::string_view text) {
  const std::size_t at = page.find(mark);
  page.replace(at, mark.size(), text);
}

}  // namespace

std::string page_of(const Results& results, std::span<const Panel> panels) {
  Json data{
      {"commit", build_commit},      {"runs", results.runs.size()},       {"notes", results.notes},
      {"files", Json::array()},      {"seriesColumns", series_columns()}, {"panels", Json::array()},
      {"tables", tables_of(results)}};
  std::size_t simulated = 0;
  for (const Run& run : results.runs) simulated += run.simulated() ? 1 : 0;
  data["simulated"] = simulated;
  for (const ResultFile& file : results.files) {
    data["files"].push_back({{"name", file.name}, {"runs", file.runs}});
  }
  for (const Panel& panel : panels) data["panels"].push_back(panel_of(panel));

  std::string page = page_html;
  fill(page, "/*STYLE*/", page_css);
  fill(page, "/*SCRIPT*/", std::string(plots_js) + page_js);
  fill(page, "/*DATA*/", data_text(data));  // last: nothing is looked for in what it holds
  return page;
}

}  // namespace irt::report
