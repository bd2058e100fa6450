#include "bench/lane_methods.h"

#include "robots/fleet.h"
#include "sensors/lane_markings/filtered_scene.h"
#include "sensors/laneedge_settings.h"

namespace sf::bench {

namespace {

/// The farm's backend and the steps of a tick that involve it.
class FarmLanes final : public LaneReader {
 public:
  FarmLanes(const LaneScene& scene, gpu::Device& device)
      : scene_(scene),
        states_(robots::states_at_load(scene.world)),
        context_{scene.world, device, thread_pool_, states_},
        sensors_(sensors::laneedge_type.parse(scene.world)),
        backend_(sensors::laneedge_type.make(context_, sensors_)),
        batch_(device) {
    for (std::uint32_t row = 0; row < scene.world.movers.size(); ++row) due_.push_back({row, 0});
  }

  std::string name() const override { return context_.device.is_host() ? "farm, host" : "farm"; }
  void poison() override {
    for (const base::ReadingBlock& block : blocks_) const_cast<double&>(block.values[0]) = kPoisonDistance;
  }
  void read(std::size_t round) override {
    for (std::size_t m = 0; m < states_.size(); ++m) states_[m].X_WM = scene_.rounds[round][m];
    backend_->place_movers();
    if (backend_->prepare(due_)) {
      batch_.begin();
      backend_->record_measure(batch_);
      batch_.barrier();
      backend_->record_derive(batch_);
      batch_.end();
    }
    backend_->add_copies(batch_);
    batch_.run();
    blocks_.resize(due_.size());
    backend_->collect(blocks_);
  }
  sensors::EdgeReading reading(std::size_t sensor) const override {
    const auto v = blocks_[sensor].values;
    return {v[0], v[1], v[2], v[3]};
  }

 private:
  const LaneScene& scene_;
  base::ThreadPool thread_pool_;
  std::vector<base::Report> states_;
  sensors::SensorContext context_;
  sensors::ParsedSensors sensors_;
  std::unique_ptr<sensors::SensorBackend> backend_;
  gpu::Batch batch_;
  std::vector<sensors::DueSample> due_;
  std::vector<base::ReadingBlock> blocks_;
};

class PlainLanes final : public LaneReader {
 public:
  PlainLanes(const LaneScene& scene, const LaneKnowledge& known, bool native)
      : scene_(scene), known_(known), job_(known.job), native_(native), readings_(known.rows.size()) {
    job_.walk = native ? walk_native : walk_portable;
  }

  std::string name() const override { return native_ ? "plain C++, -march=native" : "plain C++"; }
  void poison() override { readings_.assign(readings_.size(), {kPoisonDistance, 0, 0, 0}); }
  void read(std::size_t round) override {
    const LaneRead one = native_ ? read_lane_native : read_lane_portable;
    thread_pool_.parallel_for(readings_.size(), 32, [&](std::size_t first, std::size_t last, unsigned) {
      for (std::size_t i = first; i < last; ++i)
        one(job_, known_.rows[i], base::compose(scene_.rounds[round][i], known_.X_MS[i]), readings_[i]);
    });
  }
  sensors::EdgeReading reading(std::size_t sensor) const override { return readings_[sensor]; }

 private:
  const LaneScene& scene_;
  const LaneKnowledge& known_;
  LaneJob job_;
  bool native_;
  base::ThreadPool thread_pool_;
  std::vector<sensors::EdgeReading> readings_;
};

sensors::EdgeRow row_of(const sensors::LaneEdge& edge) {
  sensors::EdgeRow row{};
  row.beams = edge.fan.samples;
  row.flags = SF_EDGE_PACKED;
  row.perpendicular_x = edge.perpendicular.x;
  row.perpendicular_y = edge.perpendicular.y;
  row.range_limit = sensors::kNearMaximum * edge.fan.range_max;
  row.distance_max = edge.distance_max;
  row.range_max = static_cast<float>(edge.fan.range_max);
  return row;
}

}  // namespace

std::unique_ptr<LaneKnowledge> know(const LaneScene& scene) {
  auto known = std::make_unique<LaneKnowledge>();
  const bool exact = !(scene.world.road_resolution > 0.0);
  const std::vector<sensors::LaneEdge> edges = sensors::lane_edges_of(scene.world);
  for (const sensors::LaneEdge& edge : edges) {
    known->rows.push_back(row_of(edge));
    known->X_MS.push_back(edge.fan.X_MS);
  }
  const raycast::ScanSettings& fan = edges[0].fan;
  LaneJob& job = known->job;
  for (std::uint32_t k = 0; k < fan.samples; ++k) {
    const double bearing = bearing_of(fan, k);
    job.beams.push_back({std::cos(bearing), std::sin(bearing)});
    job.directions.insert(job.directions.end(), {std::cos(bearing), std::sin(bearing)});
  }
  job.range_max = fan.range_max;
  sensors::FilteredScene excerpt = sensors::filter_scene(scene.world, exact);
  job.grains = excerpt.grains;
  job.paint_tag = excerpt.paint_tag;
  if (exact) {
    known->faces = excerpt.world.walls;
    excerpt.world.extent = scene.world.extent;
    for (const world::Segment& s : known->faces) {
      excerpt.world.extent.x_min = std::min(excerpt.world.extent.x_min, s.a.x);
      excerpt.world.extent.y_min = std::min(excerpt.world.extent.y_min, s.a.y);
      excerpt.world.extent.x_max = std::max(excerpt.world.extent.x_max, s.a.x);
      excerpt.world.extent.y_max = std::max(excerpt.world.extent.y_max, s.a.y);
    }
    known->grid = make_grid(excerpt.world, 0.0, 0.25);
    job.grid = &known->grid;
  } else {
    known->raster = std::make_unique<sensors::MarkingRaster>(excerpt.paint, scene.world.road_resolution, fan.range_max,
                                                             scene.world.file);
    job.raster = known->raster.get();
  }
  return known;
}

std::unique_ptr<LaneReader> make_farm_lanes(const LaneScene& scene, gpu::Device& device) {
  return std::make_unique<FarmLanes>(scene, device);
}

std::unique_ptr<LaneReader> make_plain_lanes(const LaneScene& scene, const LaneKnowledge& known, bool native) {
  return std::make_unique<PlainLanes>(scene, known, native);
}

}  // namespace sf::bench
