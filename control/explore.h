#pragma once
// Autonomous exploration without contacts, which the thesis' avoidance (control/avoid.h) cannot guarantee. The robot
// keeps its own map and drives to the nearest pose from which its laser would see unexplored cells, until there is no
// such pose.
//
// Paths are searched over places and headings (control/pose_search.h), since the laser's field of view is limited and
// the laser may extend beyond the body. A goal is kept until all its target cells are seen or the path is blocked.
// Goals that allow `margin` come first, then goals with `least_margin`: the robot drives through a passage that is
// `least_margin` wider than the body on both sides.
//
// Robots of a team also use the maps of the others, and do not choose cells that another robot with priority is about
// to see (control/teammates.h).
//
// Assumptions: a static world, a body that turns in place (modelled as its circumscribed disc), and a precise pose,
// since margins are in millimetres. Readings of laser 0 are added at the pose of their measurement.
//
// In a moving world, cells may become free again, and commands are checked by the area that the outline sweeps
// (control/swept_area.h), not by the map. Margins are then centimetres.

#include <optional>
#include <vector>

#include "control/controllers.h"
#include "control/exploration_map.h"
#include "control/pose_search.h"
#include "control/swept_area.h"
#include "control/teammates.h"
#include "control/viewpoint_planner.h"

namespace sf::control {

struct ExploreSettings {
  maps::GridGeometry geometry;
  Footprint body;
  ScannerModel eye;
  std::vector<glm::dvec2> beams;        ///< directions in the laser's frame
  double range_min = 0.0;               ///< [m] minimum range of the laser
  double speed = 0.1;                   ///< [m/s]
  double slow_speed = 0.05;             ///< [m/s] while an obstacle ahead of the body is nearer than `slow`
  double slow = 0.05;                   ///< [m]
  double turn = 1.0;                    ///< [rad/s] maximum
  double view = HUGE_VAL;               ///< [m] cells count as explored when seen from within
  double margin = 0.01;                 ///< [m] between body and surfaces, in the first stages
  double least_margin = 0.003;          ///< [m] the same in the last stages; <= margin
  bool thorough = false;                ///< adds a last stage that looks along surfaces for hidden cells
  double patience = 2.0;                ///< [s] maximum wait for a reading at a goal
  bool moving = false;                  ///< objects move
  std::optional<SweptArea> swept_area;  ///< checks commands; nullopt: the map does. Requires `moving`
  std::optional<TeamSettings> team;     ///< nullopt: the robot explores alone, and ignores other robots
};

/// Returns a grid with cells of 3 cm (default) around all walls, at least as large as the thesis' 30 x 30 words, with
/// the world's centre at its own centre.
/// @throws base::InputError for an area that is too large
maps::GridGeometry grid_around(const world::World& world, double cell = 0.03);

class Explore final : public Controller, public SharesMap {
 public:
  explicit Explore(const ExploreSettings& settings);

  base::Twist step(const ControllerInput& input) override;
  bool done() const override { return stage_ == kStages; }
  double v2v_range() const override;
  bool shares_map() const override { return team_.has_value(); }
  std::shared_ptr<const SharedMap> shared_map() const override { return team_->published(); }
  void receive_maps(std::span<const TeammateMap> maps) override { team_->receive(maps); }

  const maps::OccupancyGrid& grid() const { return map_.grid(); }
  const maps::OccupancyGrid* own_map() const override { return &map_.grid(); }
  int stage() const { return stage_; }  ///< in [0, kStages]
  static constexpr int kStages = 5;

 private:
  struct Stage;
  static const Stage kStage[kStages];
  /// Part of a path: a turn in place, or a straight line.
  struct Leg {
    bool straight = false;
    glm::dvec2 end;  ///< [m] end point of a straight line
    bool backwards = false;
    double heading = 0.0;  ///< [rad]
    double side = 1.0;     ///< +1: turn to the left; -1: to the right
  };
  base::Twist decide(const ControllerInput& input);
  bool update_map(const ControllerInput& input);
  std::span<const double> without_bodies(const base::ReadingBlock& reading, std::span<const double> ranges);
  void drop_claimed_targets();
  base::Twist turn_once(const base::Pose& X_WM);
  bool targets_seen() const;
  bool blocked() const;
  void plan(const ControllerInput& input);
  bool find_goal(const LatticeState& from, const Stage& stage);
  void pause(std::int64_t time);
  void set_path(const std::vector<LatticeState>& way);
  base::Twist drive(const ControllerInput& input);
  base::Twist wait(const ControllerInput& input);
  void give_up();
  base::Twist follow(const Leg& leg, const base::Pose& X_WM, double dt) const;
  bool finished(const Leg& leg, const base::Pose& X_WM) const;
  bool safe(const base::Pose& X_WM, const base::Twist& twist, double dt) const;
  base::Twist checked(const ControllerInput& input, const base::Twist& wanted);
  double here() const { return 0.2 * map_.cell(); }
  double aligned() const;

  ExploreSettings settings_;
  ExplorationMap map_;
  PoseSearch search_;
  ViewpointPlanner viewpoint_planner_;
  std::optional<Teammates> team_;  ///< nullopt: alone
  int stage_ = 0;
  bool started_ = false, turned_once_ = false;
  double turned_ = 0.0, last_yaw_ = 0.0;
  std::optional<std::uint32_t> sequence_;  ///< sequence of the last scan
  base::Pose X_WS_;                        ///< sensor pose of the last scan
  std::vector<double> ranges_;             ///< [m] ranges of the last scan with flags
  std::vector<double> seen_ranges_;        ///< [m] ranges of the last scan without other robots
  std::int64_t last_time_ = 0;
  std::int64_t pause_;                        ///< [ns] until the next plan while teammates explore the rest
  std::optional<std::int64_t> evades_since_;  ///< [ns] the swept area is not free
  struct Stand {
    glm::dvec2 p;            ///< [m]
    std::int64_t since = 0;  ///< [ns]
    bool leaves = false;     ///< drives away from there
  };
  std::optional<Stand> stands_;               ///< the place of the last commands
  int blocked_plans_ = 0;                     ///< successive plans without a path around other robots
  std::int64_t paused_until_ = 0;             ///< [ns] waits for teammates
  std::optional<std::int64_t> in_way_since_;  ///< [ns] a teammate blocks the path
  std::vector<LatticeState> path_;            ///< path to the goal, which is its last state
  std::vector<Leg> legs_;                     ///< remaining legs; the next leg is last
  std::vector<maps::CellAt> targets_;
  std::optional<std::int64_t> arrived_;  ///< [ns] time of arrival at the goal
};

extern const ControllerType explore_controller;

}  // namespace sf::control
