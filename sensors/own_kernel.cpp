#include "sensors/own_kernel.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "gpu/batch.h"
#include "gpu/group_counts.h"

namespace sf::sensors {

namespace {

constexpr std::uint32_t kGroup = 64;  // local_size_x in shaders/lib/own_sensor.glsl
constexpr std::uint32_t kWall = 0xFFFFFFFFu;

/// Rejects a kernel that does not include the tables.
std::span<const std::uint32_t> checked(const OwnType& type) {
  const gpu::KernelInterface interface = gpu::interface_of(type.spirv);
  std::string names;
  for (const gpu::KernelTable& table : interface.tables) names += table.name + " ";
  if (interface.group_size != kGroup || names.find("samples ") == std::string::npos || interface.tables.size() > 3)
    throw base::InputError(type.entry.kernel, 0,
                           fmt::format("the kernel of '{}' has groups of {} and tables {}; expected those of "
                                       "shaders/lib/own_sensor.glsl",
                                       type.entry.name, interface.group_size, names.empty() ? "none" : names));
  return type.spirv;
}

std::size_t surfaces_of(const world::World& world) {
  std::size_t count = world.walls.size();
  for (const world::Mover& mover : world.movers) count += mover.body.size();
  return count;
}

OwnSurface surface_of(glm::dvec2 a, glm::dvec2 b, double foot, const world::Segment& s, std::uint32_t mover) {
  return {a.x, a.y, b.x, b.y, foot + s.z_min, foot + s.z_max, s.model, mover, 0, 0};
}

}  // namespace

OwnKernel::OwnKernel(const SensorContext& context, const OwnType& type, std::size_t sensors, std::size_t elements)
    : context_(context),
      elements_(static_cast<std::uint32_t>(elements)),
      columns_(static_cast<std::uint32_t>(type.columns.size())),
      kernel_(context.device, type.entry.name, checked(type)),
      sample_table_(context.device, "samples", gpu::Role::upload, gpu::Texel::u32x4,
                    gpu::texels_of<OwnSample>(kernel_.padded(sensors * elements) / elements + 2)),
      surface_table_(context.device, "surfaces", gpu::Role::upload, gpu::Texel::u32x4,
                     gpu::texels_of<OwnSurface>(surfaces_of(context.world) + 1)),
      value_table_(context.device, "values", gpu::Role::download, gpu::Texel::u32,
                   2 * columns_ * kGroup * gpu::most_groups_for(sensors * elements, kGroup)),
      counts_(context.device, "group counts", gpu::Role::upload, gpu::Texel::u32, 4) {
  const gpu::KernelInterface interface = gpu::interface_of(type.spirv);  // owns the names that `tables` refers to
  std::vector<gpu::TableBinding> tables;
  for (const gpu::KernelTable& table : interface.tables)
    tables.push_back({table.name, table.name == "samples"    ? &sample_table_
                                  : table.name == "surfaces" ? &surface_table_
                                                             : &value_table_});
  if (!value_table_.fits_storage_buffer())
    throw base::InputError(fmt::format("the readings of all '{}' are too many for one table", type.entry.name));
  kernel_.bind(tables);
  write_walls();
}

void OwnKernel::write_walls() {
  const auto rows = surface_table_.host<OwnSurface>();
  for (const world::Segment& wall : context_.world.walls)
    if (wall.seen_by_laser) rows[walls_++] = surface_of(wall.a, wall.b, 0.0, wall, kWall);
  surfaces_ = walls_;
}

void OwnKernel::place_movers() {
  const auto rows = surface_table_.host<OwnSurface>();
  surfaces_ = walls_;
  for (std::uint32_t m = 0; m < context_.world.movers.size(); ++m) {
    const world::Mover& mover = context_.world.movers[m];
    const Pose& X_WM = context_.states[m].X_WM;
    if (base::is_absent(X_WM)) continue;
    for (const world::Segment& side : mover.body)
      if (side.seen_by_laser)
        rows[surfaces_++] = surface_of(base::transform(X_WM, side.a), base::transform(X_WM, side.b), X_WM.z, side, m);
  }
}

void OwnKernel::add(std::size_t i, const SensorSpec& spec, const Pose& X_WS, const std::array<double, 8>& parameters,
                    std::uint64_t sequence) {
  OwnSample& sample = sample_table_.host<OwnSample>()[i];
  sample = {X_WS.x, X_WS.y, X_WS.z, base::wrap_angle(X_WS.yaw)};
  std::copy_n(parameters.begin(), 4, sample.parameters);
  std::copy_n(parameters.begin() + 4, 4, sample.more);
  sample.elements = spec.elements;
  sample.lanes = elements_;
  sample.surfaces = static_cast<std::uint32_t>(surfaces_);
  sample.columns = columns_;
  sample.mover = spec.mover;
  sample.sequence = static_cast<std::uint32_t>(sequence);
}

void OwnKernel::close(std::size_t samples) {
  samples_ = samples;
  const auto rows = sample_table_.host<OwnSample>();
  // Invocations beyond the last sensor read a sample without elements.
  const std::size_t last = std::min(rows.size(), kernel_.padded(samples * elements_) / elements_ + 1);
  for (std::size_t i = samples; i < last; ++i) rows[i] = {}, rows[i].lanes = elements_;
  gpu::write_counts(gpu::groups_for(samples * elements_, kGroup), counts_);
}

void OwnKernel::add_copies(gpu::Batch& batch) const {
  batch.upload(sample_table_, 0, std::min(sample_table_.bytes(), (samples_ + kGroup + 2) * sizeof(OwnSample)));
  batch.upload(surface_table_, 0, surfaces_ * sizeof(OwnSurface));
  batch.upload(counts_, 0, counts_.bytes());
  batch.download(value_table_, 0, samples_ * elements_ * columns_ * sizeof(double));
}

std::span<const double> OwnKernel::values(std::size_t i) {
  const std::size_t length = std::size_t{elements_} * columns_;
  return value_table_.host<double>().subspan(i * length, length);
}

}  // namespace sf::sensors
