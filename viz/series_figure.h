#pragma once
// Values over time: panels one below another with a common axis in seconds (or another quantity).

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "viz/heat_map.h"
#include "viz/picture_file.h"

namespace sf::viz {

/// One quantity, sorted by time. Rule: as many times as values.
struct Series {
  std::string name;
  std::vector<double> times;   ///< [s], or in the unit of the x axis; finite
  std::vector<double> values;  ///< in the panel's unit; values that are not finite leave a gap in the line
};

struct Panel {
  std::string title;   ///< above its plot; may be empty
  std::string y_name;  ///< axis name with unit: `distance [m]`
  std::vector<Series> series;
  bool from_zero = false;      ///< the axis always begins at 0, so that small differences look small
  bool whole = false;          ///< values are integers that last until the next one: drawn as steps, with integer ticks
  std::optional<HeatMap> map;  ///< replaces the curves; y_name is then the name of its rows
};

struct SeriesOptions {
  std::string title;
  std::string subtitle;
  std::vector<Panel> panels;  ///< at least one, at most 16
  std::string x_name = "time [s]";
  bool from_zero = false;    ///< axes begin at 0 unless more than half of their length would be empty
  bool logarithmic = false;  ///< both axes; numbers that are not above 0 leave a gap. Not for heat maps
  int width = 1600;          ///< [px] of the picture, in [600, 8000]
};

/// Draws each series in the colour and the dashes of its row. The legend below a panel names up to eight series, or
/// seven from the first to the last and the number of the others; series without a value are omitted. Adjacent panels
/// with the same names share one legend, below the last of them. Plots are lower if the page is narrow or has a height.
/// @throws base::InputError naming the path if it cannot be written.
void draw_series(const SeriesOptions& options, const std::string& path, const Page& page = {});

}  // namespace sf::viz
