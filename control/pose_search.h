#pragma once
// Path search for a body with a sensor on it, on a lattice of places and sixteen headings: cheapest path from the
// current state (Dijkstra, "A note on two problems in connexion with graphs", 1959).
//
// A state is allowed if the body keeps its margin to all surfaces and covers no unexplored ground, and no surface lies
// between the body and its sensor, which may extend beyond the body.

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "control/exploration_map.h"

namespace sf::control {

inline constexpr int kHeadings = 16;

/// Lattice node and heading.
struct LatticeState {
  Node node = 0;
  int heading = 0;  ///< in [0, kHeadings)
  bool operator==(const LatticeState&) const = default;
};

/// Returns the angle [rad] of heading k. Headings point to sixteen neighbouring nodes and are 18 to 27 degrees apart.
double heading_angle(int heading);

/// The moving body.
struct Footprint {
  double radius = 0.165;  ///< [m]
  glm::dvec2 p_MS;        ///< [m] position of its sensor in the robot's frame
};

class PoseSearch {
 public:
  /// `map` must outlive it.
  PoseSearch(const ExplorationMap& map, const Footprint& body);

  /// @param margin [m] between the body and all surfaces
  bool allowed(const LatticeState& state, double margin) const;

  /// Returns the sensor's node in a state. @pre the body is within the map
  Node sensor_at(const LatticeState& state) const {
    return state.node + sensor_[static_cast<std::size_t>(state.heading)];
  }

  /// Returns the cheapest path from `from` to the first state for which `goal` returns true. Empty if there is none.
  /// Near `from` a smaller margin is allowed if the start does not have the full margin.
  std::vector<LatticeState> find(const LatticeState& from, double margin,
                                 const std::function<bool(const LatticeState&)>& goal);

 private:
  std::uint32_t cost_at(Node node) const;
  bool sensor_arm_clear(Node node, int half_heading) const;
  void relax(const LatticeState& from, std::uint32_t so_far, double margin, double spare);
  std::vector<LatticeState> path_to(const LatticeState& goal, const LatticeState& from) const;

  const ExplorationMap& map_;
  Footprint body_;
  std::array<Node, kHeadings> ahead_{};  ///< node offset of one step forward
  std::array<Node, kHeadings> sensor_{};
  std::array<std::vector<Node>, 2 * kHeadings> sensor_arm_;  ///< offsets of the nodes between the body and its sensor
  std::vector<std::uint32_t> cost_;
  std::vector<std::uint8_t> move_;  ///< move that led to the state
  std::vector<std::vector<std::uint32_t>> buckets_;
  std::size_t waiting_ = 0;
  Node start_ = 0;
};

}  // namespace sf::control
