#include "scenarios/link_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/elementary.h"
#include "base/random.h"
#include "base/time.h"
#include "robots/estimation/link_speed.h"
#include "scenarios/simulation.h"
#include "sensors/link_speed.h"
#include "sensors/road_links.h"
#include "sensors/sensor_type.h"
#include "world/stage/build_world.h"

namespace sf::scenarios {

namespace {

// --- The corridor: full size, one lane.

constexpr double kRoad = 2000.0, kLinkLength = 500.0;  // [m]
constexpr std::uint32_t kCorridorCars = 60;
constexpr double kCorridorWarmUp = 300.0;                       // [s]
constexpr double kSignalPlaces[] = {700.0, 1450.0};             // [m] stop lines
constexpr double kCycle = 90.0;                                 // [s]
constexpr double kCarLength = 4.5, kHeadway = 1.4, kGap = 2.0;  // [m], [s], [m]
constexpr double kAcceleration = 1.2, kBraking = 1.8;           // [m/s^2]

/// Returns the share of green of the signals at a time: demand is high in the middle of the run, so queues grow.
double green_share(double time) { return time > 1200.0 && time < 2400.0 ? 0.4 : 0.6; }

/// Treiber, Hennecke and Helbing, Congested traffic states in empirical observations and microscopic simulations, 2000.
double intelligent_driver(double speed, double free_speed, double gap, double ahead_speed) {
  const double wanted = kGap + std::max(0.0, speed * kHeadway + speed * (speed - ahead_speed) /
                                                                    (2.0 * std::sqrt(kAcceleration * kBraking)));
  const double pace = speed / free_speed, squeeze = wanted / std::max(gap, 0.1);
  return kAcceleration * (1.0 - pace * pace * pace * pace - squeeze * squeeze);
}

world::Setting numbers(const std::string& key, std::vector<double> values) {
  return {key, std::move(values), "", 0, ""};
}
world::Setting words(const std::string& key, const std::string& words) { return {key, {}, words, 0, ""}; }

world::Sensor sensor_of(const std::string& type, const std::string& name, std::vector<world::Setting> settings) {
  world::Sensor sensor{.type = type, .name = name, .settings = std::move(settings), .file = "experiment links"};
  return sensor;
}

/// Uniform in (0, 1), in sequence.
class LinkChance {
 public:
  explicit LinkChance(std::uint64_t seed) : seed_(seed) {}
  double next() { return base::random_uniform({seed_, base::RandomStream::placement, 4242, 0, count_++}, 0)[0]; }

 private:
  std::uint64_t seed_;
  std::uint64_t count_ = 0;
};

/// The vehicles in random order: the first are the probes.
std::vector<std::uint32_t> shuffled(std::vector<std::uint32_t> rows, std::uint64_t seed) {
  LinkChance chance(seed);
  for (std::size_t k = rows.size(); k > 1; --k)
    std::swap(rows[k - 1], rows[std::min(k - 1, static_cast<std::size_t>(chance.next() * static_cast<double>(k)))]);
  return rows;
}

/// Adds one link-speed sensor per set to `centre`. @param vehicles in the order of `shuffled` @param report the probes'
/// sensor @param loops of `centre`
void add_estimates(world::World& world, std::uint32_t centre, const std::vector<std::uint32_t>& vehicles,
                   const std::string& report, std::size_t loops, const std::vector<world::Setting>& settings) {
  for (const LinkSet& set : kLinkSets) {
    std::vector<std::string> inputs;
    for (std::size_t n = 0; set.loops && n < loops; ++n) inputs.push_back(fmt::format("loop:{}", n));
    for (std::size_t k = 0; k < probes_of(set, vehicles.size()); ++k)
      inputs.push_back(world.movers[vehicles[k]].name + "/" + report);
    std::vector<world::Setting> all = settings;
    all.push_back(words("inputs", fmt::format("{}", fmt::join(inputs, "\n"))));
    world.movers[centre].sensors.push_back(
        sensor_of("link-speed", fmt::format("{} {}", set.percent, set.loops), std::move(all)));
  }
}

/// Adds a loop to the middle of each link. @return how many
std::size_t add_loops(world::World& world, std::uint32_t centre, const sensors::RoadLinks& links,
                      std::vector<double> size, double rate) {
  for (const sensors::RoadLink& link : links.links()) {
    const double middle = 0.5 * link.length();
    const auto k = static_cast<std::size_t>(std::ranges::upper_bound(link.s, middle) - link.s.begin());
    const glm::dvec2 a = link.points[k - 1], along = glm::normalize(link.points[k] - a);
    const glm::dvec2 p = a + (middle - link.s[k - 1]) * along;
    const base::Pose X_WL{p.x, p.y, 0.0, base::atan2(along.y, along.x)};
    world::Sensor loop = sensor_of("loop", "loop " + link.name, {numbers("size", size), numbers("rate", {rate})});
    loop.X_MS = base::compose(base::inverse(world.movers[centre].X_WM), X_WL);
    world.movers[centre].sensors.push_back(std::move(loop));
  }
  return links.links().size();
}

/// Truth and estimates of one run.
class LinkCells {
 public:
  LinkCells(const LinkPlan& plan, sensors::RoadLinks links, std::vector<std::uint32_t> vehicles, std::uint32_t centre,
            std::uint64_t seed, double from)
      : plan_(plan),
        links_(std::move(links)),
        vehicles_(std::move(vehicles)),
        centre_(centre),
        seed_(seed),
        from_(from),
        places_(vehicles_.size()),
        totals_(links_.links().size()) {
    for (const sensors::RoadLink& link : links_.links()) run_.links.push_back(link.name);
    run_.vehicles = vehicles_.size();
  }

  void add(const base::TickRecord& tick) {
    for (std::size_t k = 0; k < vehicles_.size(); ++k) add_vehicle(k, tick);
    last_ = tick.time;
    LinkCell* const first = end_interval(tick);
    if (first == nullptr) return;
    for (const base::ReadingBlock& r : tick.readings) {
      if (r.mover != centre_ || r.type != sensors::kLinkSpeed || r.time != tick.time) continue;
      for (std::size_t link = 0; link < totals_.size(); ++link) {
        const double* const row = r.values.data() + sensors::kLinkSpeedNumbers * link;
        first[link].speeds[r.sensor] = row[0], first[link].variances[r.sensor] = row[3];
      }
    }
  }
  LinkRun run() && { return std::move(run_); }

 private:
  void add_vehicle(std::size_t k, const base::TickRecord& tick) {
    const base::Report& state = tick.reports[vehicles_[k]];
    std::optional<sensors::LinkPlace> place;
    if (!base::is_absent(state.X_WM)) place = links_.find({state.X_WM.x, state.X_WM.y}, state.X_WM.yaw);
    const std::optional<sensors::LinkPlace> before = std::exchange(places_[k], place);
    if (!place || !before || place->link != before->link) return;
    estimation::ProbeTravel& total = totals_[place->link];
    total.metres += links_.driven(place->link, before->s, place->s);
    total.seconds += 1e-9 * static_cast<double>(tick.time - last_);
  }

  /// Returns the cells of the interval that ends now; null if none does.
  LinkCell* end_interval(const base::TickRecord& tick) {
    const double time = 1e-9 * static_cast<double>(tick.time), intervals = time / plan_.interval;
    if (tick.time == 0 || std::abs(intervals - std::round(intervals)) > 1e-6) return nullptr;
    const std::size_t first = run_.cells.size();
    for (std::uint32_t link = 0; link < totals_.size(); ++link) {
      const estimation::ProbeTravel total = std::exchange(totals_[link], {});
      if (time <= from_) continue;
      LinkCell& cell =
          run_.cells.emplace_back(LinkCell{seed_, link, static_cast<std::uint32_t>(std::lround(intervals))});
      if (total.seconds >= plan_.least_time) cell.truth = total.metres / total.seconds;
      cell.speeds.fill(NAN), cell.variances.fill(NAN);
    }
    return first == run_.cells.size() ? nullptr : &run_.cells[first];
  }

  const LinkPlan& plan_;
  sensors::RoadLinks links_;
  std::vector<std::uint32_t> vehicles_;
  std::uint32_t centre_;
  std::uint64_t seed_;
  double from_;                                            ///< [s] end of the warm-up
  std::vector<std::optional<sensors::LinkPlace>> places_;  ///< per vehicle, at the last tick
  std::vector<estimation::ProbeTravel> totals_;            ///< per link, in this interval
  std::int64_t last_ = 0;                                  ///< [ns] of the last tick
  LinkRun run_;
};

/// Cars on the straight road. They enter at its start, leave at its end, and enter again.
class CorridorTraffic {
 public:
  CorridorTraffic(Simulation& simulation, std::vector<std::uint32_t> cars, std::size_t movers, std::uint64_t seed)
      : simulation_(simulation), cars_(std::move(cars)), commands_(movers) {
    LinkChance chance(seed + 7);
    for (std::size_t k = 0; k < cars_.size(); ++k) {
      free_speeds_.push_back(13.9 + 2.4 * (chance.next() + chance.next() - 1.0));
      simulation_.set_absent(cars_[k], true);
      waiting_.push_back(k);
    }
  }

  /// Decides the speeds until the next tick, `step` [s] later.
  void drive(const base::TickRecord& tick, double step) {
    const double time = 1e-9 * static_cast<double>(tick.time);
    for (std::size_t i = 0; i < driving_.size(); ++i) {
      const std::size_t k = driving_[i];
      const double front = tick.reports[cars_[k]].X_WM.x + 0.5 * kCarLength;
      double& speed = commands_[cars_[k]].forward;
      double wanted = intelligent_driver(speed, free_speeds_[k], HUGE_VAL, speed);
      if (i > 0) {  // the one ahead has moved already in this loop; its place is that of the tick
        const std::uint32_t ahead = cars_[driving_[i - 1]];
        const double gap = tick.reports[ahead].X_WM.x - 0.5 * kCarLength - front;
        wanted = intelligent_driver(speed, free_speeds_[k], gap, commands_[ahead].forward);
      }
      for (const double line : kSignalPlaces) {
        const bool green = std::fmod(time, kCycle) < green_share(time) * kCycle;
        const double way = line - front;
        if (green || way < 0.0 || speed * speed > 2.0 * 3.0 * way) continue;  // or it cannot stop any more
        wanted = std::min(wanted, intelligent_driver(speed, free_speeds_[k], way + kGap, 0.0));
      }
      speed = std::max(0.0, speed + step * std::max(wanted, -8.0));
    }
    if (!driving_.empty() && tick.reports[cars_[driving_.front()]].X_WM.x > kRoad) leave();
    const double last = driving_.empty() ? HUGE_VAL : tick.reports[cars_[driving_.back()]].X_WM.x;
    if (!waiting_.empty() && time - entered_ >= 3.0 && last > 20.0) enter(time);
    simulation_.command(commands_);
  }

 private:
  void leave() {
    simulation_.set_absent(cars_[driving_.front()], true);
    waiting_.push_back(driving_.front());
    driving_.erase(driving_.begin());
  }
  void enter(double time) {
    const std::size_t k = waiting_.front();
    waiting_.erase(waiting_.begin());
    simulation_.set_absent(cars_[k], false);
    simulation_.put(cars_[k], {0.0, 0.0, 0.0, 0.0});
    commands_[cars_[k]].forward = 10.0;
    driving_.push_back(k);
    entered_ = time;
  }

  Simulation& simulation_;
  std::vector<std::uint32_t> cars_;
  std::vector<base::Twist> commands_;  ///< per mover
  std::vector<double> free_speeds_;    ///< [m/s] per car
  std::vector<std::size_t> driving_;   ///< cars, the first one ahead
  std::vector<std::size_t> waiting_;
  double entered_ = -HUGE_VAL;  ///< [s] when the last car entered
};

world::World corridor_world() {
  std::string text =
      "define car position( size [4.5 1.8 1.5] velocity_bounds [-40 40 0 0 0 0 -90 90] gps( noise 3 rate 0.1 ) )\n"
      "position( name \"centre\" size [0.2 0.2 1] pose [0 30 0 0] ctrl \"none\" )\n";
  for (std::uint32_t k = 0; k < kCorridorCars; ++k)
    text += fmt::format("car( name \"car{}\" pose [{} 60 0 0] )\n", k, -10.0 * k);
  world::World world = world::build_world("corridor.world", text, {.sensors = sensors::world_file_words()});
  world.interval = 0.2;
  return world;
}

std::vector<world::Setting> corridor_settings(const LinkPlan& plan) {
  std::vector<world::Setting> settings{numbers("links", {kRoad / kLinkLength}),
                                       numbers("reach", {15.0}),
                                       numbers("spread", {3.0}),
                                       numbers("correlation", {30.0}),
                                       numbers("drift", {0.25}),
                                       numbers("spot", {3.0}),
                                       numbers("rate", {1.0 / plan.interval}),
                                       numbers("hold", {2.0 * plan.interval})};
  for (int i = 0; i * kLinkLength < kRoad; ++i)
    settings.push_back(numbers(fmt::format("link[{}]", i), {i * kLinkLength, 0, (i + 1) * kLinkLength, 0}));
  return settings;
}

std::vector<world::Setting> town_settings(const LinkPlan& plan) {
  return {words("lanes", "all"),
          numbers("spread", {0.08}),
          numbers("correlation", {10.0}),
          numbers("drift", {0.012}),
          numbers("spot", {0.08}),
          numbers("rate", {1.0 / plan.interval}),
          numbers("hold", {2.0 * plan.interval})};
}

/// Leaves the cars what probes report from.
void fit_probe(world::Mover& mover) {
  std::erase_if(mover.sensors, [](const world::Sensor& sensor) {
    return sensor.type != "encoder" && sensor.type != "gyro" && sensor.type != "gps";
  });
  mover.sensors.push_back(
      sensor_of("localization", "probe", {words("inputs", "encoder\ngyro\ngps"), numbers("rate", {2.0})}));
}

}  // namespace

std::size_t probes_of(const LinkSet& set, std::size_t vehicles) {
  if (set.percent == 0) return 0;
  return std::max<std::size_t>(1, (vehicles * static_cast<std::size_t>(set.percent) + 50) / 100);
}

LinkPlan corridor_plan() { return {"corridor", 60.0, 7.0 / 3.6, 20.0}; }
LinkPlan town_plan() { return {"SimVille", 30.0, 7.0 / 3.6 / 7.0, 5.0}; }

LinkRun run_corridor(const ExperimentContext& context, std::uint64_t seed, double duration) {
  const LinkPlan plan = corridor_plan();
  world::World world = corridor_world();
  const std::vector<world::Setting> settings = corridor_settings(plan);
  std::vector<std::uint32_t> cars(kCorridorCars);
  std::iota(cars.begin(), cars.end(), 1u);
  const sensors::RoadLinks links = sensors::read_road_links(world, sensor_of("link-speed", "truth", settings));
  const std::size_t loops = add_loops(world, 0, links, {2.0, 2.0}, 1.0 / plan.interval);
  add_estimates(world, 0, shuffled(cars, seed), "gps", loops, settings);
  Simulation simulation(world, context.device,
                        {.seed = seed, .threads = context.options.threads, .actor = {.controller = {.name = ""}}});
  CorridorTraffic traffic(simulation, cars, world.movers.size(), seed);
  LinkCells cells(plan, links, cars, 0, seed, kCorridorWarmUp);
  for (double time = 0.0; time < duration - 1e-6;) {
    if (context.options.stop && context.options.stop()) throw Interrupted();
    const base::TickRecord tick = simulation.step();
    time = 1e-9 * static_cast<double>(tick.time);
    cells.add(tick);
    traffic.drive(tick, world.interval);
  }
  return std::move(cells).run();
}

LinkRun run_town_links(const ExperimentContext& context, std::uint64_t seed) {
  const LinkPlan plan = town_plan();
  Scenario scenario = context.scenario;
  scenario.seed = seed;
  world::World world = world_of(scenario);
  std::vector<std::uint32_t> cars;
  std::uint32_t centre = 0;
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
    if (world.movers[row].name == "khepera6") centre = row;
    if (world.movers[row].name.starts_with("khepera")) continue;
    cars.push_back(row);
    fit_probe(world.movers[row]);
  }
  const std::vector<world::Setting> settings = town_settings(plan);
  const sensors::RoadLinks links = sensors::read_road_links(world, sensor_of("link-speed", "truth", settings));
  const std::size_t loops = add_loops(world, centre, links, {0.3, 0.4}, 1.0 / plan.interval);
  add_estimates(world, centre, shuffled(cars, seed), "localization", loops, settings);
  SimulationOptions options = simulation_of(scenario, world);
  options.threads = context.options.threads;
  Simulation simulation(world, context.device, std::move(options));
  LinkCells cells(plan, links, cars, centre, seed, 2.0 * plan.interval);
  for (double time = 0.0; time < scenario.duration - 1e-6;) {
    if (context.options.stop && context.options.stop()) throw Interrupted();
    const base::TickRecord tick = simulation.step();
    time = 1e-9 * static_cast<double>(tick.time);
    cells.add(tick);
  }
  return std::move(cells).run();
}

}  // namespace sf::scenarios
