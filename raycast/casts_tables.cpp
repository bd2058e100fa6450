#include "raycast/casts_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "base/error.h"
#include "shaders/laser.comp.h"

namespace sf::raycast {

namespace {

/// Groups along x of a dispatch; more rows of groups follow along y. Devices promise 65 535.
constexpr std::uint32_t kGroupsAcross = 32'768;

/// Fans are in order of their movers.
std::uint32_t carriers_of(const std::vector<Fan>& fans) {
  std::uint32_t carriers = 0;
  for (std::size_t i = 0; i < fans.size(); ++i) carriers += i == 0 || fans[i].mover != fans[i - 1].mover;
  return carriers;
}

ScanView view_of(const Fan& fan, const Viewpoint& from) {
  ScanView view;
  view.heading = from.heading;
  view.yaw = from.X_WS.yaw;
  view.range_min = fan.laser.range_min;
  view.least_sine = kLeastSine;
  view.single = fan.single;
  return view;
}

/// Fans with the same beams share their tables.
using BeamKey = std::tuple<double, std::uint32_t, std::uint32_t>;

}  // namespace

Casts::Tables::Tables(const Site& site, const world::World& world, std::vector<Fan> f)
    : thread_pool(site.thread_pool), seed(site.seed), noise(site.noise), families(world), fans(std::move(f)) {
  plan(world);
  host = std::make_unique<HostScene>(world, families, thread_pool);
  if (caster_for(site.device.info().software, site.scene.caster) == Caster::vulkan)
    scene = std::make_unique<Scene>(world, families, site.device, thread_pool, site.scene, carriers_of(fans));
  scratch.resize(thread_pool.threads());
  turned.resize(thread_pool.threads());
  std::uint32_t beam_lanes = 0;
  struct Shared {
    std::uint32_t beams, pattern;
  };
  std::map<BeamKey, Shared> shared;
  for (std::size_t i = 0; i < fans.size(); ++i) {
    FanRow& row = fan_rows[i];
    const BeamKey key{fans[i].laser.fov, fans[i].laser.samples, fans[i].laser.resolution};
    const auto known = shared.find(key);
    if (!row.turns && known != shared.end()) {
      row.beams = known->second.beams;
      row.pattern = known->second.pattern;
      continue;
    }
    row.beams = beam_lanes;
    if (!row.turns) {
      row.pattern = static_cast<std::uint32_t>(shared.size());
      shared[key] = {beam_lanes, row.pattern};
    }
    beam_lanes += row.plan.lanes();
  }
  make_tables(site.device, site.scene.largest_buffer, beam_lanes);
  write_all_beams();
  // Patterns were numbered in order of rows, as tables of beams were.
  for (const FanRow& row : fan_rows)
    if (!row.turns && row.pattern == patterns.size())
      make_pattern(static_cast<std::size_t>(&row - fan_rows.data()), {}, scratch[0], patterns.emplace_back());
  if (!scene) share_views();
}

void Casts::Tables::plan(const world::World& world) {
  std::vector<std::size_t> beams(world.movers.size(), 0);
  for (const Fan& fan : fans) beams[fan.mover] += fan.laser.samples / fan.laser.resolution;
  for (const Fan& fan : fans) {
    FanRow row;
    row.plan = plan_beams(fan.laser, noise);
    row.height = world.movers[fan.mover].X_WM.z + fan.laser.X_MS.z;
    const double turn = noise ? kMostSigmas * fan.laser.noise.angle_sigma : 0.0;
    const Family family{row.height, fan.laser.range_max, row.plan.spread, fan.laser.fov + 2.0 * turn,
                        static_cast<std::uint32_t>(std::min<std::size_t>(beams[fan.mover], 1'000'000))};
    row.family = families.add(family);
    row.turns = noise && fan.laser.noise.angle_sigma > 0.0;
    any_turns = any_turns || row.turns;
    row.out = out_lanes;
    out_lanes += row.plan.lanes();
    spare_lanes = std::max(spare_lanes, row.plan.lanes());
    fan_rows.push_back(std::move(row));
  }
}

void Casts::Tables::make_tables(gpu::Device& device, std::size_t largest_buffer, std::uint32_t beam_lanes) {
  using gpu::Role;
  using gpu::Texel;
  const std::size_t count = std::max<std::size_t>(1, fans.size());
  if (scene)
    rows = std::make_unique<gpu::Buffer>(device, "due sensors", Role::upload, Texel::u32x4, SF_ROW_TEXELS * count);
  middles =
      std::make_unique<gpu::Buffer>(device, "middles of lanes", Role::upload, Texel::f32, std::size_t{beam_lanes} + 1);
  directions64 = std::make_unique<gpu::Buffer>(device, "beams in 64 bits", Role::upload, Texel::u32x4,
                                               4 * std::size_t{beam_lanes} + 4);
  const std::size_t results = std::size_t{out_lanes} + std::max(spare_lanes, 1u);
  ranges = std::make_unique<gpu::Buffer>(device, "ranges", Role::download, Texel::u32x4, 2 * results);
  hits = std::make_unique<gpu::Buffer>(device, "hits", Role::download, Texel::u32x4, results);
  verdicts = std::make_unique<gpu::Buffer>(device, "verdicts", Role::download, Texel::u32, results);
  texel_results = !ranges->fits_storage_buffer() || ranges->bytes() > largest_buffer;
  make_pass(device, exact, false);
  const auto asks = [](const Fan& fan) { return fan.single; };
  if (std::any_of(fans.begin(), fans.end(), asks)) make_pass(device, single.emplace(), true);
}

void Casts::Tables::make_pass(gpu::Device& device, CastPass& pass, bool is_single) {
  using gpu::Role;
  using gpu::Texel;
  // Lanes are padded to whole groups, and groups to whole rows of groups where there are many.
  const std::size_t most_groups = out_lanes / kLanesPerGroup + 1;
  const std::size_t padded = (most_groups > kGroupsAcross ? most_groups + kGroupsAcross : most_groups) * kLanesPerGroup;
  pass.lanes = std::make_unique<gpu::Buffer>(device, "whose beams", Role::upload, Texel::u32, 2 * padded);
  pass.groups = std::make_unique<gpu::Buffer>(device, "group counts", Role::upload, Texel::u32, 4);
  if (!scene) return;
  const std::uint32_t constants[] = {scene->has_movers(), is_single, texel_results};
  pass.kernel =
      std::make_unique<gpu::Kernel>(device, is_single ? "laser in 32 bits" : "laser", laser_comp_spv, 15, 3, constants);
  SF_CHECK(pass.kernel->group_size() == kLanesPerGroup, "groups of lanes are counted as of 64");
}

void Casts::Tables::write_all_beams() {
  // Tables were given out in order of rows: one that lies behind all written so far is new, others are shared.
  std::uint32_t written = 0;
  for (std::size_t i = 0; i < fans.size(); ++i) {
    const FanRow& row = fan_rows[i];
    if (row.beams < written) continue;
    write_beams(fans[i].laser, row.plan, {}, beam_tables(row.beams));
    written += row.plan.lanes();
  }
}

void Casts::Tables::turn_beams(const Due& d, unsigned thread) {
  const Fan& fan = fans[d.row];
  const FanRow& row = fan_rows[d.row];
  std::vector<double>& turns = turned[thread];
  turns.resize(row.plan.samples.size());
  draw_turns(fan.laser, row.plan, {seed, base::RandomStream::angle_noise, fan.mover, fan.sensor, d.sequence}, turns);
  write_beams(fan.laser, row.plan, turns, beam_tables(row.beams));
}

void Casts::Tables::write_lanes() {
  // Tables are born with anything in them: the first tick writes them, even when nothing is due.
  const bool same = bound && lanes_written.size() == due.size() &&
                    std::equal(due.begin(), due.end(), lanes_written.begin(),
                               [](const Due& d, std::uint32_t row) { return d.row == row; });
  if (same) return;
  lanes_written.clear();
  for (const Due& d : due) lanes_written.push_back(d.row);
  write_lanes(exact, false);
  if (single) write_lanes(*single, true);
}

void Casts::Tables::write_lanes(CastPass& pass, bool is_single) {
  const auto table = pass.lanes->host<Lane>();
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < due.size(); ++i) {
    if (fans[due[i].row].single != is_single) continue;
    for (std::uint32_t lane = 0; lane < fan_rows[due[i].row].plan.lanes(); ++lane) table[at++] = {i, lane};
  }
  const auto due_lanes = static_cast<std::uint32_t>(at);
  const std::uint32_t group = kLanesPerGroup;
  const std::uint32_t needed = (due_lanes + group - 1) / group;
  const std::uint32_t across = std::min(needed, kGroupsAcross);
  const std::uint32_t down = across > 0 ? (needed + across - 1) / across : 0;
  // Padding repeats the last lane, which then is written more than once with the same values.
  const Lane last = at > 0 ? table[at - 1] : Lane{0, 0};
  std::fill(table.begin() + static_cast<std::ptrdiff_t>(at), table.begin() + std::ptrdiff_t{across} * down * group,
            last);
  const auto counts = pass.groups->host<std::uint32_t>();
  counts[0] = across;
  counts[1] = down;
  counts[2] = across > 0 ? 1 : 0;
}

/// Of the beams in the fan's tables. @param turns [rad] of each cast beam, or none
void Casts::Tables::make_pattern(std::size_t i, std::span<const double> turns, Scratch& own, ScanPattern& pattern) {
  const world::Laser& laser = fans[i].laser;
  const FanRow& row = fan_rows[i];
  const std::vector<std::uint32_t>& samples = row.plan.samples;
  own.bearings.resize(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k)
    own.bearings[k] = world::bearing_of(laser, samples[k]) + (turns.empty() ? 0.0 : turns[k]);
  pattern.assign(own.bearings, {beam_tables(row.beams).directions64, 8 * std::size_t{row.plan.lanes()}},
                 world::bearing_of(laser, samples.front()), world::bearing_of(laser, samples.back()),
                 row.plan.place(1));
}

/// Where the due fans [first, last) look from: base::compose, with the sine and cosine of each mover once.
void Casts::Tables::look(std::size_t first, std::size_t last, std::span<const Pose> movers) {
  std::uint32_t mover = kAlone;
  glm::dvec2 turn;
  for (std::size_t i = first; i < last; ++i) {
    const Fan& fan = fans[due[i].row];
    const FanRow& row = fan_rows[due[i].row];
    const Pose &X = movers[fan.mover], &X_MS = fan.laser.X_MS;
    if (fan.mover != mover) turn = {std::cos(X.yaw), std::sin(X.yaw)};
    mover = fan.mover;
    const double yaw = X.yaw + X_MS.yaw;
    views[i] = {row.family,
                mover,
                {X.x + (turn.x * X_MS.x - turn.y * X_MS.y), X.y + (turn.y * X_MS.x + turn.x * X_MS.y), row.height, yaw},
                {std::cos(yaw), std::sin(yaw)}};
  }
}

/// Makes the device's lists for what is due, and its rows. @return whether tables were replaced
bool Casts::Tables::serve() {
  const auto ray_rows = rows->host<RayRow>().first(due.size());
  const bool replaced = scene->serve(views, ray_rows);
  thread_pool.parallel_for(due.size(), 512, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i) {
      const FanRow& row = fan_rows[due[i].row];
      ray_rows[i].beams = row.beams;
      ray_rows[i].out = row.out;
      ray_rows[i].range_min = fans[due[i].row].laser.range_min;
    }
  });
  return replaced;
}

/// Fans of one mover that look from one point.
void Casts::Tables::share_views() {
  std::vector<const BeamPlan*> plans;
  for (const FanRow& row : fan_rows) plans.push_back(&row.plan);
  for (std::uint32_t first = 0, end; first < fans.size(); first = end) {
    for (end = first + 1; end < fans.size() && look_alike(fans[first], fans[end]); ++end) {
    }
    const auto own = std::span(fan_rows).subspan(first, end - first);
    if (own.size() < 2 || std::any_of(own.begin(), own.end(), [](const FanRow& row) { return row.turns; })) continue;
    if (shares.add(first, std::span(fans).subspan(first, own.size()), std::span(plans).subspan(first, own.size())))
      fan_rows[first].shared = static_cast<std::uint32_t>(shares.views().size() - 1);
  }
}

void Casts::Tables::scan_on_host() {
  if (for_host.empty()) return;
  if (!host_placed) host->place(poses);
  host_placed = true;
  list_scans();
  host->prepare(host_views);
  thread_pool.parallel_for(scans.size(), 8, [this](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t k = first; k < last; ++k)
      scans[k].shared == kAlone ? scan_alone(k, thread) : scan_shared(k, thread);
  });
}

/// Views are shared where all of their fans are due.
void Casts::Tables::list_scans() {
  scans.clear();
  host_views.clear();
  for (std::size_t k = 0, together = 1; k < for_host.size(); k += together) {
    const std::uint32_t i = for_host[k];
    std::uint32_t shared = fan_rows[due[i].row].shared;
    together = shared == kAlone ? 1 : shares.views()[shared].fans;
    const std::size_t last = k + together - 1;
    if (last >= for_host.size() || due[for_host[last]].row - due[i].row != together - 1) shared = kAlone, together = 1;
    scans.push_back({i, shared});
    host_views.push_back(views[i]);
  }
}

/// Writes a fan's results where kernels look for them. @param grazes null where none does
void Casts::Tables::put(const FanRow& row, const double* own_ranges, const std::uint32_t* own_models,
                        const std::uint8_t* grazes) {
  const std::size_t beams = row.plan.samples.size(), lanes = row.plan.lanes(), places = SF_BEAMS_PER_LANE * lanes;
  double* const out = ranges->host<double>().data() + SF_BEAMS_PER_LANE * std::size_t{row.out};
  std::uint32_t* const met = hits->host<std::uint32_t>().data() + SF_BEAMS_PER_LANE * std::size_t{row.out};
  std::uint32_t* const lane_verdicts = verdicts->host<std::uint32_t>().data() + row.out;
  std::fill_n(lane_verdicts, lanes, 0u);
  if (row.plan.packed) {
    if (own_ranges != out) std::copy_n(own_ranges, beams, out);
    if (own_models != met) std::copy_n(own_models, beams, met);
    // Places without a beam repeat the last one.
    std::fill(out + beams, out + places, out[beams - 1]);
    std::fill(met + beams, met + places, met[beams - 1]);
    for (std::size_t b = 0; grazes != nullptr && b < beams; ++b)
      if (grazes[b] != 0) lane_verdicts[b / SF_BEAMS_PER_LANE] |= SF_GRAZES << b % SF_BEAMS_PER_LANE;
    return;
  }
  for (std::size_t b = 0; b < beams; ++b) {
    std::fill_n(out + SF_BEAMS_PER_LANE * b, SF_BEAMS_PER_LANE, own_ranges[b]);
    std::fill_n(met + SF_BEAMS_PER_LANE * b, SF_BEAMS_PER_LANE, own_models[b]);
    if (grazes != nullptr && grazes[b] != 0) lane_verdicts[b] |= SF_GRAZES;
  }
}

void Casts::Tables::scan_alone(std::size_t k, unsigned thread) {
  const Due& d = due[scans[k].due];
  const FanRow& row = fan_rows[d.row];
  const Fan& fan = fans[d.row];
  Scratch& own = scratch[thread];
  if (row.turns) turn_beams(d, thread);
  if (row.turns) make_pattern(d.row, turned[thread], own, own.pattern);
  const ScanPattern& pattern = row.turns ? own.pattern : patterns[row.pattern];
  own.make_room(pattern.beams);
  double* to = own.ranges.data();
  std::uint32_t* met = own.models.data();
  if (row.plan.packed) {
    to = ranges->host<double>().data() + SF_BEAMS_PER_LANE * std::size_t{row.out};
    met = hits->host<std::uint32_t>().data() + SF_BEAMS_PER_LANE * std::size_t{row.out};
  }
  const bool grazes = host->scan(k, view_of(fan, host_views[k]), pattern, thread, {to, met, own.grazes.data()});
  put(row, to, met, grazes ? own.grazes.data() : nullptr);
}

/// Scans all beams of a shared view and gives each fan its own.
void Casts::Tables::scan_shared(std::size_t k, unsigned thread) {
  const SharedView& shared = shares.views()[scans[k].shared];
  const SharedPattern& all = shares.pattern(shared);
  const std::size_t beams = all.sources.size();
  Scratch& own = scratch[thread];
  own.make_room(2 * beams);
  ScanView view = view_of(fans[shared.first], host_views[k]);
  for (std::size_t b = 0; b < beams; ++b) {
    const SharedPattern::Source& s = all.sources[b];
    view.heading = views[scans[k].due + s.fan].heading;
    const glm::dvec2 d = direction_of(view, patterns[fan_rows[shared.first + s.fan].pattern], s.beam);
    own.x[b] = d.x, own.y[b] = d.y;
  }
  view.heading = host_views[k].heading;
  view.x = own.x.data(), view.y = own.y.data();
  const bool grazes = host->scan(k, view, all.beams, thread, {own.ranges.data(), own.models.data(), own.grazes.data()});
  for (std::size_t b = 0; b < beams; ++b) {
    const std::size_t place = beams + all.sources[b].place;
    own.ranges[place] = own.ranges[b], own.models[place] = own.models[b], own.grazes[place] = own.grazes[b];
  }
  std::size_t at = beams;
  for (std::uint32_t f = 0; f < shared.fans; ++f) {
    const FanRow& row = fan_rows[shared.first + f];
    put(row, &own.ranges[at], &own.models[at], grazes ? &own.grazes[at] : nullptr);
    at += row.plan.samples.size();
  }
}

/// Fans that the host casts: all, or those around which more is than the device's lists hold.
void Casts::Tables::find_for_host() {
  for_host.clear();
  for (std::uint32_t i = 0; !scene && i < due.size(); ++i) for_host.push_back(i);
  if (!scene) return;
  const auto ray_rows = rows->host<RayRow>();
  for (std::uint32_t i = 0; i < due.size(); ++i) {
    if (!scene->is_for_host(i)) continue;
    for_host.push_back(i);
    ray_rows[i].out = out_lanes;
  }
  host_scans += for_host.size();
}

void Casts::Tables::bind(CastPass& pass) {
  gpu::Buffer* const results[] = {ranges.get(), hits.get(), verdicts.get()};
  gpu::Buffer* const tables[] = {rows.get(),       pass.lanes.get(), middles.get(),    directions64.get(),
                                 &scene->lists(),  &scene->names(),  &scene->places(), &scene->segments(),
                                 &scene->models(), results[0],       results[1],       results[2],
                                 results[0],       results[1],       results[2]};
  pass.kernel->bind(tables);
}

void Casts::Tables::bind() {
  if (scene) bind(exact);
  if (scene && single) bind(*single);
  bound = true;
}

}  // namespace sf::raycast
