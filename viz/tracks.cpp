#include "viz/tracks.h"

#include <algorithm>
#include <cmath>

#include "base/contact_onset.h"
#include "viz/theme.h"

namespace sf::viz {

namespace {

/// [px] shorter steps of a path are skipped: they are invisible and cost as much as long ones.
constexpr double kSmallestStep = 0.7;
/// [px] smallest reach of a cross with a border.
constexpr double kBordered = 5.0;

}  // namespace

bool is_finite(const base::Pose& p) { return std::isfinite(p.x) && std::isfinite(p.y); }

world::Extent extent_of(const world::World& world, std::span<const Track> tracks) {
  world::Extent e = world.extent;
  for (const Track& track : tracks)
    for (const base::Pose& p : track.poses) {
      if (!is_finite(p)) continue;
      e = {std::min(e.x_min, p.x), std::min(e.y_min, p.y), std::max(e.x_max, p.x), std::max(e.y_max, p.y)};
    }
  return e;
}

void draw_path(Axes& axes, const Track& track, double line_width, std::uint32_t color, std::span<const double> dash) {
  std::vector<Line> path;
  std::optional<glm::dvec2> last;
  for (std::size_t i = 0; i < track.poses.size(); ++i) {
    const base::Pose& pose = track.poses[i];
    if (!is_finite(pose)) {
      last.reset();
      continue;
    }
    const glm::dvec2 at = axes.pixel({pose.x, pose.y});
    if (last && length(at - *last) < kSmallestStep && i + 1 < track.poses.size()) continue;
    path.push_back({last.value_or(at), at});
    last = at;
  }
  axes.canvas().lines(path, line_width, color, dash);
}

void draw_contacts(Axes& axes, const Track& track, double reach, double line_width) {
  glm::dvec2 last{-1e9, -1e9};
  for (std::size_t i = 0; i < track.contacts.size(); ++i) {
    if (!track.contacts[i] || (i > 0 && track.contacts[i - 1]) || !is_finite(track.poses[i])) continue;
    const glm::dvec2 at = axes.pixel({track.poses[i].x, track.poses[i].y});
    if (length(at - last) < reach) continue;
    // A pale border makes large crosses visible on dots of any colour.
    if (reach >= kBordered) draw_cross(axes.canvas(), at, reach, line_width + 2.4, theme::kWhite);
    draw_cross(axes.canvas(), at, reach, line_width, theme::kContact);
    last = at;
  }
}

double path_length(const Track& track) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < track.poses.size(); ++i) {
    const base::Pose& a = track.poses[i];
    const base::Pose& b = track.poses[i + 1];
    if (is_finite(a) && is_finite(b)) sum += std::hypot(b.x - a.x, b.y - a.y);
  }
  return sum;
}

std::size_t contact_count(const Track& track) {
  std::size_t begun = 0;
  base::ContactOnset contact;
  for (const std::uint8_t now : track.contacts) begun += contact.begins(now != 0) ? 1u : 0u;
  return begun;
}

}  // namespace sf::viz
