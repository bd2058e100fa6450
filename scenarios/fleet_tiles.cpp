#include "scenarios/fleet_tiles.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/elementary.h"
#include "base/error.h"
#include "scenarios/rank_exchange.h"
#include "world/free_space.h"
#include "world/near_part.h"

namespace sf::scenarios {

namespace {

glm::dvec2 place_of(const base::Pose& X_WM) { return {X_WM.x, X_WM.y}; }

/// [m] Largest displacement of an origin in a tick, and largest radius.
struct Largest {
  double way = 0.0, radius = 0.0;
};

Largest largest_of(const world::World& world) {
  Largest largest;
  for (const world::Mover& mover : world.movers) {
    // A command may combine full speed forward and to the left, and a turn pushes off from walls.
    largest.way = std::max(largest.way, 1.5 * mover.max_forward * world.interval + 0.1);
    largest.radius = std::max(largest.radius, mover.radius);
  }
  return largest;
}

/// [m] Distance from a mover in a tile to the farthest surface that matters to its sensors or its motion.
double reach_of(const world::World& world, const sensors::SensorSet& sensor_set) {
  const Largest largest = largest_of(world);
  double reach = robots::Fleet::kRounds * 2.0 * (largest.way + largest.radius);
  for (const auto& group : sensor_set.groups())
    for (const sensors::SensorSpec& row : group.rows) {
      if (!std::isfinite(row.reach))
        throw base::InputError("--tiles: the readings of '" + row.name + "' of '" + world.movers[row.mover].name +
                               "' depend on the whole world; leave --tiles out");
      // Rolling scans see movers where they were.
      const double ticks = row.sweep > 0.0 ? std::ceil(row.sweep / world.interval) + 2.0 : 0.0;
      reach = std::max(reach, row.reach + base::hypot(row.X_MS.x, row.X_MS.y) + 2.0 * ticks * largest.way);
    }
  // Samples between two ticks see movers during their motion.
  return reach + largest.radius + 4.0 * largest.way;
}

cluster::Tiles tiles_of(const world::World& world, std::span<const double> costs, unsigned count) {
  std::vector<glm::dvec2> places;
  for (const world::Mover& mover : world.movers) places.push_back(place_of(mover.X_WM));
  return {places, costs, count};
}

void put_report(const base::Report& report, base::ByteWriter& out) {
  out.put(report.mover);
  out.put(report.time);
  for (const double v : {report.X_WM.x, report.X_WM.y, report.X_WM.z, report.X_WM.yaw, report.velocity.forward,
                         report.velocity.left, report.velocity.turn, report.tilt.roll, report.tilt.pitch})
    out.put(v);
  out.put(report.contact_mask);
}

base::Report get_report(base::ByteReader& in) {
  base::Report report;
  report.mover = in.get<std::uint32_t>();
  report.time = in.get<std::int64_t>();
  for (double* v : {&report.X_WM.x, &report.X_WM.y, &report.X_WM.z, &report.X_WM.yaw, &report.velocity.forward,
                    &report.velocity.left, &report.velocity.turn, &report.tilt.roll, &report.tilt.pitch})
    *v = in.get<double>();
  report.contact_mask = in.get<std::uint32_t>();
  return report;
}

enum State : std::uint8_t { kTouching = 1, kMovesIn = 2 };

}  // namespace

FleetTiles::FleetTiles(cluster::Ranks& ranks, const world::World& world)
    : FleetTiles(ranks, world, sensors::SensorSet(world)) {}

FleetTiles::FleetTiles(cluster::Ranks& ranks, const world::World& world, const sensors::SensorSet& sensor_set)
    : ranks_(ranks),
      v2v_ranges_(world.movers.size()),
      costs_(costs_of(world, sensor_set)),
      tiles_(tiles_of(world, costs_, ranks.size())),
      blocks_(ranks.size()) {
  wall_reach_ = ghost_reach_ = reach_of(world, sensor_set);
  const bool magnets = std::any_of(sensor_set.groups().begin(), sensor_set.groups().end(), [](const auto& group) {
    return std::any_of(group.rows.begin(), group.rows.end(), [](const auto& row) { return row.depends_on_magnets; });
  });
  for (const world::Mover& mover : world.movers) {
    if (!mover.dynamics.name.empty())
      throw base::InputError(mover.dynamics.at + "--tiles cannot move robots by 'dynamics'; leave --tiles out");
    homes_.push_back(tiles_.at(place_of(mover.X_WM)));
    everywhere_.push_back(magnets && !mover.magnets.empty());
  }
  for (auto* flags : {&measured_, &present_, &seen_}) flags->resize(homes_.size());
}

void FleetTiles::keep_own_part(world::World& world) const {
  world::keep_near(world, tiles_[ranks_.rank()], wall_reach_);
}

std::vector<world::Warning> FleetTiles::warnings_of_starts(const world::World& part) {
  base::Bytes block;
  base::ByteWriter out(block);
  const world::PlaceCheck check(part);
  for (std::uint32_t m = 0; m < homes_.size(); ++m) {
    const std::string problem = homes_[m] == ranks_.rank() ? check.start_problem(part.movers[m]) : "";
    if (problem.empty()) continue;
    out.put(m);
    out.put_string(problem);
  }
  std::map<std::uint32_t, std::string> problems;
  for (const cluster::Block other : ranks_.exchange(block)) {
    base::ByteReader in(other);
    while (in.left() > 0) {
      const auto mover = in.get<std::uint32_t>();
      problems[mover] = in.get_string();
    }
  }
  std::vector<world::Warning> warnings;
  for (const auto& [mover, problem] : problems) warnings.push_back({part.file, 0, problem});
  return warnings;
}

void FleetTiles::share_v2v_ranges(std::span<double> v2v_ranges) {
  base::Bytes block;
  base::ByteWriter(block).put_bytes(v2v_ranges.data(), v2v_ranges.size_bytes());
  for (const cluster::Block other : ranks_.exchange(block)) {
    base::ByteReader in(other);
    for (double& range : v2v_ranges) range = std::max(range, in.get<double>());
  }
  v2v_ranges_.assign(v2v_ranges.begin(), v2v_ranges.end());
  for (const double range : v2v_ranges) ghost_reach_ = std::max(ghost_reach_, range);
}

void FleetTiles::begin(robots::Fleet& fleet, farm::Farm& farm, std::span<double> v2v_ranges) {
  share_v2v_ranges(v2v_ranges);
  fleet_ = &fleet;
  farm_ = &farm;
  farm.sharing().set_exchange(this);
  for (std::uint32_t m = 0; m < homes_.size(); ++m) {
    measured_[m] = homes_[m] == ranks_.rank();
    farm.sharing().set_measured_here(m, measured_[m] != 0);
    if (measured_[m] != 0) own_.push_back(m);
    present_[m] = 1;
    set_present(m, near_tile(ranks_.rank(), m, place_of(fleet.reports()[m].X_WM)));
  }
}

bool FleetTiles::near_tile(unsigned rank, std::uint32_t mover, glm::dvec2 p) const {
  return everywhere_[mover] != 0 || tiles_.distance(rank, p) <= ghost_reach_ ||
         (next_ && next_->distance(rank, p) <= ghost_reach_);
}

void FleetTiles::set_present(std::uint32_t mover, bool here) {
  if (present(mover) == here) return;
  present_[mover] = here ? 1 : 0;
  fleet_->set_absent(mover, !here);
  farm_->sharing().set_hidden(mover, !here);
}

void FleetTiles::clear_blocks() {
  for (base::Bytes& block : blocks_) block.clear();
}

void FleetTiles::send_state(std::uint32_t mover, unsigned rank, bool passed) {
  base::ByteWriter out(blocks_[rank]);
  const bool contact = fleet_->contacts()[mover] != 0;
  out.put(static_cast<std::uint8_t>((contact ? kTouching : 0) | (passed ? kMovesIn : 0)));
  put_report(fleet_->reports()[mover], out);
  if (passed) farm_->write_sensors(mover, out);
}

void FleetTiles::take_state(base::ByteReader& in) {
  const auto state = in.get<std::uint8_t>();
  const base::Report report = get_report(in);
  const std::uint32_t mover = report.mover;
  SF_CHECK(in.good() && mover < homes_.size(), "the states of another rank end early");
  fleet_->set_moved(report, (state & kTouching) != 0);
  seen_[mover] = near_tile(ranks_.rank(), mover, place_of(report.X_WM)) ? 1 : 0;
  set_present(mover, seen_[mover] != 0);
  if ((state & kMovesIn) == 0) return;
  farm_->read_sensors(mover, in);
  farm_->sharing().set_measured_here(mover, true);
  measured_[mover] = 1;
  own_.push_back(mover);
}

void FleetTiles::share_states() {
  clear_blocks();
  if (next_ && std::exchange(next_known_, !next_known_)) {
    tiles_ = std::move(*next_);
    next_.reset();
  }
  std::fill(seen_.begin(), seen_.end(), 0);
  for (const std::uint32_t m : own_) {
    const glm::dvec2 p = place_of(fleet_->reports()[m].X_WM);
    const unsigned tile = tiles_.at(p);
    for (unsigned rank = 0; rank < ranks_.size(); ++rank)
      if (rank != ranks_.rank() && (rank == 0 || rank == homes_[m] || near_tile(rank, m, p)))
        send_state(m, rank, rank == tile);
    seen_[m] = near_tile(ranks_.rank(), m, p) ? 1 : 0;
    if (tile == ranks_.rank()) continue;
    farm_->sharing().set_measured_here(m, false);
    measured_[m] = 0;
    ++passed_on_;
  }
  std::erase_if(own_, [&](std::uint32_t m) { return measured_[m] == 0; });
  for (const cluster::Block block : ranks_.swap(blocks_))
    for (base::ByteReader in(block); in.left() > 0;) take_state(in);
  std::sort(own_.begin(), own_.end());
  for (std::uint32_t m = 0; m < seen_.size(); ++m) set_present(m, seen_[m] != 0);
}

void FleetTiles::cut_anew(double seconds) {
  double cost = 0.0;
  for (const std::uint32_t m : own_) cost += costs_[m];
  base::Bytes block;
  base::ByteWriter out(block);
  for (const std::uint32_t m : own_) {
    const glm::dvec2 p = place_of(fleet_->reports()[m].X_WM);
    for (const double v : {p.x, p.y, costs_[m] / cost * seconds}) out.put(v);
  }
  std::vector<glm::dvec2> places;
  std::vector<double> times;
  for (const cluster::Block other : ranks_.exchange(block))
    for (base::ByteReader in(other); in.left() > 0;) {
      const double x = in.get<double>(), y = in.get<double>();
      places.push_back({x, y});
      times.push_back(in.get<double>());
    }
  next_.emplace(places, times, ranks_.size());
  next_known_ = false;
}

void FleetTiles::share_neighbours() {
  clear_blocks();
  for (const std::uint32_t m : own_) {
    if (homes_[m] == ranks_.rank() || v2v_ranges_[m] == 0.0) continue;
    const glm::dvec2 here = place_of(fleet_->reports()[m].X_WM);
    base::ByteWriter out(blocks_[homes_[m]]);
    for (const base::Report& other : fleet_->reports()) {
      if (!present(other.mover) || glm::length(place_of(other.X_WM) - here) > v2v_ranges_[m]) continue;
      out.put(m);
      put_report(other, out);
    }
  }
  for (auto& [mover, others] : neighbours_) others.clear();
  for (const cluster::Block block : ranks_.swap(blocks_))
    for (base::ByteReader in(block); in.left() > 0;) {
      const auto mover = in.get<std::uint32_t>();
      neighbours_[mover].push_back(get_report(in));
    }
}

std::span<const base::Report> FleetTiles::neighbours(std::uint32_t mover) const {
  const auto found = neighbours_.find(mover);
  return found != neighbours_.end() ? std::span<const base::Report>(found->second) : std::span<const base::Report>();
}

void FleetTiles::exchange(std::vector<base::ReadingBlock>& readings) {
  clear_blocks();
  std::erase_if(readings, [&](const base::ReadingBlock& reading) {
    const unsigned home = homes_[reading.mover];
    if (home == ranks_.rank()) return false;
    base::ByteWriter out(blocks_[home]);
    farm::write_reading(reading, out);
    return true;
  });
  std::size_t count = 0;
  for (const cluster::Block block : ranks_.swap(blocks_))
    for (base::ByteReader in(block); in.left() > 0; ++count) {
      if (count == received_.size()) received_.emplace_back();
      received_[count].read(in);
      SF_CHECK(in.good(), "the readings of another rank end early");
    }
  if (count == 0) return;
  for (std::size_t i = 0; i < count; ++i) readings.push_back(received_[i].block);
  std::sort(readings.begin(), readings.end(), [](const base::ReadingBlock& a, const base::ReadingBlock& b) {
    return std::tie(a.type, a.mover, a.sensor) < std::tie(b.type, b.mover, b.sensor);
  });
}

}  // namespace sf::scenarios
