#ifndef SCENE_DEVICE_RECORDS_H
#define SCENE_DEVICE_RECORDS_H
// Records of scans on the device, shared by host and device (scene/device/device_rasterizer.h), and the places of the
// fields of BeamTile, TreeNode and TreeLeaf, which kernels read as words.

#define SF_TILE_LANES 128u  // invocations per tile, with four beams each
#define SF_TILE_BEAMS 512u

#define SF_BEAM_UNCERTAIN 1u  // CastBeam::flags
#define SF_BEAM_GRAZING 2u
#define SF_SCENE_NO_FACE 0xFFFFFFFFu     // scene::kNoFace
#define SF_SCENE_FLOOR_FACE 0xFFFFFFFEu  // scene::kFloorFace
#define SF_SCENE_NO_VIEW 0xFFFFFFFFu     // SceneJob::view of workgroups without a tile

#define SF_TILE_WORDS 5952u  // sizeof(BeamTile)
#define SF_TILE_X 0u
#define SF_TILE_DX 1536u
#define SF_TILE_VECTORS 5120u  // rows of 32: 9 of boxes, 12 of planes, 3 of axes
#define SF_TILE_BOX 5888u
#define SF_TILE_PLANE 5904u
#define SF_TILE_AXIS 5920u
#define SF_TILE_LONGEST 5936u
#define SF_TILE_USED 5938u
#define SF_NODE_WORDS 112u  // sizeof(TreeNode)
#define SF_NODE_CHILD 96u
#define SF_LEAF_WORDS 288u  // sizeof(TreeLeaf)
#define SF_LEAF_NORMAL 192u
#define SF_LEAF_EXTENT 240u
#define SF_LEAF_FACE 256u
#define SF_LEAF_CENTRE 272u
#define SF_LEAF_RADIUS 278u
#define SF_LEAF_COUNT 279u
#define SF_LEAF_BODY 280u
#define SF_LEAF_OUTWARD 286u

#define SF_FACE_EDGE_ON 1u  // seen edge-on: it may be anywhere
#define SF_FACE_HIDDEN 2u   // a back face of a closed body

#ifdef __cplusplus

#include <cstdint>

namespace sf::scene {

/// Work of one group: a tile of a scan.
struct SceneJob {
  std::uint32_t tile;    ///< row in the table of tiles
  std::uint32_t view;    ///< row of its SceneScan
  std::uint32_t result;  ///< first of its beams in the table of results
  std::uint32_t spare;
};

/// A scan: its range, its instances, and the plane z = 0 as seen from the sensor (SeenPlane).
struct SceneScan {
  double normal_x, normal_y;
  double normal_z, height;
  double least_sine, range_max;
  std::uint32_t first_instance, instances;
  std::uint32_t floor;  ///< 1: the plane is a surface
  std::uint32_t spare;
};

/// An instance of a mesh in one scan (SceneMesh).
struct SceneInstance {
  double ax, ay, az, bx, by, bz, cx, cy, cz;         ///< columns of X_FS.R
  double px, py, pz;                                 ///< [m] X_FS.p
  float eye_x, eye_y, eye_z, room;                   ///< [m] the sensor relative to the tree's centre; rounding
  float centre_x, centre_y, centre_z, reach;         ///< [m] sphere around the mesh in the sensor's frame
  std::int32_t root;                                 ///< SurfaceTree::root
  std::uint32_t first_node, first_leaf, first_face;  ///< rows of the tree in its tables
  double least_sine;
  std::uint32_t face;  ///< SceneMesh::first_face
  std::uint32_t spare;
};

/// Plane of a face (scene::Plane).
struct ScenePlane {
  double normal_x, normal_y, normal_z;
  double x, y, z;  ///< [m] a point
};

}  // namespace sf::scene

#endif
#endif
