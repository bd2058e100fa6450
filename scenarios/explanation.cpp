#include "scenarios/explanation.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <utility>

#include "base/elapsed.h"
#include "base/time.h"
#include "farm/farm.h"
#include "raycast/casters.h"
#include "scenarios/recorded_paths.h"
#include "sensors/derived/wiring.h"

namespace sf::scenarios {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kDriven = 2.0;  ///< [s] simulated
constexpr int kLaps = 4;         ///< measured, after one warm-up lap

/// Drives a farm along recorded paths repeatedly. Time continues from lap to lap.
class Drive {
 public:
  Drive(const world::World& world, gpu::Device& device, RecordedPaths paths, const farm::FarmOptions& options)
      : farm_(world, device, options), paths_(std::move(paths)), interval_(base::nanoseconds(world.interval)) {}

  void subscribe(base::SensorTypes types) {
    for (std::uint32_t m = 0; m < paths_[0].size(); ++m) farm_.subscribe(m, types);
  }
  void tick(std::size_t at) {
    for (base::Report& state : paths_[at]) state.time = now_;
    for (std::int64_t due = farm_.next_due(); due < now_; due = farm_.next_due()) farm_.sample_between(due, paths_[at]);
    farm_.tick(now_, paths_[at]);
    now_ += interval_;
  }
  /// [s] Returns the mean time of a tick over all laps except the first.
  double laps() {
    for (std::size_t at = 0; at < paths_.size(); ++at) tick(at);
    stats_before_ = farm_.stats();
    const auto start = Clock::now();
    for (int lap = 0; lap < kLaps; ++lap)
      for (std::size_t at = 0; at < paths_.size(); ++at) tick(at);
    return base::seconds_since(start) / static_cast<double>(ticks());
  }
  std::uint64_t ticks() const { return kLaps * paths_.size(); }
  double readings() const { return a_tick(farm_.stats().readings - stats_before_.readings); }
  double again() const { return a_tick(farm_.stats().reused - stats_before_.reused); }
  sensors::SensorStats work() const { return farm_.stats().work - stats_before_.work; }
  const sensors::SensorSet& sensor_set() const { return farm_.sensor_set(); }

 private:
  double a_tick(std::uint64_t count) const { return static_cast<double>(count) / static_cast<double>(ticks()); }

  farm::Farm farm_;
  RecordedPaths paths_;  ///< at the times of the newest lap
  std::int64_t interval_;
  std::int64_t now_ = 0;
  farm::FarmStats stats_before_;
};

SensorTypeCost facts_of(const sensors::SensorSet::Group& group) {
  SensorTypeCost cost;
  cost.type = group.type->name;
  cost.sensors = static_cast<std::uint32_t>(group.rows.size());
  cost.least_rate = HUGE_VAL;
  std::set<std::uint32_t> carriers;
  for (const sensors::SensorSpec& row : group.rows) {
    carriers.insert(row.mover);
    cost.least_rate = std::min(cost.least_rate, row.rate);
    cost.most_rate = std::max(cost.most_rate, row.rate);
  }
  cost.robots = static_cast<std::uint32_t>(carriers.size());
  return cost;
}

void add_held(const std::vector<gpu::DeviceAllocation>& held, SensorTypeCost& cost) {
  for (const gpu::DeviceAllocation& h : held) {
    if (h.owner != cost.type) continue;
    if (h.is_kernel) {
      cost.kernels.push_back(h.name);
      continue;
    }
    cost.tables.push_back(h);
    cost.bytes += h.bytes;
  }
  std::stable_sort(cost.tables.begin(), cost.tables.end(),
                   [](const gpu::DeviceAllocation& a, const gpu::DeviceAllocation& b) { return a.bytes > b.bytes; });
}

std::vector<WallSlice> slices_of(const world::World& world, const sensors::SensorSet& sensor_set) {
  std::map<double, std::uint32_t> heights;
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    for (const sensors::SensorSpec& row : group.rows)
      if (group.type->is_scan && world.terrain.empty()) ++heights[world.movers[row.mover].X_WM.z + row.X_MS.z];
  std::vector<WallSlice> slices;
  for (const auto& [z, sensors] : heights) {
    const auto seen = std::count_if(world.walls.begin(), world.walls.end(), [z = z](const world::Segment& s) {
      return s.seen_by_laser && s.z_min <= z && z < s.z_max;
    });
    slices.push_back({z, sensors, static_cast<std::size_t>(seen)});
  }
  return slices;
}

std::size_t resident_bytes() {
  std::size_t size = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> size >> resident;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

namespace {

std::vector<std::string> input_types(std::span<const sensors::DerivedNode> wired, const sensors::SensorType* type) {
  std::set<std::string> names;
  for (const sensors::DerivedNode& node : wired)
    for (const sensors::WiredInput& input : node.inputs)
      if (node.type == type) names.emplace(sensors::input_type(input.type).name);
  return {names.begin(), names.end()};
}

}  // namespace

Explanation explain(const world::World& world, gpu::Device& device, std::uint64_t seed, unsigned threads,
                    const std::function<void(double)>& progress) {
  Explanation e;
  e.caster = raycast::describe_caster(device.info().software);
  double done = 0.0;
  const auto step = [&](std::size_t types) {
    if (progress) progress(++done / static_cast<double>(types + 3));
  };
  RecordedPaths paths = record_paths(world, device, kDriven, seed, threads);
  const auto start = Clock::now();
  Drive farm(world, device, std::move(paths), {.seed = seed, .threads = threads});
  e.build = base::seconds_since(start);
  farm.subscribe(farm::kAllSensorTypes);
  const auto first = Clock::now();
  farm.tick(0);
  e.first = base::seconds_since(first);

  farm.subscribe(0);
  const std::size_t types = farm.sensor_set().groups().size();
  const std::vector<sensors::DerivedNode> wired = sensors::wire(world, farm.sensor_set());
  step(types);
  e.silent = farm.laps();
  step(types);
  std::set<std::string_view> present;
  for (const sensors::SensorSet::Group& group : farm.sensor_set().groups()) {
    present.insert(group.type->name);
    SensorTypeCost cost = facts_of(group);
    const sensors::SensorType* const source = sensors::find_sensor_type(group.type->derived_from);
    if (source != nullptr) cost.source = source->name;
    cost.inputs = input_types(wired, group.type);
    farm.subscribe(base::only(group.type->id) | (source != nullptr ? base::only(source->id) : 0u));
    cost.tick = farm.laps();
    cost.readings = farm.readings();
    cost.reused = farm.again();
    cost.work = farm.work();
    e.types.push_back(std::move(cost));
    step(types);
  }
  farm.subscribe(farm::kAllSensorTypes);
  e.all = farm.laps();
  e.ticks = farm.ticks();
  for (SensorTypeCost& cost : e.types) add_held(device.allocations(), cost);
  for (const sensors::SensorType* type : sensors::sensor_types())
    if (!present.contains(type->name)) e.absent.emplace_back(type->name);
  e.slices = slices_of(world, farm.sensor_set());
  e.statements = sensors::accuracy_statements(world, farm.sensor_set());
  e.walls = world.walls.size();
  e.resident = resident_bytes();
  return e;
}

}  // namespace sf::scenarios
