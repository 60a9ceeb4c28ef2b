/// `irt report`: results as a page to read, and as plots for a paper.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/report/figures.hpp"
#include "bench/report/page.hpp"
#include "bench/report/plots.hpp"
#include "bench/report/results.hpp"
#include "bench/running/text_files.hpp"
#include "stress/running/arguments.hpp"
#include "stress/running/program.hpp"

namespace irt::report {
namespace {

struct Options {
  std::vector<std::filesystem::path> places;
  std::filesystem::path out = "irt-out/report.html", plots;
};

void report(const Options& options) {
  const Results results = read_results(options.places);
  const std::vector<Panel> panels = panels_of(results);
  require_writable(options.out);
  write_text(options.out, page_of(results, panels));
  for (const std::string& note : results.notes) fmt::print(stderr, "note: {}\n", note);
  fmt::print(stderr, "{} runs of {} files: {}\n", results.runs.size(), results.files.size(),
             options.out.string());
  if (options.plots.empty()) return;
  const PlotsWritten written = write_plots(panels, options.plots);
  fmt::print(stderr, "{} plots with their data and scripts: {}{}\n", written.count,
             options.plots.string(),
             written.drawn ? "" : "; not drawn, for that gnuplot is needed (gnuplot-nox)");
}

int run(int argc, char** argv) {
  CLI::App app("Makes one page of any results: plots, tables, conditions.", "irt report");
  Options options;
  app.add_option("results", options.places,
                 "result files, or directories of them (default: irt-out)");
  app.add_option("--out", options.out, "the page")->capture_default_str();
  app.add_option("--plots", options.plots,
                 "directory for the plots alone: SVG, PDF, data, gnuplot scripts");
  tell_in_one_line(app, "irt");
  if (const auto code = parse(app, argc, argv)) return *code;
  if (options.places.empty()) options.places.emplace_back("irt-out");
  report(options);
  return 0;
}

}  // namespace
}  // namespace irt::report

int main(int argc, char** argv) {
  return irt::run_program("irt", [&] { return irt::report::run(argc, argv); });
}
