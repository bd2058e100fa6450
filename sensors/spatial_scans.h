#pragma once
// Base class of sensors that cast beams into the scene of solids: poses at the times of the beams, scenes, casting on
// all threads, or on the device where its caster runs there. Derived classes turn what the beams meet into readings.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "scene/device/device_rasterizer.h"
#include "scene/rasterizer.h"
#include "sensors/host_backend.h"
#include "sensors/lidar_beams.h"
#include "sensors/mover_trails.h"
#include "sensors/spatial_scene.h"

namespace sf::sensors {

/// One sensor.
struct SpatialScanner {
  base::RigidTransform X_MS;  ///< sensor in the mover's frame
  double range_max = 0.0;     ///< [m] > 0, along the beams
  double angle = 0.0;         ///< [rad] as SpatialScene::list
  std::shared_ptr<const LidarBeams> beams;
  bool plain = false;      ///< beams are cast into the reading's values
  bool cosines = false;    ///< also casts the cosines of angles of incidence,
  bool normals = false;    ///< and the normals of surfaces
  bool materials = false;  ///< surfaces have their materials, which are also cast,
  bool follows = false;    ///< tiles are passed to `follow`, with materials,
  bool textures = false;   ///< and with texture coordinates
  bool single = false;     ///< as scene::ScanOutput::single
  double depth_max = 0.0;  ///< as scene::ScanOutput::depth_max
};

/// Not thread-safe.
class SpatialScans : public HostBackend {
 public:
  void accumulate(std::int64_t now, bool between) override { trails_.add(now, between); }
  void place_movers() override { scene_.place(states()); }
  bool update_outlines(const world::World& world) override;
  bool prepare(std::span<const DueSample> due) override;
  void record_measure(gpu::Batch& batch) override;
  void add_copies(gpu::Batch& batch) override;
  bool on_device() const override { return device_.has_value(); }
  void collect(std::span<base::ReadingBlock> out) override;
  void write_state(std::uint32_t row, base::ByteWriter& out) const override;
  void read_state(std::uint32_t row, base::ByteReader& in) override;
  void take_over(SensorBackend& before, std::uint32_t rows) override;
  void restart(std::uint32_t row, std::int64_t now) override { trails_.restart(rows()[row].mover, now); }
  SensorStats stats() const override;

 protected:
  SpatialScans(const SensorContext& context, const SensorType& type, const ParsedSensors& sensors,
               std::vector<SpatialScanner> scanners);

  /// Writes the values, hits and flags of a due sample from what its beams met. Several threads call it at once.
  virtual void finish(std::size_t sample, unsigned thread) = 0;

  /// As SpatialScene::materials, if a sensor uses them.
  const std::vector<world::Material>& materials() const { return scene_.materials(); }
  const std::vector<world::TextureUse>& textures() const { return scene_.textures(); }
  /// Precedes calls of `follow` for tiles that are cast from one pose. Several threads call both at once.
  virtual void begin_follow(std::size_t /*sample*/, const base::RigidTransform& /*X_WS*/, unsigned /*thread*/) {}
  /// Computes further quantities from the hits of a tile.
  virtual void follow(std::size_t /*sample*/, const base::RigidTransform& /*X_WS*/, const scene::BeamTile& /*tile*/,
                      const scene::TileSurfaces& /*surfaces*/, unsigned /*thread*/) {}

  const SpatialScene& scene() const { return scene_; }
  /// Returns the view of a due sample, before its surroundings are used.
  SensorView sensor_view(std::size_t sample) const;
  /// Puts the instances of a list where they are at the time of a tile.
  void move_to_tile(const scene::BeamTile& tile, const SceneList& list, std::vector<scene::Instance>& out) const;
  const base::RigidTransform& X_WS(std::size_t sample) const { return surroundings_[sample].X_WS; }
  const SpatialScanner& scanner_of(std::size_t sample) const { return scanners_[samples()[sample].row]; }
  /// Returns the hits of a sample, one per part of each cast beam. For a plain sensor, this is its reading itself.
  scene::ScanOutput output_of(std::size_t sample);
  /// A sample's part of a table with one entry per part of the cast beams.
  template <class Value>
  std::span<Value> parts_of(std::vector<Value>& table, std::size_t sample) const {
    const std::size_t row = samples()[sample].row;
    return std::span(table).subspan(first_part_[row], first_part_[row + 1] - first_part_[row]);
  }
  std::size_t parts() const { return first_part_.back(); }
  std::span<std::uint32_t> hits_of(std::size_t sample) { return beams_of(hits_, sample); }
  std::span<base::QualityFlag> quality_of(std::size_t sample) { return beams_of(quality_, sample); }

 private:
  struct Follower;
  /// Part of a scan, the work of one thread.
  struct Job {
    std::size_t sample = 0;
    std::size_t first_tile = 0, end_tile = 0;
  };
  void measure_all() override;
  void cast(const Job& job, unsigned thread);
  void list_scene(std::size_t sample);
  scene::SceneView view_of(std::span<const scene::Instance> instances, std::size_t sample) const {
    return {instances, surroundings_[sample].list.floor, scene_.terrain()};
  }
  /// Returns what the device found along the beams of a job; empty: the host casts them.
  std::span<const scene::CastBeam> cast_beams_of(const Job& job);
  void cast_rolling(const Job& job, std::span<const scene::BeamTile> tiles, unsigned thread);
  static void cast_reference(const base::RigidTransform& X_WS, const scene::BeamTile& tile, const SpatialScanner& s,
                             const scene::SceneView& view, const scene::ScanOutput& out);
  void cast_tiles(const base::RigidTransform& X_WS, std::span<const scene::Instance> instances,
                  std::span<const scene::BeamTile> tiles, const Job& job, unsigned thread,
                  std::span<const scene::CastBeam> cast = {});
  /// A sample's part of a table with one entry per beam.
  template <class Value>
  std::span<Value> beams_of(std::vector<Value>& table, std::size_t sample) const {
    const std::size_t row = samples()[sample].row;
    return std::span(table).subspan(first_beam_[row], first_beam_[row + 1] - first_beam_[row]);
  }

  std::vector<SpatialScanner> scanners_;
  bool reference_;  ///< casts every beam against every face in `long double`
  SpatialScene scene_;
  std::vector<std::uint32_t> hits_;  ///< of all beams
  std::vector<base::QualityFlag> quality_;
  std::vector<std::size_t> first_beam_;  ///< per row, plus one: index of its first beam in these tables
  // Of the parts of the cast beams of sensors that are not plain.
  std::vector<double> part_ranges_;  ///< [m]
  std::vector<std::uint32_t> part_hits_;
  std::vector<base::QualityFlag> part_quality_;
  std::vector<float> part_cosines_;             ///< empty unless a sensor uses them
  std::vector<glm::vec3> part_normals_;         ///< empty unless a sensor uses them
  std::vector<std::uint32_t> part_materials_;   ///< empty unless a sensor uses them
  std::vector<std::size_t> first_part_;         ///< per row, plus one
  std::vector<scene::Rasterizer> rasterizers_;  ///< per thread
  /// Surroundings of the sensor of a due sample.
  struct Surroundings {
    base::RigidTransform X_WS;  ///< the sensor at the time of the reading
    SceneList list;
    bool rolling = false;  ///< its carrier or a surface moves between its beams
  };
  MoverTrails trails_;                               ///< empty: no scan is rolling
  std::vector<Surroundings> surroundings_;           ///< per due sample
  std::vector<std::vector<scene::Instance>> moved_;  ///< per thread: instances at the time of a beam
  std::vector<Job> jobs_;
  std::optional<scene::DeviceRasterizer> device_;
  std::vector<std::optional<std::size_t>> on_device_;  ///< per due sample: its first tile in the device's results
  std::uint64_t host_scans_ = 0;                       ///< that the device could not cast
  std::uint64_t rays_ = 0;
};

}  // namespace sf::sensors
