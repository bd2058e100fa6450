#include "tests/sensors/laneedge_trial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "raycast/casters.h"
#include "robots/fleet.h"
#include "sensors/laneedge_settings.h"
#include "tests/sensors/compare.h"

namespace sf::trial {

world::Sensor edge_sensor(const Settings& settings, const base::Pose& X_MS) {
  world::Sensor sensor;
  sensor.type = "laneedge";
  sensor.name = "edge";
  sensor.X_MS = X_MS;
  sensor.radians_per_unit = M_PI / 180.0;
  sensor.line = 7;
  sensor.file = "hand.world";
  int line = 8;
  for (const auto& [key, numbers] : settings) sensor.settings.push_back({key, numbers, "", line++, sensor.file});
  return sensor;
}

std::uint32_t add_edge_eye(world::World& world, const base::Pose& X_WM, Settings settings) {
  world::Mover mover;
  mover.id = static_cast<std::uint32_t>(world.movers.size());
  mover.name = "eye" + std::to_string(mover.id);
  mover.X_WM = X_WM;
  mover.sensors.push_back(edge_sensor(settings));
  world.movers.push_back(mover);
  return mover.id;
}

world::LaneMarking marking(glm::dvec2 from, glm::dvec2 to, double width) { return {{from, to}, width}; }

void add_dashes(world::World& world, glm::dvec2 from, glm::dvec2 to, double width, double paint, double gap) {
  const double all = length(to - from);
  const glm::dvec2 along = (1.0 / all) * (to - from);
  for (double at = 0.0; at < all - 1e-6; at += paint + gap)
    world.lane_markings.push_back(marking(from + at * along, from + std::min(at + paint, all) * along, width));
}

world::LaneMarking arc(glm::dvec2 centre, double radius, double from, double to, double width, double sagitta) {
  const double step = std::sqrt(8.0 * sagitta / (radius + width));
  const int pieces = std::max(2, static_cast<int>(std::ceil(std::fabs(to - from) / step)));
  world::LaneMarking s;
  s.width = width;
  for (int i = 0; i <= pieces; ++i) {
    const double a = from + (to - from) * i / pieces;
    s.line.push_back({centre.x + radius * std::cos(a), centre.y + radius * std::sin(a)});
  }
  return s;
}

namespace {

const raycast::CasterType* caster_of(const gpu::Device* on) {
  if (on == nullptr) return nullptr;
  return on->is_host() ? &raycast::host_caster : &raycast::device_caster;
}

}  // namespace

struct EdgeRig::State {
  world::World world;
  base::ThreadPool thread_pool;
  std::vector<base::Report> states;
  sensors::SensorContext context;
  sensors::ParsedSensors sensors;
  std::unique_ptr<sensors::SensorBackend> backend;
  gpu::Batch batch;
  std::vector<base::ReadingBlock> blocks;
  std::unique_ptr<EdgeRig> twin;  ///< on the host, for a raster; null for rigs on a chosen device

  State(const world::World& w, std::uint64_t seed, unsigned threads, bool noise, gpu::Device* on)
      : world(w),
        thread_pool(threads),
        states(robots::states_at_load(world)),
        context{world, on != nullptr ? *on : device(), thread_pool, states, seed, noise,
                true,  {.caster = caster_of(on)}},
        sensors(sensors::laneedge_type.parse(world)),
        backend(sensors::laneedge_type.make(context, sensors)),
        batch(context.device) {
    if (on == nullptr && w.road_resolution > 0.0)
      twin = std::make_unique<EdgeRig>(w, seed, threads, noise, &host_device());
  }
};

EdgeRig::EdgeRig(const world::World& world, std::uint64_t seed, unsigned threads, bool noise, gpu::Device* on)
    : s_(std::make_unique<State>(world, seed, threads, noise, on)) {}

EdgeRig::~EdgeRig() = default;

const std::vector<base::ReadingBlock>& EdgeRig::tick(const std::vector<sensors::DueSample>& due,
                                                     const std::vector<base::Pose>& poses) {
  State& s = *s_;
  for (std::size_t m = 0; m < poses.size(); ++m) s.states[m].X_WM = poses[m];
  s.backend->place_movers();
  if (s.backend->prepare(due)) {
    s.batch.begin();
    s.backend->record_measure(s.batch);
    s.batch.barrier();
    s.backend->record_derive(s.batch);
    s.batch.end();
  }
  if (s.backend->on_device()) {
    s.backend->add_copies(s.batch);
    s.batch.run();
  }
  s.blocks.resize(due.size());
  s.backend->collect(s.blocks);
  return s.blocks;
}

std::vector<sensors::EdgeReading> EdgeRig::read_some(const std::vector<sensors::DueSample>& due,
                                                     const std::vector<base::Pose>& poses) {
  std::vector<sensors::EdgeReading> readings;
  for (const base::ReadingBlock& block : tick(due, poses))
    readings.push_back({block.values[0], block.values[1], block.values[2], block.values[3]});
  return readings;
}

std::vector<sensors::EdgeReading> EdgeRig::read(std::uint64_t sequence, std::vector<base::Pose> poses) {
  if (poses.empty())
    for (const world::Mover& mover : s_->world.movers) poses.push_back(mover.X_WM);
  std::vector<sensors::DueSample> due;
  for (std::uint32_t row = 0; row < s_->sensors.rows.size(); ++row) due.push_back({row, sequence});
  std::vector<sensors::EdgeReading> readings = read_some(due, poses);
  if (s_->twin == nullptr) return readings;
  const auto on_host = s_->twin->read_some(due, poses);
  EXPECT_EQ(std::memcmp(on_host.data(), readings.data(), readings.size() * sizeof readings[0]), 0)
      << "the host's bytes differ";
  return readings;
}

std::vector<sensors::EdgeReading> read_edges(const world::World& world) { return EdgeRig(world).read(); }

}  // namespace sf::trial
