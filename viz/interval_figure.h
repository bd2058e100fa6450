#pragma once
// Mean values with intervals over a parameter: one plot, or small multiples with common axes.

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "viz/picture_file.h"

namespace sf::viz {

enum class AxisScale : std::uint8_t { automatic, linear, logarithmic };

/// One mean. NaN: unknown; the line has a gap there.
struct IntervalPoint {
  double x = 0.0;  ///< value, or index into `categories`; > 0 on a logarithmic axis
  double mean = NAN;
  double low = NAN, high = NAN;  ///< ends of its interval; NaN: none
};

struct IntervalLine {
  std::string name;  ///< in the legend; empty: omitted from it
  std::vector<IntervalPoint> points;
};

struct IntervalPlot {
  std::string title;                 ///< above the plot; may be empty
  std::vector<IntervalLine> lines;   ///< the same names in each plot of a figure
  std::vector<IntervalLine> others;  ///< grey, without intervals, for comparison
};

struct IntervalFigure {
  std::string title, subtitle;
  std::string x_name, y_name;           ///< with units
  std::vector<std::string> categories;  ///< along x; empty: numbers
  bool logarithmic = false;             ///< logarithmic x axis
  bool joined = true;                   ///< connect the points with a line
  bool proportion = false;              ///< y is in [0, 1]
  std::vector<IntervalPlot> plots;      ///< at least one
};

/// True for at least three values > 0 whose successive ratios are similar (the largest at most 1.5 times the smallest)
/// and that span a factor of 8 or more, such as 1, 2, 5, 10. @param values in any order
bool is_geometric(std::vector<double> values);

/// Each line has a distinct colour, dash pattern and marker. If x labels do not fit side by side, categories are
/// rotated and numbers thinned out.
/// @throws base::InputError naming the path if it cannot be written.
void draw_intervals(const IntervalFigure& figure, const std::string& path, const Page& page = {});

}  // namespace sf::viz
