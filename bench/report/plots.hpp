/// The plots alone, for a paper.
#pragma once

#include <filesystem>
#include <span>

#include "bench/report/figures.hpp"

namespace irt::report {

/// Writes for every plot of every panel into `directory`, which is made: NAME.dat (the values),
/// NAME.gp (a gnuplot script), NAME.txt (what must be said beside it); and for all, where gnuplot
/// is installed, NAME.svg and NAME.pdf. Returns how many plots were written, and whether they were
/// drawn. Throws UsageError where the directory cannot be written.
struct PlotsWritten {
  std::size_t count = 0;
  bool drawn = false;
};
PlotsWritten write_plots(std::span<const Panel> panels, const std::filesystem::path& directory);

}  // namespace irt::report
