#pragma once
// Speed over error, a panel a kind of sensor: what is up and to the left is better.

#include <span>
#include <string>
#include <vector>

namespace sf::viz {

/// What a stated bound says of a part of all.
struct BoundedShare {
  double part = 0.0;   ///< [-] in [0, 1]
  double high = 0.0;   ///< its largest error
  double bound = 0.0;  ///< not looked at where the part is 0
};

/// One way to measure. Rule: rates and errors are not negative.
struct TradeoffPoint {
  std::string name;
  double rate = 0.0;  ///< [1/s] > 0
  double low = 0.0, middle = 0.0,
         high = 0.0;   ///< errors of all, ascending; below 1e-12 they are none; infinite: beyond the plot
  bool front = false;  ///< on the line of those that nothing beats
  BoundedShare covered;
};

struct TradeoffPanel {
  std::string title;
  std::string rate_name;   ///< of what is counted: `rays`
  std::string error_name;  ///< with the unit
  std::vector<TradeoffPoint> points;
};

/// Errors are logarithmic, rates begin at 0. A point is at its `middle` error, a whisker goes from `low` to `high`. A
/// ring stands at the bound of what is covered, a cross at the largest error there; names say how much is covered.
/// @throws base::InputError naming the path when it cannot be written.
void draw_tradeoff(const std::string& title, const std::string& subtitle, std::span<const TradeoffPanel> panels,
                   const std::string& png_path);

}  // namespace sf::viz
