#include "raycast/host_caster.h"

#include <algorithm>

#include "raycast/casters.h"
#include "raycast/range_bounds.h"

namespace sf::raycast {

namespace {

ScanView scan_view_of(const ScannerRow& row, const Viewpoint& from) {
  ScanView view;
  view.heading = from.heading;
  view.yaw = from.X_WS.yaw;
  view.range_min = row.range_min;
  view.min_sine = kMinSine;
  view.single = row.single;
  return view;
}

/// [beams] limit of the results prefetched before a scan: a third of the smallest L1 cache.
constexpr std::size_t kMostFetched = 1024;

}  // namespace

HostCaster::HostCaster(const CasterInputs& in, bool share)
    : Caster(in),
      scene_(in.world, in.plan.configs, in.context.thread_pool),
      scratch_(in.context.thread_pool.threads()) {
  for (const ScannerRow& row : plan_.rows)
    if (!row.angle_noise && row.pattern == patterns_.size())
      make_pattern(static_cast<std::size_t>(&row - plan_.rows.data()), {}, scratch_[0], patterns_.emplace_back());
  shared_of_.assign(plan_.scanners.size(), kNotShared);
  if (share) find_shared_views();
}

/// Builds the pattern of scanner `i` from its beam tables. @param angle_noise [rad] of each cast beam; empty: none
void HostCaster::make_pattern(std::size_t i, std::span<const double> angle_noise, Scratch& own, ScanPattern& pattern) {
  const ScanSettings& scan = plan_.scanners[i].scan;
  const ScannerRow& row = plan_.rows[i];
  const std::vector<std::uint32_t>& samples = row.plan.samples;
  own.bearings.resize(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k)
    own.bearings[k] = bearing_of(scan, samples[k]) + (angle_noise.empty() ? 0.0 : angle_noise[k]);
  pattern.assign(own.bearings, {uploads_.beam_tables(row.beams).directions64, 8 * std::size_t{row.plan.lanes()}},
                 bearing_of(scan, samples.front()), bearing_of(scan, samples.back()), row.plan.place(1));
}

/// Finds runs of scanners at the same point of a mover.
void HostCaster::find_shared_views() {
  std::vector<const BeamPlan*> plans;
  for (const ScannerRow& row : plan_.rows) plans.push_back(&row.plan);
  for (std::uint32_t first = 0, end; first < plan_.scanners.size(); first = end) {
    for (end = first + 1; end < plan_.scanners.size() && same_viewpoint(plan_.scanners[first], plan_.scanners[end]);
         ++end) {
    }
    const auto own = std::span(plan_.rows).subspan(first, end - first);
    if (own.size() < 2 || std::any_of(own.begin(), own.end(), [](const ScannerRow& row) { return row.angle_noise; }))
      continue;
    if (shared_views_.add(first, std::span(plan_.scanners).subspan(first, own.size()),
                          std::span(plans).subspan(first, own.size())))
      shared_of_[first] = static_cast<std::uint32_t>(shared_views_.views().size() - 1);
  }
}

bool HostCaster::prepare(const DueScans& due, bool cast) {
  while (all_.size() < due.samples.size()) all_.push_back(static_cast<std::uint32_t>(all_.size()));
  if (cast)
    scan(due, std::span(all_).first(due.samples.size()));  // applies the angular noise itself
  else
    uploads_.turn_all_beams(due.samples, thread_pool_);
  return false;
}

void HostCaster::scan(const DueScans& due, std::span<const std::uint32_t> which) {
  if (which.empty()) return;
  if (!placed_) scene_.place_movers(states_);
  placed_ = true;
  list_scans(due, which);
  scene_.prepare(views_);
  thread_pool_.parallel_for(scans_.size(), 8, [&](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t k = first; k < last; ++k)
      scans_[k].shared == kNotShared ? scan_one(due, k, thread) : scan_shared(due, k, thread);
  });
}

/// Lists this tick's host scans. A view is shared if all of its scanners are due.
void HostCaster::list_scans(const DueScans& due, std::span<const std::uint32_t> which) {
  scans_.clear();
  views_.clear();
  for (std::size_t k = 0, together = 1; k < which.size(); k += together) {
    const std::uint32_t i = which[k];
    std::uint32_t shared = shared_of_[due.samples[i].row];
    together = shared == kNotShared ? 1 : shared_views_.views()[shared].scanners;
    const std::size_t last = k + together - 1;
    if (last >= which.size() || due.samples[which[last]].row - due.samples[i].row != together - 1)
      shared = kNotShared, together = 1;
    scans_.push_back({i, shared});
    views_.push_back(due.views[i]);
  }
}

void HostCaster::scan_one(const DueScans& due, std::size_t k, unsigned thread) {
  const DueSample& d = due.samples[scans_[k].due];
  const ScannerRow& row = plan_.rows[d.row];
  Scratch& own = scratch_[thread];
  if (row.angle_noise) make_pattern(d.row, uploads_.turn_beams(d, thread), own, own.pattern);
  const ScanPattern& pattern = row.angle_noise ? own.pattern : patterns_[row.pattern];
  own.make_room(pattern.beams);
  double* to = own.ranges.data();
  std::uint32_t* hit_models = own.models.data();
  if (row.plan.packed) {
    to = results_.ranges_of(row);
    hit_models = results_.models_of(row);
    // The results of a large fleet exceed the caches, so stores would wait for every cache line.
    const std::size_t fetched = std::min<std::size_t>(pattern.beams, kMostFetched);
    prefetch(to, fetched * sizeof *to), prefetch(hit_models, fetched * sizeof *hit_models);
  }
  const bool grazes =
      scene_.scan(k, scan_view_of(row, views_[k]), pattern, thread, {to, hit_models, own.grazes.data()});
  results_.write(row, to, hit_models, grazes ? own.grazes.data() : nullptr);
}

/// Scans all beams of a shared view and distributes the results to its scanners, in the layout that kernels use.
void HostCaster::scan_shared(const DueScans& due, std::size_t k, unsigned thread) {
  const SharedView& shared = shared_views_.views()[scans_[k].shared];
  const SharedPattern& all = shared_views_.pattern(shared);
  const ScannerRow& row = plan_.rows[shared.first];
  const std::size_t beams = all.sources.size();
  Scratch& own = scratch_[thread];
  own.make_room(beams);
  ScanView view = scan_view_of(row, views_[k]);
  for (std::size_t b = 0; b < beams; ++b) {
    view.heading = due.views[scans_[k].due + all.sources[b].scanner].heading;
    const glm::dvec2 d = direction_of(view, all.beams, b);
    own.x[b] = d.x, own.y[b] = d.y;
  }
  view.heading = views_[k].heading;
  view.x = own.x.data(), view.y = own.y.data();
  const bool grazes =
      scene_.scan(k, view, all.beams, thread, {own.ranges.data(), own.models.data(), own.grazes.data()});
  double* const out = results_.ranges_of(row);
  std::uint32_t* const hit_models = results_.models_of(row);
  std::uint32_t* const lane_flags = results_.beam_flags.data() + row.out;
  std::fill_n(lane_flags, all.lanes, 0u);
  for (std::size_t b = 0; b < beams; ++b) {
    const SharedPattern::Source& s = all.sources[b];
    std::fill_n(out + s.place, s.places, own.ranges[b]);
    std::fill_n(hit_models + s.place, s.places, own.models[b]);
    if (grazes && own.grazes[b] != 0)
      lane_flags[s.place / SF_BEAMS_PER_LANE] |= SF_GRAZING << s.place % SF_BEAMS_PER_LANE;
  }
}

SensorStats HostCaster::stats() const {
  const ScanCounts scans = scene_.counts();
  SensorStats stats;
  stats.uncertain = scans.uncertain;
  stats.cells_built = scene_.cells_built();
  stats.movers_in_range = scans.movers_in_range;
  stats.movers_visible = scans.movers_visible;
  return stats;
}

constinit const CasterType host_caster{
    .name = "host",
    .summary = "vector code on the host, with the same results",
    .describe = [] { return std::string("host, ") + vector_instructions(); },
    .bound = exact_bound,
    .make = [](const CasterInputs& in) -> std::unique_ptr<Caster> { return std::make_unique<HostCaster>(in); },
};

}  // namespace sf::raycast
