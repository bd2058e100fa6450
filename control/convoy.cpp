#include "control/convoy.h"

#include <algorithm>
#include <cmath>

#include "control/route.h"

namespace sf::control {

namespace {

constexpr double kNear = 2.5;    // [m] a newcomer is let in from here on
constexpr double kBehind = 1.2;  // [m] who is farther off has fallen behind

/// Another follower of the same leader.
std::optional<std::uint32_t> newcomer(const Company& company, const std::vector<Driver>& drivers) {
  if (company.leader == base::kNoId || company.merges) return std::nullopt;
  for (std::uint32_t row = 1; row < drivers.size(); ++row)
    if (drivers[row].follows == company.leader) return row;
  return std::nullopt;
}

bool on_one_lane(const Corridors& corridors, const Driver& driver, const Driver& ahead) {
  for (const Place& own : driver.places)
    for (const Place& other : ahead.places)
      if (other.way == own.way && corridors.way(own.way).kind == Way::Kind::lane) return true;
  return false;
}

}  // namespace

std::optional<std::uint32_t> row_of(const std::vector<Driver>& drivers, std::uint32_t id) {
  for (std::uint32_t row = 1; row < drivers.size(); ++row)
    if (drivers[row].id == id) return row;
  return std::nullopt;
}

std::optional<std::uint32_t> heading_for(const Corridors& corridors, const Driver& driver) {
  // Where ways part from a lane it is on them all: it stays on the lane until it has left it.
  for (const bool lane : {true, false})
    for (const Place& place : driver.places) {
      const Way& way = corridors.way(place.way);
      const std::uint32_t row = lane ? place.way : way.into;
      if (lane != (way.kind == Way::Kind::lane) || row == world::kNone) continue;
      const std::uint32_t next = point_from(corridors.roads().lanes[row], lane ? place.s : way.enter);
      return corridors.node_of({world::PointRef::Kind::lane, row, next});
    }
  return std::nullopt;
}

void keep_company(Company& company, const Corridors& corridors, const std::vector<Driver>& drivers,
                  const std::vector<Ahead>& ahead) {
  if (company.leader == base::kNoId || ahead.empty()) return;
  const Driver& next = drivers[ahead.front().row];
  if (company.merges) {
    if (next.id == company.leader && on_one_lane(corridors, drivers.front(), next)) company.merges = false;
    return;
  }
  const auto row = newcomer(company, drivers);
  if (row && next.id == drivers[*row].id) company.leader = next.id;
}

double opened_gap(const Company& company, const Corridors& corridors, const std::vector<Driver>& drivers) {
  const auto row = newcomer(company, drivers);
  if (!row) return 0.0;
  const Pose& a = drivers[0].X_WM;
  const Pose& b = drivers[*row].X_WM;
  return std::hypot(a.x - b.x, a.y - b.y) < kNear ? 2.0 * corridors.body().radius + 0.3 : 0.0;
}

bool left_behind(const std::vector<Driver>& drivers) {
  const Pose& here = drivers.front().X_WM;
  return std::any_of(drivers.begin() + 1, drivers.end(), [&](const Driver& other) {
    return other.follows == drivers.front().id && std::hypot(other.X_WM.x - here.x, other.X_WM.y - here.y) > kBehind;
  });
}

namespace {

std::unique_ptr<Controller> make_convoy(const Site& site, Settings& settings) {
  return make_route_controller(site, settings, true);
}

}  // namespace

constinit const ControllerKind convoy_controller{
    .name = "convoy",
    .summary = "follows another robot over the roads at a gap, lets others in",
    .rate = 10.0,
    .waits = true,
    .make = make_convoy,
};

}  // namespace sf::control
