#pragma once
// Stretches of road (links), and the link on which a vehicle is. Links are lines in driving direction.
//
// In a world file, as settings of a sensor:
//   links 2  link[0] [0 0 10 0]  link[1] [10 -3 5 -3 0 -3]  reach 1.5
//   lanes ["1.1" "2.1"]        of the world's road network; lanes "all"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/box_tree.h"
#include "world/world.h"

namespace sf::sensors {

inline constexpr std::uint32_t kMostLinks = 10'000;

struct RoadLink {
  std::string name;                ///< "0", "1", ..., or the lane's: "2.1"
  std::vector<glm::dvec2> points;  ///< [m] world frame, at least two; neighbouring points differ
  double reach = 0.0;              ///< [m] > 0: vehicles on it are at most that far from the line
  std::vector<double> s = {};      ///< [m] length up to each point

  double length() const { return s.back(); }
};

/// A place on a link.
struct LinkPlace {
  std::uint32_t link = 0;  ///< row
  double s = 0.0;          ///< [m] along it
};

/// Immutable and thread-safe.
class RoadLinks {
 public:
  /// @param links `s` is computed
  explicit RoadLinks(std::vector<RoadLink> links);

  const std::vector<RoadLink>& links() const { return links_; }
  /// Returns the nearest place within reach on a link whose direction differs from `yaw` by at most 60 degrees.
  /// @param p [m] world frame  @param yaw [rad]; nullopt: any direction
  std::optional<LinkPlace> find(glm::dvec2 p, std::optional<double> yaw) const;
  /// Returns the distance [m] driven from one place to another of one link. On a link that ends where it begins, the
  /// shorter way counts.
  double driven(std::uint32_t link, double from, double to) const;

 private:
  struct Piece {
    std::uint32_t link = 0, point = 0;
  };
  std::vector<RoadLink> links_;
  std::vector<Piece> pieces_;  ///< by link, then along it
  base::BoxTree tree_;         ///< of the pieces, widened by their reach
};

/// @throws base::InputError with file and line
RoadLinks read_road_links(const world::World& world, const world::Sensor& sensor);
/// Returns the rows of the links that make up `route`, by name or by row; empty: there is no such property.
/// @throws base::InputError with file and line
std::vector<std::uint32_t> read_link_route(const world::Sensor& sensor, const RoadLinks& links);

}  // namespace sf::sensors
