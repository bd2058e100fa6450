#pragma once
// Working memory of the rasterizer: one tile of beams, and the faces drawn into it.

#include <cstdint>
#include <vector>

#include "scene/decision.h"
#include "scene/rasterizer.h"

namespace sf::scene {

/// Up to sixteen faces of a leaf, as seen from the sensor.
struct LeafView {
  alignas(64) float edge[12][kWidth];    ///< e of the four edges, positive inside
  alignas(64) float inverse[3][kWidth];  ///< n / h; 0 if seen edge-on
  alignas(64) float above[kWidth], below[kWidth],
      slack[kWidth];                     ///< bounds of 1 / t: w * above + slack, w * below - slack
  alignas(64) float edge_error[kWidth];  ///< of e . d for |d| <= 1
  const std::uint32_t* face = nullptr;
};

/// Spheres around sixteen meshes, in the sensor's frame, with room for rounding.
struct alignas(64) MeshSpheres {
  float centre[3][kWidth];  ///< [m]
  float reach[kWidth];      ///< [m] radius; negative infinity: unused
};

/// A mesh that a tile may see.
struct MeshInView {
  float depth = 0.0f;     ///< [m] along the tile's axis, of its nearest point
  std::uint32_t row = 0;  ///< in Scratch::meshes
};

struct Rasterizer::Scratch {
  // Beams of the tile, in the frame of the mesh that is drawn.
  alignas(64) float x[kTileBeams], y[kTileBeams], z[kTileBeams];
  // [1/m] bounds of the nearest face so far, the largest upper bound of all others, and that face.
  alignas(64) float low[kTileBeams], high[kTileBeams], others[kTileBeams];
  alignas(64) std::uint32_t face[kTileBeams];
  alignas(64) float farthest[kTileVectors];  ///< [1/m] smallest `low` of each vector

  // Boxes in the same frame. A point q relative to the tree's centre is inside of side k if plane . q >= side_offset.
  DirectionBoxes<kTileVectors> vectors;
  alignas(64) float side_offset[4][kTileVectors], axis_offset[kTileVectors];
  alignas(64) float side_size[12][kTileVectors], axis_size[3][kTileVectors];  ///< absolute values of `vectors`
  DirectionBoxes<1> tile;
  float tile_side_offset[4], tile_axis_offset;

  LeafView leaf;
  TileSurfaces surfaces;              ///< for ScanOutput::sink
  std::vector<std::uint64_t> stack;   ///< depth as sortable bits, above node * 16 + child
  std::vector<DrawnFace> drawn;       ///< in this tile
  std::vector<Candidate> candidates;  ///< of one vector
  std::vector<SceneMesh> meshes;      ///< of this scan, by first face
  std::vector<MeshSpheres> spheres;   ///< of `meshes`
  std::vector<MeshInView> in_view;    ///< of this tile, from near to far
  ScanCounts counts;
};

}  // namespace sf::scene
