#pragma once
// A world in tiles, one per rank. A rank moves and senses the movers in its tile. Decisions for a mover are made at its
// home, the rank of the tile in which it started. A rank stores only the surroundings of its tile:
//
//   walls   within reach of any sensor or collision in the tile
//   ghosts  movers of other tiles within that reach; the ranks of their tiles send their exact states each tick
//
// Near a tile's edge a rank also moves its ghosts. A mover's motion depends only on the movers near it
// (robots/fleet.h), so a rank's own movers move exactly as in a single process. A mover that crosses an edge is handed
// over with the states of its sensors. Its home receives its state, its readings and its neighbours in radio range.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "base/report.h"
#include "cluster/ranks.h"
#include "cluster/tiles.h"
#include "farm/farm.h"
#include "robots/fleet.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::scenarios {

/// Not thread-safe; all ranks make the same calls.
class FleetTiles final : public farm::ReadingExchange {
 public:
  /// `ranks` must outlive it.
  /// @throws base::InputError for a sensor whose readings depend on the whole world
  FleetTiles(cluster::Ranks& ranks, const world::World& world);

  /// Drops the walls that this rank does not need. Reads the needed ones from files of outlines that are not loaded
  /// yet.
  void keep_own_part(world::World& world) const;
  /// Returns warnings about robots of all ranks that cannot start at their poses, each checked by its home. All ranks
  /// call this.
  std::vector<world::Warning> warnings_of_starts(const world::World& part);
  /// Returns the home of each mover.
  std::span<const unsigned> homes() const { return homes_; }
  /// Initializes `fleet` and `farm`, which must outlive it, with the movers of this part at load.
  /// @param v2v_ranges [m] in: of the movers at home here, 0 for all others; out: of all movers
  void begin(robots::Fleet& fleet, farm::Farm& farm, std::span<double> v2v_ranges);

  /// Called after each motion: takes over movers and ghosts. The first rank receives the states of all movers.
  void share_states();
  /// Called after `share_states`: sends the neighbours in radio range of movers that are away from home.
  void share_neighbours();
  /// Sends readings to each mover's home rank.
  void exchange(std::vector<base::ReadingBlock>& readings) override;

  /// Repartitions the plane by the time that ranks have taken. The new tiles take effect two motions later, when their
  /// ranks have the states of their movers from the previous motion. All ranks must have all walls.
  /// @param seconds [s] of sensing since the last repartition
  void cut_anew(double seconds);

  bool measures(std::uint32_t mover) const { return measured_[mover] != 0; }
  /// Returns whether the mover is in this rank's tile or a ghost there.
  bool present(std::uint32_t mover) const { return present_[mover] != 0; }
  /// Returns the states of the neighbours of a mover that is away from its home, which is this rank.
  std::span<const base::Report> neighbours(std::uint32_t mover) const;
  /// Returns the number of movers that this rank has handed over.
  std::uint64_t passed_on() const { return passed_on_; }

 private:
  FleetTiles(cluster::Ranks& ranks, const world::World& world, const sensors::SensorSet& sensor_set);
  void send_state(std::uint32_t mover, unsigned rank, bool passed);
  void take_state(base::ByteReader& in);
  void set_present(std::uint32_t mover, bool here);
  bool near_tile(unsigned rank, std::uint32_t mover, glm::dvec2 p) const;
  void share_v2v_ranges(std::span<double> v2v_ranges);
  void clear_blocks();

  cluster::Ranks& ranks_;
  double wall_reach_ = 0.0;               ///< [m] from a tile to the farthest wall that matters in it
  double ghost_reach_ = 0.0;              ///< [m] from a tile to the farthest mover that matters in it
  std::vector<double> v2v_ranges_;        ///< [m] per mover
  std::vector<std::uint8_t> everywhere_;  ///< per mover: it carries magnets, whose fields are summed in a fixed order
  std::vector<unsigned> homes_;           ///< per mover
  std::vector<double> costs_;             ///< per mover
  cluster::Tiles tiles_;
  std::optional<cluster::Tiles> next_;  ///< tiles that take effect two motions later
  bool next_known_ = false;             ///< whether ghosts of the next tiles have been shared once
  robots::Fleet* fleet_ = nullptr;
  farm::Farm* farm_ = nullptr;
  std::vector<std::uint8_t> measured_, present_, seen_;  ///< per mover
  std::vector<std::uint32_t> own_;                       ///< movers in the tile, ascending
  std::vector<base::Bytes> blocks_;                      ///< per rank
  std::vector<farm::ReadingFromBytes> received_;
  std::map<std::uint32_t, std::vector<base::Report>> neighbours_;  ///< of movers that are away from this home
  std::uint64_t passed_on_ = 0;
};

}  // namespace sf::scenarios
