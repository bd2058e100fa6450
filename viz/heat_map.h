#pragma once
// Readings of many elements over time as colours: a row of cells per element. For panels of viz/series_figure.h.

#include <cmath>
#include <string>
#include <vector>

#include "viz/canvas.h"
#include "viz/legend.h"

namespace sf::viz {

/// Rule: as many readings as times, and in each a value per row.
struct HeatMap {
  std::string value_name;                     ///< with its unit, beside the bar of colours: `range [m]`
  std::vector<std::string> rows;              ///< label of each element, the upper row first
  std::vector<std::size_t> elements = {};     ///< number of each row's element, for tables; may be empty
  std::vector<std::string> short_rows = {};   ///< the same for narrow pictures; empty: `rows`
  std::string short_name = {};                ///< of the rows' axis where these are used
  std::vector<double> times;                  ///< [s] of each reading, in order
  std::vector<std::vector<double>> readings;  ///< by reading and row. NaN: no value; -infinity: too near
  double limit = HUGE_VAL;                    ///< values from here on are those of no return
  std::string too_near, no_return;            ///< words of the legend for both
  double longest_hold = 0.0;                  ///< [s] a reading lasts until the next one, at most as long as this
  bool whole = false;                         ///< values are integers
};

/// [px] of the widest label of a row.
double rows_room(const HeatMap& map);

/// [px] room for the bar of colours right of the plot, with its labels.
double bar_room(const HeatMap& map, double height);

/// The words for cells without a value of their own that the map has.
std::vector<LegendItem> heat_legend(const HeatMap& map, double from, double to);

/// The cells in `plot` over [from, to] [s], and the bar of colours to its right. A column of pixels shows the last
/// reading until its middle; where that is older than `longest_hold`, hatching.
void draw_heat_map(Canvas& canvas, const HeatMap& map, const PixelBox& plot, double from, double to);

}  // namespace sf::viz
