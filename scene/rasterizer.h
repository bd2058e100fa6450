#pragma once
// Finds the nearest surface along each beam of a scan, in any pattern, by rasterizing surfaces in direction space.
//
// Seen from the sensor, a plane n . p = h has along a unit direction d the inverse range 1 / t = (n / h) . d, which is
// linear in d, and a face covers d if e . d >= 0 for each of its edges, e = p_i x (p_j - p_i). Each beam keeps the
// largest lower bound of 1 / t among faces that certainly cover it, the upper bound of that face, and the largest
// upper bound among all others. If the first exceeds the last, the nearest face is certified, and its range is
// evaluated in 64 bits. Otherwise 64 bits decide among all faces that were drawn near the beam (decision.h).
//
// Errors in 32 bits, u = 2^-24, of a leaf whose centre has distance D, with radius r and R = D + r:
// - corners relative to the sensor: 2 u R (their storage u r, the sensor's offset u D, the difference u R); edges as
//   vectors: u (2 r + L), L the longest; hence e: u R (2 r + 4 L) + u |e|;
// - directions after rotation into the mesh's frame, or e and n / h into the sensor's: 8.7 u; e . d in addition:
//   3 u |e|. In all
//   |error of e . d| <= u (R (2 r + 6 L) + 14 |e|), with two units of u R L to spare for machines without fused
//   products;
// - h: 6 u R, of which n has u; the relative error of 1 / t from it is B = 6 u R / |h|, at most 1.34 B above or below
//   for B < 0.25; the rest of it: (3 + 8.7 + 3) u / |h| < 17 u / |h|.
// A face with B >= 0.25 is seen edge-on: it may be anywhere, in either orientation, and is never certain.
// R is rounded up by 1e-5, which exceeds all products of these errors.
//
// Ranges in 32 bits (ScanOutput::single) are 1 / (a . d), where a = n / h is computed in 64 bits and rounded: a, d, the
// products and the sums each have u, in all 5 u / |h|. With s = |h| (a . d), the sine of the angle to the face, the
// relative error of a range is below 6 u / s for s >= 80 u, and with the rounding of the quotient and of s itself the
// error of a range t is below 10 u t / s. Beams where this exceeds kSingleRangeError, less the error in 64 bits, have
// ranges in 64 bits. All beams of a face, certified or decided, have this formula in one order of operations, so that
// ranges do not depend on the instruction set.

#include <cstdint>
#include <glm/ext/vector_float3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "base/reading.h"
#include "base/rigid_transform.h"
#include "scene/beam_pattern.h"
#include "scene/height_field.h"
#include "scene/surface_tree.h"

namespace sf::scene {

using base::RigidTransform;

/// Faces of a scan that are none of a mesh's: nothing within range, and the plane z = 0 of the world.
inline constexpr std::uint32_t kNoFace = base::kNoHit, kFloorFace = base::kFloorHit;

/// A mesh in the world. The tree must outlive the scans.
struct Instance {
  const SurfaceTree* tree = nullptr;
  RigidTransform X_WI;
  bool at_origin = false;              ///< X_WI is the identity
  std::uint32_t owner = base::kNoHit;  ///< of all faces, for a mesh without `Mesh::owners`
};

/// A height field in the world. It must outlive the scans.
struct Terrain {
  const HeightField* field = nullptr;  ///< null: none
  RigidTransform X_WF;
};

/// Scene of one scan.
struct SceneView {
  std::span<const Instance> instances;
  bool floor = false;  ///< the plane z = 0 is a surface
  Terrain terrain{};   ///< a beam that meets it hits base::kFloorHit
};

/// The hits of a tile's beams, in the tile's order.
struct TileSurfaces {
  alignas(64) double ranges[kTileBeams];                              ///< [m] as ScanOutput::ranges
  alignas(64) float x[kTileBeams], y[kTileBeams], z[kTileBeams];      ///< as ScanOutput::normals
  alignas(64) std::uint32_t hits[kTileBeams], materials[kTileBeams];  ///< as in ScanOutput
  alignas(64) double u[kTileBeams], v[kTileBeams];  ///< texture coordinates, where the face has some (Mesh), and
  alignas(64) glm::vec3 spread[kTileBeams];         ///< products of their gradients (texture_map.h)
  std::uint32_t uniform = 0;  ///< bit mask of vectors whose beams all meet one face, or all nothing
};

/// Receives the hits of each tile as soon as the tile has been cast.
class TileSink {
 public:
  virtual ~TileSink() = default;
  /// @param surfaces of the vectors that the tile uses, until the next call
  virtual void take(const BeamTile& tile, const TileSurfaces& surfaces) = 0;
};

/// Results of one scan, beam by beam in the order of the scan.
struct ScanOutput {
  std::span<double> ranges;              ///< [m] in [0, range_max]; range_max where nothing is nearer
  std::span<std::uint32_t> hits;         ///< owner of the face (Mesh::owners), base::kFloorHit, or base::kNoHit
  std::span<base::QualityFlag> quality;  ///< `grazing` where the error may exceed the bound. Only these are written
  std::span<float> cosines = {};         ///< of the angles between beams and the surfaces' normals, in [0, 1]; 0
                                         ///< without a surface. Empty: not wanted
  /// Unit normals of the surfaces in the sensor's frame, on the side of the sensor; 0 without a surface. Empty: not
  /// wanted.
  std::span<glm::vec3> normals = {};
  std::span<std::uint32_t> materials =
      {};               ///< of the faces (Mesh::materials), or world::kNoMaterial. Empty: not wanted
  bool single = false;  ///< ranges of meshes and the floor in 32 bits where these are within kSingleRangeError
  /// [m] > 0: instead of ranges, depths along the sensor's x axis, depth_max where nothing is nearer. All beams reach
  /// it within range_max. The sink gets ranges.
  double depth_max = 0.0;
  TileSink* sink = nullptr;  ///< null: none
};

/// Result of one beam that a device has cast (scene/device/device_rasterizer.h).
struct CastBeam {
  static constexpr std::uint32_t kUncertain = 1, kGrazing = 2;
  double range = 0.0;       ///< [m] as ScanOutput::ranges
  std::uint32_t face = 0;   ///< among those of all meshes (decision.h), kFloorFace or kNoFace
  std::uint32_t flags = 0;  ///< `kUncertain`: the host has to cast the beam, the rest means nothing. `kGrazing`
};

struct ScanCounts {
  std::uint64_t beams = 0;
  std::uint64_t uncertain = 0;  ///< decided in 64 bits
};

/// Largest error [m] of ranges without a flag, relative to the stored vertices, directions and sensor position.
inline constexpr double kRangeError = 1e-8;
inline constexpr double kSingleRangeError = 1e-3;  ///< [m] the same with ScanOutput::single

/// Computes scans in its own scratch memory: one object per thread. Not thread-safe.
class Rasterizer {
 public:
  Rasterizer();
  ~Rasterizer();
  Rasterizer(Rasterizer&&) noexcept;

  /// Casts the beams of some tiles of a pattern. Ranges and flags do not depend on the order of instances, nor results
  /// on the division into tiles or the machine's instruction set.
  /// @param X_WS the sensor's pose  @param range_max [m] > 0
  /// @param cast kTileBeams per tile that a device has cast in this scene, which has no terrain; empty: none
  /// @return true if any of these beams has a flag
  bool scan(const RigidTransform& X_WS, std::span<const BeamTile> tiles, double range_max, const SceneView& scene,
            const ScanOutput& out, std::span<const CastBeam> cast = {});
  const ScanCounts& counts() const;

  struct Scratch;

 private:
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace sf::scene
