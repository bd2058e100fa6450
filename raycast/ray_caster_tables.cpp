#include "raycast/ray_caster_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/error.h"
#include "shaders/laser.comp.h"
#include "shaders/laser_uncertain.comp.h"

namespace sf::raycast {

namespace {

/// Scanners are sorted by mover.
std::uint32_t count_sensing_movers(const std::vector<Scanner>& scanners) {
  std::uint32_t sensing_movers = 0;
  for (std::size_t i = 0; i < scanners.size(); ++i)
    sensing_movers += i == 0 || scanners[i].mover != scanners[i - 1].mover;
  return sensing_movers;
}

ScanView scan_view_of(const ScannerRow& row, const Viewpoint& from) {
  ScanView view;
  view.heading = from.heading;
  view.yaw = from.X_WS.yaw;
  view.range_min = row.range_min;
  view.min_sine = kMinSine;
  view.single = row.single;
  return view;
}

/// [beams] whose results are fetched before a scan: a third of the smallest first-level cache.
constexpr std::size_t kMostFetched = 1024;

/// True for the caster of Vulkan kernels. @throws base::DeviceError where it is asked for on the host
bool kernels_cast(const SensorContext& context) {
  const bool kernels = choose_caster(context.device.info().software, context.scene.caster) == CasterChoice::vulkan;
  if (kernels && context.device.is_host())
    throw base::DeviceError(
        "the caster 'vulkan' needs a Vulkan device, but the device is the host; choose the caster 'host' or 'auto', or "
        "a Vulkan device (Debian: mesa-vulkan-drivers)");
  return kernels;
}

}  // namespace

RayCaster::Tables::Tables(const SensorContext& context, const world::World& world, std::vector<Scanner> scanners)
    : thread_pool(context.thread_pool),
      states(context.states),
      plan(world, std::move(scanners), context.noise),
      uploads(context, plan),
      results(context.device, plan) {
  host = std::make_unique<HostScene>(world, plan.configs, thread_pool);
  if (kernels_cast(context))
    scene = std::make_unique<DeviceScene>(world, plan.configs, context.device, thread_pool, context.scene,
                                          count_sensing_movers(plan.scanners));
  scratch.resize(thread_pool.threads());
  if (scene) make_passes(context.device, context.scene.largest_buffer);
  for (const ScannerRow& row : plan.rows)
    if (!row.angle_noise && row.pattern == patterns.size())
      make_pattern(static_cast<std::size_t>(&row - plan.rows.data()), {}, scratch[0], patterns.emplace_back());
  shared_of.assign(plan.scanners.size(), kNotShared);
  if (!scene) find_shared_views();
}

void RayCaster::Tables::make_passes(gpu::Device& device, std::size_t largest_buffer) {
  rows = std::make_unique<gpu::Buffer>(device, "due sensors", gpu::Role::upload, gpu::Texel::u32x4,
                                       gpu::texels_of<RayRow>(std::max<std::size_t>(1, plan.scanners.size())));
  texel_results = !results.ranges.fits_storage_buffer() || results.ranges.bytes() > largest_buffer;
  make_pass(device, exact, false);
  if (uploads.single()) make_pass(device, single.emplace(), true);
}

void RayCaster::Tables::make_pass(gpu::Device& device, CastDispatch& pass, bool is_single) {
  using gpu::Role;
  using gpu::Texel;
  pass.lanes = is_single ? &*uploads.single() : &uploads.exact();
  const std::size_t padded = pass.lanes->lanes.texels() / 2;
  const std::uint32_t constants[] = {scene->has_movers(), is_single, texel_results, device.rounds32()};
  constexpr std::size_t kWords = sizeof(UncertainLanes) / 4, kEntryWords = sizeof(UncertainLanes::Entry) / 4;
  pass.uncertain = std::make_unique<gpu::Buffer>(device, "uncertain lanes", Role::download, Texel::u32,
                                                 kWords + kEntryWords * padded);
  if (!pass.uncertain->fits_storage_buffer())
    throw base::DeviceError(
        fmt::format("{} million beams exceed the storage buffers of the device; use fewer robots or beams, or --caster "
                    "host",
                    SF_BEAMS_PER_LANE * plan.result_lanes / 1'000'000));
  pass.begin_uncertain();  // no lanes until the first cast
  pass.kernel =
      std::make_unique<gpu::Kernel>(device, is_single ? "laser in 32 bits" : "laser", laser_comp_spv, constants);
  pass.uncertain_kernel = std::make_unique<gpu::Kernel>(
      device, is_single ? "uncertain beams in 32 bits" : "uncertain beams", laser_uncertain_comp_spv, constants);
}

/// Makes the pattern of scanner `i` from its beam tables. @param angle_noise [rad] of each cast beam; empty: none
void RayCaster::Tables::make_pattern(std::size_t i, std::span<const double> angle_noise, Scratch& own,
                                     ScanPattern& pattern) {
  const ScanSettings& scan = plan.scanners[i].scan;
  const ScannerRow& row = plan.rows[i];
  const std::vector<std::uint32_t>& samples = row.plan.samples;
  own.bearings.resize(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k)
    own.bearings[k] = bearing_of(scan, samples[k]) + (angle_noise.empty() ? 0.0 : angle_noise[k]);
  pattern.assign(own.bearings, {uploads.beam_tables(row.beams).directions64, 8 * std::size_t{row.plan.lanes()}},
                 bearing_of(scan, samples.front()), bearing_of(scan, samples.back()), row.plan.place(1));
}

/// Poses of the due scanners [first, last): as base::compose, with one sine and cosine per mover. Counts their beams.
void RayCaster::Tables::compute_viewpoints(std::size_t first, std::size_t last) {
  std::uint32_t mover = kNotShared;
  std::uint64_t beams = 0;
  glm::dvec2 turn;
  for (std::size_t i = first; i < last; ++i) {
    const ScannerRow& row = plan.rows[due[i].row];
    const Pose &X = states[row.mover].X_WM, &X_MS = row.mount;
    if (row.mover != mover) turn = {std::cos(X.yaw), std::sin(X.yaw)};
    mover = row.mover;
    beams += row.plan.samples.size();
    const double yaw = X.yaw + X_MS.yaw;
    views[i] = {row.config,
                mover,
                {X.x + (turn.x * X_MS.x - turn.y * X_MS.y), X.y + (turn.y * X_MS.x + turn.x * X_MS.y), X_MS.z, yaw},
                yaw == X.yaw ? turn : glm::dvec2{std::cos(yaw), std::sin(yaw)}};
  }
  rays += beams;
}

/// Builds the device's lists and rows of all due scanners. @return true when tables were replaced
bool RayCaster::Tables::prepare() {
  const auto ray_rows = rows->host<RayRow>().first(due.size());
  const bool replaced = scene->prepare(views, ray_rows);
  thread_pool.parallel_for(due.size(), 512, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const ScannerRow& row = plan.rows[due[i].row];
      ray_rows[i].beams = row.beams;
      ray_rows[i].results = row.out;
      ray_rows[i].range_min = plan.scanners[due[i].row].scan.range_min;
    }
  });
  return replaced;
}

/// Finds runs of scanners of one mover at one point.
void RayCaster::Tables::find_shared_views() {
  std::vector<const BeamPlan*> plans;
  for (const ScannerRow& row : plan.rows) plans.push_back(&row.plan);
  for (std::uint32_t first = 0, end; first < plan.scanners.size(); first = end) {
    for (end = first + 1; end < plan.scanners.size() && same_viewpoint(plan.scanners[first], plan.scanners[end]);
         ++end) {
    }
    const auto own = std::span(plan.rows).subspan(first, end - first);
    if (own.size() < 2 || std::any_of(own.begin(), own.end(), [](const ScannerRow& row) { return row.angle_noise; }))
      continue;
    if (shared_views.add(first, std::span(plan.scanners).subspan(first, own.size()),
                         std::span(plans).subspan(first, own.size())))
      shared_of[first] = static_cast<std::uint32_t>(shared_views.views().size() - 1);
  }
}

void RayCaster::Tables::scan_on_host() {
  if (host_due.empty()) return;
  if (!host_has_movers) host->place_movers(states);
  host_has_movers = true;
  list_scans();
  host->prepare(host_views);
  thread_pool.parallel_for(scans.size(), 8, [this](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t k = first; k < last; ++k)
      scans[k].shared == kNotShared ? scan_one(k, thread) : scan_shared(k, thread);
  });
}

/// Lists this tick's host scans. A view is shared when all of its scanners are due.
void RayCaster::Tables::list_scans() {
  scans.clear();
  host_views.clear();
  for (std::size_t k = 0, together = 1; k < host_due.size(); k += together) {
    const std::uint32_t i = host_due[k];
    std::uint32_t shared = shared_of[due[i].row];
    together = shared == kNotShared ? 1 : shared_views.views()[shared].scanners;
    const std::size_t last = k + together - 1;
    if (last >= host_due.size() || due[host_due[last]].row - due[i].row != together - 1)
      shared = kNotShared, together = 1;
    scans.push_back({i, shared});
    host_views.push_back(views[i]);
  }
}

void RayCaster::Tables::scan_one(std::size_t k, unsigned thread) {
  const DueSample& d = due[scans[k].due];
  const ScannerRow& row = plan.rows[d.row];
  Scratch& own = scratch[thread];
  if (row.angle_noise) make_pattern(d.row, uploads.turn_beams(d, thread), own, own.pattern);
  const ScanPattern& pattern = row.angle_noise ? own.pattern : patterns[row.pattern];
  own.make_room(pattern.beams);
  double* to = own.ranges.data();
  std::uint32_t* hit_models = own.models.data();
  if (row.plan.packed) {
    to = results.ranges_of(row);
    hit_models = results.models_of(row);
    // A fleet's results exceed the caches: stores would wait for each of their lines.
    const std::size_t fetched = std::min<std::size_t>(pattern.beams, kMostFetched);
    prefetch(to, fetched * sizeof *to), prefetch(hit_models, fetched * sizeof *hit_models);
  }
  const bool grazes =
      host->scan(k, scan_view_of(row, host_views[k]), pattern, thread, {to, hit_models, own.grazes.data()});
  results.write(row, to, hit_models, grazes ? own.grazes.data() : nullptr);
}

/// Scans all beams of a shared view and distributes the results to its scanners, in the layout of the kernels.
void RayCaster::Tables::scan_shared(std::size_t k, unsigned thread) {
  const SharedView& shared = shared_views.views()[scans[k].shared];
  const SharedPattern& all = shared_views.pattern(shared);
  const ScannerRow& row = plan.rows[shared.first];
  const std::size_t beams = all.sources.size();
  Scratch& own = scratch[thread];
  own.make_room(beams);
  ScanView view = scan_view_of(row, host_views[k]);
  for (std::size_t b = 0; b < beams; ++b) {
    view.heading = views[scans[k].due + all.sources[b].scanner].heading;
    const glm::dvec2 d = direction_of(view, all.beams, b);
    own.x[b] = d.x, own.y[b] = d.y;
  }
  view.heading = host_views[k].heading;
  view.x = own.x.data(), view.y = own.y.data();
  const bool grazes = host->scan(k, view, all.beams, thread, {own.ranges.data(), own.models.data(), own.grazes.data()});
  double* const out = results.ranges_of(row);
  std::uint32_t* const hit_models = results.models_of(row);
  std::uint32_t* const lane_flags = results.beam_flags.data() + row.out;
  std::fill_n(lane_flags, all.lanes, 0u);
  for (std::size_t b = 0; b < beams; ++b) {
    const SharedPattern::Source& s = all.sources[b];
    std::fill_n(out + s.place, s.places, own.ranges[b]);
    std::fill_n(hit_models + s.place, s.places, own.models[b]);
    if (grazes && own.grazes[b] != 0)
      lane_flags[s.place / SF_BEAMS_PER_LANE] |= SF_GRAZING << s.place % SF_BEAMS_PER_LANE;
  }
}

/// Lists the scanners of host scans: all, or those whose lists exceed the device's limits.
void RayCaster::Tables::find_host_due() {
  host_due.clear();
  for (std::uint32_t i = 0; !scene && i < due.size(); ++i) host_due.push_back(i);
  if (!scene) return;
  const auto ray_rows = rows->host<RayRow>();
  for (std::uint32_t i = 0; i < due.size(); ++i) {
    if (!scene->needs_host(i)) continue;
    host_due.push_back(i);
    ray_rows[i].results = plan.result_lanes;
  }
  host_scans += host_due.size();
}

void RayCaster::Tables::bind(CastDispatch& pass) {
  const std::vector<gpu::TableBinding> tables{{"rows", rows.get()},
                                              {"lanes", &pass.lanes->lanes},
                                              {"bearings", &uploads.mid_bearings()},
                                              {"directions", &uploads.directions64()},
                                              {"lists", &scene->lists()},
                                              {"segment_ids", &scene->segment_ids()},
                                              {"mover_rows", &scene->mover_rows()},
                                              {"segments", &scene->segments()},
                                              {"models", &scene->models()},
                                              {"range_texels", &results.ranges},
                                              {"hit_texels", &results.hits},
                                              {"ranges", &results.ranges},
                                              {"hits", &results.hits},
                                              {"uncertain", pass.uncertain.get()}};
  pass.kernel->bind(tables);
  pass.uncertain_kernel->bind(tables);
}

/// Empties the lists of uncertain lanes, and clears the flags of the last cast.
void RayCaster::Tables::begin_uncertain() {
  for (const std::uint32_t lane : flagged) results.beam_flags[lane] = 0;
  flagged.clear();
  exact.begin_uncertain();
  if (single) single->begin_uncertain();
}

/// Takes in the flags of the device's last cast, without scanners whose scans the host computed.
void RayCaster::Tables::take_uncertain(CastDispatch& pass) {
  const std::span<const std::uint32_t> words = pass.uncertain->host<std::uint32_t>();
  const std::uint32_t count = reinterpret_cast<const UncertainLanes*>(words.data())->count;
  const std::span<const Lane> lanes = pass.lanes->lanes.host<Lane>();
  const auto* entries =
      reinterpret_cast<const UncertainLanes::Entry*>(words.data() + sizeof(UncertainLanes) / sizeof words[0]);
  for (const UncertainLanes::Entry& entry : std::span(entries, count)) {
    const Lane& lane = lanes[entry.lane];
    std::uint32_t& flags = results.beam_flags[plan.rows[due[lane.row].row].out + lane.lane];
    if (scene->needs_host(lane.row) || flags != 0) continue;  // padding repeats the last lane
    flags = entry.flags;
    flagged.push_back(plan.rows[due[lane.row].row].out + lane.lane);
    uncertain_beams += static_cast<std::uint64_t>(std::popcount(flags / SF_UNCERTAIN));
  }
}

void RayCaster::Tables::bind() {
  if (scene) bind(exact);
  if (scene && single) bind(*single);
  bound = true;
}

}  // namespace sf::raycast
