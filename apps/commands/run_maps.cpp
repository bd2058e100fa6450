#include "apps/commands/run_maps.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "control/own_localization.h"
#include "maps/merge.h"
#include "sensors/laser.h"

namespace sf::apps {

namespace {

constexpr std::chrono::seconds kInterval{1};  ///< between pictures
constexpr int kShare = 10;                    ///< copying and merging take at most this part of the time

std::vector<const maps::OccupancyGrid*> pointers_to(const std::vector<maps::OccupancyGrid>& grids) {
  std::vector<const maps::OccupancyGrid*> all;
  for (const maps::OccupancyGrid& grid : grids) all.push_back(&grid);
  return all;
}

}  // namespace

RunMaps::RunMaps(const world::World& world, const scenarios::Simulation& simulation, const std::string& file,
                 const std::optional<bridges::WebAddress>& view)
    : world_(world), simulation_(simulation), file_(file), page_(view.has_value()) {
  const sensors::SensorSet& sensor_set = simulation.farm().sensor_set();
  std::vector<std::string> names;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    const control::Controller* controller = simulation.controller(m);
    if (controller == nullptr) continue;
    const bool keeps = controller->own_map() != nullptr;
    if (!keeps && sensor_set.of(sensors::kLaser, m).empty()) continue;
    if (robots_.size() == kMostRobots)
      throw base::InputError(fmt::format(
          "--map-file and --map-view draw the maps of at most {} robots, but more have lasers; name the robots to "
          "drive (--drive NAME)",
          kMostRobots));
    robots_.push_back({m, nullptr, world.movers[m].X_WM});
    if (!keeps) robots_.back().scans = std::make_unique<server::OwnMap>(world, sensor_set, m, server::OwnMapOptions{});
    names.push_back(world.movers[m].name);
  }
  if (robots_.empty())
    throw base::InputError("--map-file and --map-view draw the maps that driven robots build, but none has a laser");
  std::vector<maps::OccupancyGrid> grids;
  for (const RobotMap& robot : robots_) grids.push_back(grid_of(robot));
  if (const std::string problem = maps::merge_problem(pointers_to(grids)); !problem.empty())
    throw base::InputError("--map-file and --map-view: " + problem);
  if (robots_.size() > 1) names.insert(names.begin(), "merged");
  const std::string title = robots_.size() == 1 ? "map of " + names.front() : "maps of the robots";
  live_.emplace(LiveMapOptions{.title = title, .names = std::move(names), .view = view});
}

maps::OccupancyGrid RunMaps::grid_of(const RobotMap& robot) const {
  return robot.scans ? robot.scans->grid() : *simulation_.controller(robot.mover)->own_map();
}

void RunMaps::write(const base::TickRecord& tick) {
  for (RobotMap& robot : robots_) {
    const control::OwnLocalization* own = control::localization_of(*simulation_.controller(robot.mover));
    if (own != nullptr && !own->quality().stated) own = nullptr;  // before its first step
    robot.lost = own != nullptr && own->is_lost();
    if (robot.lost) continue;
    robot.X_WM = own != nullptr ? own->state().X_WM : tick.reports[robot.mover].X_WM;
    if (!robot.scans) continue;
    for (const base::ReadingBlock& reading : tick.readings)
      if (reading.mover == robot.mover)
        robot.scans->add(reading, own != nullptr ? own->pose_at(reading.time) : reading.X_WM);
  }
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  show();
  const Clock::time_point done = Clock::now();
  next_ = std::max(now + kInterval, done + kShare * (done - now));
}

void RunMaps::finish() {
  show();
  live_->finish();
}

std::vector<viz::PoseMarker> RunMaps::place_of(const RobotMap& robot) const {
  if (robot.lost) return {};
  return {{world_.movers[robot.mover].name, robot.X_WM}};
}

void RunMaps::show() {
  std::vector<maps::OccupancyGrid> grids;
  std::vector<viz::PoseMarker> places;
  for (const RobotMap& robot : robots_) {
    grids.push_back(grid_of(robot));
    for (const viz::PoseMarker& place : place_of(robot)) places.push_back(place);
  }
  const bool several = grids.size() > 1;
  if (several) live_->show(0, maps::merge(pointers_to(grids)), {"Merged map", "", places}, file_);
  for (std::size_t i = 0; i < grids.size() && (page_ || !several); ++i)
    live_->show(several ? i + 1 : 0, std::move(grids[i]),
                {"Map of " + world_.movers[robots_[i].mover].name, "", place_of(robots_[i])}, several ? "" : file_);
}

}  // namespace sf::apps
