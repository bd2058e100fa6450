#include "sensors/lane_markings/raster_caster.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "sensors/lane_markings/host_raster.h"
#include "shaders/marking_raster.comp.h"

namespace sf::sensors {

namespace {

/// [cells] longest ray. At this distance the rounding error of 32-bit floats is a thousandth of a cell, and the number
/// of steps stays below the limit of older Mesa.
constexpr double kLongestRay = 8192.0;

void refuse_long_rays(const SensorContext& context, const raycast::RayCaster& caster, double cell) {
  for (const raycast::Scanner& fan : caster.scanners()) {
    if (fan.scan.range_max <= kLongestRay * cell) continue;
    throw base::InputError(
        context.world.file, 0,
        fmt::format("road_resolution {:g} m is too fine for the lane edge sensor '{}', whose range_max is {:g} m; "
                    "expected at most {:g} pixels along a ray; use at least {:g} m, or 0 for exact paint",
                    cell, fan.scan.name, fan.scan.range_max, kLongestRay, fan.scan.range_max / kLongestRay));
  }
}

}  // namespace

RasterCaster::RasterCaster(const SensorContext& context, const MarkingRaster& raster, raycast::RayCaster& caster,
                           std::uint32_t tag, bool with_casts, bool on_host)
    : thread_pool_(context.thread_pool),
      caster_(caster),
      cell_(raster.cell()),
      columns_(static_cast<double>(raster.columns()) * MarkingRaster::kBlock),
      rows_(static_cast<double>(raster.rows()) * MarkingRaster::kBlock),
      first_column_(static_cast<double>(raster.first_column())),
      first_row_(static_cast<double>(raster.first_row())),
      block_columns_(raster.columns()),
      block_rows_(raster.rows()),
      tag_(tag),
      with_casts_(with_casts),
      kernel_(context.device, "paint raster", marking_raster_comp_spv,
              std::array{std::uint32_t{context.device.rounds32()}}),
      place_(context.device, "due sensors", gpu::Role::upload, gpu::Texel::u32x4,
             gpu::texels_of<RasterRow>(caster.scanners().size())),
      groups_(context.device, "group counts", gpu::Role::upload, gpu::Texel::u32, 4),
      directory_(context.device, "blocks of the raster", gpu::Role::upload, gpu::Texel::u32, raster.directory().size()),
      blocks_(context.device, "raster of the paint", gpu::Role::upload, gpu::Texel::u32, raster.blocks().size() + 4) {
  refuse_long_rays(context, caster, cell_);
  SF_CHECK(kernel_.group_size() == SF_LANES_PER_GROUP, "the raster's rays are the cast's lanes, beam by beam");
  std::memcpy(directory_.host<std::uint32_t>().data(), raster.directory().data(), 4 * raster.directory().size());
  std::memcpy(blocks_.host<std::uint32_t>().data(), raster.blocks().data(), 4 * raster.blocks().size());
  if (!on_host) return;
  ranges_.resize(caster.ranges().host<double>().size());
  tags_.resize(ranges_.size());
}

RasterRow RasterCaster::row_of(std::size_t i) const {
  const raycast::ScanResult results = caster_.results(i);
  const double range_max = results.scanner->scan.range_max;
  const double x = results.X_WS.x / cell_;
  const double y = results.X_WS.y / cell_;
  const double column = std::floor(x) - first_column_;
  const double row = std::floor(y) - first_row_;
  const bool near = column >= 0.0 && row >= 0.0 && column < columns_ && row < rows_;
  RasterRow r{};
  r.column = near ? static_cast<std::int32_t>(column) : -1;
  r.row = near ? static_cast<std::int32_t>(row) : -1;
  r.x = static_cast<float>(x - std::floor(x));
  r.y = static_cast<float>(y - std::floor(y));
  r.heading_cos = results.heading.x;
  r.heading_sin = results.heading.y;
  r.lane = results.lane;
  r.beams = results.beams;
  r.flags = with_casts_ ? SF_EDGE_CAST : 0u;
  r.reach = static_cast<float>(range_max / cell_);
  r.cell = cell_;
  r.range_max = range_max;
  r.tag = tag_;
  r.columns = block_columns_;
  r.rows = block_rows_;
  return r;
}

void RasterCaster::prepare(std::size_t due) {
  due_ = due;
  const auto rows = place_.host<RasterRow>();
  thread_pool_.parallel_for(due, 256, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) rows[i] = row_of(i);
  });
  // One invocation per beam, unlike the cast, which has one per lane.
  const auto lanes = caster_.groups().host<std::uint32_t>();
  const auto groups = groups_.host<std::uint32_t>();
  groups[0] = lanes[0];
  groups[1] = SF_BEAMS_PER_LANE * lanes[1];
  groups[2] = lanes[2];
}

void RasterCaster::cast_on_host(std::size_t i) {
  const raycast::ScanResult results = caster_.results(i);
  const RasterRow& row = place_.host<RasterRow>()[i];
  const RasterTables tables{directory_.host<std::uint32_t>(), blocks_.host<std::uint32_t>()};
  const std::size_t bearings = SF_BEAMS_PER_LANE * std::size_t{row.beams};
  const std::size_t first = SF_BEAMS_PER_LANE * std::size_t{row.lane};
  const auto directions = caster_.directions64().host<raycast::BeamDirection>();
  const auto cast_ranges = caster_.ranges().host<double>();
  const auto cast_tags = caster_.hits().host<std::uint32_t>();
  for (std::size_t k = 0; k < results.plan->samples.size(); ++k) {
    const std::size_t place = results.plan->place(k), at = first + place;
    const RasterHit hit =
        cast_through_raster(tables, row, directions[bearings + place], {cast_ranges[at], cast_tags[at]});
    ranges_[at] = hit.range;
    tags_[at] = hit.tag;
  }
}

void RasterCaster::bind(const PointTables& out) {
  kernel_.bind({{"rows", &place_},
                {"lanes", &caster_.lanes()},
                {"directions64", &caster_.directions64()},
                {"directory", &directory_},
                {"blocks", &blocks_},
                {"ranges", &caster_.ranges()},
                {"hits", &caster_.hits()},
                {"edges", &out.rows},
                {"directions", &out.directions},
                {"normals", &out.normals},
                {"points", &out.points}});
}

void RasterCaster::record(gpu::Batch& batch) { batch.dispatch(kernel_, groups_, 0); }

void RasterCaster::add_copies(gpu::Batch& batch) {
  batch.upload(place_, 0, due_ * sizeof(RasterRow));
  batch.upload(groups_, 0, groups_.bytes());
  if (!fresh_) return;
  batch.upload(directory_, 0, directory_.bytes());
  batch.upload(blocks_, 0, blocks_.bytes());
  fresh_ = false;
}

}  // namespace sf::sensors
