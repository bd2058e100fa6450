#pragma once
// Plans ways around obstacles that a robot has found by contact: everything else is taken as free. A way is the descent
// of the cost to the nearest goal, computed over a grid by Dijkstra's algorithm (LaValle, "Planning Algorithms", 2006,
// section 8.2.2), again after each contact.

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

namespace sf::control {

/// Positions [m] are in one frame of the caller's choice. Not thread-safe.
class ContactMap {
 public:
  /// @param radius [m] of the robot
  explicit ContactMap(double radius) : radius_(radius) {}

  /// Adds a point of an obstacle. Drops the oldest one beyond kMostPoints.
  void add(const glm::dvec2& p);
  /// Returns whether a point is within `distance` [m] of `p`.
  bool is_near(const glm::dvec2& p, double distance) const;
  /// Returns whether a robot at `p` keeps its distance from all points.
  bool is_free(const glm::dvec2& p) const { return !is_near(p, radius_ + kMargin); }
  /// Plans ways to the nearest of the goals. Robots and goals are within kMostExtent of the origin; those farther away
  /// are taken as at the border.
  void plan(const glm::dvec2& robot, std::span<const glm::dvec2> goals);
  /// Returns the point to drive to next. @pre `plan`
  glm::dvec2 next(const glm::dvec2& robot) const;

  static constexpr double kMostExtent = 10.0;  ///< [m] in x and y
  static constexpr std::size_t kMostPoints = 256;

 private:
  static constexpr double kCell = 0.05;     // [m]
  static constexpr double kMargin = 0.03;   // [m] kept from points
  static constexpr double kSurround = 1.5;  // [m] planned around the robot, the goals and the points
  static constexpr float kBlocked = 30.0f;  // [-] cost of a cell near a point: crossed if no other way is shorter
  std::size_t cell_of(const glm::dvec2& p) const;
  glm::dvec2 middle_of(std::size_t cell) const;
  void frame(const glm::dvec2& robot, std::span<const glm::dvec2> goals);
  bool is_clear(const glm::dvec2& from, const glm::dvec2& to) const;
  template <class Visit>
  void for_each_neighbour(std::size_t cell, const Visit& visit) const;

  double radius_;
  std::vector<glm::dvec2> points_;
  glm::dvec2 corner_{};  ///< [m] lower left corner of the grid
  std::size_t columns_ = 0, rows_ = 0;
  std::vector<float> cost_;  ///< [cells] to the nearest goal, by row
};

}  // namespace sf::control
