#include "tests/selftest/scene_notes.h"

#include <fmt/format.h>

#include "base/hash.h"
#include "farm/farm.h"
#include "sensors/magnetic_field/sampling.h"

// Names of the farm's constructor, its tick and sample_field in object files.
#define SF_FARM "_ZN2sf4farm4FarmC1ERKNS_5world5WorldERNS_3gpu6DeviceERKNS0_11FarmOptionsE"
#define SF_TICK "_ZN2sf4farm4Farm4tickElSt4spanIKNS_4base6ReportELm18446744073709551615EE"
#define SF_FIELD                                                                                              \
  "_ZN2sf7sensors12sample_fieldERKNS_5world5WorldERNS_3gpu6DeviceESt4spanIKNS0_10FieldPointELm18446744073709" \
  "551615EERKNS0_18FieldSampleOptionsE"

namespace sf::selftest {

using farm::Farm;
using Readings = std::span<const base::ReadingBlock>;
using Reports = std::span<const base::Report>;
using Points = std::span<const sensors::FieldPoint>;
using Sums = std::vector<sensors::FieldSum>;

// Weak: the linker makes the former names only where it leads the calls.
[[gnu::weak]] void make_farm(Farm*, const world::World&, gpu::Device&, const farm::FarmOptions&) asm("__real_" SF_FARM);
[[gnu::weak]] Readings tick(Farm*, std::int64_t, Reports) asm("__real_" SF_TICK);
[[gnu::weak]] Sums sample(const world::World&, gpu::Device&, Points,
                          const sensors::FieldSampleOptions&) asm("__real_" SF_FIELD);
void note_farm(Farm*, const world::World&, gpu::Device&, const farm::FarmOptions&) asm("__wrap_" SF_FARM);
Readings note_tick(Farm*, std::int64_t, Reports) asm("__wrap_" SF_TICK);
Sums note_sample(const world::World&, gpu::Device&, Points, const sensors::FieldSampleOptions&) asm("__wrap_" SF_FIELD);

namespace {

struct Scenes {
  std::size_t farms = 0, ticks = 0, reports = 0, points = 0;
  std::size_t walls = 0, magnets = 0, markings = 0, movers = 0, sensors = 0;  ///< of all worlds
  std::uint64_t hash = 0;

  template <class... T>
  void add(T... values) {
    ((hash = base::hash_bytes(&values, sizeof values, hash)), ...);
  }
  void add_world(world::World world) {
    world::update_extent_and_hash(world);
    add(world.hash);
    walls += world.walls.size();
    magnets += world.magnets.size();
    markings += world.lane_markings.size();
    movers += world.movers.size();
    for (const world::Mover& mover : world.movers) sensors += mover.sensors.size();
  }
};

Scenes scenes;

}  // namespace

void note_farm(Farm* farm, const world::World& world, gpu::Device& device, const farm::FarmOptions& options) {
  ++scenes.farms;
  scenes.add_world(world);
  scenes.add(options.seed, options.noise);
  make_farm(farm, world, device, options);
}

Readings note_tick(Farm* farm, std::int64_t now, Reports reports) {
  ++scenes.ticks;
  scenes.reports += reports.size();
  scenes.add(now);
  for (const base::Report& r : reports) scenes.add(r.mover, r.time, r.X_WM.x, r.X_WM.y, r.X_WM.z, r.X_WM.yaw);
  return tick(farm, now, reports);
}

Sums note_sample(const world::World& world, gpu::Device& device, Points points,
                 const sensors::FieldSampleOptions& options) {
  scenes.points += points.size();
  scenes.add_world(world);
  for (const sensors::FieldPoint& p : points) scenes.add(p.x, p.y, p.z);
  return sample(world, device, points, options);
}

void forget_scenes() { scenes = {}; }

std::string measured_scenes() {
  const Scenes& s = scenes;
  std::string text;
  for (const auto& [count, what] : {std::pair{s.walls, "walls"},
                                    {s.magnets, "magnets"},
                                    {s.markings, "markings"},
                                    {s.movers, "movers"},
                                    {s.sensors, "sensors"},
                                    {s.farms, "farms"},
                                    {s.ticks, "ticks"},
                                    {s.reports, "reports"},
                                    {s.points, "points"}})
    if (count > 0) text += fmt::format("{} {}, ", count, what);
  return text + "hash " + base::hash_hex(s.hash);
}

}  // namespace sf::selftest
