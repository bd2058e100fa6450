#pragma once
// Maps an area and touches nothing: what the thesis' avoidance (control/avoid.h) lacks. It drives by a map of its own,
// to the nearest pose from which its laser would see something unexplored, until there is no such pose.
//
// Ways are searched over places and headings (control/pose_search.h): the laser looks one way, and may reach beyond the
// body. It keeps a goal until everything it wanted to see there is seen, or the way is barred. First it takes what is
// easy to reach, with some margin, then the rest with hardly any: a passage is one when it is `least_margin` wider on
// both sides than the body.
//
// For a world that stands still, a body that turns in place (it is taken as the disc about it) and a pose that is known
// well: margins are in millimetres. Readings of laser 0 are taken at the pose they were measured at.

#include <optional>
#include <vector>

#include "control/controllers.h"
#include "control/exploration_map.h"
#include "control/pose_search.h"
#include "control/viewpoint_planner.h"

namespace sf::control {

struct ExploreSettings {
  maps::GridGeometry plan;
  Footprint body;
  ScannerModel eye;
  std::vector<glm::dvec2> beams;  ///< of the laser, in its frame
  double range_min = 0.0;         ///< [m] of the laser
  double speed = 0.1;             ///< [m/s]
  double slow_speed = 0.05;       ///< [m/s] with something nearer than `slow` to the body ahead
  double slow = 0.05;             ///< [m]
  double turn = 1.0;              ///< [rad/s] at most
  double margin = 0.01;           ///< [m] between body and surfaces, at first
  double least_margin = 0.003;    ///< [m] when nothing else is left; <= margin
  bool thorough = false;          ///< at last, looks along surfaces for what may be hidden behind them
  double patience = 2.0;          ///< [s] for a reading after it stands where it wanted to look
};

/// A map of cells of 3 cm around all walls, at least the thesis' 30 x 30 words, the world's middle in its own.
/// @throws base::InputError for an area that is too large
maps::GridGeometry grid_around(const world::World& world, double cell = 0.03);

class Explore final : public Controller {
 public:
  explicit Explore(const ExploreSettings& settings);

  base::Twist step(const ControllerInput& input) override;
  bool done() const override { return stage_ == kStages; }

  const maps::OccupancyGrid& grid() const { return map_.grid(); }
  int stage() const { return stage_; }  ///< in [0, kStages]
  static constexpr int kStages = 5;

 private:
  /// Part of a way: a turn in place, or a straight line.
  struct Leg {
    bool straight = false;
    glm::dvec2 end;  ///< [m] of a straight line
    bool backwards = false;
    double heading = 0.0;  ///< [rad]
    double side = 1.0;     ///< +1: turns left
  };
  bool update_map(const ControllerInput& input);
  base::Twist turn_once(const base::Pose& X_WM);
  bool targets_seen() const;
  bool blocked() const;
  void plan(const base::Pose& X_WM);
  void set_path(const std::vector<LatticeState>& way);
  base::Twist drive(const ControllerInput& input);
  base::Twist wait(const ControllerInput& input);
  void give_up();
  base::Twist follow(const Leg& leg, const base::Pose& X_WM, double dt) const;
  bool finished(const Leg& leg, const base::Pose& X_WM) const;
  bool safe(const base::Pose& X_WM, const base::Twist& twist, double dt) const;

  ExploreSettings settings_;
  ExplorationMap map_;
  PoseSearch search_;
  ViewpointPlanner viewpoint_planner_;
  int stage_ = 0;
  bool started_ = false, turned_once_ = false;
  double turned_ = 0.0, last_yaw_ = 0.0;
  std::optional<std::uint32_t> sequence_;  ///< of the last scan
  base::Pose X_WS_;                        ///< of the last scan
  std::int64_t last_time_ = 0;
  std::vector<LatticeState> path_;  ///< to the goal, its last state
  std::vector<Leg> legs_;           ///< still to go, the next one last
  std::vector<maps::CellAt> targets_;
  std::optional<std::int64_t> arrived_;  ///< [ns]
};

extern const ControllerType explore_controller;

}  // namespace sf::control
