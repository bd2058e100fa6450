#include "vision/overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>

#include "base/box.h"

namespace sf::vision {

namespace {

using Color = std::array<std::uint8_t, 3>;
constexpr Color kTag{86, 224, 120}, kAxis{255, 160, 40}, kWall{240, 90, 90}, kMarking{110, 190, 255};
constexpr double kPiece = 0.05;  // [m] length of the straight pieces of lines, since lenses bend them

/// Returns the bounding box of the visible part of the plane at height `z`; all points if the camera sees the plane's
/// horizon.
base::Box seen_box(const Camera& camera, double z) {
  constexpr int kSteps = 16;  // along each border, since lenses bend it
  const glm::dvec2 last{camera.intrinsics.width - 1, camera.intrinsics.height - 1};
  base::Box box = base::empty_box();
  for (int k = 0; k < 4 * kSteps; ++k) {
    const double along = static_cast<double>(k % kSteps) / kSteps;
    const glm::dvec2 corner = k / kSteps == 0   ? glm::dvec2{along, 0.0}
                              : k / kSteps == 1 ? glm::dvec2{1.0, along}
                              : k / kSteps == 2 ? glm::dvec2{1.0 - along, 1.0}
                                                : glm::dvec2{0.0, 1.0 - along};
    const auto p = to_plane(camera, corner * last, z);
    if (!p) return {glm::dvec2{-HUGE_VAL}, glm::dvec2{HUGE_VAL}};
    box = base::united(box, {*p, *p});
  }
  const glm::dvec2 margin = 0.1 * (box.max - box.min);
  return {box.min - margin, box.max + margin};
}

/// Returns the part of the line from a to b within a box, as fractions of its length (Liang and Barsky); empty: first >
/// second.
std::pair<double, double> clip(const base::Box& box, glm::dvec2 a, glm::dvec2 b) {
  double first = 0.0, last = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    const double d = b[axis] - a[axis];
    if (d == 0.0 && (a[axis] < box.min[axis] || a[axis] > box.max[axis])) return {1.0, 0.0};
    if (d == 0.0) continue;
    const double u = (box.min[axis] - a[axis]) / d, v = (box.max[axis] - a[axis]) / d;
    first = std::max(first, std::min(u, v));
    last = std::min(last, std::max(u, v));
  }
  return {first, last};
}

/// Converts lines on a horizontal plane to marks, clipped to the picture.
class LineMarks {
 public:
  /// @param box contains the visible part of the plane
  LineMarks(const Camera& camera, double z, const base::Box& box, const Mark& style, std::vector<Mark>& out)
      : camera_(camera), z_(z), box_(box), mark_(style), out_(out) {}

  void add(std::span<const glm::dvec2> line) {
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const auto [first, last] = clip(box_, line[i], line[i + 1]);
      if (first > 0.0 || first > last) end();
      const glm::dvec2 a = glm::mix(line[i], line[i + 1], first), b = glm::mix(line[i], line[i + 1], last);
      const int pieces = static_cast<int>(std::clamp(std::ceil(glm::distance(a, b) / kPiece), 1.0, 4096.0));
      for (int k = last_ ? 1 : 0; k <= pieces && first <= last; ++k)
        add(glm::mix(a, b, static_cast<double>(k) / pieces));
    }
    end();
  }

 private:
  /// Continues the line to `p`. Skips pieces outside the picture.
  void add(glm::dvec2 p) {
    const auto pixel = project(camera_, {p.x, p.y, z_});
    if (!pixel) return end();
    const auto margin = static_cast<double>(mark_.width);
    const base::Box picture{glm::dvec2{-margin},
                            glm::dvec2{camera_.intrinsics.width, camera_.intrinsics.height} + margin};
    if (last_ && base::meet(picture, base::box_of(*last_, *pixel))) {
      if (mark_.points.empty()) mark_.points.push_back(*last_);
      mark_.points.push_back(*pixel);
    } else {
      flush();
    }
    last_ = pixel;
  }
  void flush() {
    if (!mark_.points.empty()) out_.push_back(mark_);
    mark_.points.clear();
  }
  void end() {
    flush();
    last_.reset();
  }

  const Camera& camera_;
  double z_;
  base::Box box_;
  Mark mark_;  ///< visible line so far
  std::vector<Mark>& out_;
  std::optional<glm::dvec2> last_;  ///< [px] end of the last piece, inside or outside the picture
};

/// Adds id, heading, position and, if known, speed in lines below the tag, inside the picture.
void add_label(const Camera& camera, const Sighting& sighting, const TrackedTag* tracked, std::vector<Mark>& marks) {
  constexpr double kLetter = 8.5, kLine = 16.0;  // [px] of OpenCV's font, as used by Mark
  const base::Pose& X = sighting.fit.X_WT;
  const auto middle = project(camera, {X.x, X.y, X.z});
  if (!middle) return;
  std::vector<std::string> lines{fmt::format("{}: {:.0f} deg", sighting.id, X.yaw * 180.0 / M_PI),
                                 fmt::format("{:.2f} {:.2f} m", X.x, X.y)};
  if (tracked != nullptr) lines.push_back(fmt::format("{:.2f} m/s", glm::length(tracked->velocity)));
  const double width = kLetter * static_cast<double>(std::max(lines[0].size(), lines[1].size()));
  glm::dvec2 at = *middle + glm::dvec2{-0.5 * width, 1.1 * sighting.fit.side / sighting.fit.pixel + 0.5 * kLine};
  const glm::dvec2 last{camera.intrinsics.width - width,
                        camera.intrinsics.height - kLine * (static_cast<double>(lines.size()) - 1.0) - 6.0};
  at = glm::max(glm::min(at, last), glm::dvec2{2.0, kLine});
  for (const std::string& line : lines) {
    marks.push_back({{at}, line, kTag, 1});
    at.y += kLine;
  }
}

}  // namespace

std::vector<Mark> tag_marks(const Camera& camera, std::span<const Sighting> sightings,
                            std::span<const TrackedTag> tracked) {
  std::vector<Mark> marks;
  for (const Sighting& sighting : sightings) {
    const base::Pose& X = sighting.fit.X_WT;
    const double h = 0.5 * sighting.fit.side;
    const auto at = [&](double x, double y) { return base::transform(X, {x, y}); };
    const base::Box near = base::box_around({X.x, X.y}, 4.0 * h);
    const std::vector<glm::dvec2> square{at(-h, -h), at(h, -h), at(h, h), at(-h, h), at(-h, -h)};
    LineMarks(camera, X.z, near, {{}, "", kTag, 2}, marks).add(square);
    const std::vector<glm::dvec2> arrow{at(0.0, 0.0), at(2.0 * h, 0.0), at(1.6 * h, 0.25 * h), at(2.0 * h, 0.0),
                                        at(1.6 * h, -0.25 * h)};
    LineMarks(camera, X.z, near, {{}, "", kAxis, 2}, marks).add(arrow);
    const auto state =
        std::find_if(tracked.begin(), tracked.end(), [&](const TrackedTag& tag) { return tag.id == sighting.id; });
    add_label(camera, sighting, state == tracked.end() ? nullptr : &*state, marks);
  }
  return marks;
}

std::vector<Mark> line_marks(const Camera& camera, std::span<const PlaneLine> lines) {
  std::vector<Mark> marks;
  std::map<double, base::Box> boxes;  // by height, which many lines share
  for (const PlaneLine& line : lines) {
    const auto [box, is_new] = boxes.try_emplace(line.z);
    if (is_new) box->second = seen_box(camera, line.z);
    LineMarks(camera, line.z, box->second, {{}, "", line.color, line.width}, marks).add(line.points);
  }
  return marks;
}

std::vector<Mark> world_marks(const Camera& camera, const world::World& world) {
  std::vector<PlaneLine> lines;
  for (const world::LaneMarking& marking : world.lane_markings) lines.push_back({marking.line, 0.0, kMarking, 2});
  for (const world::Segment& wall : world.walls) {
    lines.push_back({{wall.a, wall.b}, wall.z_min, kWall, 1});
    lines.push_back({{wall.a, wall.b}, wall.z_max, kWall, 2});
  }
  return line_marks(camera, lines);
}

Image draw_over(const Image& grey, const std::vector<Mark>& marks) {
  Image image{grey.width, grey.height, 3, {}};
  image.pixels.reserve(3 * grey.pixels.size());
  for (const std::uint8_t value : grey.pixels) image.pixels.insert(image.pixels.end(), 3, value);
  opencv().draw(image, marks);
  return image;
}

}  // namespace sf::vision
