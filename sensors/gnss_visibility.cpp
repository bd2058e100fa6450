#include "sensors/gnss_visibility.h"

#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "base/elementary.h"
#include "base/error.h"

namespace sf::sensors {

namespace {

using world::Segment;

constexpr double kMostPieces = 64.0;  // largest number of steps along a line of sight
constexpr double kSingular = 1e-9;    // of the satellites' normal matrix

bool blocks(const Segment& wall) { return wall.seen_by_laser || wall.stops_robots; }

std::vector<Segment> blocking(const world::World& world) {
  std::vector<Segment> walls;
  std::copy_if(world.walls.begin(), world.walls.end(), std::back_inserter(walls), blocks);
  return walls;
}

double top_of(std::span<const Segment> walls) {
  double top = -HUGE_VAL;
  for (const Segment& wall : walls) top = std::max(top, wall.z_max);
  return top;
}

/// Returns a piece length [m], about a tenth of a line of sight to the lowest satellite.
double piece_of(std::span<const Segment> walls) {
  double bottom = HUGE_VAL;
  for (const Segment& wall : walls) bottom = std::min(bottom, wall.z_min);
  return walls.empty() ? 1.0 : std::max(0.5, 0.4 * (top_of(walls) - bottom));
}

}  // namespace

double top_of_blocking(const world::World& world) {
  double top = -HUGE_VAL;
  for (const Segment& wall : world.walls)
    if (blocks(wall)) top = std::max(top, wall.z_max);
  return top;
}

std::vector<Satellite> constellation(std::uint32_t count) {
  SF_CHECK(count >= 1 && count <= 64, std::to_string(count) + " satellites");
  const double golden = M_PI * (3.0 - std::sqrt(5.0));
  std::vector<Satellite> satellites;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double up = base::sin(kLeastElevation) + (1.0 - base::sin(kLeastElevation)) * (i + 0.5) / count;
    satellites.push_back({base::rotate(golden * i, {1.0, 0.0}), up / std::sqrt(1.0 - up * up)});
  }
  return satellites;
}

std::optional<Dilution> dilution(std::span<const Satellite> satellites, std::uint64_t seen) {
  // Normal matrix of (clock, up, x, y), lower half.
  std::array<std::array<double, 4>, 4> m{};
  int count = 0;
  for (std::size_t i = 0; i < satellites.size(); ++i) {
    if ((seen >> i & 1) == 0) continue;
    ++count;
    const Satellite& s = satellites[i];
    const double horizontal = 1.0 / std::sqrt(1.0 + s.tan_elevation * s.tan_elevation);
    const std::array<double, 4> row{1.0, s.tan_elevation * horizontal, s.horizontal.x * horizontal,
                                    s.horizontal.y * horizontal};
    for (std::size_t r = 0; r < 4; ++r)
      for (std::size_t c = 0; c <= r; ++c) m[r][c] += row[r] * row[c];
  }
  if (count < 4) return std::nullopt;

  // Its Cholesky factor. The inverse of the product of its last 2 x 2 block is the covariance of (x, y).
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t c = 0; c <= r; ++c) {
      for (std::size_t k = 0; k < c; ++k) m[r][c] -= m[r][k] * m[c][k];
      if (r == c && m[r][r] < kSingular) return std::nullopt;
      m[r][c] = r == c ? std::sqrt(m[r][r]) : m[r][c] / m[c][c];
    }
  // Cholesky factor with x first: for Q = [a b; b d] it is [sqrt(a) 0; b / sqrt(a), sqrt(d - b^2 / a)].
  const double l = m[2][2], k = m[3][2], n = m[3][3];
  const double a = 1.0 / (l * l) + k * k / (l * l * n * n), b = -k / (l * n * n), d = 1.0 / (n * n);
  // The errors (up, x, y) solve the transposed factor for three normal numbers, so up follows from the others.
  const double z = 1.0 / m[1][1], zx = -m[2][1] * z, zy = -m[3][1] * z;
  return Dilution{std::sqrt(a),
                  b / std::sqrt(a),
                  std::sqrt(std::max(0.0, d - b * b / a)),
                  std::sqrt(a + d),
                  zx,
                  zy,
                  z,
                  std::sqrt(zx * zx * a + 2.0 * zx * zy * b + zy * zy * d + z * z)};
}

GnssVisibility::GnssVisibility(const world::World& world) : GnssVisibility(blocking(world)) {}

GnssVisibility::GnssVisibility(std::vector<Segment> walls)
    : piece_(piece_of(walls)), z_top_(top_of(walls)), walls_(std::move(walls)) {
  add_solids(walls_.walls());
}

/// Adds one solid per model and range of heights. Overlapping parts add to the winding number.
void GnssVisibility::add_solids(std::span<const Segment> walls) {
  std::map<std::tuple<std::uint32_t, double, double>, std::vector<Segment>> outlines;
  for (const Segment& wall : walls)
    if (wall.solid_left) outlines[{wall.model, wall.z_min, wall.z_max}].push_back(wall);
  std::vector<base::Box> boxes;
  for (const auto& [key, edges] : outlines) {
    const auto first = static_cast<std::uint32_t>(solid_edges_.size());
    solid_edges_.insert(solid_edges_.end(), edges.begin(), edges.end());
    solids_.push_back({first, static_cast<std::uint32_t>(solid_edges_.size()), std::get<1>(key)});
    boxes.push_back(world::box_of(edges));
  }
  boxes_ = base::BoxTree(boxes);
}

bool GnssVisibility::crosses(glm::dvec2 p, double z, const Satellite& satellite, const Segment& wall) const {
  const glm::dvec2 along = wall.b - wall.a, to = wall.a - p;
  const double turn = base::cross(satellite.horizontal, along);
  if (turn == 0.0) return false;  // edge on
  const double way = base::cross(to, along) / turn;
  const double t = base::cross(to, satellite.horizontal) / turn;
  if (way < 0.0 || t < 0.0 || t > 1.0) return false;
  const double height = z + way * satellite.tan_elevation;
  return height >= wall.z_min && height < wall.z_max;
}

bool GnssVisibility::under(glm::dvec2 p, double z, const Satellite& satellite, const Solid& solid) const {
  if (solid.z_min <= z) return false;
  const glm::dvec2 q = p + (solid.z_min - z) / satellite.tan_elevation * satellite.horizontal;
  return world::winding_number(std::span(solid_edges_).subspan(solid.first, solid.last - solid.first), q) > 0;
}

bool GnssVisibility::is_visible(glm::dvec2 p, double z, const Satellite& satellite) const {
  const double way = (z_top_ - z) / satellite.tan_elevation;
  if (!(way > 0.0)) return true;
  const glm::dvec2 end = p + way * satellite.horizontal;
  const bool roofed =
      boxes_.any(base::box_of(p, end), [&](std::uint32_t i) { return under(p, z, satellite, solids_[i]); });
  if (roofed) return false;
  const int pieces = static_cast<int>(std::min(std::ceil(way / piece_), kMostPieces));
  for (int i = 0; i < pieces; ++i) {
    const glm::dvec2 from = p + way * i / pieces * satellite.horizontal,
                     to = p + way * (i + 1) / pieces * satellite.horizontal;
    if (walls_.any(base::box_of(from, to), [&](const Segment& wall) { return crosses(p, z, satellite, wall); }))
      return false;
  }
  return true;
}

}  // namespace sf::sensors
