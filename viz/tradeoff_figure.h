#pragma once
// Speed over error, a panel a kind of sensor: what is up and to the left is better.

#include <span>
#include <string>
#include <vector>

namespace sf::viz {

/// One way to measure. Rule: rates and errors are not negative.
struct TradeoffPoint {
  std::string name;
  double rate = 0.0;  ///< [1/s] > 0
  double low = 0.0, middle = 0.0,
         high = 0.0;   ///< errors, ascending; below 1e-12 they are none; infinite: beyond the plot
  bool front = false;  ///< on the line of those that nothing beats
};

struct TradeoffPanel {
  std::string title;
  std::string rate_name;   ///< of what is counted: `rays`
  std::string error_name;  ///< with the unit
  std::vector<TradeoffPoint> points;
};

/// Errors are logarithmic, rates begin at 0. A point is at its `middle` error, a whisker goes from `low` to `high`.
/// @throws base::InputError naming the path when it cannot be written.
void draw_tradeoff(const std::string& title, const std::string& subtitle, std::span<const TradeoffPanel> panels,
                   const std::string& png_path);

}  // namespace sf::viz
