#include "vision/placement.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "base/elementary.h"
#include "base/error.h"
#include "base/pose.h"
#include "vision/tag_family.h"
#include "vision/tag_fit.h"

namespace sf::vision {

namespace {

constexpr std::size_t kFewestPoints = 4;
constexpr double kLeastSpread = 0.05;  // distance from the line through the two farthest points over their distance
constexpr std::size_t kFewestEdges = 3;

/// A line in normalised image coordinates: normal · p = offset.
struct Line {
  glm::dvec2 normal;
  double offset = 0.0;
};

/// Fits by total least squares.
Line fit_line(const std::vector<glm::dvec2>& points) {
  glm::dvec2 mean{0.0};
  for (const glm::dvec2& p : points) mean += p / static_cast<double>(points.size());
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const glm::dvec2& p : points) {
    const glm::dvec2 d = p - mean;
    xx += d.x * d.x, xy += d.x * d.y, yy += d.y * d.y;
  }
  const double angle = 0.5 * base::atan2(2.0 * xy, xx - yy);  // of the line
  const glm::dvec2 normal{-base::sin(angle), base::cos(angle)};
  return {normal, glm::dot(normal, mean)};
}

std::optional<glm::dvec2> meet(const Line& a, const Line& b) {
  const double det = base::cross(a.normal, b.normal);
  if (std::abs(det) < 1e-3) return std::nullopt;
  return glm::dvec2{a.offset * b.normal.y - b.offset * a.normal.y, a.normal.x * b.offset - b.normal.x * a.offset} / det;
}

using Corners = std::array<glm::dvec2, 4>;

/// [px] Returns the corners of a tag, in the order of its outline; nullopt if a side has no edge.
std::optional<Corners> corners_of(const Image& image, const Intrinsics& intrinsics, const TagOutline& outline,
                                  int cells) {
  std::vector<EdgePoint> edges;
  find_edges(image, outline, cells, edges);
  std::array<std::vector<glm::dvec2>, 4> sides;
  for (const EdgePoint& edge : edges)
    sides[static_cast<std::size_t>(edge.side)].push_back(undistort(intrinsics, edge.pixel));
  Corners corners;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& before = sides[(k + 3) % 4];
    if (before.size() < kFewestEdges || sides[k].size() < kFewestEdges) return std::nullopt;
    const auto corner = meet(fit_line(before), fit_line(sides[k]));
    if (!corner) return std::nullopt;
    corners[k] = distort(intrinsics, *corner);
    // Another object's edge, if the tag is partly hidden.
    if (glm::distance(corners[k], outline.corners[k]) > 4.0) return std::nullopt;
  }
  return corners;
}

/// Observations of one surveyed tag.
struct Seen {
  Corners sum{};
  std::size_t images = 0;
};

std::map<std::uint32_t, Seen> look(const Testbed& testbed, const Camera& camera, ImageSource& images,
                                   const std::string& from) {
  const auto finder = make_family_finder(testbed.dictionary);
  const int cells = family_pattern(testbed.dictionary, 0).cells;
  const std::size_t most = images.is_live() ? kLivePlacementImages : kMaxPlacementImages;
  std::map<std::uint32_t, Seen> seen;
  std::vector<TagOutline> found;
  Image image;
  for (std::size_t i = 0; i < most && images.next(image); ++i) {
    if (image.pixels.empty()) continue;
    if (image.width != camera.intrinsics.width || image.height != camera.intrinsics.height)
      throw base::InputError(from, 0,
                             fmt::format("image {} is {} x {}, but camera '{}' has size = [{}, {}]; expected the size "
                                         "with which it was calibrated",
                                         i + 1, image.width, image.height, camera.name, camera.intrinsics.width,
                                         camera.intrinsics.height));
    finder->find(image, whole(image), found);
    for (const TagOutline& outline : found) {
      if (testbed.surveyed.count(outline.id) == 0) continue;
      const auto corners = corners_of(image, camera.intrinsics, outline, cells);
      if (!corners) continue;
      Seen& tag = seen[outline.id];
      ++tag.images;
      for (std::size_t k = 0; k < 4; ++k) tag.sum[k] += (*corners)[k];
    }
  }
  return seen;
}

/// Points in the world and their pixels, tag by tag.
struct Points {
  std::vector<glm::dvec3> places;
  std::vector<glm::dvec2> pixels;

  std::size_t size() const { return pixels.size(); }
  /// [px²]
  double square(const Camera& camera, std::size_t i) const {
    const auto pixel = project(camera, places[i]);
    const double error = pixel ? glm::distance(*pixel, pixels[i]) : HUGE_VAL;
    return error * error;
  }
  Points without(std::size_t from, std::size_t to) const {
    Points others = *this;
    const auto cut = [&](auto& list) {
      list.erase(list.begin() + static_cast<std::ptrdiff_t>(from), list.begin() + static_cast<std::ptrdiff_t>(to));
    };
    cut(others.places);
    cut(others.pixels);
    return others;
  }

  void add(const SurveyedTag& tag, double side, const Corners& corners, const Intrinsics& intrinsics) {
    if (!tag.heading) {
      // The diagonals of a square meet at its centre in any perspective.
      Corners c;
      std::transform(corners.begin(), corners.end(), c.begin(), [&](glm::dvec2 p) { return undistort(intrinsics, p); });
      const auto center = meet(fit_line({c[0], c[2]}), fit_line({c[1], c[3]}));
      places.push_back(tag.position);
      pixels.push_back(distort(intrinsics, *center));
      return;
    }
    constexpr std::array<glm::dvec2, 4> kCorners{{{-0.5, 0.5}, {0.5, 0.5}, {0.5, -0.5}, {-0.5, -0.5}}};
    for (std::size_t k = 0; k < 4; ++k) {
      const glm::dvec2 p = base::rotate(*tag.heading, side * kCorners[k]);
      places.push_back(tag.position + glm::dvec3{p, 0.0});
      pixels.push_back(corners[k]);
    }
  }
};

/// Returns the distance of the farthest point from the line through two distant points, relative to the distance
/// between these two.
double spread_of(const std::vector<glm::dvec3>& points) {
  const auto farthest = [&](glm::dvec3 from) {
    return *std::max_element(points.begin(), points.end(), [&](const glm::dvec3& a, const glm::dvec3& b) {
      return glm::distance(a, from) < glm::distance(b, from);
    });
  };
  const glm::dvec3 a = farthest(points.front()), b = farthest(a);
  const double length = glm::distance(a, b);
  double most = 0.0;
  for (const glm::dvec3& p : points) most = std::max(most, glm::length(glm::cross(p - a, b - a)));
  return length > 0.0 ? most / (length * length) : 0.0;
}

[[noreturn]] void refuse(const Testbed& testbed, const Camera& camera, const std::string& from, const Placement& found,
                         std::size_t points, const std::string& problem) {
  std::vector<std::uint32_t> ids;
  for (const TagResidual& tag : found.tags) ids.push_back(tag.id);
  throw base::InputError(
      from, 0,
      fmt::format("of the {} surveyed tags of {}, camera '{}' saw {}{}, with {} points: {}; expected four points that "
                  "are not on one line: four tags, or one whose [[survey]] section has a heading. Not seen: {}",
                  testbed.surveyed.size(), testbed.file, camera.name, ids.size(),
                  ids.empty() ? "" : fmt::format(" ({})", fmt::join(ids, ", ")), points, problem,
                  found.unseen.empty() ? "none" : fmt::format("{}", fmt::join(found.unseen, ", "))));
}

std::optional<double> residual_of(const Points& points, Camera camera) {
  if (points.size() < kFewestPoints || spread_of(points.places) < kLeastSpread) return std::nullopt;
  opencv().place(points.places, points.pixels, camera);
  double sum = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) sum += points.square(camera, i);
  return std::sqrt(sum / static_cast<double>(points.size()));
}

/// Computes the residuals of one tag, whose points have the indices from `first` to `last`.
void judge(const Points& points, std::size_t first, std::size_t last, const SurveyedTag& surveyed, const Camera& camera,
           TagResidual& tag) {
  glm::dvec2 center{0.0};
  double squares = 0.0;
  const auto count = static_cast<double>(last - first);
  for (std::size_t i = first; i < last; ++i) {
    squares += points.square(camera, i);
    center += points.pixels[i] / count;
  }
  tag.pixels = std::sqrt(squares / count);
  const auto place = to_plane(camera, center, surveyed.position.z);
  tag.metres = place ? glm::distance(*place, glm::dvec2{surveyed.position.x, surveyed.position.y}) : HUGE_VAL;
  tag.without = residual_of(points.without(first, last), camera);
}

}  // namespace

Placement place_camera(const Testbed& testbed, const Camera& camera, ImageSource& images, const std::string& from) {
  if (testbed.surveyed.empty())
    throw base::InputError(
        testbed.file, 0,
        "has no surveyed tags; expected [[survey]] sections with id = 3 and position = [x, y, z] (docs/vps.md)");
  auto seen = look(testbed, camera, images, from);
  Placement result{.camera = camera};
  Points points;
  std::vector<std::size_t> first;  // index of each tag's first point
  for (const auto& [id, tag] : testbed.surveyed) {
    const auto at = seen.find(id);
    if (at == seen.end()) {
      result.unseen.push_back(id);
      continue;
    }
    for (glm::dvec2& corner : at->second.sum) corner /= static_cast<double>(at->second.images);
    first.push_back(points.pixels.size());
    result.tags.push_back({id, at->second.images});
    points.add(tag, testbed.mount(id).side, at->second.sum, camera.intrinsics);
  }
  first.push_back(points.pixels.size());
  if (points.size() < kFewestPoints) refuse(testbed, camera, from, result, points.size(), "too few");
  if (spread_of(points.places) < kLeastSpread)
    refuse(testbed, camera, from, result, points.size(), "nearly on one line");
  opencv().place(points.places, points.pixels, result.camera);
  result.residual = *residual_of(points, result.camera);
  for (std::size_t t = 0; t < result.tags.size(); ++t)
    judge(points, first[t], first[t + 1], testbed.surveyed.at(result.tags[t].id), result.camera, result.tags[t]);
  return result;
}

}  // namespace sf::vision
