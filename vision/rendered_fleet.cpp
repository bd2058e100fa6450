#include "vision/rendered_fleet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/elementary.h"
#include "base/error.h"
#include "base/random.h"
#include "vision/tag_family.h"

namespace sf::vision {

namespace {

constexpr double kMargin = 4.0;           // [px] between a visible tag and the border of the image
constexpr double kOccluderHeight = 1.0;   // [m]
constexpr double kOccluderRadius = 0.15;  // [m]
constexpr double kMaxPlaces = 20'000;     // of a grid, visible or not

/// Returns half of the diagonal of a tag including its white border.
double reach_of(const TagMount& mount, int cells) {
  return M_SQRT1_2 * mount.side * (cells + 2.0 * kTagBorder) / cells;
}

bool sees(const Camera& camera, glm::dvec3 p) {
  const auto pixel = project(camera, p);
  return pixel && pixel->x >= kMargin && pixel->y >= kMargin && pixel->x <= camera.intrinsics.width - 1 - kMargin &&
         pixel->y <= camera.intrinsics.height - 1 - kMargin;
}

bool sees_disc(const Camera& camera, glm::dvec2 center, double radius, double height) {
  for (int k = 0; k < 16; ++k) {
    const glm::dvec2 p = center + radius * base::direction(k * M_PI / 8.0);
    if (!sees(camera, {p.x, p.y, height})) return false;
  }
  return true;
}

/// Returns the centres of a square grid of pitch `pitch` whose discs are visible in some camera; empty for a grid of
/// more than `kMaxPlaces`.
std::vector<glm::dvec2> seen_grid(const Testbed& testbed, glm::dvec2 low, glm::dvec2 high, double pitch) {
  std::vector<glm::dvec2> seen;
  const glm::dvec2 counts = glm::floor((high - low) / pitch);
  if (!(counts.x >= 1.0 && counts.y >= 1.0 && counts.x * counts.y <= kMaxPlaces)) return seen;
  const glm::dvec2 first = 0.5 * (low + high) - 0.5 * pitch * (counts - 1.0);
  for (int j = 0; j < static_cast<int>(counts.y); ++j)
    for (int i = 0; i < static_cast<int>(counts.x); ++i) {
      const glm::dvec2 center = first + pitch * glm::dvec2{i, j};
      for (const TestbedCamera& each : testbed.cameras)
        if (sees_disc(each.camera, center, 0.5 * pitch, testbed.tag.height)) {
          seen.push_back(center);
          break;
        }
    }
  return seen;
}

}  // namespace

glm::dvec2 RenderedFleet::place(const Circle& circle, double time) {
  const double angle = circle.phase + circle.speed * time / circle.radius;
  return circle.center + circle.radius * base::direction(angle);
}

RenderedFleet::RenderedFleet(const Testbed& testbed, const FleetOptions& options)
    : testbed_(testbed), options_(options) {
  std::vector<std::uint32_t> ids;
  for (const auto& [id, mount] : testbed.tags) ids.push_back(id);
  for (std::uint32_t id = 1; ids.size() < options.tags; ++id)
    if (testbed.tags.count(id) == 0) ids.push_back(id);
  ids.resize(options.tags);

  // Find the widest grid that has room for all tags.
  glm::dvec2 low, high;
  field_of_view(testbed, low, high);
  double least = 0.0;
  for (const std::uint32_t id : ids) least = std::max(least, 2.2 * kBodyRadius * testbed.mount(id).side);
  std::vector<glm::dvec2> grid;
  std::size_t most = 0;
  for (pitch_ = 2.0; pitch_ >= least && grid.size() < ids.size(); pitch_ *= 0.98) {
    grid = seen_grid(testbed, low, high, pitch_);
    most = std::max(most, grid.size());
  }
  pitch_ /= 0.98;
  if (grid.size() < ids.size())
    throw base::InputError(testbed.file, 0,
                           fmt::format("{} tags do not fit into the cameras' field of view at a height of {} m; "
                                       "expected at most {}",
                                       ids.size(), testbed.tag.height, most));

  const auto uniform = [&](std::size_t tag, std::uint32_t draw) {
    return base::random_uniform({options.seed, base::RandomStream::placement, static_cast<std::uint32_t>(tag)}, draw);
  };
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const double side = testbed.mount(ids[i]).side;
    const auto [a, b] = uniform(i, 0);
    const auto [c, d] = uniform(i, 1);
    const double radius = std::max(0.02, (0.3 + 0.7 * a) * (0.5 * pitch_ - kBodyRadius * side));
    const double speed = options.speed * (0.2 + 0.8 * b);
    // If the grid has more positions than tags, spread the tags over its whole area.
    tags_.push_back({ids[i],
                     {grid[i * grid.size() / ids.size()], radius, i % 2 == 0 ? speed : -speed, 2.0 * M_PI * c},
                     2.0 * M_PI * d,
                     family_pattern(testbed.dictionary, ids[i])});
  }
  for (std::uint32_t i = 0; i < options.occluders; ++i) {
    const auto [a, b] = uniform(1000000 + i, 0);
    const auto [c, d] = uniform(1000000 + i, 1);
    occluders_.push_back({glm::mix(low, high, glm::dvec2{a, b}), 0.3 + 0.5 * c, 0.5, 2.0 * M_PI * d});
  }
  if (options.clutter) clutter_ = clutter(testbed, options.seed);
}

TrueTag RenderedFleet::truth(std::size_t tag, double time) const {
  const Tag& t = tags_[tag];
  const double turn = t.circle.speed / t.circle.radius;
  const double angle = t.circle.phase + turn * time;
  const glm::dvec2 p = place(t.circle, time);
  const glm::dvec2 velocity = t.circle.speed * glm::dvec2{-base::sin(angle), base::cos(angle)};
  return {t.id, {p.x, p.y, testbed_.mount(t.id).height, base::wrap_angle(angle + t.yaw)}, velocity, turn};
}

Scene RenderedFleet::scene_at(double time) const {
  Scene scene;
  scene.gradient = {0.06, -0.04};
  scene.patches = clutter_;
  for (std::size_t i = 0; i < tags_.size(); ++i) {
    const TrueTag state = truth(i, time);
    add_tag(scene, state, time, testbed_.mount(state.id).side, tags_[i].pattern);
  }
  for (const Circle& circle : occluders_) {
    const glm::dvec2 p = place(circle, time);
    Patch disc{Patch::Shape::disc, {p.x, p.y, kOccluderHeight, 0.0}, time};
    disc.velocity = (place(circle, time + 1e-3) - place(circle, time - 1e-3)) / 2e-3;
    disc.size = glm::dvec2{2.0 * kOccluderRadius};
    disc.albedo = 0.3;
    scene.patches.push_back(disc);
  }
  return scene;
}

bool RenderedFleet::is_visible(const Camera& camera, std::size_t tag, double time) const {
  const TrueTag state = truth(tag, time);
  const double reach = reach_of(testbed_.mount(state.id), tags_[tag].pattern.cells);
  const glm::dvec2 at{state.X_WT.x, state.X_WT.y};
  if (!sees_disc(camera, at, reach, state.X_WT.z)) return false;
  return std::none_of(occluders_.begin(), occluders_.end(), [&](const Circle& circle) {
    // The occluder's shadow on the tag's plane, with the camera as the light.
    const double scale = (camera.position.z - state.X_WT.z) / (camera.position.z - kOccluderHeight);
    const glm::dvec2 eye{camera.position.x, camera.position.y};
    const glm::dvec2 shadow = eye + scale * (place(circle, time) - eye);
    return scale > 0.0 && glm::distance(shadow, at) < scale * kOccluderRadius + reach + 0.02;
  });
}

}  // namespace sf::vision
