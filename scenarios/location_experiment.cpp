// Locations of cars from cameras, satellites and dead reckoning that come and go: error, availability and consistency
// of each way to choose among them.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "base/elementary.h"
#include "scenarios/experiment.h"
#include "scenarios/simulation.h"
#include "sensors/location.h"
#include "world/stage/build_world.h"

namespace sf::scenarios {

namespace {

constexpr std::uint32_t kLocationSeeds = 10;
constexpr std::array<std::string_view, 4> kLocationChoices{"first", "best", "weighted", "intersection"};
// Values of a reading of a location.
constexpr std::size_t kValidAt = 2, kCovarianceAt = 3, kSourceAt = 6;

/// A time in which the same sensors are available.
struct Phase {
  double from, until;  ///< [s] without the transitions before
  std::string_view available;
};
constexpr Phase kPhases[] = {{10, 60, "camera, gps, odometry"}, {62, 80, "gps, odometry"}, {82, 100, "odometry"},
                             {102, 120, "camera, odometry"},    {122, 140, "all"},         {142, 149, "gps, odometry"},
                             {152, 160, "gyro only"},           {182, 200, "all"}};

/// Results of one choice in one phase.
struct Located {
  std::size_t readings = 0, valid = 0;
  double squares = 0.0, normalized = 0.0, largest = 0.0;
  std::array<std::size_t, 4> sources{};  ///< camera, gps, odometry, several
};
using LocatedTable = std::array<std::array<Located, kLocationChoices.size()>, std::size(kPhases)>;

/// Sensors of a robot with dead reckoning and one location per choice.
std::vector<world::Sensor> location_sensors() {
  std::string text =
      "position( encoder() gyro() gps()\nderived( type \"localization\" inputs [\"encoder\" \"gyro\"] )\n";
  for (const std::string_view choice : kLocationChoices)
    text += fmt::format(
        "derived( type \"location\" inputs [\"camera\" \"gps\" \"localization\"] choose \"{}\" rate 5 )\n", choice);
  world::World world = world::build_world("location.world", text + ")", {.sensors = sensors::world_file_words()});
  std::vector<world::Sensor>& all = world.movers[0].sensors;
  all.erase(all.begin(), all.begin() + 3);
  return all;
}

bool is_located(const world::Mover& mover) { return mover.name.starts_with("roomba"); }

world::World located_world(const Scenario& scenario) {
  world::World world = world_of(scenario);
  const std::vector<world::Sensor> more = location_sensors();
  for (world::Mover& mover : world.movers)
    if (is_located(mover)) mover.sensors.insert(mover.sensors.end(), more.begin(), more.end());
  world::update_extent_and_hash(world);
  return world;
}

void note(const base::ReadingBlock& reading, LocatedTable& table) {
  const double time = 1e-9 * static_cast<double>(reading.time);
  const auto phase = std::ranges::find_if(kPhases, [&](const Phase& p) { return time >= p.from && time < p.until; });
  if (phase == std::end(kPhases)) return;
  Located& located = table[static_cast<std::size_t>(phase - kPhases)][reading.sensor];
  ++located.readings;
  const std::span<const double> v = reading.values;
  if (v[kValidAt] == 0.0) return;
  ++located.valid;
  const double x = v[0] - reading.X_WM.x, y = v[1] - reading.X_WM.y;
  const double xx = v[kCovarianceAt], xy = v[kCovarianceAt + 1], yy = v[kCovarianceAt + 2];
  located.squares += x * x + y * y;
  located.largest = std::max(located.largest, base::hypot(x, y));
  located.normalized += 0.5 * (yy * x * x - 2.0 * xy * x * y + xx * y * y) / (xx * yy - xy * xy);
  ++located.sources[v[kSourceAt] < 0.0 ? 3 : static_cast<std::size_t>(v[kSourceAt])];
}

void run_located(const ExperimentContext& context, std::uint64_t seed, LocatedTable& table) {
  Scenario scenario = context.scenario;
  scenario.seed = seed;
  const world::World world = located_world(scenario);
  SimulationOptions options = simulation_of(scenario, world);
  options.threads = context.options.threads;
  Simulation simulation(world, context.device, std::move(options));
  for (double time = 0.0; time < scenario.duration;) {
    if (context.options.stop && context.options.stop()) throw Interrupted();
    const base::TickRecord tick = simulation.step();
    time = 1e-9 * static_cast<double>(tick.time);
    for (const base::ReadingBlock& reading : tick.readings)
      if (reading.type == sensors::kLocation) note(reading, table);
  }
}

/// @param separator between cells @param line of one phase and choice
std::string location_rows(const LocatedTable& table, bool csv) {
  std::string text;
  for (std::size_t p = 0; p < table.size(); ++p)
    for (std::size_t c = 0; c < kLocationChoices.size(); ++c) {
      const Located& l = table[p][c];
      const auto n = static_cast<double>(l.valid), all = static_cast<double>(std::max<std::size_t>(l.readings, 1));
      const double rms = l.valid == 0 ? NAN : std::sqrt(l.squares / n), nees = l.valid == 0 ? NAN : l.normalized / n;
      const auto share = [&](std::size_t k) { return 100.0 * static_cast<double>(l.sources[k]) / all; };
      text +=
          csv ? fmt::format("{},{},\"{}\",{},{},{},{:.4f},{:.4f},{:.4g},{:.3f},{:.3f},{:.3f},{:.3f}\n", kPhases[p].from,
                            kPhases[p].until, kPhases[p].available, kLocationChoices[c], l.readings, l.valid, rms,
                            l.largest, nees, 0.01 * share(0), 0.01 * share(1), 0.01 * share(2), 0.01 * share(3))
              : fmt::format(
                    "| {:g} to {:g} s: {} | {} | {:.0f} % | {:.3f} | {:.3f} | {:.2f} | {:.0f} / {:.0f} / "
                    "{:.0f} / {:.0f} |\n",
                    kPhases[p].from, kPhases[p].until, kPhases[p].available, kLocationChoices[c], 100.0 * n / all, rms,
                    l.largest, nees, share(0), share(1), share(2), share(3));
    }
  return text;
}

std::vector<std::string> run_location(const ExperimentContext& context) {
  if (!reports(context)) return {};
  LocatedTable table{};
  for (std::uint32_t k = 0; k < kLocationSeeds; ++k) {
    if (context.progress) context.progress(k / static_cast<double>(kLocationSeeds), fmt::format("seed {}", k + 1));
    run_located(context, context.options.seed + k, table);
  }
  const std::vector<std::string> files{in_folder(context, "results.csv"), in_folder(context, "report.md")};
  write_text(files[0],
             "from_s,until_s,available,choose,readings,valid,rms_m,largest_m,nees,camera,gps,odometry,several\n" +
                 location_rows(table, true));
  write_text(files[1], fmt::format("# Locations that come and go\n\nSeeds {} to {}.\n\n"
                                   "| available | choose | valid | RMS [m] | largest [m] | NEES | from camera / gps / "
                                   "odometry / several [%] |\n|---|---|---|---|---|---|---|\n{}\n{}\n",
                                   context.options.seed, context.options.seed + kLocationSeeds - 1,
                                   location_rows(table, false), context.type.reasons));
  return files;
}

constexpr std::string_view kLocationReasons =
    "NEES is the mean squared error in units of the stated covariance, divided by 2. It is below 1 where readings are "
    "old, because the robot may have moved since then by as much as its largest speed allows. It is above 1 after two "
    "minutes of dead reckoning, which is then too sure of itself.";

}  // namespace

extern const ExperimentType location_experiment;

constinit const ExperimentType location_experiment{
    .name = "location",
    .summary = "locations of cars from cameras, satellites and odometry that come and go",
    .fixed_trials = true,
    .reasons = kLocationReasons,
    .run = run_location,
};

}  // namespace sf::scenarios
