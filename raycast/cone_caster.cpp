#include "raycast/cone_caster.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/elementary.h"
#include "base/error.h"
#include "gpu/group_counts.h"

namespace sf::raycast {

namespace {

/// A unit vector, up to rounding in 32 bits.
struct Direction {
  float x, y;
};

Direction turned(Direction by, Direction v) { return {by.x * v.x - by.y * v.y, by.x * v.y + by.y * v.x}; }

bool limit_incidence(std::span<const Cone> cones) {
  return std::any_of(cones.begin(), cones.end(), [](const Cone& cone) { return cone.min_cosine > 0.0F; });
}

std::vector<Scanner> scanners_of(const world::World& world, std::span<const Cone> cones, const ConeKernel& kernel) {
  const std::size_t most_cones = std::size_t{gpu::kMostGroupsAcross} * gpu::interface_of(kernel.spirv).group_size;
  if (cones.size() > most_cones)
    throw base::InputError(world.file, 0,
                           "the world has " + std::to_string(cones.size()) + " transducers of one type; at most " +
                               std::to_string(most_cones) + " are supported");
  std::vector<Scanner> scanners;
  for (const Cone& cone : cones) scanners.push_back(cone.scanner);
  return scanners;
}

}  // namespace

ConeCaster::ConeCaster(const SensorContext& context, std::span<const Cone> cones, const ConeKernel& kernel)
    : ConeCaster(context, cones, limit_incidence(cones),
                 limit_incidence(cones) ? reflectors_of(context.world) : Reflectors{}, kernel) {}

ConeCaster::ConeCaster(const SensorContext& context, std::span<const Cone> cones, bool incidence,
                       const Reflectors& reflectors, const ConeKernel& kernel)
    : thread_pool_(context.thread_pool),
      states_(context.states),
      caster_(context, incidence ? reflectors.world : context.world, scanners_of(context.world, cones, kernel)),
      kernel_(context.device, kernel.name, kernel.spirv),
      rows_(context.device, "cones", gpu::Role::upload, gpu::Texel::u32x4,
            gpu::texels_of<ConeRow>(kernel_.padded(cones.size() + 1))),
      echoes_(context.device, "echoes", gpu::Role::download, gpu::Texel::u32x4, kernel_.padded(cones.size() + 1)),
      groups_(context.device, "group counts", gpu::Role::upload, gpu::Texel::u32, 4),
      reflectors_(context.device, "faces", gpu::Role::upload, gpu::Texel::u32x4, reflectors.rows.size() + 1),
      headings_(context.device, "headings", gpu::Role::upload, gpu::Texel::f32x4, context.world.movers.size() + 1),
      incidence_(incidence) {
  for (const Cone& cone : cones) min_cosines_.push_back(cone.min_cosine);
  SF_CHECK(kernel.uses_incidence || !incidence_, "this kernel ignores the angle of incidence");
  std::vector<gpu::TableBinding> tables{
      {"cones", &rows_}, {"ranges", &caster_.ranges()}, {"hits", &caster_.hits()}, {"echoes", &echoes_}};
  if (kernel.uses_incidence)
    tables.insert(tables.end(),
                  {{"directions", &caster_.directions64()}, {"reflectors", &reflectors_}, {"headings", &headings_}});
  kernel_.bind(tables);
  std::memset(groups_.host<std::uint32_t>().data(), 0, groups_.bytes());
  std::memset(reflectors_.host<std::uint32_t>().data(), 0, reflectors_.bytes());
  std::copy(reflectors.rows.begin(), reflectors.rows.end(), reflectors_.host<ReflectorDirection>().begin());
  std::memset(headings_.host<float>().data(), 0, headings_.bytes());
  headings_.host<float>()[0] = 1.0F;
}

void ConeCaster::place_movers() {
  caster_.place_movers();
  if (!incidence_) return;
  const auto table = headings_.host<float>();
  for (std::size_t m = 0; m < states_.size(); ++m) {
    const auto [s, c] = base::sin_cos(states_[m].X_WM.yaw);
    table[4 * (m + 1)] = static_cast<float>(c), table[4 * (m + 1) + 1] = static_cast<float>(s);
  }
}

bool ConeCaster::prepare(std::span<const DueSample> due) {
  const bool again = caster_.prepare(due);
  count_ = due.size();
  if (!on_device()) return again;
  const auto rows = rows_.host<ConeRow>();
  thread_pool_.parallel_for(count_, 512, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) rows[i] = row_of(i);
  });
  // Padding repeats one cone, whose echoes are written after all others.
  if (count_ > 0)
    std::fill_n(rows.begin() + static_cast<std::ptrdiff_t>(count_), kernel_.padded(count_) - count_, rows[count_ - 1]);
  gpu::write_counts(gpu::groups_for(count_, kernel_.group_size()), groups_);
  return again;
}

ConeRow ConeCaster::row_of(std::size_t i) const {
  const ScanResult results = caster_.results(i);
  ConeRow row{};
  row.lane = results.lane;
  row.lanes = results.plan->lanes();
  row.directions = results.beams;
  row.min_cosine = min_cosines_[results.row];
  row.heading_cos = static_cast<float>(results.heading.x);
  row.heading_sin = static_cast<float>(results.heading.y);
  row.range_max = results.scanner->scan.range_max;
  return row;
}

bool ConeCaster::returns_echo(const ConeRow& row, std::size_t beam, std::uint32_t hit) {
  if (row.min_cosine <= 0.0F) return true;
  const double* const bearing = caster_.directions64().host<double>().data() + 2 * beam;
  const ReflectorDirection& face = reflectors_.host<ReflectorDirection>()[hit];
  const float* const mover = headings_.host<float>().data() + 4 * std::size_t{face.heading};
  const Direction look =
      turned({row.heading_cos, row.heading_sin}, {static_cast<float>(bearing[0]), static_cast<float>(bearing[1])});
  const Direction along = turned({mover[0], mover[1]}, {face.along_x, face.along_y});
  return std::abs(look.x * along.y - look.y * along.x) >= row.min_cosine;
}

ConeEcho ConeCaster::nearest_echo(std::size_t i) {
  const ConeRow row = row_of(i);
  const double* const ranges = caster_.ranges().host<double>().data() + SF_BEAMS_PER_LANE * std::size_t{row.lane};
  const std::uint32_t* const hits =
      caster_.hits().host<std::uint32_t>().data() + SF_BEAMS_PER_LANE * std::size_t{row.lane};
  ConeEcho echo{row.range_max, SF_NO_HIT, 0};
  for (std::size_t k = 0; k < SF_BEAMS_PER_LANE * std::size_t{row.lanes}; ++k)
    if (hits[k] != SF_NO_HIT && ranges[k] < echo.range &&
        returns_echo(row, SF_BEAMS_PER_LANE * std::size_t{row.directions} + k, hits[k]))
      echo = {ranges[k], hits[k], 0};
  return echo;
}

void ConeCaster::add_copies(gpu::Batch& batch) {
  caster_.add_copies(batch, false);
  batch.upload(rows_, 0, kernel_.padded(count_) * sizeof(ConeRow));
  batch.upload(groups_, 0, groups_.bytes());
  if (incidence_ || fresh_) batch.upload(headings_, 0, headings_.bytes());
  if (fresh_) batch.upload(reflectors_, 0, reflectors_.bytes());
  fresh_ = false;
  batch.download(echoes_, 0, count_ * sizeof(ConeEcho));
}

}  // namespace sf::raycast
