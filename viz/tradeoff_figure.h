#pragma once
// Speed over error, one panel per sensor type. Points to the upper left are better.

#include <span>
#include <string>
#include <vector>

#include "viz/picture_file.h"

namespace sf::viz {

/// The elements with an error bound.
struct BoundedShare {
  double part = 0.0;   ///< [-] share of all elements, in [0, 1]
  double high = 0.0;   ///< their largest error
  double bound = 0.0;  ///< unused if the share is 0
};

/// One accuracy mode. Rule: rates and errors are not negative.
struct TradeoffPoint {
  std::string name;
  double rate = 0.0;  ///< [1/s] > 0
  double low = 0.0, middle = 0.0,
         high = 0.0;  ///< errors of all elements, ascending; below 1e-12 they count as 0; infinite: outside of the plot
  bool front = false;  ///< Pareto-optimal: no other mode is both faster and more accurate
  BoundedShare covered;
};

struct TradeoffPanel {
  std::string title;
  std::string rate_name;   ///< name of the counted items: `rays`
  std::string error_name;  ///< with the unit
  std::vector<TradeoffPoint> points;
};

/// Errors are on a logarithmic axis, rates begin at 0. A point is at its `middle` error, with a whisker from `low` to
/// `high`. A ring marks the bound of the covered elements, a cross their largest error; names include the covered
/// share.
/// @throws base::InputError naming the path if it cannot be written.
void draw_tradeoff(const std::string& title, const std::string& subtitle, std::span<const TradeoffPanel> panels,
                   const std::string& path, const Page& page = {});

}  // namespace sf::viz
