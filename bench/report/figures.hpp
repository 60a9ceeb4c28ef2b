/// From runs to the figures of a report: which runs belong beside each other, and over what.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/report/facts.hpp"
#include "bench/report/results.hpp"

namespace irt::report {

struct Point {
  double x = 0, y = 0;
  std::optional<double> low, high;  ///< 95 % interval, where there is one
  std::vector<double> samples;      ///< one value per repetition
  std::size_t run = 0;              ///< index into Results::runs
};

/// The runs of one queue that differ in `Panel::x` alone.
struct Series {
  std::string name;
  bool simulated = false;
  bool baseline = false;   ///< what queues are measured against, see baseline_queues()
  std::size_t colour = 0;  ///< a number that a queue keeps throughout a report
  std::vector<std::size_t> runs;
  std::vector<std::string> facts;  ///< by `series_columns()`
};

/// A place on the x axis that means something to a simulated machine.
struct Mark {
  double x = 0;
  std::string name;
};

/// One figure of merit of all series of a panel. Axes are logarithmic where the range asks for it.
struct Plot {
  std::string name;   ///< for a file
  std::string title;  ///< with the unit in brackets
  std::string x_title;
  bool log_x = false, log_y = false;
  bool dots = false;                      ///< one value per series: a row each, `Point::x` unused
  std::vector<std::string> categories;    ///< names of x = 0, 1 ...; empty where x is a number
  std::vector<std::vector<Point>> lines;  ///< by series, each by rising x
  std::vector<Mark> marks;                ///< within the range of the points
};

/// Several plots of the same series, with what must be known about them.
struct Panel {
  Family family;
  std::string title;    ///< the scene or the scenario, and over what
  std::string variant;  ///< in what panels of the same title differ; may be empty
  std::string name;     ///< for a file
  std::vector<Series> series;
  std::vector<Plot> plots;
  std::vector<Fact> facts;
};

/// Every panel that `results` have something for.
std::vector<Panel> panels_of(const Results& results);

}  // namespace irt::report
