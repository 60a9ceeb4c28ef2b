#include "bench/report/plots.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fmt/format.h>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "bench/running/text_files.hpp"
#include "stress/running/child.hpp"

namespace irt::report {
namespace {

// As in page.css: distinguishable by colour-blind readers, on white.
constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#a8477e",
                             "#b07a00", "#2f9bd6", "#333333", "#7a7f00"};
constexpr const char* baseline_colour = "#8a8a8a";
constexpr std::array filled_marks{7, 5, 9, 13, 11};
constexpr std::array open_marks{6, 4, 8, 12, 10};

std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }, ' ');
  return text;
}

// Between single quotes gnuplot expands nothing; such a quote is doubled.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : one_line(text)) {
    result += c;
    if (c == '\'') result += c;
  }
  return result + "'";
}

// A block per series, two empty lines between them; "?" where there is no interval.
std::string data_of(const Panel& panel, const Plot& plot) {
  std::string text = fmt::format("# {}\n", one_line(panel.title));
  text += fmt::format("# {}\n", one_line(plot.title));
  for (const Fact& fact : panel.facts) {
    text += fmt::format("# {}: {}\n", fact.name, one_line(fact.value));
  }
  bool first = true;
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    if (plot.lines[i].empty()) continue;
    if (!first) text += "\n\n";
    first = false;
    text += fmt::format("# {}\n# x y low high\n", one_line(panel.series[i].name));
    for (const Point& point : plot.lines[i]) {
      const auto or_missing = [](const std::optional<double>& value) {
        return value ? fmt::format("{:.9g}", *value) : std::string("?");
      };
      text += fmt::format("{:.9g} {:.9g} {} {}\n", plot.dots ? static_cast<double>(i) : point.x,
                          point.y, or_missing(point.low), or_missing(point.high));
    }
  }
  return text + '\n';
}

// Where a position has a name in place of a number.
std::string tics(const char* axis, const std::vector<std::string>& names) {
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i) {
    list += fmt::format("{}{} {}", i == 0 ? "" : ", ", quoted(names[i]), i);
  }
  return fmt::format("set {}tics ({})\n", axis, list);
}

// An upright line each, with its name beside it.
std::string marks_of(const Plot& plot) {
  std::string lines;
  for (const Mark& mark : plot.marks) {
    lines += fmt::format(
        "set arrow from {0}, graph 0 to {0}, graph 1 nohead dt 3 lc rgb '#707070'\n"
        "set label {1} at {0}, graph 0.02 rotate by 90 offset character -0.9,0 "
        "textcolor rgb '#707070'\n",
        mark.x, quoted(mark.name));
  }
  return lines;
}

std::string axes_of(const Panel& panel, const Plot& plot) {
  if (plot.dots) {
    std::vector<std::string> names;
    for (const Series& series : panel.series) names.push_back(series.name);
    return fmt::format("set xlabel {}\n{}set yrange [{}:-1]\nset key off\n{}", quoted(plot.title),
                       plot.log_y ? "set logscale x\n" : "set xrange [0:*]\n", panel.series.size(),
                       tics("y", names));
  }
  return fmt::format(
             "set xlabel {}\nset ylabel {}\n{}{}{}set key outside bottom center maxcols 2 Left "
             "reverse\n",
             quoted(plot.x_title), quoted(plot.title), plot.log_x ? "set logscale x 2\n" : "",
             plot.log_y ? "set logscale y\n" : "set yrange [0:*]\n",
             plot.categories.empty() ? "" : tics("x", plot.categories)) +
         marks_of(plot);
}

std::string script_of(const Panel& panel, const Plot& plot, const std::string& name) {
  std::string lines;
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    if (plot.lines[i].empty()) continue;
    const Series& series = panel.series[i];
    const auto& marks = series.simulated ? open_marks : filled_marks;
    const std::string style =
        fmt::format("lc rgb '{}' pt {} dt {}{}",
                    series.baseline ? baseline_colour : colours[series.colour % colours.size()],
                    marks[series.colour % marks.size()], series.simulated ? 2 : 1,
                    series.baseline ? " lw 0.6" : "");
    // An index counts the blocks that have lines.
    const auto block = std::ranges::count_if(plot.lines.begin(),
                                             plot.lines.begin() + static_cast<std::ptrdiff_t>(i),
                                             [](const auto& line) { return !line.empty(); });
    const std::string block_of = fmt::format("'{}.dat' index {}", name, block);
    if (!lines.empty()) lines += ", \\\n  ";
    const char* columns = plot.dots ? "2:1" : "1:2";
    lines += fmt::format("{} using {} with {} {} title {}", block_of, columns,
                         plot.dots ? "points" : "linespoints", style, quoted(series.name));
    const bool bounded = std::ranges::any_of(
        plot.lines[i], [](const Point& point) { return point.low && point.high; });
    if (bounded) {
      lines += fmt::format(", \\\n  {} using {}:3:4 with {}errorbars {} notitle", block_of, columns,
                           plot.dots ? "x" : "y", style);
    }
  }
  return fmt::format(
      "# {}: {}\nreset\nset datafile missing '?'\nset title {}\nset grid\n{}"
      "set terminal svg size 760,{} background 'white' font 'Helvetica,14' noenhanced\n"
      "set output '{}.svg'\nplot {}\n"
      "set terminal pdfcairo size 16cm,{}cm font 'Helvetica,10' noenhanced\n"
      "set output '{}.pdf'\nreplot\nset output\n",
      one_line(panel.title), one_line(plot.title),
      quoted(panel.variant.empty() ? panel.title : panel.title + ": " + panel.variant),
      axes_of(panel, plot), 400 + 24 * panel.series.size(), name, lines,
      9 + panel.series.size() / 2, name);
}

// What a caption must say.
std::string caption_of(const Panel& panel, const Plot& plot) {
  std::string text = fmt::format("{}: {}\n", one_line(panel.title), one_line(plot.title));
  if (!panel.variant.empty()) text += one_line(panel.variant) + '\n';
  for (const Fact& fact : panel.facts) {
    text += fmt::format("{}: {}\n", fact.name, one_line(fact.value));
  }
  const std::vector<std::string> columns = series_columns();
  for (const Series& series : panel.series) {
    text += fmt::format("\n{}\n", one_line(series.name));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      text += fmt::format("  {}: {}\n", columns[i], one_line(series.facts[i]));
    }
  }
  return text;
}

bool draw(const std::vector<std::string>& scripts, const std::filesystem::path& directory) {
  std::vector<std::string> words{"gnuplot"};
  words.insert(words.end(), scripts.begin(), scripts.end());
  Child gnuplot([&](int) {
    std::filesystem::current_path(directory);
    if (std::freopen("gnuplot.log", "w", stderr) == nullptr) _exit(1);
    become(words);
  });
  const int status = gnuplot.wait();
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

PlotsWritten write_plots(std::span<const Panel> panels, const std::filesystem::path& directory) {
  std::vector<std::string> scripts;
  for (const Panel& panel : panels) {
    for (const Plot& plot : panel.plots) {
      const std::string name = fmt::format("{}-{}", panel.name, plot.name);
      if (scripts.empty()) require_writable(directory / (name + ".dat"));
      write_text(directory / (name + ".dat"), data_of(panel, plot));
      write_text(directory / (name + ".txt"), caption_of(panel, plot));
      scripts.push_back(name + ".gp");
      write_text(directory / scripts.back(), script_of(panel, plot, name));
    }
  }
  return {.count = scripts.size(), .drawn = !scripts.empty() && draw(scripts, directory)};
}

}  // namespace irt::report
