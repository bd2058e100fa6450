#pragma once
// Means with their intervals over a parameter: one plot, or small multiples with common axes.

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "viz/picture_file.h"

namespace sf::viz {

enum class AxisScale : std::uint8_t { automatic, linear, logarithmic };

/// One mean. NaN: unknown; the line is broken there.
struct IntervalPoint {
  double x = 0.0;  ///< value, or row of `categories`; above 0 on a logarithmic axis
  double mean = NAN;
  double low = NAN, high = NAN;  ///< ends of its interval; NaN: none
};

struct IntervalLine {
  std::string name;  ///< in the legend; empty: not there
  std::vector<IntervalPoint> points;
};

struct IntervalPlot {
  std::string title;                 ///< above it; may be empty
  std::vector<IntervalLine> lines;   ///< the same names in each plot of a figure
  std::vector<IntervalLine> others;  ///< grey, without intervals, for comparison
};

struct IntervalFigure {
  std::string title, subtitle;
  std::string x_name, y_name;           ///< with their units
  std::vector<std::string> categories;  ///< along x; empty: numbers
  bool logarithmic = false;             ///< x
  bool joined = true;                   ///< a line through the points
  bool proportion = false;              ///< y is in [0, 1]
  std::vector<IntervalPlot> plots;      ///< at least one
};

/// True for at least three values above 0 whose successive ratios are about equal (the largest at most 1.5 times the
/// smallest) and span a factor of 8 or more, such as 1, 2, 5, 10. @param values in any order
bool is_geometric(std::vector<double> values);

/// Each line has its colour, its dashes and the shape of its points. Labels of x that do not fit side by side are
/// upright (categories) or fewer (numbers).
/// @throws base::InputError naming the path when it cannot be written.
void draw_intervals(const IntervalFigure& figure, const std::string& path, const Page& page = {});

}  // namespace sf::viz
