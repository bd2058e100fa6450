#pragma once
// The states and the motion of all movers.
//
//   Fleet fleet(world);
//   fleet.move(commands, interval);            // simulated, or
//   farm.tick(now, fleet.reports()); ... fleet.contacts();
//   fleet.apply(reports);                      // from outside
//   farm.tick(now, fleet.predict(now));
//
// `move` resolves conflicts in at most Fleet::kRounds rounds of two phases:
//
//   1 propose  Each mover advances as far as the walls and the other movers allow, with the others at their poses at
//              the start of the round. If a mover that may still advance is in the way, it waits with the rest of its
//              path.
//   2 resolve  A mover whose proposed path meets the proposed place of a mover with a smaller id keeps its old place.
//
// The next round runs for the movers that wait or were held back, if they or a mover near them moved or were held back.
// In the last round no mover waits: a mover whose step is still refused stops, and turns if it can. Each round
// therefore gives the same result as moving one mover after another in order of ids (robots, then tags), and no mover
// overlaps another that it did not overlap before. A mover's result depends only on the movers near it (within kRounds
// times the paths of both), not on rows, threads or the rest of the fleet.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"
#include "base/report.h"
#include "base/thread_pool.h"
#include "robots/contact_sectors.h"
#include "robots/dynamics.h"
#include "robots/footprint.h"
#include "robots/neighbour_grid.h"
#include "world/copies.h"
#include "world/ground.h"
#include "world/wall_tree.h"
#include "world/world.h"

namespace sf::robots {

/// Returns the states of all movers at rest at their load poses at time 0, in order of rows.
std::vector<base::Report> states_at_load(const world::World& world);

/// Not thread-safe. Does not allocate after construction, unless more than a thousand walls are near one mover.
class Fleet {
 public:
  static constexpr int kRounds = 4;                ///< per tick, at most
  static constexpr double kMostTested = 16'384.0;  ///< [substeps] with obstacles near, per mover and round

  /// All movers start at rest at their load poses at time 0. `world` and `thread_pool` must outlive the fleet.
  /// @param thread_pool shares the work of `move` and `predict` without changing results; null: uses only the caller's
  /// thread
  explicit Fleet(const world::World& world, base::ThreadPool* thread_pool = nullptr);

  /// Simulates `dt` [ns] > 0. A command passes through the mover's actuator model, then through the limits of its drive
  /// and of its accelerations from its current velocity. Motion is tested in substeps no longer than `Footprint::step`.
  /// A substep that would make the outline touch a wall or another mover is refused: the mover advances to within 0.5
  /// mm of the contact and stops. A stopped mover may still turn in place (except a car), and may push itself off by up
  /// to 4 mm per substep to do so. An existing contact (from overlapping starts or reports) stops a mover only if its
  /// origin would move closer to the touched wall or mover. Conflicts between movers follow the rule above.
  ///
  /// Afterwards `Report::contact_mask` has the touched sectors (robots/contact_sectors.h) of movers with a refused step
  /// and of the movers that refused it. The mask is kept as long as the contact lasts, also at rest. Passing by without
  /// a refused step does not count.
  ///
  /// A robot with `dynamics` advances by these instead, without obstacles, and its path for the tests is the arc to
  /// that pose, at the height before the tick. If a step is refused, it keeps its height above the ground, its tilt and
  /// its vertical motion.
  ///
  /// The work is bounded. On a path of more than 1024 substeps, pieces without obstacles near them are not tested. A
  /// mover that has passed obstacles for 16384 substeps ends its tick there.
  /// @param commands one per mover; NaN and infinity count as 0
  void move(std::span<const base::Twist> commands, std::int64_t dt);

  /// Applies states of movers from outside; `predict` computes their contacts. A report older than the mover's state is
  /// ignored; a report of the same time replaces it.
  /// @param reports finite, with rows of existing movers
  /// @return number of accepted reports
  std::size_t apply(std::span<const base::Report> reports);

  /// Returns the height [m] of a mover after a move to `p` (world::Ground::follow).
  double height_at(std::uint32_t row, glm::dvec2 p) const { return ground_.follow(reports_[row].X_WM, p); }

  /// Marks a mover as absent or present. Other movers do not collide with an absent mover, `move` does not move it, and
  /// it has no contacts.
  void set_absent(std::uint32_t row, bool gone) { absent_[row] = gone ? 1 : 0, disturbed_ = true; }

  /// Makes a robot move by `dynamics`, from its current state. Cars (`dynamics "car"`) do so from the start; the
  /// dynamics of plug-ins have to be set before `move` (control/own_dynamics.h).
  void set_dynamics(std::uint32_t row, DynamicsPointer dynamics);

  /// Adds the world's new last mover: at rest at its load pose, at the time of the others.
  void add_mover();

  /// Restarts a mover: at rest at its load pose, which may have changed, at the time of the others.
  void restart(std::uint32_t row);

  /// Call this after outlines of movers have changed in the world (world::change_shape).
  void update_outlines(std::span<const std::uint32_t> rows);
  void update_outline(std::uint32_t row) { update_outlines({&row, 1}); }

  /// Sets the state of a mover that another process computed with `move`.
  /// @param contact its entry in `contacts`
  void set_moved(const base::Report& report, bool contact);

  /// Returns the newest states, one per mover in order of rows. Yaw is in [-pi, pi] after `move`, and as reported after
  /// `apply`. The velocity of a simulated mover is that at the end of the tick, and 0 after a stop. Valid for the
  /// lifetime of the fleet.
  std::span<const base::Report> reports() const { return reports_; }

  /// Returns `reports()` extrapolated to `time` [ns] (robots::extrapolate). Contacts of movers with reports from
  /// outside are computed at these poses and added to those in the reports. Valid until the next call.
  std::span<const base::Report> predict(std::int64_t time);

  /// A surface within kContactDistance of a mover's outline, or inside it.
  struct Touch {
    std::uint32_t model = 0;             ///< row in World::models: of the other mover, or of the static model
    std::uint32_t mover = world::kNone;  ///< row of the other mover; kNone: it is static
    glm::dvec2 p;                        ///< [m] world frame: the surface's point nearest to the outline, or inside it
  };
  /// Appends one touch per static model, and one per mover of `others` that is present. Stateless: a touch needs no
  /// refused step.
  /// @param states one per mover
  void find_touches(std::uint32_t row, std::span<const base::Report> states, std::span<const std::uint32_t> others,
                    std::vector<Touch>& touches) const;

  /// Returns the number of substeps that `move` has tested against obstacles near them, in all ticks.
  std::uint64_t steps_tested() const;

  /// Returns one value per mover: 1 if the last `move` refused it a step or if it touches something
  /// (`Report::contact_mask`).
  std::span<const std::uint8_t> contacts() const { return contacts_; }

 private:
  /// Progress of a mover in this tick.
  struct Progress {
    base::Pose X_WM;
    base::Twist velocity;  ///< for the rest of the tick
    double left = 0.0;     ///< [s] left of the tick; 0: finished
    bool refused = false;  ///< a step was refused in this tick
    bool free = false;     ///< no obstacle is near
    bool exposed = false;  ///< paths of other movers are near
  };
  /// Outcome of one step: free, held for another round, or refused.
  enum class Stop : std::uint8_t { none, waiting, refused };
  struct BodyContact {
    std::uint32_t sectors = 0;
    glm::dvec2 away;  ///< world frame: sum of the unit vectors from the touching surfaces to the mover's origin
  };
  /// A disc without walls around a former place. No walls are searched while a mover's path stays in it. Those of
  /// robots with dynamics, whose heights change, last for a tick.
  struct FreeDisc {
    glm::dvec2 centre;
    double radius = 0.0;  ///< [m]
  };
  /// The other movers whose discs may come within kContactDistance of a mover's in this tick. Searching the grid once
  /// per tick instead of in every round makes crowds cheaper.
  struct Nearby {
    static constexpr std::uint32_t kMost = 15;
    std::uint32_t count = world::kNone;  ///< more than kMost: they are not listed
    std::array<std::uint32_t, kMost> rows{};
  };
  /// The footprint of a mover at its last tested pose, kept because movers in a crowd are tested many times.
  struct Placed {
    std::uint32_t row = world::kNone;
    base::Pose X_WM;
    std::vector<FootprintEdge> edges;
  };
  /// Buffers of one thread.
  struct Scratch {
    std::vector<FootprintEdge> next;  ///< for place_footprint
    Placed now;
    std::array<Placed, 16> others;             ///< by the last bits of their rows
    std::vector<std::uint32_t> near;           ///< movers near this mover's path or a piece of it
    std::vector<std::uint32_t> all_near;       ///< movers near the whole path
    std::vector<const world::Segment*> walls;  ///< walls near the whole path
    std::vector<std::uint32_t>
        priority_movers;       ///< subset: movers with a smaller id and a different place after this round
    std::uint64_t tested = 0;  ///< [steps] as `steps_tested`
    bool yields = false;       ///< its path meets the place of a priority mover
    double farthest = 0.0;     ///< [m] largest travel of an origin in this tick, of all movers so far
  };

  /// A robot with dynamics.
  struct DynamicBody {
    DynamicsPointer dynamics;   ///< null: it moves in the plane
    std::vector<double> state;  ///< Dynamics::state_size
    base::Report end;           ///< after this tick, without obstacles
  };

  void make_room();
  void add_dynamics(std::uint32_t row);
  void require_dynamics() const;
  bool is_dynamic(std::uint32_t row) const { return !bodies_.empty() && bodies_[row].dynamics != nullptr; }
  base::Twist move_body(std::uint32_t row, const base::Twist& wanted, double seconds);
  void place_body(std::uint32_t row);
  base::Twist velocity_for(std::uint32_t row, const base::Twist& wanted, double seconds) const;
  void start(std::uint32_t row, const base::Twist& command, double seconds, Scratch& scratch);
  void run_round(bool last);
  void find_next();
  void propose(std::uint32_t row, bool last, Scratch& scratch);
  bool yields(std::uint32_t row, bool last, Scratch& scratch);
  bool meets_priority_movers_freely(std::uint32_t row, Scratch& scratch) const;
  double sweep_of(std::uint32_t row) const;
  double reach_of(std::uint32_t row) const;
  void commit(std::uint32_t row);
  void find_free_disc(std::uint32_t row);
  bool is_in_free_disc(std::uint32_t row) const;
  void list_nearby(std::uint32_t row);
  template <class Visit>
  bool any_nearby(std::uint32_t row, glm::dvec2 p, double reach, Visit&& visit) const;
  void find_near(std::uint32_t row, Scratch& scratch) const;
  bool moved(std::uint32_t row) const;

  bool clear(std::uint32_t row, std::span<const base::Report> reports, double sweep) const;
  template <class Visit>
  bool any_wall(std::uint32_t row, const base::Pose& X_WM, double sweep, Visit&& visit) const;
  bool comes_near(std::uint32_t row, const base::Pose& from, double sweep, std::uint32_t other,
                  const base::Pose& X_WO) const;
  Progress advance_mover(std::uint32_t row, bool last, Scratch& scratch) const;
  bool is_free(std::uint32_t row, const Progress& from, double seconds, std::span<const std::uint32_t> others,
               std::span<const std::uint32_t> rivals) const;
  void find_obstacles(std::uint32_t row, const base::Pose& X_WM, double reach, std::span<const std::uint32_t> others,
                      Scratch& scratch) const;
  Progress advance_in_pieces(std::uint32_t row, double steps, bool last, Scratch& scratch) const;
  Progress advance_in_steps(std::uint32_t row, Progress progress, double steps, bool last, Scratch& scratch) const;
  double advance_to_contact(std::uint32_t row, Progress& progress, double dt, bool last, Scratch& scratch) const;
  bool turn_in_contact(std::uint32_t row, Progress& progress, double dt, bool last, Scratch& scratch) const;
  bool push_off(std::uint32_t row, Progress& progress, double dt, bool last, Scratch& scratch) const;

  // Obstacles on a mover's path from one pose to another.
  Stop stop_at(std::uint32_t row, const base::Pose& from, const base::Pose& to, bool last, Scratch& scratch) const;
  PlacedFootprint place_again(std::uint32_t row, const base::Pose& X_WM, Placed& memory) const;
  bool meets_priority_mover(std::uint32_t row, const base::Pose& from, const PlacedFootprint& next,
                            Scratch& scratch) const;
  bool is_stopped(std::uint32_t row, const base::Pose& from, const PlacedFootprint& next, std::uint32_t other,
                  const base::Pose& X_WO, Scratch& scratch) const;
  bool leaves(std::uint32_t row, const base::Pose& from, glm::dvec2 to, const world::Segment& wall,
              Scratch& scratch) const;

  /// @param struck if not empty: set to 1 for other movers that touch it
  BodyContact body_contact(std::uint32_t row, const base::Pose& X_WM, std::span<const base::Report> reports,
                           std::span<std::uint8_t> struck = {}) const;
  bool keeps_contacts(std::uint32_t row) const;
  void update_contacts();
  void update_reported_contacts();
  template <class Body>
  void for_rows(std::size_t count, Body&& body);

  const world::World& world_;
  base::ThreadPool* thread_pool_;
  std::vector<Footprint> footprints_;
  world::WallTree walls_;
  world::Ground ground_;
  world::CopyIndex copies_;
  NeighbourGrid neighbours_;
  double widest_ = 0.0;    ///< [m] largest outline radius
  double farthest_ = 0.0;  ///< [m] largest distance of an origin from its position in `neighbours_`
  std::vector<base::Report> reports_;
  std::vector<base::Report> predicted_;
  std::vector<std::uint32_t> rank_;  ///< place in the order of ids, robots before tags
  std::vector<base::Pose> starts_;   ///< at the start of the tick; empty on flat ground
  std::vector<double> travels_;      ///< [m] largest travel of each origin in this tick
  std::vector<DynamicBody> bodies_;  ///< empty: all movers move in the plane
  std::vector<Progress>
      progress_;  ///< at the start of the round; `reports_` has the poses that other movers test against
  std::vector<Progress> proposed_;
  std::vector<FreeDisc> free_discs_;
  std::vector<Nearby> nearby_;
  std::vector<std::uint8_t> waiting_;      ///< 1: its tick is not finished
  std::vector<std::uint8_t> yielded_;      ///< 1: yielded in this round
  std::vector<std::uint8_t> changed_;      ///< 1: it moved or yielded in this round
  std::vector<std::uint8_t> moved_;        ///< 1: it moved in this tick
  std::vector<std::uint8_t> continues_;    ///< 1: takes part in the next round
  std::vector<std::uint32_t> unfinished_;  ///< rows whose tick is not finished
  std::vector<std::uint32_t> round_rows_;  ///< subset of `unfinished_`: rows in this round
  std::vector<Scratch> scratch_;           ///< per thread
  std::vector<std::uint8_t> contacts_;
  std::vector<std::uint8_t> refused_;   ///< 1: the last `move` refused it a step
  std::vector<std::uint8_t> struck_;    ///< 1: it touches a mover with a refused step; 0 between calls
  std::vector<std::uint8_t> reported_;  ///< 1: set by a report since the last `move`
  std::vector<std::uint8_t> absent_;
  bool disturbed_ = true;  ///< a mover changed since the last `move`, other than by it
};

/// Returns true as soon as `visit(other)` is true for a mover within about `reach` [m] of `p`, a place that the mover
/// `row` may reach in this tick.
template <class Visit>
bool Fleet::any_nearby(std::uint32_t row, glm::dvec2 p, double reach, Visit&& visit) const {
  const Nearby& listed = nearby_[row];
  if (listed.count <= Nearby::kMost) return std::any_of(&listed.rows[0], &listed.rows[0] + listed.count, visit);
  return neighbours_.any(p, reach, visit, copies_.copy_of(row));
}

template <class Body>
void Fleet::for_rows(std::size_t count, Body&& body) {
  constexpr std::size_t kGrain = 32;
  const auto row = [&](std::size_t i, unsigned thread) { body(static_cast<std::uint32_t>(i), scratch_[thread]); };
  if (thread_pool_ != nullptr) return thread_pool_->parallel_for_each(count, kGrain, row);
  for (std::size_t i = 0; i < count; ++i) row(i, 0);
}

}  // namespace sf::robots
