#pragma once
// A world in tiles, one per rank. A rank moves and senses the movers in its tile, wherever it is decided for them: at
// their home, the rank of the tile in which they began. It knows its tile's surroundings alone:
//
//   walls   as far as anything in the tile can sense or collide with them
//   ghosts  movers of other tiles as near as that; the ranks of their tiles send their states each tick, bit by bit
//
// Near a tile's edge a rank moves its ghosts, too: a mover's motion depends on the movers near it alone
// (robots/fleet.h), so its own movers go where one process would let them go. A mover that crosses an edge is passed on
// with the states of its sensors. Its home gets its state, its readings and its neighbours in radio range.

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

/// One thread; all ranks make the same calls.
class FleetTiles final : public farm::ReadingExchange {
 public:
  /// `ranks` must outlive it. @throws base::InputError for a sensor whose readings depend on the whole world
  FleetTiles(cluster::Ranks& ranks, const world::World& world);

  /// Drops the walls that this rank does not need. Of files of outlines that are not read yet, it reads the others.
  void keep_own_part(world::World& world) const;
  /// Robots of all ranks that cannot stand where they start, each judged by its home; all ranks call this.
  std::vector<world::Warning> warnings_of_starts(const world::World& part);
  /// The home of each mover.
  std::span<const unsigned> homes() const { return homes_; }
  /// Shows `fleet` and `farm`, which must outlive it, the movers of this part at load.
  /// @param v2v_ranges [m] in: of the movers whose home this is, 0 for all others; out: of all movers
  void begin(robots::Fleet& fleet, farm::Farm& farm, std::span<double> v2v_ranges);

  /// After each motion: takes over movers and ghosts. The first rank gets the states of all movers.
  void share_states();
  /// After that: the neighbours in radio range of movers that are away from home.
  void share_neighbours();
  /// Readings go home.
  void exchange(std::vector<base::ReadingBlock>& readings) override;

  /// Cuts the plane anew, by the time that ranks have taken; the new tiles hold from the next motion but one, when
  /// their ranks know the states of their movers from the motion before. Ranks must know all walls.
  /// @param seconds [s] of sensing since the last cut
  void cut_anew(double seconds);

  bool measures(std::uint32_t mover) const { return measured_[mover] != 0; }
  /// The mover is in this rank's tile or a ghost there.
  bool present(std::uint32_t mover) const { return present_[mover] != 0; }
  /// Neighbours of a mover away from its home, which this is: their states.
  std::span<const base::Report> neighbours(std::uint32_t mover) const;
  /// Movers that this rank has passed on so far.
  std::uint64_t passed_on() const { return passed_on_; }

 private:
  void send_state(std::uint32_t mover, unsigned rank, bool passed);
  void take_state(base::ByteReader& in);
  void set_present(std::uint32_t mover, bool here);
  bool near_tile(unsigned rank, std::uint32_t mover, glm::dvec2 p) const;
  void share_v2v_ranges(std::span<double> v2v_ranges);
  void clear_blocks();

  cluster::Ranks& ranks_;
  double wall_reach_ = 0.0;               ///< [m] from a tile to the farthest wall that matters there
  double ghost_reach_ = 0.0;              ///< [m] likewise, to the farthest mover
  std::vector<double> v2v_ranges_;        ///< [m] per mover
  std::vector<std::uint8_t> everywhere_;  ///< per mover: it carries magnets, which are summed in one order
  std::vector<unsigned> homes_;           ///< per mover
  std::vector<double> costs_;             ///< per mover
  cluster::Tiles tiles_;
  std::optional<cluster::Tiles> next_;  ///< tiles from the next motion but one on
  bool next_known_ = false;             ///< ghosts of the next tiles have been shared once
  robots::Fleet* fleet_ = nullptr;
  farm::Farm* farm_ = nullptr;
  std::vector<std::uint8_t> measured_, present_, seen_;  ///< per mover
  std::vector<std::uint32_t> own_;                       ///< movers in the tile, ascending
  std::vector<base::Bytes> blocks_;                      ///< per rank
  std::vector<farm::ReadingFromBytes> received_;
  std::map<std::uint32_t, std::vector<base::Report>> neighbours_;  ///< of movers away from this home
  std::uint64_t passed_on_ = 0;
};

}  // namespace sf::scenarios
