#include "raycast/mover_geometry.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/elementary.h"
#include "world/wall_tree.h"

namespace sf::raycast {

namespace {

constexpr std::size_t kLongestLoop = 64;  ///< limits the number of pairs of an edge and a corner

/// Returns whether the edges form a closed convex outline that is solid inside. Corners may be outside by rounding.
bool is_convex(std::span<const world::Segment> loop, double radius) {
  if (loop.size() < 3 || loop.size() > kLongestLoop || loop.back().b != loop.front().a) return false;
  return std::all_of(loop.begin(), loop.end(), [&](const world::Segment& s) {
    const glm::dvec2 e = s.b - s.a;
    return s.solid_left && std::all_of(loop.begin(), loop.end(), [&](const world::Segment& corner) {
             return base::cross(e, corner.a - s.a) >= -1e-13 * radius * length(e);
           });
  });
}

bool is_same(const world::Segment& p, const world::Segment& q) {
  return p.a == q.a && p.b == q.b && p.z_min == q.z_min && p.z_max == q.z_max && p.solid_left == q.solid_left;
}

}  // namespace

MoverGeometry::MoverGeometry(const world::World& world) : walls_(static_cast<std::uint32_t>(world.walls.size())) {
  std::map<std::vector<double>, std::uint32_t> shapes;
  std::vector<OutlineTable::Shape> of_shape;
  for (const world::Mover& mover : world.movers) {
    first_rows_.push_back(walls_ + static_cast<std::uint32_t>(local_.size()));
    std::vector<double> shape{mover.radius};
    double inner = mover.radius;
    for (const world::Segment& s : mover.body) {
      if (!s.seen_by_laser) continue;
      local_.push_back(s);
      models_.push_back(s.model);
      inner = std::min(inner, world::distance({}, s.a, s.b));
      shape.insert(shape.end(), {s.a.x, s.a.y, s.b.x, s.b.y, s.z_min, s.z_max, s.solid_left ? 1.0 : 0.0});
    }
    inner_.push_back(inner);
    const bool met = first_rows_.back() - walls_ < local_.size();
    radii_.push_back(met ? mover.radius : 0.0);
    const auto [known, fresh] = shapes.try_emplace(std::move(shape), static_cast<std::uint32_t>(of_shape.size()));
    shapes_.push_back(known->second);
    const auto slices = static_cast<std::uint32_t>(outlines_.slices.size());
    if (fresh) {
      add_slices(shapes_.size() - 1);
      of_shape.push_back({slices, static_cast<std::uint32_t>(outlines_.slices.size()) - slices});
    }
    outlines_.of_mover.push_back(of_shape[known->second]);
    grid_.largest_radius = std::max(grid_.largest_radius, mover.radius);
  }
  first_rows_.push_back(walls_ + static_cast<std::uint32_t>(local_.size()));
  next_shape_ = static_cast<std::uint32_t>(of_shape.size());
  most_slices_ = 3 * outlines_.slices.size() + 1'000;
  grid_.copies = world::CopyIndex(world);
  const std::size_t movers = world.movers.size(), padded = movers + kBlock;
  headings_.resize(movers);
  cells_.resize(movers);
  twins_.resize(movers, kNoMover);
  grid_.mover.resize(padded), grid_.twin.resize(padded);
  grid_.x.resize(padded), grid_.y.resize(padded), grid_.radius.resize(padded), grid_.inner.resize(padded);
  grid_.first.reserve(grid_.copies.copies() * most_cells() * most_cells() + 1);
  next_.reserve(std::max(grid_.first.capacity(), movers));
}

bool MoverGeometry::update(const world::World& world) {
  scratch_.clear();
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    std::size_t row = first_rows_[m] - walls_;
    const std::size_t end = end_of(m);
    bool same = true;
    for (const world::Segment& s : world.movers[m].body) {
      if (!s.seen_by_laser) continue;
      if (row == end || s.model != local_[row].model) return false;
      same = same && is_same(s, local_[row++]);
    }
    if (row != end) return false;
    if (!same) scratch_.push_back(m);
  }
  if (outlines_.slices.size() > most_slices_) return false;
  for (const std::uint32_t m : scratch_) update_mover(m, world.movers[m]);
  return true;
}

/// The old slices of its shape stay, without a use.
void MoverGeometry::update_mover(std::uint32_t mover, const world::Mover& now) {
  std::size_t row = first_rows_[mover] - walls_;
  double& inner = inner_[mover] = now.radius;
  for (const world::Segment& s : now.body) {
    if (!s.seen_by_laser) continue;
    local_[row++] = s;
    inner = std::min(inner, world::distance({}, s.a, s.b));
  }
  radii_[mover] = now.radius;
  grid_.largest_radius = std::max(grid_.largest_radius, now.radius);
  shapes_[mover] = next_shape_++;
  const auto slices = static_cast<std::uint32_t>(outlines_.slices.size());
  add_slices(mover);
  outlines_.of_mover[mover] = {slices, static_cast<std::uint32_t>(outlines_.slices.size()) - slices};
}

double MoverGeometry::smallest_inner() const {
  return inner_.empty() ? 0.0 : *std::min_element(inner_.begin(), inner_.end());
}

/// Adds the slices of a new shape.
void MoverGeometry::add_slices(std::size_t mover) {
  std::vector<double> breaks;
  for (std::size_t row = first_rows_[mover] - walls_; row < end_of(mover); ++row)
    breaks.insert(breaks.end(), {local_[row].z_min, local_[row].z_max});
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  double z = -HUGE_VAL;
  breaks.push_back(HUGE_VAL);
  for (const double z_max : breaks) {
    outlines_.slices.push_back({z_max, outline_at(mover, z)});
    z = z_max;
  }
}

/// Adds the edges of a new shape at height `z` [m] above its origin.
OutlineTable::Outline MoverGeometry::outline_at(std::size_t mover, double z) {
  std::vector<std::uint32_t> edges;
  std::vector<SegmentBlock> outward, inward;
  std::uint32_t used_outward = 0, used_inward = 0;
  for (std::uint32_t number = 0; first_rows_[mover] - walls_ + number < end_of(mover); ++number) {
    const world::Segment& s = local_[first_rows_[mover] - walls_ + number];
    if (z < s.z_min || z >= s.z_max) continue;
    edges.push_back(number);
    append(outward, used_outward, s.a, s.b, number);
    s.solid_left ? append(inward, used_inward, s.b, s.a, number) : append(outward, used_outward, s.b, s.a, number);
  }
  const auto size = [](const auto& items) { return static_cast<std::uint32_t>(items.size()); };
  OutlineTable::Outline outline{size(outlines_.blocks), size(outward), size(outward) + size(inward),
                                size(outlines_.edges),  size(edges),   size(outlines_.loops)};
  outlines_.blocks.insert(outlines_.blocks.end(), outward.begin(), outward.end());
  outlines_.blocks.insert(outlines_.blocks.end(), inward.begin(), inward.end());
  outlines_.edges.insert(outlines_.edges.end(), edges.begin(), edges.end());
  add_loops(mover, edges);
  outline.loops = size(outlines_.loops) - outline.first_loop;
  return outline;
}

/// Appends the closed convex outlines among a new shape's edges at one height.
void MoverGeometry::add_loops(std::size_t mover, std::span<const std::uint32_t> edges) {
  const std::span<const world::Segment> body = std::span(local_).subspan(first_rows_[mover] - walls_);
  for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
    for (end = first + 1; end < edges.size() && edges[end] == edges[end - 1] + 1; ++end)
      if (body[edges[end]].a != body[edges[end - 1]].b) break;
    if (is_convex(body.subspan(edges[first], end - first), radii_[mover]))
      outlines_.loops.push_back({edges[first], static_cast<std::uint32_t>(end - first)});
  }
}

void MoverGeometry::place(std::span<const base::Report> states, base::ThreadPool& thread_pool,
                          std::span<ExactSegment> exact) {
  states_ = states;
  exact_ = exact;
  thread_pool.parallel_for(states_.size(), 64, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const Pose& X = states_[i].X_WM;
      headings_[i] = base::direction(X.yaw);
      for (std::uint32_t row = first_rows_[i] - walls_; row < first_rows_[i + 1] - walls_; ++row) {
        exact[row] = to_world(local_[row].a, local_[row].b, {X.x, X.y}, headings_[i]);
      }
    }
  });
  build_grid();
}

}  // namespace sf::raycast
