#include "sensors/laser_tables.h"

#include <algorithm>

#include "base/random.h"

namespace sf::sensors {

namespace {

/// Groups along x of a dispatch; more rows of groups follow along y. Devices promise 65 535.
constexpr std::uint32_t kGroupsAcross = 32'768;

}  // namespace

void Lasers::Tables::plan(const world::World& world) {
  std::size_t samples = 0;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    const world::Mover& mover = world.movers[m];
    std::size_t beams = 0;
    for (const world::Laser& laser : mover.lasers) beams += laser.samples / laser.resolution;
    for (std::uint32_t i = 0; i < mover.lasers.size(); ++i) {
      LaserRow row;
      row.laser = mover.lasers[i];
      row.plan = plan_beams(row.laser, options.noise);
      row.height = mover.X_WM.z + row.laser.X_MS.z;
      const double turn = options.noise ? kMostSigmas * row.laser.noise.angle_sigma : 0.0;
      row.family = scene.add_family({row.height, row.laser.range_max, row.plan.spread, row.laser.fov + 2.0 * turn,
                                     static_cast<std::uint32_t>(std::min<std::size_t>(beams, 1'000'000))});
      row.turns = options.noise && row.laser.noise.angle_sigma > 0.0;
      row.shaped = row.laser.resolution > 1 || !row.plan.packed || (options.noise && has_range_noise(row.laser.noise));
      row.out = out_lanes;
      row.values = samples;
      out_lanes += row.plan.lanes();
      if (row.shaped) samples += row.laser.samples;
      owners.push_back({m, i});
      lasers.push_back(std::move(row));
    }
  }
  values.resize(samples);
  met.resize(samples);
}

void Lasers::Tables::make_tables(gpu::Device& device, std::uint32_t beam_lanes) {
  using gpu::Role;
  using gpu::Texel;
  const std::size_t group = kernel->group_size();
  const std::size_t count = std::max<std::size_t>(1, lasers.size());
  // Lanes are padded to whole groups, and groups to whole rows of groups where there are many.
  const std::size_t most_groups = out_lanes / group + 1;
  const std::size_t padded = (most_groups > kGroupsAcross ? most_groups + kGroupsAcross : most_groups) * group;
  rows = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32x4, SF_ROW_TEXELS * count);
  lanes = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32, 2 * padded);
  groups = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32, 4);
  directions = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::f32x4, 2 * std::size_t{beam_lanes} + 2);
  middles = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::f32, std::size_t{beam_lanes} + 1);
  directions64 = std::make_unique<gpu::Buffer>(device, Role::upload, Texel::u32x4, 4 * std::size_t{beam_lanes} + 4);
  ranges = std::make_unique<gpu::Buffer>(device, Role::download, Texel::u32x4, 2 * std::size_t{out_lanes} + 2);
  hits = std::make_unique<gpu::Buffer>(device, Role::download, Texel::u32x4, std::size_t{out_lanes} + 1);
  doubts = std::make_unique<gpu::Buffer>(device, Role::download, Texel::u32, std::size_t{out_lanes} + 1);
}

void Lasers::Tables::write_all_beams() {
  // Tables were given out in order of rows: one that lies behind all written so far is new, others are shared.
  std::uint32_t written = 0;
  for (const LaserRow& row : lasers) {
    if (row.beams < written) continue;
    write_beams(row.laser, row.plan, {}, beam_tables(row.beams));
    written += row.plan.lanes();
  }
}

void Lasers::Tables::turn_beams(const LaserDue& d, unsigned thread) {
  const LaserRow& row = lasers[d.row];
  std::vector<double>& turns = turned[thread];
  turns.resize(row.plan.samples.size());
  const base::Draw draw{options.seed, base::Stream::angle_noise, owners[d.row].mover, owners[d.row].sensor, d.sequence};
  for (std::size_t k = 0; k < turns.size(); ++k) {
    const double normal = base::random_normal(draw, row.plan.samples[k])[0];
    turns[k] = row.laser.noise.angle_sigma * std::clamp(normal, -kMostSigmas, kMostSigmas);
  }
  write_beams(row.laser, row.plan, turns, beam_tables(row.beams));
}

void Lasers::Tables::write_lanes() {
  const bool same = lanes_written.size() == due.size() &&
                    std::equal(due.begin(), due.end(), lanes_written.begin(),
                               [](const LaserDue& d, std::uint32_t row) { return d.row == row; });
  if (same) return;
  lanes_written.clear();
  const auto table = lanes->host<Lane>();
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < due.size(); ++i) {
    for (std::uint32_t lane = 0; lane < lasers[due[i].row].plan.lanes(); ++lane) table[at++] = {i, lane};
    lanes_written.push_back(due[i].row);
  }
  const auto due_lanes = static_cast<std::uint32_t>(at);
  const std::uint32_t group = kernel->group_size();
  const std::uint32_t needed = (due_lanes + group - 1) / group;
  const std::uint32_t across = std::min(needed, kGroupsAcross);
  const std::uint32_t down = across > 0 ? (needed + across - 1) / across : 0;
  // Padding repeats the last lane, which then is written more than once with the same values.
  const Lane last = at > 0 ? table[at - 1] : Lane{0, 0};
  std::fill(table.begin() + static_cast<std::ptrdiff_t>(at), table.begin() + std::ptrdiff_t{across} * down * group,
            last);
  const auto counts = groups->host<std::uint32_t>();
  counts[0] = across;
  counts[1] = down;
  counts[2] = across > 0 ? 1 : 0;
}

void Lasers::Tables::bind() {
  gpu::Buffer* const tables[] = {rows.get(),         lanes.get(),       directions.get(), middles.get(),
                                 directions64.get(), &scene.headers(),  &scene.entries(), &scene.ids(),
                                 &scene.nearest(),   &scene.segments(), &scene.models(),  ranges.get(),
                                 hits.get(),         doubts.get()};
  kernel->bind(tables);
  bound = true;
}

}  // namespace sf::sensors
