#include "raycast/reference_caster.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "raycast/casters.h"
#include "raycast/range_bounds.h"
#include "raycast/scan_tables.h"

namespace sf::raycast {

namespace {

/// Same as bearing_of, in `long double`.
long double wide_bearing(const ScanSettings& scan, std::uint32_t i) {
  if (scan.samples < 2) return 0.0L;
  const long double last = scan.samples - 1;
  return static_cast<long double>(scan.fov) * ((2.0L * i - last) / (2.0L * last));
}

WideBeam heading_of(double yaw) {
  return {{}, std::cos(static_cast<long double>(yaw)), std::sin(static_cast<long double>(yaw))};
}

/// Same as exact_bound, with the unit roundoff of `long double`. The range is rounded to `double`.
double wide_bound(double range_max, double longest, double farthest) {
  constexpr auto kRoundoff = static_cast<double>(std::numeric_limits<long double>::epsilon() / 2);
  return SF_CONTACT_DISTANCE + 0x1p-53 * range_max +
         kRoundoff * (16.0 * (range_max + longest) + 4.0 * farthest) / kMinSine;
}

std::uint64_t count_visible(std::span<const world::Segment> surfaces) {
  return static_cast<std::uint64_t>(
      std::count_if(surfaces.begin(), surfaces.end(), [](const world::Segment& s) { return s.seen_by_laser; }));
}

std::uint64_t beams_of(const CastPlan& plan) {
  std::uint64_t beams = 0;
  for (const ScannerRow& row : plan.rows) beams += row.plan.samples.size();
  return beams;
}

std::uint64_t surfaces_of(const world::World& world) {
  std::uint64_t surfaces = count_visible(world.walls);
  for (const world::Mover& mover : world.movers) surfaces += count_visible(mover.body);
  return surfaces;
}

bool fits(std::uint64_t beams, std::uint64_t surfaces) {
  return beams == 0 || surfaces <= ReferenceCaster::kMostPairs / beams;
}

/// Rejects worlds with more than ReferenceCaster::kMostPairs.
void check_size(const CasterInputs& in) {
  const std::uint64_t beams = beams_of(in.plan), surfaces = surfaces_of(in.world);
  if (fits(beams, surfaces)) return;
  const std::string refusal = fmt::format(
      "the caster 'reference' intersects every beam with every surface: {} beams and {} surfaces are more "
      "than {} million pairs; use fewer robots or beams, a smaller world, or the caster 'host'",
      beams, surfaces, ReferenceCaster::kMostPairs / 1'000'000);
  const std::string& file = in.context.world.file;
  throw file.empty() ? base::InputError(refusal) : base::InputError(file, 0, refusal);
}

}  // namespace

ReferenceCaster::ReferenceCaster(const CasterInputs& in)
    : Caster(in), copies_(in.world), scratch_(in.context.thread_pool.threads()) {
  check_size(in);
  for (const world::Segment& wall : in.world.walls) add(wall, kNoMover);
  add_outlines(in.world);
}

void ReferenceCaster::add_outlines(const world::World& world) {
  for (std::uint32_t m = 0; m < world.movers.size(); ++m)
    for (const world::Segment& edge : world.movers[m].body) add(edge, m);
}

void ReferenceCaster::add(const world::Segment& s, std::uint32_t mover) {
  if (!s.seen_by_laser) return;
  local_.push_back(s);
  movers_.push_back(mover);
  surfaces_.push_back({{s.a.x, s.a.y}, {s.b.x, s.b.y}, s.model});
}

bool ReferenceCaster::update_outlines(const world::World& world) {
  if (!fits(beams_of(plan_), surfaces_of(world))) return false;
  const auto first = std::ranges::find_if(movers_, [](std::uint32_t mover) { return mover != kNoMover; });
  const auto walls = static_cast<std::size_t>(first - movers_.begin());
  local_.resize(walls), movers_.resize(walls), surfaces_.resize(walls);
  add_outlines(world);
  return true;
}

void ReferenceCaster::place_movers() {
  std::uint32_t mover = kNoMover;
  WideBeam heading;
  for (std::size_t i = 0; i < local_.size(); ++i) {
    if (movers_[i] == kNoMover) continue;
    const base::Pose& X = states_[movers_[i]].X_WM;
    if (movers_[i] != mover) heading = heading_of(X.yaw);
    mover = movers_[i];
    const auto to_world = [&](glm::dvec2 p) {
      return Point{X.x + (heading.x * p.x - heading.y * p.y), X.y + (heading.y * p.x + heading.x * p.y)};
    };
    surfaces_[i].a = to_world(local_[i].a);
    surfaces_[i].b = to_world(local_[i].b);
  }
}

bool ReferenceCaster::prepare(const DueScans& due, bool cast) {
  if (!cast) {
    uploads_.turn_all_beams(due.samples, thread_pool_);
    return false;
  }
  if (!placed_) place_movers();
  placed_ = true;
  thread_pool_.parallel_for_each(due.samples.size(), 1, [&](std::size_t i, unsigned thread) { scan(due, i, thread); });
  return false;
}

/// Collects the surfaces at the height of a sensor, except those of its own mover.
void ReferenceCaster::find_visible(const Viewpoint& view, std::vector<Surface>& visible) const {
  visible.clear();
  for (std::size_t i = 0; i < local_.size(); ++i) {
    const std::uint32_t mover = movers_[i];
    if (mover != kNoMover &&
        (mover == view.self || base::is_absent(states_[mover].X_WM) || !copies_.meet(mover, view.self)))
      continue;
    const double z = mover == kNoMover ? view.X_WS.z : view.X_WS.z - states_[mover].X_WM.z;
    if (local_[i].z_min <= z && z < local_[i].z_max) visible.push_back(surfaces_[i]);
  }
}

void ReferenceCaster::scan(const DueScans& due, std::size_t i, unsigned thread) {
  const DueSample& sample = due.samples[i];
  const ScannerRow& row = row_of(sample);
  const ScanSettings& settings = plan_.scanners[sample.row].scan;
  const Viewpoint& view = due.views[i];
  Scratch& own = scratch_[thread];
  find_visible(view, own.surfaces);
  const std::size_t beams = row.plan.samples.size();
  own.ranges.resize(beams), own.models.resize(beams), own.grazes.resize(beams);
  const std::span<const double> noise =
      row.angle_noise ? uploads_.turn_beams(sample, thread) : std::span<const double>();
  const WideBeam heading = heading_of(view.X_WS.yaw);
  for (std::size_t k = 0; k < beams; ++k) {
    const long double bearing = wide_bearing(settings, row.plan.samples[k]) + (noise.empty() ? 0.0L : noise[k]);
    const WideBeam beam = wide_beam({view.X_WS.x, view.X_WS.y}, heading, bearing);
    const WideHit hit = nearest_surface(std::span<const Surface>(own.surfaces), beam, settings.range_max);
    const auto range = static_cast<double>(hit.range);
    own.models[k] = range < settings.range_max ? hit.model : SF_NO_HIT;
    own.ranges[k] = std::max(range, settings.range_min);
    own.grazes[k] = own.models[k] != SF_NO_HIT && hit.sine < kMinSine;
  }
  results_.write(row, own.ranges.data(), own.models.data(), own.grazes.data());
}

constinit const CasterType reference_caster{
    .name = "reference",
    .summary = "every beam against every surface in long double, for small worlds",
    .same_bytes = false,
    .describe = [] { return std::string("reference, long double"); },
    .bound = wide_bound,
    .make = [](const CasterInputs& in) -> std::unique_ptr<Caster> { return std::make_unique<ReferenceCaster>(in); },
};

}  // namespace sf::raycast
