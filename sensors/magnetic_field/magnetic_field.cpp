#include "sensors/magnetic_field/magnetic_field.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "robots/fleet.h"
#include "sensors/magnetic_field/host_sums.h"
#include "sensors/magnetic_field/tables.h"
#include "shaders/magnetometer.comp.h"

namespace sf::sensors {

namespace {

constexpr double kLeastRadius = 1e-9;  // [m] smallest radius whose inverse cubed is finite in 32 bits
constexpr std::size_t kLeastCells = 1u << 20;
constexpr std::size_t kLeastMovingCells = 1u << 12;

/// Returns the number of cells of a grid: few enough to be filled every tick if magnets move.
std::size_t most_cells(std::size_t magnets, std::size_t least) { return std::max(least, 8 * magnets); }

template <class Rows>
std::uint32_t count_of(const Rows& rows) {
  return static_cast<std::uint32_t>(rows.size());
}

}  // namespace

DipoleRow dipole_row(const world::Magnet& magnet, glm::dvec2 p, double z) {
  return {p.x, p.y, z, static_cast<float>(magnet.moment),
          static_cast<float>(1.0 / std::max(magnet.radius, kLeastRadius))};
}

MagneticField::MagneticField(const world::World& world, gpu::Device& device, base::ThreadPool& thread_pool,
                             bool magnitudes, double cutoff)
    : t_(std::make_unique<Tables>(world, device, thread_pool, magnitudes, cutoff)) {
  place_movers(robots::states_at_load(world));
}

MagneticField::MagneticField(MagneticField&&) noexcept = default;
MagneticField::~MagneticField() = default;

MagneticField::Tables::Tables(const world::World& w, gpu::Device& d, base::ThreadPool& k, bool has_magnitudes, double c)
    : world(w), device(d), thread_pool(k), cutoff(c), magnitudes(has_magnitudes) {
  using gpu::Role;
  using gpu::Texel;
  fixed_magnets = count_of(world.magnets);
  for (const world::Mover& mover : world.movers) moving_magnets += count_of(mover.magnets);
  const std::uint32_t constants[] = {magnitudes, device.rounds32()};
  kernel = std::make_unique<gpu::Kernel>(device, magnitudes ? "magnetometer with magnitudes" : "magnetometer",
                                         magnetometer_comp_spv, constants);
  // An unrolled iteration may load rows after the last magnet; they have moment 0.
  const std::size_t rows = std::size_t{fixed_magnets} + moving_magnets + SF_FIELD_UNROLL;
  dipoles =
      std::make_unique<gpu::Buffer>(device, "magnets", Role::upload, Texel::u32x4, gpu::texels_of<DipoleRow>(rows));
  groups = std::make_unique<gpu::Buffer>(device, "group counts", Role::upload, Texel::u32, 4);
  std::ranges::fill(dipoles->host<std::uint32_t>(), 0u);
  write_fixed();
}

void MagneticField::Tables::write_fixed() {
  std::vector<glm::dvec2> at;
  for (const world::Magnet& magnet : world.magnets) at.push_back(magnet.p);
  fixed_grid.build(at, cutoff, most_cells(at.size(), kLeastCells));
  const auto rows = dipoles->host<DipoleRow>();
  for (std::size_t i = 0; i < at.size(); ++i) {
    const world::Magnet& magnet = world.magnets[fixed_grid.order()[i]];
    rows[i] = dipole_row(magnet, magnet.p, magnet.z);
  }
}

void MagneticField::Tables::write_moving() {
  moving_grid.build(moving_points, cutoff, most_cells(moving_points.size(), kLeastMovingCells));
  const auto rows = dipoles->host<DipoleRow>().subspan(fixed_magnets);
  for (std::size_t i = 0; i < moving_rows.size(); ++i) rows[i] = moving_rows[moving_grid.order()[i]];
}

void MagneticField::place_movers(std::span<const base::Report> states) {
  Tables& t = *t_;
  if (t.moving_magnets == 0) return;
  t.moving_points.clear();
  t.moving_rows.clear();
  for (std::size_t m = 0; m < t.world.movers.size(); ++m) {
    const world::Mover& mover = t.world.movers[m];
    if (base::is_absent(states[m].X_WM)) continue;
    for (const world::Magnet& magnet : mover.magnets) {
      const glm::dvec2 p = base::transform(states[m].X_WM, magnet.p);
      t.moving_points.push_back(p);
      t.moving_rows.push_back(dipole_row(magnet, p, states[m].X_WM.z + magnet.z));
    }
  }
  t.write_moving();
}

bool MagneticField::prepare(std::span<const FieldPoint> points, std::span<const std::uint32_t> ends) {
  Tables& t = *t_;
  SF_CHECK(ends.empty() ? points.empty() : ends.back() == points.size(), "groups that are not the places");
  t.gather(points, ends);
  t.thread_pool.parallel_for(ends.size(), 64, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t g = first; g < last; ++g) {
      t.write_places(g, points.first(ends[g]).last(t.point_groups[g].points));
      t.find_spans(g);
    }
  });
  t.plan_items();
  t.sort_items();
  t.write_items();
  const bool again = !t.bound;
  if (again) t.bind();
  return again;
}

bool MagneticField::on_device() const { return !t_->device.is_host(); }

void MagneticField::record(gpu::Batch& batch) { batch.dispatch(*t_->kernel, *t_->groups, 0); }

void MagneticField::add_copies(gpu::Batch& batch) {
  Tables& t = *t_;
  const std::size_t first = t.fixed_sent ? t.fixed_magnets * sizeof(DipoleRow) : 0;
  batch.upload(*t.dipoles, first, t.dipoles->bytes() - first);
  t.fixed_sent = true;
  const auto counts = t.groups->host<std::uint32_t>();
  batch.upload(*t.items, 0, sizeof(FieldItem) * t.kernel->group_size() * counts[0] * counts[1]);
  batch.upload(*t.spans, 0, t.point_groups.size() * t.stride * sizeof(MagnetSpan));
  batch.upload(*t.points, 0, t.point_groups.size() * SF_FIELD_POINTS * sizeof(FieldPointRow));
  batch.upload(*t.groups, 0, t.groups->bytes());
  batch.download(*t.results, 0, t.planned.size() * SF_FIELD_POINTS * sizeof(FieldSum));
}

void MagneticField::sum_on_host() {
  Tables& t = *t_;
  const std::span<const MagnetSpan> spans = t.spans->host<MagnetSpan>();
  const std::span<const DipoleRow> dipoles = t.dipoles->host<DipoleRow>();
  const std::span<const FieldPointRow> points = t.points->host<FieldPointRow>();
  const std::span<FieldSum> results = t.results->host<FieldSum>();
  // Longest first, one item at a time, so that no thread ends up with several long ones.
  t.thread_pool.parallel_for_each(t.sorted.size(), 4, [&](std::size_t i, unsigned) {
    const FieldItem& item = t.planned[t.sorted[i]].item;
    sum_fields(spans.subspan(item.first, item.end - item.first), dipoles,
               points.subspan(std::size_t{item.group} * SF_FIELD_POINTS, SF_FIELD_POINTS),
               t.point_groups[item.group].points, t.magnitudes,
               results.subspan(std::size_t{item.sums} * SF_FIELD_POINTS, SF_FIELD_POINTS));
  });
}

FieldSum MagneticField::at(std::size_t group, std::size_t i) const {
  const PointGroup& point_groups = t_->point_groups.at(group);
  const auto results = t_->results->host<FieldSum>();
  FieldSum sum;
  for (std::uint32_t item = point_groups.item; item < point_groups.item + point_groups.items; ++item) {
    const FieldSum& part = results[std::size_t{item} * SF_FIELD_POINTS + i];
    sum.x += part.x;
    sum.y += part.y;
    sum.z += part.z;
    sum.magnitudes += part.magnitudes;
  }
  sum = {kPermeability * sum.x, kPermeability * sum.y, kPermeability * sum.z, kPermeability * sum.magnitudes};
  const glm::dvec3& earth = t_->world.earth_field;
  if (earth == glm::dvec3{}) return sum;  // adding 0 would change -0
  const double magnitude = t_->magnitudes ? glm::length(earth) : 0.0;
  return {sum.x + earth.x, sum.y + earth.y, sum.z + earth.z, sum.magnitudes + magnitude};
}

std::uint64_t MagneticField::dipoles() const { return t_->dipoles_summed; }

}  // namespace sf::sensors
