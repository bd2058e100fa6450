#include "sensors/laneedge.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "raycast/ray_caster.h"
#include "sensors/lane_markings/edge_fit.h"
#include "sensors/lane_markings/filtered_scene.h"
#include "sensors/lane_markings/raster_caster.h"
#include "sensors/laneedge_packets.h"
#include "sensors/laneedge_settings.h"
#include "sensors/laser_modes.h"

namespace sf::sensors {

namespace {

std::vector<raycast::Scanner> scanners_of(const std::vector<LaneEdge>& edges) {
  std::vector<raycast::Scanner> scanners;
  for (const LaneEdge& edge : edges) scanners.push_back({edge.fan, edge.row.mover, edge_noise_id(edge.row.sensor)});
  return scanners;
}

/// Returns true when beams can hit anything except paint.
bool anything_else(const world::World& world) {
  const auto bodies = std::count_if(world.movers.begin(), world.movers.end(),
                                    [](const world::Mover& mover) { return !mover.body.empty(); });
  return !world.walls.empty() || (bodies > 0 && world.movers.size() > 1);
}

/// Constants for the quality of readings with one element: a span of them outlives the tick.
constexpr base::QualityFlag kReasons[] = {base::QualityFlag::none, base::QualityFlag::not_cast,
                                          base::QualityFlag::grazing, base::QualityFlag::not_straight,
                                          base::QualityFlag::extrapolated};

/// Casts beams exactly against the filtered scene, and through the raster if the road has one, then fits lines to the
/// hits.
class LaneEdges : public SensorBackend {
 public:
  LaneEdges(const SensorContext& context, const ParsedSensors& sensors);

  void place_movers() override { caster_.place_movers(); }
  bool update_outlines(const world::World& world) override;
  bool prepare(std::span<const DueSample> due) override;
  void record_measure(gpu::Batch& batch) override;
  void record_derive(gpu::Batch& batch) override {
    if (on_device_) fit_.record(batch);
  }
  void add_copies(gpu::Batch& batch) override;
  void collect(std::span<base::ReadingBlock> out) override;
  SensorStats stats() const override { return caster_.stats(); }
  bool on_device() const override { return on_device_; }

 private:
  void make_raster_caster(const SensorContext& context);
  void bind();
  void fit_on_host(std::size_t i);
  void write(std::size_t i, base::ReadingBlock& block);
  void state(std::size_t i, base::ReadingBlock& block);

  base::ThreadPool& thread_pool_;
  const std::vector<LaneEdge>& edges_;
  bool noise_;
  bool exact_;  ///< markings are exact outlines, not pixels
  FilteredScene scene_;
  double longest_;  ///< [m] longest surface in the scene
  raycast::RayCaster caster_;
  bool casting_;    ///< `caster_` has surfaces that beams can hit
  bool on_device_;  ///< lines are fitted, and rays cast through the raster, on the device
  std::optional<RasterCaster> raster_caster_;
  EdgeFit fit_;
  std::vector<DueSample> due_;
  std::vector<std::uint32_t> lanes_;  ///< first result lane of each due sensor
  bool bound_ = false;
};

LaneEdges::LaneEdges(const SensorContext& context, const ParsedSensors& sensors)
    : thread_pool_(context.thread_pool),
      edges_(sensors.settings_as<LaneEdge>()),
      noise_(context.noise),
      exact_(!uses_raster(context.world)),
      scene_(filter_scene(context.world, exact_)),
      longest_(reaches_of(scene_.world).longest),
      caster_(context, scene_.world, scanners_of(edges_)),
      casting_(exact_ || anything_else(scene_.world)),
      on_device_(caster_.on_device() || (!exact_ && !context.device.is_host())),
      fit_(context, edges_, scene_.grains, !on_device()) {
  if (!exact_) make_raster_caster(context);
}

bool LaneEdges::update_outlines(const world::World& world) {
  take_movers(world, scene_);
  longest_ = reaches_of(scene_.world).longest;
  return casting_ == (exact_ || anything_else(scene_.world)) && caster_.update_outlines(scene_.world);
}

void LaneEdges::make_raster_caster(const SensorContext& context) {
  double longest = 0.0;
  for (const LaneEdge& edge : edges_) longest = std::max(longest, edge.fan.range_max);
  const MarkingRaster raster(scene_.paint, context.world.road_resolution, longest, context.world.file);
  raster_caster_.emplace(context, raster, caster_, scene_.paint_tag, casting_, !on_device_);
}

bool LaneEdges::prepare(std::span<const DueSample> due) {
  due_.assign(due.begin(), due.end());
  const bool again = caster_.prepare(due, casting_) || !bound_;
  lanes_.resize(due.size());
  for (std::size_t i = 0; i < due.size(); ++i) lanes_[i] = caster_.results(i).lane;
  if (raster_caster_) raster_caster_->prepare(due.size());
  fit_.prepare(due, lanes_);
  if (!on_device_) return false;
  if (again) bind();
  return again;
}

void LaneEdges::bind() {
  if (raster_caster_)
    raster_caster_->bind(fit_.tables());
  else
    fit_.bind(caster_.lanes(), caster_.ranges(), caster_.hits());
  bound_ = true;
}

void LaneEdges::record_measure(gpu::Batch& batch) {
  if (!on_device_) return;
  if (casting_) caster_.record(batch);
  if (casting_) batch.barrier();
  if (raster_caster_)
    raster_caster_->record(batch);
  else
    fit_.record_points(batch, caster_.groups());
}

void LaneEdges::add_copies(gpu::Batch& batch) {
  if (!on_device_) return;
  caster_.add_copies(batch, false);
  if (raster_caster_) raster_caster_->add_copies(batch);
  fit_.add_copies(batch);
}

/// Sets the error bound of a reading, or the reason why none is stated.
void LaneEdges::state(std::size_t i, base::ReadingBlock& block) {
  const LaneEdge& edge = edges_[due_[i].row];
  const bool noisy = noise_ && edge.row.sigma > 0.0;
  const double away = std::max(std::abs(block.X_WS.x), std::abs(block.X_WS.y)) + edge.fan.range_max;
  if (noisy) block.sigma = std::isnan(block.values[3]) ? HUGE_VAL : block.values[3];
  if (exact_ && !noisy && !std::isnan(block.values[0])) block.bound = lane_edge_bound(edge, longest_, away);
  base::QualityFlag why = base::QualityFlag::none;
  if (edge.row.mode > 0)
    why = base::QualityFlag::not_cast;  // a skipped beam might have hit another edge
  else if (edge.single)
    why = (caster_.beam_flags()[lanes_[i]] & SF_GRAZING) != 0 ? base::QualityFlag::grazing : why;
  else if (std::isfinite(block.bound))
    why = quality_of(fit_.reading(i), point_error(edge, longest_, away), block.bound);
  if (why != base::QualityFlag::none) {
    block.quality = {&kReasons[static_cast<std::size_t>(why)], 1};
    block.bound = HUGE_VAL;
  }
  block.bound_without_noise = block.bound;
}

void LaneEdges::fit_on_host(std::size_t i) {
  if (!raster_caster_)
    return fit_.fit_on_host(i, lanes_[i], caster_.ranges().host<double>(), caster_.hits().host<std::uint32_t>());
  raster_caster_->cast_on_host(i);
  fit_.fit_on_host(i, lanes_[i], raster_caster_->ranges(), raster_caster_->tags());
}

void LaneEdges::write(std::size_t i, base::ReadingBlock& block) {
  const LaneEdge& edge = edges_[due_[i].row];
  if (!on_device_) fit_on_host(i);
  block = {};
  block.mover = edge.row.mover;
  block.sensor = edge.row.sensor;
  block.type = kLaneEdge;
  block.X_WS = caster_.X_WS(i);
  block.values = fit_.values(i);
  block.mode = edge.row.mode;
  state(i, block);
}

void LaneEdges::collect(std::span<base::ReadingBlock> out) {
  if (casting_) caster_.take_flags();
  thread_pool_.parallel_for(due_.size(), 16, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) write(i, out[i]);
  });
}

ParsedSensors parse_lane_edges(const world::World& world) {
  std::vector<LaneEdge> edges = lane_edges_of(world);
  std::vector<SensorSpec> rows;
  for (const LaneEdge& edge : edges) rows.push_back(edge.row);
  return {std::move(rows), std::move(edges)};
}

constexpr Column kColumns[] = {{"distance_m"}, {"points", 1, true}, {"residual_m"}, {"sigma_m"}};

}  // namespace

constinit const SensorType laneedge_type{
    .id = kLaneEdge,
    .name = "laneedge",
    .word = {"laneedge", kLaneEdgeKeys},
    .base_port = 20000,
    .list = "",
    .columns = kColumns,
    .modes = kLaneEdgeModes,
    .bound = bound_of_lane_edge,
    .parse = parse_lane_edges,
    .make = make_backend<LaneEdges>,
    .wire_problem = lane_edge_wire_problem,
    .parts = lane_edge_parts,
    .encode = encode_lane_edge,
    .wire_error = lane_edge_wire_error,
    .decode = decode_lane_edge,
    .read = read_lane_edge,
};

}  // namespace sf::sensors
