#include "sensors/lane_markings/edge_fit.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <tuple>

#include "base/elementary.h"
#include "base/error.h"
#include "base/random.h"
#include "gpu/group_counts.h"
#include "sensors/lane_markings/host_fit.h"
#include "shaders/laneedge.comp.h"
#include "shaders/laneedge_points.comp.h"

namespace sf::sensors {

namespace {

/// Returns the constant part of a sensor's row. The places in shared tables are filled in later.
EdgeRow row_of(const LaneEdge& edge, const raycast::BeamPlan& plan, const raycast::ScanNoise& noise) {
  EdgeRow row{};
  row.beams = edge.fan.samples;
  row.flags = (plan.packed ? SF_EDGE_PACKED : 0u) | (edge.single ? SF_EDGE_SINGLE : 0u);
  row.perpendicular_x = edge.perpendicular.x;
  row.perpendicular_y = edge.perpendicular.y;
  row.range_limit = kNearMaximum * edge.fan.range_max;
  row.range_min = edge.fan.range_min;
  row.range_sigma = noise.range_sigma;
  row.range_proportional = noise.range_proportional;
  row.angle_sigma = noise.angle_sigma;
  row.distance_max = edge.distance_max;
  row.range_max = static_cast<float>(edge.fan.range_max);
  return row;
}

}  // namespace

std::uint32_t edge_noise_id(std::uint32_t sensor) { return (std::uint32_t{kLaneEdge} << 16) | sensor; }

EdgeFit::Plan EdgeFit::plan(const SensorContext& context, const std::vector<LaneEdge>& edges) {
  const std::size_t most = std::size_t{gpu::kMostGroupsAcross} * gpu::interface_of(laneedge_comp_spv).group_size;
  if (edges.size() > most)
    throw base::InputError(context.world.file, 0,
                           "the world has " + std::to_string(edges.size()) + " lane edge sensors; at most " +
                               std::to_string(most) + " are supported");
  Plan plan;
  std::map<std::tuple<double, std::uint32_t, bool>, std::uint32_t> shared;
  // Sensors without noise share the first deviates, which stay 0.
  plan.noise_lanes = kMostEdgeSamples;
  for (const LaneEdge& edge : edges) {
    const raycast::BeamPlan beams = raycast::plan_beams(edge.fan, context.noise);
    const raycast::ScanNoise noise = context.noise ? edge.fan.noise : raycast::ScanNoise{};
    EdgeRow row = row_of(edge, beams, noise);
    const auto [known, is_new] =
        shared.try_emplace({edge.fan.fov, edge.fan.samples, beams.packed}, plan.direction_lanes);
    if (is_new) plan.direction_lanes += beams.lanes();
    row.directions = known->second;
    if (noise.range_sigma > 0.0 || noise.range_proportional > 0.0) {
      row.noise = plan.noise_lanes;
      row.noise_share = 1.0F;
      plan.noise_lanes += beams.lanes();
      plan.any_noise = true;
    }
    plan.lanes += beams.lanes();
    plan.rows.push_back(row);
    plan.beams.push_back(beams);
  }
  return plan;
}

EdgeFit::EdgeFit(const SensorContext& context, const std::vector<LaneEdge>& edges, const std::vector<double>& grains,
                 bool on_host)
    : thread_pool_(context.thread_pool),
      episodes_(context.episodes),
      edges_(edges),
      sizes_(grains),
      on_host_(on_host),
      plan_(plan(context, edges)),
      kernel_(context.device, "line through points", laneedge_comp_spv),
      maker_(context.device, "points of paint", laneedge_points_comp_spv),
      rows_(context.device, "due sensors", gpu::Role::upload, gpu::Texel::u32x4,
            gpu::texels_of<EdgeRow>(kernel_.padded(on_host ? 1 : edges.size()))),
      directions_(context.device, "bearings", gpu::Role::upload, gpu::Texel::u32x4,
                  SF_BEAMS_PER_LANE * std::size_t{plan_.direction_lanes}),
      normals_(context.device, "normal deviates", gpu::Role::upload, gpu::Texel::f32x4, plan_.noise_lanes),
      grains_(context.device, "sizes of pixels", gpu::Role::upload, gpu::Texel::u32x4, grains.size()),
      readings_(context.device, "readings", gpu::Role::download, gpu::Texel::u32x4,
                gpu::texels_of<EdgeReading>(edges.size())),
      groups_(context.device, "group counts", gpu::Role::upload, gpu::Texel::u32, 4),
      points_(context.device, "points", gpu::Role::download, gpu::Texel::u32x4,
              SF_BEAMS_PER_LANE * (on_host ? 1 : std::size_t{plan_.lanes} + 1)),
      order_(context.device, "order of work", gpu::Role::upload, gpu::Texel::u32,
             kernel_.padded(on_host ? 1 : edges.size())),
      mixtures_(context.device, "mixtures", gpu::Role::download, gpu::Texel::u32, edges.size()) {
  kernel_.bind({{"rows", &rows_},
                {"points", &points_},
                {"grains", &grains_},
                {"readings", &readings_},
                {"order", &order_},
                {"mixtures", &mixtures_}});
  write_directions();
  std::memset(normals_.host<float>().data(), 0, normals_.bytes());
  std::memset(groups_.host<std::uint32_t>().data(), 0, groups_.bytes());
  for (std::size_t i = 0; i < grains.size(); ++i) grains_.host<double>()[2 * i] = grains[i];
}

void EdgeFit::write_directions() {
  const auto table = directions_.host<double>();
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const raycast::ScanSettings& fan = edges_[i].fan;
    const raycast::BeamPlan& beams = plan_.beams[i];
    for (std::uint32_t slot = 0; slot < SF_BEAMS_PER_LANE * beams.lanes(); ++slot) {
      const std::uint32_t beam = std::min(beams.packed ? slot : slot / SF_BEAMS_PER_LANE, fan.samples - 1);
      const double bearing = bearing_of(fan, beam);
      const std::size_t at = 2 * (SF_BEAMS_PER_LANE * std::size_t{plan_.rows[i].directions} + slot);
      table[at] = base::cos(bearing);
      table[at + 1] = base::sin(bearing);
    }
  }
}

std::span<const double> EdgeFit::directions(std::uint32_t edge) {
  return directions_.host<double>().subspan(2 * SF_BEAMS_PER_LANE * std::size_t{plan_.rows[edge].directions},
                                            2 * SF_BEAMS_PER_LANE * std::size_t{plan_.beams[edge].lanes()});
}

void EdgeFit::prepare(std::span<const DueSample> due, std::span<const std::uint32_t> lanes) {
  due_.assign(due.begin(), due.end());
  if (!on_host_) write_order(write_rows(lanes));
  if (!plan_.any_noise) return;
  thread_pool_.parallel_for(due_.size(), 16, [this](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) draw_noise(due_[i]);
  });
}

bool EdgeFit::write_rows(std::span<const std::uint32_t> lanes) {
  const bool same =
      written_.size() == due_.size() && std::equal(due_.begin(), due_.end(), written_.begin(),
                                                   [](const DueSample& d, std::uint32_t row) { return d.row == row; });
  if (same) return true;
  written_.clear();
  const auto rows = rows_.host<EdgeRow>();
  for (std::size_t i = 0; i < due_.size(); ++i) {
    rows[i] = plan_.rows[due_[i].row];
    rows[i].lane = lanes[i];
    rows[i].reading = static_cast<std::uint32_t>(i);
    written_.push_back(due_[i].row);
  }
  gpu::write_counts(gpu::groups_for(due_.size(), kernel_.group_size()), groups_);
  return false;
}

/// Orders the sensors in the dispatch. Lanes of one group wait for the slowest lane, so sensors that separated several
/// edges last time, the slowest case, share groups. These are every other group, because lavapipe splits the groups in
/// halves between its threads. Readings do not depend on the order.
void EdgeFit::write_order(bool same_due) {
  if (due_.empty()) return;
  const auto order = order_.host<std::uint32_t>();
  const auto mixtures = mixtures_.host<std::uint32_t>();
  const std::size_t size = kernel_.group_size();
  const std::size_t groups = kernel_.padded(due_.size()) / size;
  std::size_t at = 0;
  const auto put = [&](std::uint32_t row) {
    const std::size_t group = at / size;
    const std::size_t place = group % 2 == 0 ? group / 2 : (groups + 1) / 2 + group / 2;
    order[size * place + at++ % size] = row;
  };
  std::uint32_t last = 0;
  for (const std::uint32_t mixed : {1u, 0u})
    for (std::uint32_t i = 0; i < due_.size(); ++i)
      if ((same_due ? mixtures[i] & 1u : 0u) == mixed) put(last = i);
  // Padding repeats one row. Its results are written repeatedly with equal values.
  while (at < groups * size) put(last);
}

void EdgeFit::draw_noise(const DueSample& due) {
  const EdgeRow& row = plan_.rows[due.row];
  if (row.noise_share == 0.0F) return;
  const SensorSpec& sensor = edges_[due.row].row;
  const base::RandomKey draw =
      episodes_.key(base::RandomStream::range_noise, sensor.mover, edge_noise_id(sensor.sensor), due.sequence);
  float* const out = normals_.host<float>().data() + SF_BEAMS_PER_LANE * std::size_t{row.noise};
  for (std::uint32_t k = 0; k < row.beams; ++k)
    out[plan_.beams[due.row].place(k)] = static_cast<float>(base::random_normal(draw, k)[0]);
}

void EdgeFit::fit_on_host(std::size_t i, std::uint32_t lane, std::span<const double> ranges,
                          std::span<const std::uint32_t> tags) {
  const EdgeRow& row = plan_.rows[due_[i].row];
  const std::size_t first = SF_BEAMS_PER_LANE * std::size_t{lane};
  fit::Points points;
  fit::make_points(row,
                   {ranges.data() + first, tags.data() + first, directions(due_[i].row).data(),
                    normals_.host<float>().data() + SF_BEAMS_PER_LANE * std::size_t{row.noise},
                    plan_.beams[due_[i].row].packed ? 1u : SF_BEAMS_PER_LANE},
                   points);
  readings_.host<EdgeReading>()[i] = fit::read_edge(row, points, sizes_);
}

void EdgeFit::bind(gpu::Buffer& lanes, gpu::Buffer& ranges, gpu::Buffer& hits) {
  maker_.bind({{"edges", &rows_},
               {"directions", &directions_},
               {"normals", &normals_},
               {"points", &points_},
               {"lanes", &lanes},
               {"ranges", &ranges},
               {"hits", &hits}});
}

void EdgeFit::add_copies(gpu::Batch& batch) {
  batch.upload(rows_, 0, kernel_.padded(due_.size()) * sizeof(EdgeRow));
  batch.upload(groups_, 0, groups_.bytes());
  if (fresh_) {
    for (const gpu::Buffer* table : {&directions_, &grains_, &normals_}) batch.upload(*table, 0, table->bytes());
  } else if (plan_.any_noise) {
    for (const DueSample& d : due_)
      if (plan_.rows[d.row].noise_share != 0.0F)
        batch.upload(normals_, 16 * std::size_t{plan_.rows[d.row].noise}, 16 * std::size_t{plan_.beams[d.row].lanes()});
  }
  fresh_ = false;
  batch.upload(order_, 0, kernel_.padded(due_.size()) * sizeof(std::uint32_t));
  batch.download(mixtures_, 0, due_.size() * sizeof(std::uint32_t));
  batch.download(readings_, 0, due_.size() * sizeof(EdgeReading));
}

}  // namespace sf::sensors
