#include "raycast/bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raycast/clearance.h"
#include "raycast/decide.h"
#include "raycast/screen.h"

namespace sf::raycast {

namespace {

constexpr int kMostCells = 128;  ///< along an axis

}  // namespace

Bodies::Bodies(const world::World& world, const Sight* any_wall)
    : walls_(any_wall), wall_count_(static_cast<std::uint32_t>(world.walls.size())) {
  for (const world::Mover& mover : world.movers) {
    Body body{static_cast<std::uint32_t>(local_.size()), 0, mover.radius};
    for (const world::Segment& s : mover.body) {
      if (!s.seen_by_laser) continue;
      local_.push_back(s);
      models_.push_back(s.model);
      owners_.push_back(static_cast<std::uint32_t>(bodies_.size()));
    }
    body.count = static_cast<std::uint32_t>(local_.size()) - body.first;
    bodies_.push_back(body);
    loaded_z_.push_back(mover.X_WM.z);
    largest_ = std::max(largest_, mover.radius);
  }
  segments_.resize(local_.size());
  poses_.resize(bodies_.size());
  clearances_.resize(bodies_.size());
  cell_items_.resize(bodies_.size());
  cell_first_.reserve(static_cast<std::size_t>(kMostCells) * kMostCells + 1);
  cell_next_.reserve(static_cast<std::size_t>(kMostCells) * kMostCells + 1);
}

std::vector<float> Bodies::own_clearances(double cap) const {
  std::vector<float> all;
  for (const Body& body : bodies_) {
    const auto first = local_.begin() + body.first;
    const std::vector<float> own = wall_clearances({first, first + body.count}, cap);
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

void Bodies::place(std::span<const Pose> poses, base::Workers& workers) {
  std::copy(poses.begin(), poses.end(), poses_.begin());
  nearby_.resize(workers.threads());
  index();
  workers.run(bodies_.size(), 64, [this](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t i = first; i < last; ++i) {
      const Pose& X = poses_[i];
      const Vec2 heading{std::cos(X.yaw), std::sin(X.yaw)};
      for (std::uint32_t row = bodies_[i].first; row < bodies_[i].first + bodies_[i].count; ++row) {
        segments_[row] = placed(local_[row].a, local_[row].b, {X.x, X.y}, heading);
      }
    }
    measure_clearances(first, last, nearby_[thread]);
  });
}

void Bodies::index() {
  const auto somewhere = std::find_if(poses_.begin(), poses_.end(), [](const Pose& X) { return !std::isnan(X.x); });
  Vec2 high = somewhere == poses_.end() ? Vec2{} : Vec2{somewhere->x, somewhere->y};
  low_ = high;
  for (const Pose& X : poses_) {
    if (std::isnan(X.x)) continue;
    low_ = {std::min(low_.x, X.x), std::min(low_.y, X.y)};
    high = {std::max(high.x, X.x), std::max(high.y, X.y)};
  }
  cell_ = std::max({4.0 * largest_, (high.x - low_.x) / (kMostCells - 1), (high.y - low_.y) / (kMostCells - 1), 1e-6});
  columns_ = static_cast<int>((high.x - low_.x) / cell_) + 1;
  rows_ = static_cast<int>((high.y - low_.y) / cell_) + 1;
  const auto cell_of = [this](const Pose& X) {
    return static_cast<std::size_t>((X.y - low_.y) / cell_) * columns_ +
           static_cast<std::size_t>((X.x - low_.x) / cell_);
  };
  cell_first_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
  // Movers that no beam can meet, or that are gone, are nobody's neighbours.
  for (std::uint32_t i = 0; i < poses_.size(); ++i)
    if (is_met(i)) ++cell_first_[cell_of(poses_[i]) + 1];
  for (std::size_t i = 1; i < cell_first_.size(); ++i) cell_first_[i] += cell_first_[i - 1];
  cell_next_.assign(cell_first_.begin(), cell_first_.end() - 1);
  for (std::uint32_t i = 0; i < poses_.size(); ++i)
    if (is_met(i)) cell_items_[cell_next_[cell_of(poses_[i])]++] = i;
}

template <class Visit>
void Bodies::each_near(Vec2 p, double reach, Visit visit) const {
  const auto clamp_cell = [](double value, int count) {
    return static_cast<int>(std::clamp(std::floor(value), 0.0, static_cast<double>(count - 1)));
  };
  const int x0 = clamp_cell((p.x - reach - low_.x) / cell_, columns_);
  const int x1 = clamp_cell((p.x + reach - low_.x) / cell_, columns_);
  const int y0 = clamp_cell((p.y - reach - low_.y) / cell_, rows_);
  const int y1 = clamp_cell((p.y + reach - low_.y) / cell_, rows_);
  for (int y = y0; y <= y1; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * columns_;
    for (std::uint32_t at = cell_first_[row + x0]; at < cell_first_[row + x1 + 1]; ++at) visit(cell_items_[at]);
  }
}

void Bodies::measure_clearances(std::size_t first, std::size_t last, Sight::Nearby& nearby) {
  for (std::size_t i = first; i < last; ++i) {
    if (!is_met(i)) continue;
    const Vec2 p{poses_[i].x, poses_[i].y};
    double to_movers = kLookout;
    each_near(p, bodies_[i].radius + largest_ + kLookout, [&](std::uint32_t other) {
      if (other == i) return;
      const double gap = length(Vec2{poses_[other].x, poses_[other].y} - p) - bodies_[i].radius - bodies_[other].radius;
      to_movers = std::min(to_movers, gap);
    });
    double to_walls = kLookout;
    walls_->near(p, bodies_[i].radius + kLookout, nearby);
    for (const std::uint32_t row : nearby.found) {
      const SightSegment& s = walls_->segments()[row];
      to_walls = std::min(to_walls, world::distance(p, s.a, s.b) - bodies_[i].radius);
    }
    const auto at_least = [](double gap) { return static_cast<float>(std::max(0.0, 0.99 * gap)); };
    clearances_[i] = {at_least(to_walls), at_least(std::min(to_walls, to_movers))};
  }
}

std::uint32_t Bodies::watch_height(double z) {
  for (std::uint32_t i = 0; i < heights_.size(); ++i)
    if (heights_[i].z == z) return i;
  Height height{z, {}};
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    // A disc round the origin that no edge enters lies in the solid when the origin does.
    double least = std::numeric_limits<double>::infinity();
    int winding = 0;
    for (std::uint32_t row = bodies_[i].first; row < bodies_[i].first + bodies_[i].count; ++row) {
      const world::Segment& s = local_[row];
      if (z - loaded_z_[i] < s.z_min || z - loaded_z_[i] >= s.z_max) continue;
      least = std::min(least, world::distance({}, s.a, s.b));
      if (!s.solid_left || (s.a.y <= 0.0) == (s.b.y <= 0.0)) continue;
      const double side = cross(s.b - s.a, {-s.a.x, -s.a.y});
      winding += s.a.y <= 0.0 ? (side > 0.0) : -(side < 0.0);
    }
    height.opaque.push_back(winding != 0 && std::isfinite(least) ? static_cast<float>(0.999 * least) : 0.0f);
  }
  heights_.push_back(std::move(height));
  return static_cast<std::uint32_t>(heights_.size() - 1);
}

void Bodies::find_near(const View& view, Scratch& scratch) const {
  scratch.near.clear();
  each_near(view.origin, view.range + view.radius + largest_, [&](std::uint32_t body) {
    if (body == view.self) return;
    const double nearest =
        length(Vec2{poses_[body].x, poses_[body].y} - view.origin) - bodies_[body].radius - view.radius;
    if (nearest <= view.range) scratch.near.push_back({nearest, body});
  });

  scratch.sorted.clear();
  if (scratch.near.empty()) return;

  // Near to far, by distance in steps that cost no more than they order.
  constexpr std::uint32_t kSteps = 256;
  const double per_metre = kSteps / (view.range + 1e-9);
  const auto step_of = [&](const Near& n) {
    return std::min(kSteps - 1, static_cast<std::uint32_t>(std::max(0.0, n.nearest) * per_metre));
  };
  scratch.counts.assign(kSteps + 1, 0);
  for (const Near& n : scratch.near) ++scratch.counts[step_of(n) + 1];
  for (std::uint32_t i = 0; i < kSteps; ++i) scratch.counts[i + 1] += scratch.counts[i];
  scratch.sorted.resize(scratch.near.size());
  for (const Near& n : scratch.near) scratch.sorted[scratch.counts[step_of(n)]++] = n;
}

bool Bodies::collect(const View& view, Scratch& scratch, SectorLists& lists, float clearances[SF_SECTORS]) const {
  lists.clear();
  std::fill(clearances, clearances + SF_SECTORS, std::numeric_limits<float>::infinity());
  find_near(view, scratch);
  scratch.movers_near += scratch.sorted.size();
  Screen screen;
  if (view.fov < 2.0 * M_PI)
    screen.cover(view.yaw + 0.5 * view.fov + 1e-6, view.yaw - 0.5 * view.fov - 1e-6 + 2.0 * M_PI);

  const std::vector<float>& opaque = heights_[view.height].opaque;
  std::size_t hiding = 0;  // the first of the sorted bodies that does not hide what is behind it yet
  for (const Near& n : scratch.sorted) {
    for (; hiding < scratch.sorted.size(); ++hiding) {
      const std::uint32_t other = scratch.sorted[hiding].body;
      const Vec2 p = Vec2{poses_[other].x, poses_[other].y} - view.origin;
      const double distance = length(p);
      if (distance + view.radius > n.nearest) break;
      // From inside of a body nothing is behind it.
      const double hidden = opaque[other] - view.radius;
      if (hidden <= 0.0 || distance <= bodies_[other].radius + view.radius) continue;
      const double half = std::asin(hidden / distance);
      const double bearing = std::atan2(p.y, p.x);
      screen.cover(bearing - half, bearing + half);
    }
    if (screen.covers_all()) break;
    const Vec2 p = Vec2{poses_[n.body].x, poses_[n.body].y} - view.origin;
    const double distance = length(p);
    const double radius = bodies_[n.body].radius + view.radius;
    const bool around = distance <= 1.001 * radius + 1e-6;
    const double bearing = std::atan2(p.y, p.x);
    const double wide = around ? M_PI : std::asin(radius / distance) + 1e-6;
    if (screen.covers(bearing - wide, bearing + wide)) continue;
    if (view.depth && !around &&
        view.depth->hides(view.origin, view.radius, view.origin + p, bodies_[n.body].radius, scratch.walls))
      continue;

    ++scratch.movers_met;
    const std::size_t before = lists.items.size();
    add_body(view, n.body, bearing, wide, lists);
    for (std::size_t at = before; at < lists.items.size(); ++at) {
      float& least = clearances[lists.items[at].sector];
      least = std::min(least, clearances_[n.body].walls);
    }
    if (lists.items.size() > view.most) return false;
  }
  lists.sort();
  return true;
}

void Bodies::add_body(const View& view, std::uint32_t number, double bearing, double wide, SectorLists& lists) const {
  constexpr double kTwoSectors = 2.0 * (2.0 * M_PI / SF_SECTORS);
  const Body& body = bodies_[number];
  const bool near = wide >= M_PI;
  const double height = heights_[view.height].z - loaded_z_[number];
  const double with_spread = wide + view.spread;

  for (std::uint32_t row = body.first; row < body.first + body.count; ++row) {
    const world::Segment& local = local_[row];
    if (height < local.z_min || height >= local.z_max) continue;
    const ExactSegment& s = segments_[row];
    const Vec2 a = Vec2{s.ax, s.ay} - view.origin;
    const Vec2 b = Vec2{s.bx, s.by} - view.origin;
    // Outside of the body only its facing sides can be met first.
    const double facing = cross(b - a, {-a.x, -a.y});
    const double unsure = view.radius * length(b - a) + 1e-6;
    const bool keep_front = near || facing < unsure;
    const bool keep_back = near || (!local.solid_left && facing > -unsure);
    const double nearest = std::max(0.0, world::distance({}, a, b) - view.radius - 1e-6);
    if (nearest > view.range) continue;
    const auto add = [&](Vec2 from, Vec2 to, bool facing_view) {
      const Candidate candidate{from, to, nearest, wall_count_ + row, facing_view};
      if (near) return lists.add_seen(candidate, view.radius + 1e-6, view.spread);
      lists.candidates.push_back(candidate);
      if (wide < kTwoSectors || view.radius > 0.0)
        return lists.add_interval(bearing - with_spread, bearing + with_spread);
      const double bearing_a = std::atan2(a.y, a.x);
      const double bearing_b = bearing_a + std::atan2(cross(a, b), dot(a, b));
      lists.add_interval(std::min(bearing_a, bearing_b) - view.spread, std::max(bearing_a, bearing_b) + view.spread);
    };
    if (keep_front || !keep_back) add(a, b, keep_front);
    if (keep_back) add(b, a, true);
  }
}

}  // namespace sf::raycast
