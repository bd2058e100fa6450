#include "scene/rasterizer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <optional>
#include <type_traits>

#include "scene/rasterizer/scratch.h"
#include "scene/texture_map.h"

#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/rasterizer.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h: the code that is compiled per instruction set.
#include "scene/rasterizer/march-inl.h"
#include "scene/rasterizer/ranges-inl.h"
#include "scene/rasterizer/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

/// One scan.
class Scan {
 public:
  /// @param tiles of the scan
  Scan(Scratch& s, const RigidTransform& X_WS, std::span<const BeamTile> tiles, double range_max,
       const SceneView& scene, const ScanOutput& out)
      : s_(s), range_max_(range_max), floor_(scene.floor), floor_plane_(floor_plane(X_WS, range_max)), out_(out) {
    if (scene.terrain.field != nullptr)
      terrain_.emplace(*scene.terrain.field, base::relative(scene.terrain.X_WF, X_WS), range_max);
    if (terrain_ && terrain_->side > 0) build_horizon(*terrain_, tiles, horizon_);
    for (const SceneMesh& mesh : s.meshes) textured_ = textured_ || !mesh.tree->mesh.coordinates.empty();
    set_spheres();
  }
  /// @param next tile that will be cast
  bool cast(const BeamTile& tile, const BeamTile& next);
  /// Casts only the vectors with uncertain beams. @param cast the tile's beams from the device, in a scene without
  /// terrain
  bool finish(const BeamTile& tile, std::span<const CastBeam> cast);

 private:
  /// Plane of a face, kept while beams next to each other meet it.
  struct KnownPlane {
    std::uint32_t face = kNoFace;
    SeenPlane plane;
    SinglePlane single;
  };
  void draw(const BeamTile& tile, std::uint32_t vectors);
  void begin(const BeamTile& tile, std::uint32_t vectors);
  void draw_floor(const BeamTile& tile, std::uint32_t vectors);
  void take(const BeamTile& tile, std::uint32_t vector, std::span<const CastBeam, kWidth> cast);
  void set_spheres();
  void list_meshes(const BeamTile& tile);
  void measure(const BeamTile& tile, std::uint32_t vector);
  void evaluate_vector(const BeamTile& tile, std::uint32_t vector);
  std::uint32_t measure_single(const BeamTile& tile, std::uint32_t vector, std::uint32_t known);
  std::uint32_t decide_uncertain(const BeamTile& tile, std::uint32_t vector);
  void march(const BeamTile& tile, std::uint32_t vector);
  void meet_terrain(const BeamTile& tile, std::uint32_t vector);
  bool stays_above(const BeamTile& tile) const;
  void write(const BeamTile& tile, std::uint32_t vector);
  void write_surfaces(const BeamTile& tile, std::uint32_t vector);
  void write_coordinates(const BeamTile& tile, std::uint32_t vector);
  bool end(const BeamTile& tile);
  const SeenPlane& plane_of(std::uint32_t face) { return known_plane(face).plane; }
  const KnownPlane& known_plane(std::uint32_t face) {
    KnownPlane& known = planes_[face % kKnownPlanes];
    if (face == known.face) return known;
    known = {face, face == kFloorFace ? floor_plane_ : seen_plane(mesh_with(s_.meshes, face), face), {}};
    if (out_.single) known.single = single_plane(known.plane);
    return known;
  }

  std::uint32_t material_of(std::uint32_t hit, std::uint32_t beam) {
    const bool on_mesh = hit != base::kNoHit && (terrain_hits_ >> beam % kWidth & 1) == 0;
    return on_mesh ? plane_of(s_.face[beam]).material : world::kNoMaterial;
  }

  /// Normal of a beam's surface, toward the sensor, which is on one side of a face for all beams.
  glm::vec3 normal_of(std::uint32_t hit, std::uint32_t beam) {
    if (hit == base::kNoHit) return {};
    const std::uint32_t i = beam % kWidth, face = s_.face[beam];
    if ((terrain_hits_ >> i & 1) != 0) return glm::vec3(sines_[i] > 0.0 ? -terrain_normals_[i] : terrain_normals_[i]);
    if (face != normal_face_) {
      const SeenPlane& plane = plane_of(face);
      normal_face_ = face, normal_ = glm::vec3(plane.height > 0.0 ? -plane.normal : plane.normal);
    }
    return normal_;
  }

  Scratch& s_;
  double range_max_;
  bool floor_;
  SeenPlane floor_plane_;
  std::optional<FieldView> terrain_;
  Horizon horizon_;  ///< of a sensor above the terrain
  static constexpr std::uint32_t kMarchings = 4;
  Marching marching_[kMarchings];
  const ScanOutput& out_;
  bool flagged_ = false;
  static constexpr std::uint32_t kKnownPlanes = 64;
  KnownPlane planes_[kKnownPlanes];  ///< by face, modulo their number
  std::uint32_t normal_face_ = kNoFace;
  glm::vec3 normal_;       ///< of `normal_face_`
  bool textured_ = false;  ///< a mesh has texture coordinates
  std::uint32_t texture_face_ = kNoFace;
  bool has_texture_ = false;  ///< `texture_face_` has texture coordinates,
  TextureMap texture_;        ///< which these are

  // One vector's results.
  alignas(64) double ranges_[kWidth];
  alignas(64) std::uint32_t hits_[kWidth];
  alignas(64) double sines_[kWidth];  ///< of the angles to the faces; 0 without one
  std::uint32_t grazing_ = 0;         ///< bit mask
  std::uint32_t terrain_hits_ = 0;    ///< bit mask of beams that meet the terrain,
  // and of these, if cosines, normals or surfaces are wanted:
  glm::dvec3 terrain_normals_[kWidth];
};

/// @param vectors bit mask of those that are cast
void Scan::begin(const BeamTile& tile, std::uint32_t vectors) {
  const auto inverse = static_cast<float>(1.0 / range_max_);
  const Floats low = all(inverse * (1.0f - 1e-6f)), high = all(inverse * (1.0f + 1e-6f));
  for (std::uint32_t i = 0; i < kWidth * tile.used; i += kWidth) {
    store(low, s_.low + i), store(high, s_.high + i), store(all(0.0f), s_.others + i);
    store(all(kNoFace), s_.face + i);
  }
  for (std::uint32_t v = 0; v < kTileVectors; ++v)
    s_.farthest[v] = (vectors >> v & 1) != 0 ? inverse * (1.0f - 1e-6f) : kUnbounded;  // else it sees nothing
  s_.drawn.clear();
  if (floor_) draw_floor(tile, vectors);
}

/// Errors as in rasterizer.h, without a rotation.
void Scan::draw_floor(const BeamTile& tile, std::uint32_t vectors) {
  const auto inverse = static_cast<float>(1.0 / floor_plane_.height);
  const bool edge_on = !(std::abs(inverse) < kUnbounded);
  LeafView& view = s_.leaf;
  for (int axis = 0; axis < 3; ++axis)
    view.inverse[axis][0] = edge_on ? 0.0f : static_cast<float>(floor_plane_.normal[axis]) * inverse;
  view.above[0] = view.below[0] = 1.0f;
  view.slack[0] = edge_on ? kUnbounded : 17.0f * kRounding * std::abs(inverse);
  for (; vectors != 0; vectors &= vectors - 1) {
    const auto v = static_cast<std::uint32_t>(__builtin_ctz(vectors));
    Beams beams = load_beams(tile, s_, v);
    HWY_NAMESPACE::draw<true>(view, 0, 1.0f, kFloorFace, beams);
    store_beams(s_, v, beams);
  }
}

void Scan::set_spheres() {
  s_.spheres.resize((s_.meshes.size() + kWidth - 1) / kWidth);
  for (std::size_t i = 0; i < kWidth * s_.spheres.size(); ++i) {
    const SceneMesh mesh = i < s_.meshes.size() ? s_.meshes[i] : SceneMesh{.reach = -HUGE_VAL};
    MeshSpheres& out = s_.spheres[i / kWidth];
    for (int axis = 0; axis < 3; ++axis) out.centre[axis][i % kWidth] = static_cast<float>(mesh.centre[axis]);
    out.reach[i % kWidth] = static_cast<float>(mesh.reach + 1e-6 * (glm::length(mesh.centre) + mesh.reach));
  }
}

/// Lists the meshes of which the tile may see something, from near to far.
void Scan::list_meshes(const BeamTile& tile) {
  s_.in_view.clear();
  for (std::uint32_t first = 0; const MeshSpheres& spheres : s_.spheres) {
    const Floats x = load(spheres.centre[0]), y = load(spheres.centre[1]), z = load(spheres.centre[2]),
                 outside = all(0.0f) - load(spheres.reach);
    const auto along = [&](const float(*n)[1]) { return dot(all(n[0][0]), all(n[1][0]), all(n[2][0]), x, y, z); };
    Mask inside = at_least(along(tile.tile.plane), outside);
    for (int k = 3; k < 12; k += 3) inside = both(inside, at_least(along(tile.tile.plane + k), outside));
    alignas(64) float depths[kWidth];
    store(along(tile.tile.axis) + outside, depths);
    for (std::uint32_t rest = bits_of(inside); rest != 0; rest &= rest - 1) {
      const auto k = static_cast<std::uint32_t>(__builtin_ctz(rest));
      s_.in_view.push_back({depths[k], first + k});
    }
    first += kWidth;
  }
  std::sort(s_.in_view.begin(), s_.in_view.end(), [](const auto& a, const auto& b) { return a.depth < b.depth; });
}

void Scan::evaluate_vector(const BeamTile& tile, std::uint32_t vector) {
  const std::uint32_t first = kWidth * vector, face = s_.face[first];
  grazing_ = 0;
  if (are_all(s_.face + first, face)) {
    const std::uint32_t owner = face == kNoFace ? base::kNoHit : plane_of(face).owner;
    store(all(owner), hits_);
    if (face == kNoFace)
      std::fill_n(ranges_, kWidth, range_max_), std::fill_n(sines_, kWidth, 0.0);
    else
      grazing_ = evaluate_one(tile, first, range_max_, plane_of(face), ranges_, sines_);
  } else {
    grazing_ = evaluate_several(
        tile, first, range_max_, s_.face + first, [&](std::uint32_t f) -> const SeenPlane& { return plane_of(f); },
        ranges_, sines_, hits_);
  }
}

/// Decides and measures uncertain beams in 64 bits. @return their bit mask
std::uint32_t Scan::decide_uncertain(const BeamTile& tile, std::uint32_t vector) {
  if (s_.drawn.empty() && !floor_) return 0;
  const std::uint32_t first = kWidth * vector;
  const std::uint32_t all = bits_of(at_least(load(s_.others + first), load(s_.low + first)));
  std::uint32_t rest = all;
  if (rest != 0) list_candidates(s_.meshes, s_.drawn, 1u << vector, s_.candidates);
  for (; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<std::uint32_t>(__builtin_ctz(rest));
    const glm::dvec3 d{tile.dx[first + i], tile.dy[first + i], tile.dz[first + i]};
    Decision nearest{range_max_, kNoFace, false};
    if (floor_) {
      const double sine = sine_of(floor_plane_, d), range = floor_plane_.height / sine;
      if (range > 0.0 && range < range_max_) nearest = {range, kFloorFace, std::abs(sine) < floor_plane_.least_sine};
      if (floor_plane_.height == 0.0) nearest.flagged = sine > -floor_plane_.least_sine;  // at the sensor itself
    }
    nearest = decide(s_.candidates, d, nearest);
    ranges_[i] = nearest.range;
    hits_[i] = nearest.face == kNoFace ? base::kNoHit : plane_of(nearest.face).owner;
    sines_[i] = nearest.face == kNoFace ? 0.0 : sine_of(plane_of(nearest.face), d);
    s_.face[first + i] = nearest.face;
    grazing_ = (grazing_ & ~(1u << i)) | std::uint32_t{nearest.flagged} << i;
    ++s_.counts.uncertain;
  }
  return all;
}

/// Measures a vector's beams in 32 bits where these are accurate enough, the others in 64 bits.
/// @param known bit mask of beams that have been measured in 64 bits  @return that of those in 32 bits
std::uint32_t Scan::measure_single(const BeamTile& tile, std::uint32_t vector, std::uint32_t known) {
  const std::uint32_t first = kWidth * vector, *const faces = s_.face + first;
  double ranges[kWidth], sines[kWidth];  // in 64 bits
  if (known != 0) std::copy_n(ranges_, kWidth, ranges), std::copy_n(sines_, kWidth, sines);
  SingleVectors planes{all(0.0f), all(0.0f), all(0.0f), all(0.0f), all(0.0f)};
  Words owners = all(base::kNoHit);
  for (std::uint32_t rest = (1u << kWidth) - 1; rest != 0;) {
    const std::uint32_t face = faces[__builtin_ctz(rest)];
    const Mask meets = equal(load(faces), all(face));
    rest &= ~bits_of(meets);
    if (face == kNoFace) continue;
    const KnownPlane& plane = known_plane(face);
    owners = select(meets, all(plane.plane.owner), owners);
    put(meets, plane.single, planes);
  }
  store(owners, hits_);
  const std::uint32_t good = evaluate_single(tile, first, range_max_, planes, ranges_, sines_);
  for (std::uint32_t rest = ~good & 0xFFFFu; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<std::uint32_t>(__builtin_ctz(rest));
    if ((known >> i & 1) != 0) {
      ranges_[i] = ranges[i], sines_[i] = sines[i];
    } else if (faces[i] != kNoFace) {
      const SeenPlane& plane = plane_of(faces[i]);
      sines_[i] = sine_of(plane, {tile.dx[first + i], tile.dy[first + i], tile.dz[first + i]});
      ranges_[i] = std::min(range_max_, plane.height / sines_[i]);
      grazing_ |= std::uint32_t{std::abs(sines_[i]) < plane.least_sine} << i;
    } else {
      ranges_[i] = range_max_;
    }
  }
  return good;
}

/// Measures the beams of a vector that has been drawn.
void Scan::measure(const BeamTile& tile, std::uint32_t vector) {
  if (out_.single) {
    grazing_ = 0;
    measure_single(tile, vector, decide_uncertain(tile, vector));
  } else {
    evaluate_vector(tile, vector);
    decide_uncertain(tile, vector);
  }
}

void Scan::write(const BeamTile& tile, std::uint32_t vector) {
  const std::uint32_t first = kWidth * vector;
  const std::uint32_t* const place = tile.place + first;
  if (out_.sink != nullptr) write_surfaces(tile, vector);
  if (out_.depth_max > 0.0) to_depths(tile, first, out_.depth_max, ranges_, hits_);
  const auto write_runs = [&](auto run) {
    for (std::uint32_t i = 0; i < kWidth; i += run) {
      std::memcpy(&out_.ranges[place[i]], ranges_ + i, run * sizeof *ranges_);
      std::memcpy(&out_.hits[place[i]], hits_ + i, run * sizeof *hits_);
    }
  };
  if (tile.run == kWidth)
    write_runs(std::integral_constant<std::uint32_t, kWidth>());
  else if (tile.run == 4)
    write_runs(std::integral_constant<std::uint32_t, 4>());
  else
    write_runs(std::integral_constant<std::uint32_t, 1>());
  if (!out_.cosines.empty())
    for (std::uint32_t i = 0; i < kWidth; ++i)
      out_.cosines[place[i]] = hits_[i] == base::kNoHit ? 0.0f : static_cast<float>(std::min(1.0, std::abs(sines_[i])));
  if (!out_.normals.empty())
    for (std::uint32_t i = 0; i < kWidth; ++i) out_.normals[place[i]] = normal_of(hits_[i], first + i);
  if (!out_.materials.empty())
    for (std::uint32_t i = 0; i < kWidth; ++i) out_.materials[place[i]] = material_of(hits_[i], first + i);
  flagged_ = flagged_ || grazing_ != 0;
  for (; grazing_ != 0; grazing_ &= grazing_ - 1)
    out_.quality[place[__builtin_ctz(grazing_)]] = base::QualityFlag::grazing;
}

/// Writes the texture coordinates of a vector's beams for the sink, after their normals.
void Scan::write_coordinates(const BeamTile& tile, std::uint32_t vector) {
  TileSurfaces& to = s_.surfaces;
  for (std::uint32_t i = 0, beam = kWidth * vector; i < kWidth; ++i, ++beam) {
    const std::uint32_t face = s_.face[beam];
    if (face == kNoFace || face == kFloorFace || (terrain_hits_ >> i & 1) != 0) continue;
    if (face != texture_face_) {
      texture_face_ = face;
      const SceneMesh& mesh = mesh_with(s_.meshes, face);
      has_texture_ = !mesh.tree->mesh.coordinates.empty();
      if (has_texture_) texture_ = seen_texture(mesh, face);
    }
    if (!has_texture_) continue;
    const glm::dvec3 d{tile.dx[beam], tile.dy[beam], tile.dz[beam]};
    const glm::dvec2 at = texture_.at(ranges_[i] * d);
    to.u[beam] = at.x, to.v[beam] = at.y;
    to.spread[beam] = texture_spread(texture_, {to.x[beam], to.y[beam], to.z[beam]}, d, ranges_[i]);
  }
}

/// Writes what a vector's beams meet for the sink.
void Scan::write_surfaces(const BeamTile& tile, std::uint32_t vector) {
  TileSurfaces& to = s_.surfaces;
  const std::uint32_t first = kWidth * vector;
  std::memcpy(to.ranges + first, ranges_, sizeof ranges_);
  std::memcpy(to.hits + first, hits_, sizeof hits_);
  if (terrain_hits_ == 0 && are_all(s_.face + first, s_.face[first])) {
    const glm::vec3 n = normal_of(hits_[0], first);
    store(all(n.x), to.x + first), store(all(n.y), to.y + first), store(all(n.z), to.z + first);
    store(all(material_of(hits_[0], first)), to.materials + first);
    to.uniform |= 1u << vector;
  } else {
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      const glm::vec3 n = normal_of(hits_[i], first + i);
      to.x[first + i] = n.x, to.y[first + i] = n.y, to.z[first + i] = n.z;
      to.materials[first + i] = material_of(hits_[i], first + i);
    }
  }
  if (textured_) write_coordinates(tile, vector);
}

/// Searches the terrain for some vectors at a time, since each step waits for the one before.
void Scan::march(const BeamTile& tile, std::uint32_t vector) {
  const std::span marchings = std::span(marching_).first(std::min(kMarchings, tile.used - vector));
  for (std::uint32_t k = 0; k < marchings.size(); ++k) {
    const std::uint32_t first = kWidth * (vector + k);
    marchings[k].begin(*terrain_, horizon_, tile, first, all(1.000002f) / load(s_.low + first));
  }
  for (bool more = true; more;) {
    more = false;
    for (Marching& m : marchings) more = m.step() || more;
  }
}

/// Shortens a vector's ranges to the terrain.
void Scan::meet_terrain(const BeamTile& tile, std::uint32_t vector) {
  Marching& marching = marching_[vector % kMarchings];
  grazing_ |= marching.finish(ranges_, hits_, s_.counts);
  terrain_hits_ = marching.met();
  if (out_.cosines.empty() && out_.normals.empty() && out_.sink == nullptr) return;
  for (std::uint32_t rest = terrain_hits_; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<std::uint32_t>(__builtin_ctz(rest));
    const std::uint32_t beam = kWidth * vector + i;
    terrain_normals_[i] = glm::transpose(terrain_->X_FS.R) * marching.normal(i);
    sines_[i] = glm::dot(terrain_normals_[i], glm::dvec3{tile.dx[beam], tile.dy[beam], tile.dz[beam]});
  }
}

/// Draws all surfaces into vectors. @param vectors bit mask
void Scan::draw(const BeamTile& tile, std::uint32_t vectors) {
  begin(tile, vectors);
  list_meshes(tile);
  for (const MeshInView& near : s_.in_view) {
    if (near.depth > depth_limit(farthest_of(s_))) break;
    draw_mesh(s_, tile, s_.meshes[near.row]);
  }
}

/// Returns true if all beams of a tile stay above the terrain.
bool Scan::stays_above(const BeamTile& tile) const {
  if (terrain_->side <= 0) return false;
  const double slope = std::max(double{horizon_.highest}, 0.0);  // directions above a positive slope are a convex cone
  return std::ranges::all_of(corners_of(tile, terrain_->X_FS.R), [&](const glm::dvec3& d) {
    return d.z > slope * (std::abs(d.x) + std::abs(d.y)) * 1.00001 + 1e-5;
  });
}

/// @return true if any beam so far has a flag
bool Scan::end(const BeamTile& tile) {
  if (out_.sink != nullptr) out_.sink->take(tile, s_.surfaces);
  s_.surfaces.uniform = 0;
  s_.counts.beams += kWidth * tile.used;
  return flagged_;
}

bool Scan::cast(const BeamTile& tile, const BeamTile& next) {
  draw(tile, used_vectors(tile));
  const bool terrain = terrain_ && !stays_above(tile);
  terrain_hits_ = 0;
  for (std::uint32_t v = 0; v < tile.used; ++v) {
    if (terrain && v % kMarchings == 0) march(tile, v);
    measure(tile, v);
    if (terrain) meet_terrain(tile, v);
    write(tile, v);
    prefetch_beams(next, v);
  }
  return end(tile);
}

/// Takes over what the device found along a vector's beams, which are all certain.
void Scan::take(const BeamTile& tile, std::uint32_t vector, std::span<const CastBeam, kWidth> cast) {
  const std::uint32_t first = kWidth * vector;
  const bool sines = !out_.cosines.empty() || !out_.normals.empty();
  grazing_ = 0;
  for (std::uint32_t i = 0; i < kWidth; ++i) {
    const std::uint32_t face = cast[i].face, beam = first + i;
    ranges_[i] = cast[i].range;
    s_.face[beam] = face;
    hits_[i] = face == kNoFace ? base::kNoHit : plane_of(face).owner;
    sines_[i] = 0.0;
    if (sines && face != kNoFace) sines_[i] = sine_of(plane_of(face), {tile.dx[beam], tile.dy[beam], tile.dz[beam]});
    grazing_ |= (cast[i].flags & CastBeam::kGrazing) != 0 ? 1u << i : 0u;
  }
  if (out_.single) grazing_ &= ~measure_single(tile, vector, 0xFFFFu);
}

bool Scan::finish(const BeamTile& tile, std::span<const CastBeam> cast) {
  std::uint32_t uncertain = 0;
  for (std::uint32_t i = 0; i < kWidth * tile.used; ++i)
    uncertain |= (cast[i].flags & CastBeam::kUncertain) != 0 ? 1u << i / kWidth : 0u;
  if (uncertain != 0) draw(tile, uncertain);
  for (std::uint32_t v = 0; v < tile.used; ++v) {
    if ((uncertain >> v & 1) != 0)
      measure(tile, v);
    else
      take(tile, v, cast.subspan(kWidth * v).first<kWidth>());
    write(tile, v);
  }
  return end(tile);
}

bool scan_tiles(Scratch& s, const RigidTransform& X_WS, std::span<const BeamTile> tiles, double range_max,
                const SceneView& scene, const ScanOutput& out, std::span<const CastBeam> cast) {
  Scan scan(s, X_WS, tiles, range_max, scene, out);
  bool flagged = false;
  for (std::size_t i = 0; i < tiles.size(); ++i)
    flagged = cast.empty() ? scan.cast(tiles[i], tiles[std::min(i + 1, tiles.size() - 1)])
                           : scan.finish(tiles[i], cast.subspan(i * kTileBeams, kTileBeams));
  return flagged;
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sf::scene {

HWY_EXPORT(scan_tiles);

Rasterizer::Rasterizer() : scratch_(std::make_unique<Scratch>()) {}
Rasterizer::~Rasterizer() = default;
Rasterizer::Rasterizer(Rasterizer&&) noexcept = default;

const ScanCounts& Rasterizer::counts() const { return scratch_->counts; }

bool Rasterizer::scan(const RigidTransform& X_WS, std::span<const BeamTile> tiles, double range_max,
                      const SceneView& scene, const ScanOutput& out, std::span<const CastBeam> cast) {
  Scratch& s = *scratch_;
  list_meshes(X_WS, range_max, scene.instances, s.meshes);
  return HWY_DYNAMIC_DISPATCH(scan_tiles)(s, X_WS, tiles, range_max, scene, out, cast);
}

}  // namespace sf::scene
#endif
