#pragma once
// Values over time: panels one below another, over one axis of seconds (or of another quantity).

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "viz/heat_map.h"
#include "viz/picture_file.h"

namespace sf::viz {

/// One quantity, in order of time. Rule: equal numbers of times and values.
struct Series {
  std::string name;
  std::vector<double> times;   ///< [s], or in the unit of the x axis; finite
  std::vector<double> values;  ///< in the panel's unit; the line is broken at values that are not finite
};

struct Panel {
  std::string title;   ///< above its plot; may be empty
  std::string y_name;  ///< name of its axis with the unit: `distance [m]`
  std::vector<Series> series;
  bool from_zero = false;      ///< its axis begins at 0 in any case, so that small differences look small
  bool whole = false;          ///< values are integers, which last until the next one: steps, and integer ticks
  std::optional<HeatMap> map;  ///< in place of curves; y_name is then the name of its rows
};

struct SeriesOptions {
  std::string title;
  std::string subtitle;
  std::vector<Panel> panels;  ///< at least one, at most 16
  std::string x_name = "time [s]";
  bool from_zero = false;  ///< axes begin at 0 unless more than half of their length would be empty
  int width = 1600;        ///< [px] of the picture, in [600, 8000]
};

/// Draws each series in the colour and the dashes of its row. Up to eight are named below their panel; of more, seven
/// from the first to the last, and the number of the others; those without a value are not. Neighbouring panels with
/// the same names have one legend, below the last of them. Plots are lower where the page is narrow, or has a height.
/// @throws base::InputError naming the path when it cannot be written.
void draw_series(const SeriesOptions& options, const std::string& path, const Page& page = {});

}  // namespace sf::viz
