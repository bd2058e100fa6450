#pragma once
// The other robots around an explorer: their maps, which it merges into its own, their claims, and their bodies.
//
// A robot claims the cells that it is about to see. Of several robots that claim a cell, the nearest to the cell has
// priority, and of equally near ones the lowest id. The others drop the cell at their next step.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "control/controller.h"
#include "control/exploration_map.h"

namespace sf::control {

struct TeamSettings {
  std::uint32_t id = 0;  ///< own id in packets
  double radio = 50.0;   ///< [m] range
  double radius = 0.2;   ///< [m] of the own body
  double others = 0.2;   ///< [m] largest radius of all robots
};

class Teammates {
 public:
  explicit Teammates(const TeamSettings& settings) : settings_(settings) {}
  double radio() const { return settings_.radio; }

  void receive(std::span<const TeammateMap> maps) { maps_.assign(maps.begin(), maps.end()); }
  /// Updates places and claims, and merges new measurements into `map`. @return true if they changed it
  /// @throws base::InputError for a map with another geometry
  bool update(const ControllerInput& input, ExplorationMap& map);

  /// Returns whether another robot has claimed the cell and has priority.
  bool claimed(maps::CellAt cell, const ExplorationMap& map) const;
  /// Returns whether the surface point belongs to the body of another robot.
  bool is_body(glm::dvec2 p) const;
  /// Returns whether a motion from the own place to `p` leads too close to another robot.
  bool blocks(glm::dvec2 p) const;
  /// Adds the bodies of the others to the map.
  void add_bodies(ExplorationMap& map) const;

  /// Replaces the snapshot if the claim changed, or at most once per second if there are new measurements.
  /// @param time [ns]  @param claim ascending keys of cells
  void publish(std::int64_t time, std::vector<std::int64_t> claim, ExplorationMap& map);
  const std::shared_ptr<const SharedMap>& published() const { return published_; }

 private:
  struct Claimant {
    std::uint32_t id = 0;
    glm::dvec2 p;  ///< [m]
    std::shared_ptr<const SharedMap> map;
  };
  /// Measurements of one robot that are merged already.
  struct Merged {
    std::size_t count = 0;
    std::shared_ptr<const MapChanges> last;  ///< another robot may use an id again, and then starts from 0
  };
  bool merge(const TeammateMap& teammate, ExplorationMap& map);

  TeamSettings settings_;
  glm::dvec2 here_{};                           ///< [m] own place
  std::vector<glm::dvec2> places_;              ///< [m] of the others, with and without maps
  std::vector<TeammateMap> maps_;               ///< inputs of the next step
  std::vector<Claimant> claimants_;             ///< present teammates
  std::map<std::uint32_t, Merged> merged_;      ///< per id
  std::shared_ptr<const SharedMap> published_;  ///< null before the first step
  std::int64_t published_at_ = 0;               ///< [ns] time of the last measurements
};

}  // namespace sf::control
