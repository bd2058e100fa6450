#pragma once
// Readings with many elements over time as colours, one row of cells per element. For panels of viz/series_figure.h.

#include <cmath>
#include <string>
#include <vector>

#include "viz/canvas.h"
#include "viz/legend.h"

namespace sf::viz {

/// Rule: `readings` has one entry per time, each with one value per row.
struct HeatMap {
  std::string value_name;                     ///< with its unit, shown at the colour bar: `range [m]`
  std::vector<std::string> rows;              ///< label of each element, the top row first
  std::vector<std::size_t> elements = {};     ///< index of each row's element, for tables; may be empty
  std::vector<std::string> short_rows = {};   ///< shorter labels for narrow pictures; empty: `rows`
  std::string short_name = {};                ///< name of the rows' axis if `short_rows` are used
  std::vector<double> times;                  ///< [s] of each reading, in order
  std::vector<std::vector<double>> readings;  ///< by reading and row. NaN: no value; -infinity: too near
  double limit = HUGE_VAL;                    ///< values from this limit on mean no return
  std::string too_near, no_return;            ///< legend texts for both
  double longest_hold = 0.0;                  ///< [s] a reading is shown until the next one, but no longer than this
  bool whole = false;                         ///< values are integers
};

/// [px] Returns the width of the widest row label.
double rows_room(const HeatMap& map);

/// [px] Returns the width of the colour bar right of the plot, including its labels.
double bar_room(const HeatMap& map, double height);

/// Legend items for the kinds of cells without a value that occur in the map.
std::vector<LegendItem> heat_legend(const HeatMap& map, double from, double to);

/// Draws the cells in `plot` over [from, to] [s], and the colour bar to its right. A pixel column shows the last
/// reading before its middle, or hatching if that is older than `longest_hold`.
void draw_heat_map(Canvas& canvas, const HeatMap& map, const PixelBox& plot, double from, double to);

}  // namespace sf::viz
