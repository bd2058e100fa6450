#include "scenarios/tree_grids.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"
#include "sensors/infrared.h"
#include "sensors/laser.h"
#include "sensors/localization.h"
#include "sensors/sonar.h"

namespace sf::scenarios {

namespace {

constexpr double kScanRange = 4.0;  // [m] of the exact scan: that of the farthest sensor
constexpr int kScanBeams = 2880;
constexpr double kScanHeight = 0.02;  // [m] of the sensors
constexpr double kAround = 0.1;       // [m] cells left out around a robot

/// Returns the distance along `along` at which a ray from `p` meets a wall; infinity if it does not.
double distance_to(glm::dvec2 p, glm::dvec2 along, const world::Segment& wall) {
  const glm::dvec2 e = wall.b - wall.a, d = wall.a - p;
  const double turned = base::cross(along, e);
  if (turned == 0.0) return HUGE_VAL;
  const double t = base::cross(d, e) / turned, s = base::cross(d, along) / turned;
  return t > 0.0 && s >= 0.0 && s <= 1.0 ? t : HUGE_VAL;
}

double odds_of(const maps::LogOddsGrid& grid, maps::CellAt at) {
  const auto word = static_cast<std::size_t>(at.row / 4 * grid.geometry.word_columns + at.column / 4);
  return 0.01 * grid.cells[16 * word + static_cast<std::size_t>(4 * (at.row % 4) + at.column % 4)];
}

template <class Visit>
void for_each_cell(const maps::GridGeometry& geometry, Visit&& visit) {
  for (std::int64_t row = 0; row < maps::rows(geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(geometry); ++column) visit(maps::CellAt{column, row});
}

}  // namespace

void TreeGrid::add(const TreeGrid& other) {
  surfaces += other.surfaces, found += other.found, occupied += other.occupied, right += other.right;
  exact += other.exact, free += other.free, wrong += other.wrong, cells += other.cells, explored += other.explored;
  log_loss += other.log_loss, squares += other.squares;
}

TreeGrids::TreeGrids(const world::World& world, const sensors::Occupancy& map)
    : world_(world), car_(map.row.mover), geometry_(map.settings.grid) {
  constexpr std::array<std::pair<std::uint8_t, std::uint32_t>, kGridSensors> kSensors{
      {{sensors::kLaser, 0}, {sensors::kLaser, 1}, {sensors::kSonar, 0}, {sensors::kInfrared, 0}}};
  for (const auto& [type, number] : kSensors) {
    const sensors::RangeSensor sensor{type, car_, number};
    if (!std::ranges::binary_search(map.sources, sensor))
      throw base::InputError("the map of the car 'probe' has other sources; expected worlds/simville/tree.world");
    for (auto& sources : sources_) sources.emplace_back(world, sensor);
  }
  for (auto& grids : grids_) grids.assign(kAllGridSensors, maps::LogOddsGrid(geometry_, *map.settings.odds));
  truth_.resize(static_cast<std::size_t>(maps::rows(geometry_) * maps::columns(geometry_)));
}

void TreeGrids::add(const base::TickRecord& tick) {
  std::optional<base::Pose> own;
  for (const base::ReadingBlock& r : tick.readings)
    if (r.type == sensors::kLocalization && r.mover == car_ && r.time == tick.time && r.values[3] != 0.0)
      own = {r.values[0], r.values[1], 0.0, r.values[2]};
  std::vector<maps::LogOddsGrid*> grids;
  for (const GridPose pose : {GridPose::exact, GridPose::own})
    for (std::size_t k = 0; k < kGridSensors; ++k) {
      sensors::RangeSource& source = sources_[static_cast<std::size_t>(pose)][k];
      const auto is_its = [&](const base::ReadingBlock& r) {
        return sensors::RangeSensor{r.type, r.mover, r.sensor} == source.sensor();
      };
      const auto reading = std::ranges::find_if(tick.readings, is_its);
      if (reading == tick.readings.end() || (pose == GridPose::own && !own)) continue;
      grids.clear();
      for (unsigned sensors = 1; sensors <= kAllGridSensors; ++sensors)
        if ((sensors >> k & 1u) != 0) grids.push_back(&grids_[static_cast<std::size_t>(pose)][sensors - 1]);
      source.add_to(grids, source.cones(*reading, pose == GridPose::own ? *own : reading->X_WM), evidence_);
    }
}

void TreeGrids::cast(const base::Pose& X_WM, double bearing) {
  const glm::dvec2 from{X_WM.x, X_WM.y}, along = base::rotate(bearing, {1.0, 0.0});
  double nearest = HUGE_VAL;
  for (const world::Segment& wall : world_.walls)
    if (const double z = X_WM.z + kScanHeight; wall.seen_by_laser && wall.z_min <= z && z < wall.z_max)
      nearest = std::min(nearest, distance_to(from, along, wall));
  const double end = std::min(nearest, kScanRange);
  const auto mark = [&](double range, Truth truth) {
    const maps::CellAt at = maps::cell_at(geometry_, from + range * along);
    if (maps::contains(geometry_, at)) truth_[index_of(at)] = std::max(truth_[index_of(at)], truth);
  };
  for (double range = 0.0; range < end; range += 0.5 * geometry_.cell) mark(range, Truth::free);
  if (nearest <= kScanRange) mark(nearest, Truth::surface);
}

void TreeGrids::look(const base::TickRecord& tick) {
  for (int i = 0; i < kScanBeams; ++i) cast(tick.reports[car_].X_WM, 2.0 * M_PI * i / kScanBeams);
}

std::vector<TreeGrids::Truth> TreeGrids::truth_now(const base::TickRecord& tick) const {
  std::vector<Truth> truth = truth_;
  for_each_cell(geometry_, [&](maps::CellAt at) {
    const glm::dvec2 p = maps::middle(geometry_, at);
    for (const base::Report& report : tick.reports)
      if (report.mover != car_ &&
          base::hypot(p.x - report.X_WM.x, p.y - report.X_WM.y) < world_.movers[report.mover].radius + kAround)
        truth[index_of(at)] = Truth::unseen;
  });
  return truth;
}

bool TreeGrids::near_surface(const std::vector<Truth>& truth, maps::CellAt at) const {
  for (std::int64_t row = at.row - 1; row <= at.row + 1; ++row)
    for (std::int64_t column = at.column - 1; column <= at.column + 1; ++column)
      if (maps::contains(geometry_, {column, row}) && truth[index_of({column, row})] == Truth::surface) return true;
  return false;
}

std::vector<TreeGrid> TreeGrids::compare(const base::TickRecord& tick) const {
  const std::vector<Truth> truth = truth_now(tick);
  std::vector<TreeGrid> all;
  for (const GridPose pose : {GridPose::exact, GridPose::own})
    for (unsigned sensors = 1; sensors <= kAllGridSensors; ++sensors) {
      TreeGrid& sum = all.emplace_back(TreeGrid{.sensors = sensors, .pose = pose});
      const maps::LogOddsGrid& of = grid(sensors, pose);
      std::vector<Truth> taken(truth.size());
      for_each_cell(geometry_, [&](maps::CellAt at) {
        const double odds = odds_of(of, at), p = 1.0 / (1.0 + base::exp(-odds));
        const Truth is = truth[index_of(at)];
        taken[index_of(at)] = odds > 0.0 ? Truth::surface : Truth::unseen;
        if (is == Truth::unseen) return;
        ++sum.cells, sum.explored += odds != 0.0;
        const double right = is == Truth::surface ? p : 1.0 - p;
        sum.log_loss -= base::log(right), sum.squares += (1.0 - right) * (1.0 - right);
        sum.occupied += odds > 0.0, sum.exact += odds > 0.0 && is == Truth::surface;
        sum.right += odds > 0.0 && near_surface(truth, at);
        sum.free += odds < 0.0, sum.wrong += odds < 0.0 && is == Truth::surface;
      });
      for_each_cell(geometry_, [&](maps::CellAt at) {
        if (truth[index_of(at)] != Truth::surface) return;
        ++sum.surfaces, sum.found += near_surface(taken, at);
      });
    }
  return all;
}

}  // namespace sf::scenarios
