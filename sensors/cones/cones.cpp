#include "sensors/cones/cones.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"

namespace sf::sensors {

namespace {

constexpr std::uint32_t kGroup = 64;
constexpr std::size_t kMostCones = std::size_t{32'768} * kGroup;

/// A unit vector, or nearly.
struct Direction {
  float x, y;
};

Direction turned(Direction by, Direction v) { return {by.x * v.x - by.y * v.y, by.x * v.y + by.y * v.x}; }

std::size_t padded(std::size_t cones) { return (cones + kGroup - 1) / kGroup * kGroup; }

raycast::Scanner fan_of(const ConeArray& array, std::size_t transducer) {
  world::Laser beams;
  beams.X_MS = base::compose(array.row.X_MS, array.X_SC[transducer]);
  beams.fov = array.rays > 1 ? array.fov : 0.0;
  beams.samples = array.rays;
  beams.range_max = array.range_max;
  return {beams, array.row.mover, array.row.sensor};
}

}  // namespace

Cones::Plan Cones::plan(const world::World& world, const std::vector<ConeArray>& arrays) {
  Plan plan;
  for (const ConeArray& array : arrays) {
    plan.first.push_back(static_cast<std::uint32_t>(plan.fans.size()));
    plan.incidence = plan.incidence || array.least_cosine > 0.0;
    for (std::size_t i = 0; i < array.X_SC.size(); ++i) {
      plan.fans.push_back(fan_of(array, i));
      plan.least_cosines.push_back(static_cast<float>(array.least_cosine));
    }
  }
  if (plan.fans.size() > kMostCones)
    throw base::InputError(world.file, 0,
                           "the world has " + std::to_string(plan.fans.size()) + " transducers of one kind; at most " +
                               std::to_string(kMostCones) + " are supported");
  return plan;
}

Cones::Cones(const SensorContext& context, const std::vector<ConeArray>& arrays, const ConeKernel& kernel)
    : Cones(context, plan(context.world, arrays), kernel) {}

Cones::Cones(const SensorContext& context, const Plan& plan, const ConeKernel& kernel)
    : Cones(context, plan, plan.incidence ? faces_of(context.world) : Faces{}, kernel) {}

Cones::Cones(const SensorContext& context, const Plan& plan, const Faces& faces, const ConeKernel& kernel)
    : thread_pool_(context.thread_pool),
      first_cones_(plan.first),
      least_cosines_(plan.least_cosines),
      casts_(context, plan.incidence ? faces.world : context.world, plan.fans),
      kernel_(context.device, kernel.name, kernel.spirv, kernel.hears_incidence ? 7 : 4),
      rows_(context.device, "cones", gpu::Role::upload, gpu::Texel::u32x4,
            SF_CONE_TEXELS * padded(plan.fans.size() + 1)),
      echoes_(context.device, "echoes", gpu::Role::download, gpu::Texel::u32x4, padded(plan.fans.size() + 1)),
      groups_(context.device, "group counts", gpu::Role::upload, gpu::Texel::u32, 4),
      faces_(context.device, "faces", gpu::Role::upload, gpu::Texel::u32x4, faces.rows.size() + 1),
      headings_(context.device, "headings", gpu::Role::upload, gpu::Texel::f32x4, context.world.movers.size() + 1),
      incidence_(plan.incidence) {
  SF_CHECK(kernel_.group_size() == kGroup, "groups of cones are counted as of 64");
  SF_CHECK(kernel.hears_incidence || !incidence_, "this kernel hears all angles");
  gpu::Buffer* const tables[] = {&rows_,  &casts_.ranges(), &casts_.hits(), &echoes_, &casts_.directions64(),
                                 &faces_, &headings_};
  kernel_.bind(std::span(tables).first(kernel.hears_incidence ? 7 : 4));
  std::memset(groups_.host<std::uint32_t>().data(), 0, groups_.bytes());
  std::memset(faces_.host<std::uint32_t>().data(), 0, faces_.bytes());
  std::copy(faces.rows.begin(), faces.rows.end(), faces_.host<ConeFace>().begin());
  std::memset(headings_.host<float>().data(), 0, headings_.bytes());
  headings_.host<float>()[0] = 1.0F;
}

void Cones::set_poses(std::span<const Pose> poses) {
  casts_.set_poses(poses);
  if (!incidence_) return;
  const auto table = headings_.host<float>();
  for (std::size_t m = 0; m < poses.size(); ++m) {
    table[4 * (m + 1)] = static_cast<float>(std::cos(poses[m].yaw));
    table[4 * (m + 1) + 1] = static_cast<float>(std::sin(poses[m].yaw));
  }
}

bool Cones::prepare(std::span<const DueSample> due, std::span<const Pose> poses) {
  const bool again = casts_.prepare(due, poses);
  count_ = due.size();
  if (!on_device()) return again;
  const auto rows = rows_.host<ConeRow>();
  thread_pool_.parallel_for(count_, 512, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) rows[i] = row_of(i);
  });
  // Padding repeats one cone; its echoes lie behind all others.
  if (count_ > 0)
    std::fill_n(rows.begin() + static_cast<std::ptrdiff_t>(count_), padded(count_) - count_, rows[count_ - 1]);
  const auto counts = groups_.host<std::uint32_t>();
  counts[0] = static_cast<std::uint32_t>(padded(count_) / kGroup);
  counts[1] = counts[2] = count_ > 0 ? 1 : 0;
  return again;
}

ConeRow Cones::row_of(std::size_t i) const {
  const raycast::ScanResult results = casts_.results(i);
  ConeRow row{};
  row.lane = results.lane;
  row.lanes = results.plan->lanes();
  row.directions = results.beams;
  row.least_cosine = least_cosines_[results.row];
  row.heading_cos = static_cast<float>(results.heading.x);
  row.heading_sin = static_cast<float>(results.heading.y);
  row.range_max = results.scanner->laser.range_max;
  return row;
}

bool Cones::is_audible(const ConeRow& row, std::size_t beam, std::uint32_t hit) {
  if (row.least_cosine <= 0.0F) return true;
  const double* const bearing = casts_.directions64().host<double>().data() + 2 * beam;
  const ConeFace& face = faces_.host<ConeFace>()[hit];
  const float* const mover = headings_.host<float>().data() + 4 * std::size_t{face.heading};
  const Direction look =
      turned({row.heading_cos, row.heading_sin}, {static_cast<float>(bearing[0]), static_cast<float>(bearing[1])});
  const Direction along = turned({mover[0], mover[1]}, {face.along_x, face.along_y});
  return std::abs(look.x * along.y - look.y * along.x) >= row.least_cosine;
}

ConeEcho Cones::hear(std::size_t i) {
  const ConeRow row = row_of(i);
  const double* const ranges = casts_.ranges().host<double>().data() + SF_BEAMS_PER_LANE * std::size_t{row.lane};
  const std::uint32_t* const hits =
      casts_.hits().host<std::uint32_t>().data() + SF_BEAMS_PER_LANE * std::size_t{row.lane};
  ConeEcho echo{row.range_max, SF_NO_HIT, 0};
  for (std::size_t k = 0; k < SF_BEAMS_PER_LANE * std::size_t{row.lanes}; ++k)
    if (hits[k] != SF_NO_HIT && ranges[k] < echo.range &&
        is_audible(row, SF_BEAMS_PER_LANE * std::size_t{row.directions} + k, hits[k]))
      echo = {ranges[k], hits[k], 0};
  return echo;
}

void Cones::add_copies(gpu::Batch& batch) {
  casts_.add_copies(batch, false);
  batch.upload(rows_, 0, padded(count_) * sizeof(ConeRow));
  batch.upload(groups_, 0, groups_.bytes());
  if (incidence_ || fresh_) batch.upload(headings_, 0, headings_.bytes());
  if (fresh_) batch.upload(faces_, 0, faces_.bytes());
  fresh_ = false;
  batch.download(echoes_, 0, count_ * sizeof(ConeEcho));
}

}  // namespace sf::sensors
