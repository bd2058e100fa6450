#pragma once
// Plots of a sweep's metrics with 95 % intervals over the seeds. Uses only its table of jobs (jobs.csv), so plots can
// be redrawn without the sweep's files.

#include <string>
#include <string_view>
#include <vector>

#include "viz/interval_figure.h"

namespace sf::scenarios {

struct SweepPlotChoice {
  std::string over;  ///< parameter along x; empty: the first that varies and is numeric, else the first that varies
  viz::AxisScale x_axis = viz::AxisScale::automatic;
  std::string format = "png";  ///< suffix of the pictures
  viz::Page page;
};

struct SweepPlots {
  std::vector<std::string> files;  ///< written files
  std::vector<std::string> notes;  ///< parts of the sweep that are not plotted, with the reason
};

/// Draws into `folder` each metric that any job has. One parameter: a line. Two: a line for each value of the other
/// one, and a page of small multiples. More: small multiples of such plots. Points of a sample are not connected, and
/// each parameter has its own figure.
/// @param jobs text of the table; `file` names it in errors
/// @throws base::InputError with the line of a damaged table, for an unknown parameter, and for a logarithmic axis of
/// values that are not above 0
SweepPlots draw_sweep(const std::string& file, std::string_view jobs, const std::string& folder,
                      const SweepPlotChoice& choice);

}  // namespace sf::scenarios
