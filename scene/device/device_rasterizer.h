#pragma once
// Rasterizer on the device: kernels cast whole scans, one workgroup per tile, and the host finishes them
// (Rasterizer::scan), which casts the uncertain beams. The results have the bytes of the host's scans.
//
//   rasterizer.begin();
//   const auto first = rasterizer.add(X_WS, pattern, range_max, scene);  // for each scan
//   if (rasterizer.prepare()) { batch.begin(); rasterizer.record(batch); batch.end(); }
//   rasterizer.add_copies(batch), batch.run();
//   host.scan(X_WS, tiles, range_max, scene, out, rasterizer.results(*first, tile_count));

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "gpu/batch.h"
#include "gpu/kernel.h"
#include "scene/decision.h"
#include "scene/device/growing_table.h"
#include "scene/rasterizer.h"

namespace sf::scene {

/// Not thread-safe. Trees and patterns of scans are copied to the device when they are first used; they must not change
/// until `forget`.
class DeviceRasterizer {
 public:
  /// @param device must outlive this object  @throws base::DeviceError if it is the host
  explicit DeviceRasterizer(gpu::Device& device);

  /// Forgets all trees and patterns.
  void forget();
  /// Starts the list of a tick's scans.
  void begin();
  /// Adds a scan. @param pattern all of its tiles, as Rasterizer::scan
  /// @return its first tile in the results; nullopt for the host: the scene has terrain, or a table would exceed the
  /// device's limits
  std::optional<std::size_t> add(const RigidTransform& X_WS, std::span<const BeamTile> pattern, double range_max,
                                 const SceneView& scene);
  /// Writes the tables. @return true if the batch must be recorded again
  bool prepare();
  void record(gpu::Batch& batch) const;
  void add_copies(gpu::Batch& batch);
  /// Returns the beams of tiles, each with kTileBeams, after the batch.
  std::span<const CastBeam> results(std::size_t first_tile, std::size_t tiles);

 private:
  struct TreeRows {
    std::uint32_t first_node = 0, first_leaf = 0, first_face = 0;
  };
  TreeRows rows_of(const SurfaceTree& tree);
  std::uint32_t first_tile_of(std::span<const BeamTile> pattern);
  void add_instance(const SceneMesh& mesh);

  gpu::Device& device_;
  // Contents that stay from tick to tick.
  GrowingTable nodes_, leaves_, planes_, tiles_;
  std::unordered_map<const SurfaceTree*, TreeRows> trees_;
  std::unordered_map<const BeamTile*, std::uint32_t> patterns_;
  // Contents of one tick.
  GrowingTable jobs_, scans_, instances_;
  std::size_t tile_count_ = 0;
  gpu::Buffer results_, groups_;
  gpu::Kernel kernel_;
  bool bound_ = false;
  std::vector<SceneMesh> meshes_;  ///< of one scan
};

}  // namespace sf::scene
