#pragma once
// Ways for a body with a sensor on it: a lattice of places and sixteen headings, searched by cost from where it is
// (Dijkstra, "A note on two problems in connexion with graphs", 1959).
//
// A state is allowed where the body keeps its distance from every surface and covers no unexplored ground, and nothing
// stands between it and its sensor, which may reach beyond the body: it is never turned into a wall.

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "control/exploration_map.h"

namespace sf::control {

inline constexpr int kHeadings = 16;

/// A place and a heading.
struct LatticeState {
  Node node = 0;
  int heading = 0;  ///< in [0, kHeadings)
  bool operator==(const LatticeState&) const = default;
};

/// [rad] of heading k: towards one of sixteen neighbours on the lattice, 21 to 27 degrees apart.
double heading_angle(int heading);

/// What moves.
struct Footprint {
  double radius = 0.165;  ///< [m]
  glm::dvec2 p_MS;        ///< [m] its sensor
};

class PoseSearch {
 public:
  /// `terrain` outlives it.
  PoseSearch(const ExplorationMap& map, const Footprint& body);

  /// @param margin [m] the body keeps from every surface; from `from` on it may begin nearer
  bool allowed(const LatticeState& state, double margin) const;

  /// The sensor's node in a state. Rule: the body is within the map.
  Node sensor_at(const LatticeState& state) const {
    return state.node + sensor_[static_cast<std::size_t>(state.heading)];
  }

  /// The cheapest way to the first state that is a goal: `from` first, the goal last; empty: there is none.
  std::vector<LatticeState> find(const LatticeState& from, double margin,
                                 const std::function<bool(const LatticeState&)>& goal);

 private:
  std::uint32_t cost_at(Node node) const;
  bool sensor_arm_clear(Node node, int half_heading) const;
  void relax(const LatticeState& from, std::uint32_t so_far, double margin, double spare);
  std::vector<LatticeState> path_to(const LatticeState& goal, const LatticeState& from) const;

  const ExplorationMap& map_;
  Footprint body_;
  std::array<Node, kHeadings> ahead_{};  ///< one step forward
  std::array<Node, kHeadings> sensor_{};
  std::array<std::vector<Node>, 2 * kHeadings> sensor_arm_;  ///< nodes between the body and its sensor
  std::vector<std::uint32_t> cost_;
  std::vector<std::uint8_t> move_;  ///< that led there
  std::vector<std::vector<std::uint32_t>> buckets_;
  std::size_t waiting_ = 0;
  Node start_ = 0;
};

}  // namespace sf::control
