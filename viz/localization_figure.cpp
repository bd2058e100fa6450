#include "viz/localization_figure.h"

#include <cmath>

#include "viz/axes.h"
#include "viz/color.h"
#include "viz/theme.h"

namespace sf::viz {
namespace {

constexpr int kCorners = 40;
constexpr double kSigmas = 3.0;

/// Returns the outline of an ellipse, from the Cholesky factor of its covariance.
std::vector<glm::dvec2> outline_of(const Axes& axes, const CovarianceEllipse& ellipse) {
  const auto [xx, xy, yy] = ellipse.covariance;
  const double a = std::sqrt(std::max(xx, 1e-12)), b = xy / a, c = std::sqrt(std::max(yy - b * b, 0.0));
  std::vector<glm::dvec2> points;
  for (int k = 0; k <= kCorners; ++k) {
    const double angle = 2.0 * M_PI * k / kCorners, u = kSigmas * std::cos(angle), v = kSigmas * std::sin(angle);
    points.push_back(axes.pixel(ellipse.p + glm::dvec2{a * u, b * u + c * v}));
  }
  return points;
}

}  // namespace

void draw_localization(const LocalizationFigure& figure, const std::string& path, const Page& page) {
  const std::uint32_t truth = theme::kReferencePath, estimate = row_color(0, 3), ellipse = row_color(1, 3);
  FigureOptions options{.title = figure.title, .subtitle = figure.subtitle, .page = page};
  std::vector<Track> tracks{figure.truth, figure.estimate};
  for (const glm::dvec2& p : figure.landmarks) tracks.front().poses.push_back({p.x, p.y, 0.0, 0.0});
  options.extent = extent_of({}, tracks);
  options.legend = {{LegendMark::line, truth, "truth"},
                    {LegendMark::line, estimate, "estimate"},
                    {LegendMark::ring, ellipse, "three standard deviations"}};
  if (!figure.landmarks.empty()) options.legend.push_back({LegendMark::dot, theme::kFrame, "landmark"});
  Axes axes(std::move(options));
  draw_path(axes, figure.truth, 3.0, truth);
  for (const CovarianceEllipse& each : figure.ellipses)
    axes.canvas().polyline(outline_of(axes, each), 1.2, with_opacity(ellipse, 0.8));
  draw_path(axes, figure.estimate, 1.6, estimate);
  for (const glm::dvec2& p : figure.landmarks) axes.canvas().disc(axes.pixel(p), 6.0, theme::kFrame);
  axes.save(path);
}

}  // namespace sf::viz
