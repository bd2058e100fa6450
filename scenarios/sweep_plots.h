#pragma once
// Plots of a sweep's metrics with 95 % intervals over the seeds, from its table of jobs (jobs.csv), so that they can be
// drawn again without the sweep's files.

#include <string>
#include <string_view>
#include <vector>

#include "viz/interval_figure.h"

namespace sf::scenarios {

struct SweepPlotChoice {
  std::string over;  ///< parameter along x; empty: the first whose values are numbers and differ, else the first that
                     ///< differs
  viz::AxisScale x_axis = viz::AxisScale::automatic;
  std::string format = "png";  ///< suffix of the pictures
  viz::Page page;
};

struct SweepPlots {
  std::vector<std::string> files;  ///< written
  std::vector<std::string> notes;  ///< parts of the sweep that are in no plot, and why
};

/// Draws each metric that some job has into `folder`. One parameter: a line; two: a line for each value of the other
/// one, and a page of small multiples; more: small multiples of such plots. Points of a sample are not joined, and each
/// parameter has a figure of its own.
/// @param jobs text of the table; `file` names it in errors
/// @throws base::InputError with the line of a damaged table, for an unknown parameter, and for a logarithmic axis of
/// values that are not above 0
SweepPlots draw_sweep(const std::string& file, std::string_view jobs, const std::string& folder,
                      const SweepPlotChoice& choice);

}  // namespace sf::scenarios
