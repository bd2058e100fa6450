#pragma once
// What the sources of sensors::Lasers share: one row per laser, and the device's tables.

#include <cstdint>
#include <memory>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "sensors/beams.h"
#include "sensors/laser.h"

namespace sf::sensors {

/// One laser, planned at load.
struct LaserRow {
  world::Laser laser;
  BeamPlan plan;
  double height = 0.0;  ///< [m] of the beams in the world, fixed at load: the world is 2.5-D
  std::uint32_t family = 0;
  std::uint32_t beams = 0;  ///< first lane of its beam tables
  std::uint32_t out = 0;    ///< first lane of its results
  std::size_t values = 0;   ///< first of its samples in the host's own results
  bool turns = false;       ///< has angular noise: beams are its own and change
  bool shaped = false;      ///< results are reworked on the host
};

/// True when its ranges are disturbed.
inline bool has_range_noise(const world::LaserNoise& noise) {
  return noise.range_sigma > 0.0 || noise.range_proportional > 0.0;
}

struct Lasers::Tables {
  Scene& scene;
  base::Workers& workers;
  LaserOptions options;
  std::vector<LaserOwner> owners;
  std::vector<LaserRow> lasers;
  std::unique_ptr<gpu::Kernel> kernel;
  std::unique_ptr<gpu::Buffer> rows, lanes, groups, directions, middles, directions64, ranges, hits, doubts;
  std::vector<LaserDue> due;
  std::vector<std::uint32_t> lanes_written;  ///< due rows, in order, that `lanes` holds
  std::vector<Viewpoint> views;
  std::vector<double> values;  ///< [m] results reworked on the host
  std::vector<std::uint32_t> met;
  std::vector<std::vector<double>> turned;  ///< scratch per thread
  std::uint32_t out_lanes = 0;
  std::uint64_t rays = 0;
  std::uint64_t doubts_seen = 0;
  bool bound = false;
  bool beams_changed = true;

  Tables(Scene& s, base::Workers& w, const LaserOptions& o) : scene(s), workers(w), options(o) {}
  void plan(const world::World& world);
  void make_tables(gpu::Device& device, std::uint32_t beam_lanes);
  void write_all_beams();
  void write_lanes();
  void turn_beams(const LaserDue& d, unsigned thread);
  void shape(const LaserDue& d);
  void bind();
  BeamTables beam_tables(std::uint32_t lane) const {
    return {directions->host<float>().data() + 8 * std::size_t{lane}, middles->host<float>().data() + lane,
            directions64->host<double>().data() + 8 * std::size_t{lane}};
  }
};

}  // namespace sf::sensors
