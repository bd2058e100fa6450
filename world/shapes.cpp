#include "world/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/suggest.h"
#include "world/stage/color_names.h"

namespace sf::world {

namespace {

OriginalShape original_of(const World& world, std::uint32_t row) {
  const Mover& mover = world.movers[row];
  const Model& model = world.models[mover.model];
  OriginalShape own{.color = model.color, .is_bitmap = model.is_bitmap, .pixel = model.pixel, .magnets = mover.magnets};
  own.surface.model = mover.model;
  for (const Segment& side : mover.body) {
    if (side.model != mover.model) continue;
    if (own.outline.empty()) own.surface = side;
    own.outline.push_back(side);
  }
  own.size = size_of(world, mover);
  for (const Fiducial& fiducial : world.fiducials)
    if (fiducial.model == mover.model) own.fiducial_z = fiducial.X_BF.z;
  return own;
}

/// The rule of sizes: the ratio first, so that a box gets exactly its new size.
double stretched(double value, double from, double to) { return from == to || from <= 0.0 ? value : value / from * to; }

void stretch(std::vector<Segment>& outline, const Stretch& by) {
  for (Segment& side : outline) {
    const glm::dvec3 low = by({side.a, side.z_min}), high = by({side.b, side.z_max});
    side.a = low, side.b = high;
    side.z_min = low.z, side.z_max = high.z;
  }
}

/// Returns an outline of the mover's frame, scaled about the origin of `X_MB`.
std::vector<Segment> scaled(const std::vector<Segment>& outline, const Pose& X_MB, const Segment& surface,
                            const glm::dvec3& from, const glm::dvec3& to) {
  if (from == to) return outline;
  std::vector<Segment> local, placed;
  place_outline(outline, inverse(X_MB), surface, local);
  stretch(local, {from, to});
  place_outline(local, X_MB, surface, placed);
  return placed;
}

/// Returns the mover's own outline in its current shape, in the mover's frame.
std::vector<Segment> outline_of(const World& world, const Mover& mover, const ChangedShape& now) {
  const OriginalShape& own = now.original;
  if (now.shape == kNone) return scaled(own.outline, mover.X_MB, own.surface, own.size, now.size);
  std::vector<Segment> local = world.shapes[now.shape].outline, placed;
  stretch(local, {world.shapes[now.shape].size, now.size});
  place_outline(local, mover.X_MB, own.surface, placed);
  return placed;
}

/// Returns the row of the shape; kNone for kOriginalShape.
std::uint32_t shape_named(const World& world, const std::string& name) {
  if (name == kOriginalShape) return kNone;
  const auto found = std::ranges::find(world.shapes, name, &Shape::name);
  if (found != world.shapes.end()) return static_cast<std::uint32_t>(found - world.shapes.begin());
  std::vector<std::string_view> names{kOriginalShape};
  for (const Shape& shape : world.shapes) names.emplace_back(shape.name);
  throw base::InputError(world.file, 0, fmt::format("has no shape '{}'{}", name, base::expected_one_of(name, names)));
}

ChangedShape current_shape(const World& world, std::uint32_t mover) {
  const auto found = world.changed_shapes.find(mover);
  if (found != world.changed_shapes.end()) return found->second;
  ChangedShape shape{.original = original_of(world, mover)};
  shape.size = shape.original.size;
  shape.color = shape.original.color;
  return shape;
}

/// Returns the state after a change.
ChangedShape changed(const World& world, const ChangedShape& before, const ShapeChange& change) {
  ChangedShape now = before;
  if (change.shape) {
    now.shape = shape_named(world, *change.shape);
    now.size = now.shape == kNone ? now.original.size : world.shapes[now.shape].size;
    const std::uint32_t color = now.shape == kNone ? 0 : world.shapes[now.shape].color;
    now.color = color != 0 ? color : now.original.color;
  }
  if (change.size) now.size = *change.size;
  if (change.color) now.color = *change.color;
  return now;
}

/// Magnets and fiducials of the mover's own model are at its middle height.
void move_middle(World& world, Mover& mover, const ChangedShape& now) {
  const bool original = now.shape == kNone && now.size == now.original.size;
  const double z = mover.X_MB.z + 0.5 * now.size.z;
  mover.magnets = now.original.magnets;
  for (Magnet& magnet : mover.magnets)
    if (!original && magnet.model == mover.model) magnet.z = z, magnet.radius = 0.5 * std::min(now.size.x, now.size.y);
  for (Fiducial& fiducial : world.fiducials)
    if (fiducial.model == mover.model) fiducial.X_BF.z = original ? now.original.fiducial_z : z;
}

void write_shape(World& world, std::uint32_t row, const ChangedShape& now) {
  Mover& mover = world.movers[row];
  Model& model = world.models[mover.model];
  std::vector<Segment> body = outline_of(world, mover, now);
  for (const Segment& side : mover.body)
    if (side.model != mover.model) body.push_back(side);
  mover.body = std::move(body);
  mover.radius = radius_of(mover);
  move_middle(world, mover, now);
  model.size = {now.size.x, now.size.y};
  model.color = now.color;
  model.is_bitmap = now.shape == kNone ? now.original.is_bitmap : world.shapes[now.shape].is_bitmap;
  model.pixel = now.shape == kNone ? now.original.pixel : world.shapes[now.shape].pixel;
}

/// @return whether the outline changed
bool use_shape(World& world, std::uint32_t row, const ChangedShape& now) {
  const ChangedShape before = current_shape(world, row);
  write_shape(world, row, now);
  const OriginalShape& own = now.original;
  const bool original = now.shape == kNone && now.size == own.size && now.color == own.color;
  if (original) world.changed_shapes.erase(row);
  if (!original) world.changed_shapes[row] = now;
  return now.shape != before.shape || now.size != before.size;
}

/// Triangles of the meshes of models, by row.
std::map<std::uint32_t, std::size_t> triangles_of_models(const World& world) {
  std::map<std::uint32_t, std::size_t> triangles;
  for (const MeshModel& row : world.mesh_models)
    if (world.models[row.model].mover != kNone) triangles[row.model] = world.meshes[row.mesh].corners.size() / 3;
  return triangles;
}

std::size_t sides_of(const World& world, const ChangedShape& shape) {
  return shape.shape == kNone ? shape.original.outline.size() : world.shapes[shape.shape].outline.size();
}

/// Returns the sides of all changed movers, and the triangles of those whose meshes have another size.
std::size_t changed_sides(const World& world, std::uint32_t mover, const ChangedShape& now) {
  const std::map<std::uint32_t, std::size_t> triangles = triangles_of_models(world);
  const auto count = [&](std::uint32_t row, const ChangedShape& shape) {
    const auto mesh = triangles.find(world.movers[row].model);
    const bool scaled = shape.shape == kNone && shape.size != shape.original.size && mesh != triangles.end();
    return sides_of(world, shape) + (scaled ? mesh->second : 0);
  };
  std::size_t sides = count(mover, now);
  for (const auto& [row, other] : world.changed_shapes) sides += row == mover ? 0 : count(row, other);
  return sides;
}

}  // namespace

void ShapeChange::add(const ShapeChange& later) {
  if (later.shape) *this = {.shape = later.shape};
  if (later.color) color = later.color;
  if (later.size) size = later.size;
}

std::uint32_t color_named(const std::string& text) {
  if (const auto color = color_of(text)) return *color;
  std::uint32_t rgb = 0;
  const char* const end = text.data() + text.size();
  const bool hex = text.size() == 7 && text[0] == '#' && std::from_chars(text.data() + 1, end, rgb, 16).ptr == end;
  if (!hex)
    throw base::InputError(
        fmt::format("unknown colour \"{}\"; expected a name of X11, e.g. \"steel blue\", or \"#RRGGBB\"", text));
  return 0xFF000000u | rgb;
}

void check_change(const World& world, std::uint32_t mover, const ShapeChange& change) {
  const auto refuse = [&](const std::string& what) {
    throw base::InputError(fmt::format("'{}' cannot change: {}", world.movers.at(mover).name, what));
  };
  const ChangedShape now = changed(world, current_shape(world, mover), change);
  if (change.size) {
    const glm::dvec3& s = *change.size;
    if (!base::is_shape_length(s.x) || !base::is_shape_length(s.y) || !base::is_shape_length(s.z))
      refuse(fmt::format("size ({:g}, {:g}, {:g}); expected lengths above 0 and at most {:g} m", s.x, s.y, s.z,
                         base::kMostShapeSize));
    if (sides_of(world, now) == 0) refuse("it has no outline of its own to scale; give a shape, too");
  }
  if (const std::size_t sides = changed_sides(world, mover, now); sides > kMostChangedSides)
    refuse(fmt::format(
        "changed objects would have {} sides, and triangles of scaled meshes, together; expected at most {}", sides,
        kMostChangedSides));
}

bool has_own_shape(const World& world, std::uint32_t mover) {
  const auto found = world.changed_shapes.find(mover);
  return found == world.changed_shapes.end() ||
         (found->second.shape == kNone && found->second.size == found->second.original.size);
}

glm::dvec3 Stretch::operator()(const glm::dvec3& p) const {
  return {stretched(p.x, from.x, to.x), stretched(p.y, from.y, to.y), stretched(p.z, from.z, to.z)};
}

std::optional<Stretch> stretch_of(const World& world, std::uint32_t mover) {
  const auto found = world.changed_shapes.find(mover);
  if (found == world.changed_shapes.end()) return Stretch{};
  if (found->second.shape != kNone) return {};
  return Stretch{found->second.original.size, found->second.size};
}

bool change_shape(World& world, std::uint32_t mover, const ShapeChange& change) {
  check_change(world, mover, change);
  return use_shape(world, mover, changed(world, current_shape(world, mover), change));
}

base::ShapeState shape_state(const World& world, std::uint32_t mover) {
  const ChangedShape now = current_shape(world, mover);
  return {mover, now.shape, now.color, now.size, world.movers[mover].X_MB};
}

bool restore_shape(World& world, const base::ShapeState& state) {
  const Pose& X = state.X_MB;
  const auto good = [](double length) { return length >= 0.0 && length <= 1e7; };
  if (state.mover >= world.movers.size() || (state.shape != kNone && state.shape >= world.shapes.size()) ||
      !good(state.size.x) || !good(state.size.y) || !good(state.size.z) || !std::isfinite(X.x + X.y + X.z + X.yaw))
    throw base::InputError(fmt::format("shape {} of mover {} does not belong to this world", state.shape, state.mover));
  world.movers[state.mover].X_MB = X;
  ChangedShape now = current_shape(world, state.mover);
  now.shape = state.shape, now.size = state.size, now.color = state.color;
  return use_shape(world, state.mover, now);
}

std::vector<base::ShapeState> restore_originals(World& world) {
  std::vector<base::ShapeState> restored;
  for (const auto& [mover, shape] : std::map(world.changed_shapes)) {
    change_shape(world, mover, {.shape = std::string(kOriginalShape)});
    restored.push_back(shape_state(world, mover));
  }
  return restored;
}

void restore_copy(World& world, std::uint32_t copy, const World& from, std::uint32_t original) {
  const auto found = from.changed_shapes.find(original);
  if (found == from.changed_shapes.end()) return;
  const Mover& changed = from.movers[original];
  ChangedShape own = found->second;
  own.shape = kNone, own.size = own.original.size, own.color = own.original.color;
  own.original.surface.model = world.movers[copy].model;
  for (Segment& side : own.original.outline) side.model = world.movers[copy].model;
  for (std::size_t i = 0; i < changed.magnets.size(); ++i)
    own.original.magnets[i].model = world.movers[copy].magnets[i].model;
  write_shape(world, copy, own);
}

glm::dvec3 size_of(const World& world, const Mover& mover) {
  double top = 0.0;
  for (const Segment& side : mover.body)
    if (side.model == mover.model) top = std::max(top, side.z_max - mover.X_MB.z);
  const glm::dvec2& size = world.models[mover.model].size;
  return {size.x, size.y, top};
}

void resize(Mover& mover, const Mover& original, const glm::dvec3& from, const glm::dvec3& to) {
  std::vector<Segment> own, carried;
  for (const Segment& side : original.body) (side.model == original.model ? own : carried).push_back(side);
  if (own.empty()) return;
  mover.body = scaled(own, original.X_MB, own.front(), from, to);
  mover.body.insert(mover.body.end(), carried.begin(), carried.end());
  mover.radius = radius_of(mover);
}

void place_outline(std::span<const Segment> outline, const Pose& X, const Segment& surface,
                   std::vector<Segment>& segments) {
  for (const Segment& local : outline) {
    Segment segment = surface;
    segment.a = transform(X, local.a);
    segment.b = transform(X, local.b);
    segment.z_min = local.z_min + X.z;
    segment.z_max = local.z_max + X.z;
    segment.solid_left = local.solid_left;
    const bool lost_in_rounding = segment.a.x == segment.b.x && segment.a.y == segment.b.y;
    if (!lost_in_rounding) segments.push_back(segment);
  }
}

}  // namespace sf::world
