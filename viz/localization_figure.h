#pragma once
// An estimated track over the true one, with covariance ellipses.

#include <array>
#include <string>
#include <vector>

#include "viz/picture_file.h"
#include "viz/tracks.h"

namespace sf::viz {

/// Three standard deviations around a point.
struct CovarianceEllipse {
  glm::dvec2 p{};                      ///< [m]
  std::array<double, 3> covariance{};  ///< [m^2] xx, xy, yy; positive semidefinite
};

struct LocalizationFigure {
  std::string title, subtitle;
  Track truth, estimate;
  std::vector<CovarianceEllipse> ellipses;
  std::vector<glm::dvec2> landmarks;  ///< [m]
};

/// @throws base::InputError naming the path if it cannot be written.
void draw_localization(const LocalizationFigure& figure, const std::string& path, const Page& page = {});

}  // namespace sf::viz
