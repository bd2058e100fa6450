#pragma once
// Converts the traffic lights of a world to SPaT and MAP messages, and SPaT messages to states of lights.
//
//   for (const Intersection& each : intersections_of(world, roads)) {
//     Spat spat = spat_of(each, forecasts, utc);               // the states of all lights
//     auto map = map_of(*roads, each, origin);                 // stop lines and lanes; never changes
//   }
//   read_spat(spat, intersections, utc, take);                 // the reverse
//
// A light is a signal group. Lights whose exits meet or lead to the same point belong to one intersection; a light
// without exits forms an intersection alone.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "v2x/map_data.h"
#include "v2x/spat.h"
#include "world/lights.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::server {

struct Intersection {
  std::uint16_t id = 0;                ///< from `first`, in the order of their first lights; of a light that joins,
                                       ///< the id of its post
  std::vector<std::uint32_t> lights;   ///< rows of `World::lights`, ascending; the k-th is signal group k + 1
  std::vector<world::PointRef> stops;  ///< way-points of their stop lines, ordered by light
  std::vector<std::uint32_t> groups;   ///< signal group per stop
};

/// @param roads the world's network; null: none
/// @param first in [0, netio::kMaxId], id of the first one
/// @throws base::InputError if an intersection has more than 254 lights, or an id is above netio::kMaxId
std::vector<Intersection> intersections_of(const world::World& world, const world::RoadNetwork* roads,
                                           std::uint32_t first = 1);

/// Returns the present state of each light, the time of its change, and the next state. Times are rounded up to 0.1 s,
/// never before `utc`, with start <= min_end <= max_end. Changes an hour or more ahead are `kMoreThanAnHour`.
/// @param forecasts one per row of `World::lights` @param utc [ms] since 1970 at the time of the forecasts
v2x::Spat spat_of(const Intersection& intersection, std::span<const world::SignalForecast> forecasts, std::int64_t utc);

/// Returns a lane that ends at each stop line, a lane that begins at the end of each exit, and the connections between
/// them. Offsets are in the world frame, x east and y north. Returns nullopt if the intersection has no stop line.
/// @param origin of the world
/// @throws base::InputError for more than 255 lanes, and for lanes that begin more than 327 m from the middle
std::optional<v2x::MapData> map_of(const world::RoadNetwork& roads, const Intersection& intersection,
                                   world::Geodetic origin);

/// Passes the states in `spat` for lights of `intersections` to `take`; ignores other intersections and groups. The
/// time to the next change counts from the message's own time, or from `utc` if it has none. A change more than half an
/// hour ahead is treated as overdue: 0 s are left.
/// @param utc [ms] current time since 1970 @param take receives the row of `World::lights`
/// @return number of states
std::size_t read_spat(const v2x::Spat& spat, std::span<const Intersection> intersections, std::int64_t utc,
                      const std::function<void(std::uint32_t light, const world::Signal&)>& take);

v2x::PhaseState phase_of(world::LightState state);
/// Maps unavailable to dark, and red with yellow to red.
world::LightState light_of(v2x::PhaseState phase);

}  // namespace sf::server
