#include "robots/device/fleet_tables.h"

#include <map>

#include "base/elementary.h"
#include "base/report.h"
#include "robots/fleet_rules.h"
#include "robots/motion_limits.h"

namespace sf::robots {

namespace {

using Numbers = std::vector<double>;  ///< all that distinguishes one footprint from another

Numbers numbers_of(const Footprint& outline) {
  Numbers numbers;
  for (const FootprintEdge& e : outline.edges)
    numbers.insert(numbers.end(), {e.a.x, e.a.y, e.b.x, e.b.y, e.z_min, e.z_max, e.solid ? 1.0 : 0.0});
  return numbers;
}

FleetFootprint footprint_record(const Footprint& outline, std::size_t first_edge) {
  const int halvings = halvings_to_gap(outline.step);
  return {.radius = outline.radius,
          .step = outline.step,
          .z_min = outline.z_min,
          .z_max = outline.z_max,
          .inner = outline.inner,
          .smallest_part = std::ldexp(1.0, -halvings),
          .first = static_cast<std::uint32_t>(first_edge),
          .count = static_cast<std::uint32_t>(outline.edges.size()),
          .halvings = static_cast<std::uint32_t>(halvings)};
}

/// Adds the mover's footprint, unless another mover has it. Returns its row.
std::uint32_t add_footprint(const Footprint& outline, std::map<Numbers, std::uint32_t>& known, FleetTables& tables) {
  const auto row = static_cast<std::uint32_t>(tables.footprints.size());
  const auto [at, is_new] = known.emplace(numbers_of(outline), row);
  if (!is_new) return at->second;
  tables.footprints.push_back(footprint_record(outline, tables.edges.size()));
  for (const FootprintEdge& e : outline.edges)
    tables.edges.push_back({e.a.x, e.a.y, e.b.x, e.b.y, e.z_min, e.z_max, e.solid ? 1u : 0u, 0, 0, 0});
  return row;
}

FleetDrive drive_of(const world::Mover& mover, const world::Variation& variation) {
  return {.max_forward = mover.max_forward,
          .max_turn = mover.max_turn,
          .steer_tangent = base::tan(kMaxSteer),
          .wheelbase = mover.wheelbase,
          .track = mover.track,
          .max_acceleration = mover.max_acceleration,
          .max_turn_acceleration = mover.max_turn_acceleration,
          .grip = 1.0 - variation.slip,
          .acceleration = variation.acceleration,
          .spare = 0.0};
}

std::uint32_t kind_of(world::Drive drive) {
  return drive == world::Drive::car ? SF_DRIVE_CAR : drive == world::Drive::omni ? SF_DRIVE_OMNI : SF_DRIVE_OTHER;
}

template <class Record>
void keep_one(std::vector<Record>& records) {
  if (records.empty()) records.emplace_back();
}

}  // namespace

MotionBound motion_bound(const world::Mover& mover) {
  const Footprint outline = footprint_of(mover);
  return {1.001 * mover.max_forward, 1.001 * mover.max_turn, outline.radius, outline.step};
}

FleetTables fleet_tables(const world::World& world) {
  FleetTables tables;
  std::map<Numbers, std::uint32_t> known;
  const std::vector<std::uint32_t> ranks = ranks_of(world);
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
    const world::Mover& mover = world.movers[row];
    const std::uint32_t footprint = add_footprint(footprint_of(mover), known, tables);
    tables.drives.push_back(drive_of(mover, world.variation_of(row)));
    tables.bodies.push_back({footprint, ranks[row], kind_of(mover.drive),
                             mover.actuator_model == world::ActuatorModel::player_create ? 1u : 0u});
  }
  tables.walls = wall_tables(world.walls, [](const world::Segment& wall) { return wall.stops_robots; });
  for (std::uint32_t k = 0; k <= base::kContactSectors; ++k) {
    const glm::dvec2 border = contact_border(k);
    tables.borders.push_back({border.x, border.y});
  }
  keep_one(tables.drives), keep_one(tables.bodies), keep_one(tables.footprints), keep_one(tables.edges);
  return tables;
}

}  // namespace sf::robots
