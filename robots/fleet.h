#pragma once
// Everything that moves, and where it is.
//
//   Fleet fleet(world);
//   fleet.move(commands, interval);            // simulated, or
//   fleet.apply(reports);                      // told by someone else
//   farm.tick(fleet.reports()); ... fleet.contacts();
//
// The rule of `move` has two phases, in at most Fleet::kRounds rounds:
//
//   1 propose  Every mover goes as far as the walls and the others allow, these standing where they are when the round
//              begins. In front of one that may still go on it waits with the rest of its way.
//   2 resolve  A mover whose proposed way meets the place that a mover of smaller id proposes stays where it was.
//
// The next round is for movers that wait or stayed, where one near them moved or stayed. In the last round nothing is
// waited for: a mover that is still refused a step stands, turning where it can. So each round is what movers that go
// one after another would do, in order of ids, and none overlaps another that did not before. A mover's result depends
// on the movers near it alone (within kRounds times the ways of both), not on rows, threads or the rest of the fleet.

#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"
#include "base/report.h"
#include "base/thread_pool.h"
#include "robots/contact_sectors.h"
#include "robots/footprint.h"
#include "robots/neighbour_grid.h"
#include "world/wall_grid.h"
#include "world/world.h"

namespace sf::robots {

/// How long a report is carried on with its velocity. [ns]
inline constexpr std::int64_t kMaxExtrapolation = 500'000'000;

/// One caller at a time. Nothing is allocated after construction, but where more than a thousand walls are near one
/// mover.
class Fleet {
 public:
  static constexpr int kRounds = 4;  ///< of a tick, at most

  /// All movers at their places at load, at rest, at time 0. `world` must outlive the fleet, and so must `thread_pool`.
  /// @param workers share the work of `move` and `predict`, with the same results; null: the caller does it alone
  explicit Fleet(const world::World& world, base::ThreadPool* thread_pool = nullptr);

  /// Simulates `dt` [ns] > 0. A command passes the mover's command law, is reduced to what the drive can follow and to
  /// what its accelerations allow from the velocity it has, then tried in substeps no longer than `Footprint::step`; a
  /// substep that would make the outline touch a wall or another mover is refused, and done only as far as the last
  /// 0.5 mm before that. From there on the mover stands at once, only turning in place while it still can (a car
  /// stands): for that it may push itself off by up to 4 mm a substep. What a mover touched already (overlapping
  /// starts, reports) stops it only where its origin would come nearer to it. Other movers stop it by the rule above.
  ///
  /// `Report::contact_mask` then says what presses where (robots/contact_sectors.h): for movers that were refused a
  /// step, for those that they were refused by, and for as long as anything touches them afterwards, also while they
  /// stand. Passing by without being stopped is no touch.
  /// @param commands one per mover; not finite means 0
  void move(std::span<const base::Twist> commands, std::int64_t dt);

  /// Takes the states of movers that live elsewhere; what they touch is looked at in `predict`. A report older than
  /// what is known of the mover is left out; one of the same time replaces it. Heights are those at load, whatever
  /// reports say: the world is 2.5-D, for contacts as for sensors.
  /// @param reports finite, rows of movers that exist
  /// @return how many were taken
  std::size_t apply(std::span<const base::Report> reports);

  /// A mover that is gone touches nobody, until it is back.
  void set_absent(std::uint32_t row, bool gone) { absent_[row] = gone ? 1 : 0; }

  /// One per mover, in order of rows: the newest state. Yaw is in [-pi, pi] after `move`, as told after `apply`.
  /// A simulated mover's velocity is what it does at the end of the tick: 0 once stopped. Valid until the fleet is
  /// gone.
  std::span<const base::Report> reports() const { return reports_; }

  /// `reports()` carried on to `time` [ns] with constant twists, by kMaxExtrapolation at most; never backwards. What
  /// touches movers that were told by reports, there, is added to what the reports themselves say. Valid until the next
  /// call.
  std::span<const base::Report> predict(std::int64_t time);

  /// One per mover: 1 where the last `move` refused it a step, or where something touches it (`Report::contact_mask`).
  std::span<const std::uint8_t> contacts() const { return contacts_; }

 private:
  static constexpr double kMaxYield = 4e-3;  ///< [m] that a turning body pushes itself off by, a substep

  /// How far a mover has come in this tick.
  struct Progress {
    base::Pose X_WM;
    base::Twist velocity;  ///< that it goes on with
    double left = 0.0;     ///< [s] of the tick; 0: it goes no farther
    bool refused = false;  ///< a step, in this tick
    bool free = false;     ///< nothing stood near it
    bool exposed = false;  ///< others' ways are near it
  };
  /// Outcome of one step: free, held for another round, or not allowed.
  enum class Stop : std::uint8_t { none, waiting, refused };
  struct BodyContact {
    std::uint32_t sectors = 0;
    glm::dvec2 away;  ///< world frame: the sum of unit vectors from what touches to the mover's origin
  };
  /// One thread's memory.
  struct Scratch {
    std::vector<FootprintEdge> next, now, other;  ///< of `place`
    std::vector<std::uint32_t> near;              ///< movers that this one's way may meet
    std::vector<const world::Segment*> walls;     ///< likewise
    std::vector<std::uint32_t>
        priority_movers;    ///< of these: with a smaller id, and another place to be after this round
    bool yields = false;    ///< its way meets such a place
    double farthest = 0.0;  ///< [m] that an origin may travel this tick, of all movers seen
  };

  void start(std::uint32_t row, const base::Twist& command, double seconds, Scratch& scratch);
  void run_round(bool last);
  void find_next();
  void propose(std::uint32_t row, bool last, Scratch& scratch);
  bool yields(std::uint32_t row, bool last, Scratch& scratch);
  bool meets_priority_movers_freely(std::uint32_t row, Scratch& scratch) const;
  double sweep_of(std::uint32_t row) const;
  double reach_of(std::uint32_t row) const;
  void commit(std::uint32_t row);
  void find_near(std::uint32_t row, Scratch& scratch) const;
  bool moved(std::uint32_t row) const;

  bool clear(std::uint32_t row, std::span<const base::Report> reports, double sweep) const;
  template <class Visit>
  bool any_wall(std::uint32_t row, const base::Pose& X_WM, double sweep, Visit&& visit) const;
  bool comes_near(std::uint32_t row, const base::Pose& from, double sweep, std::uint32_t other,
                  const base::Pose& X_WO) const;
  Progress advance_mover(std::uint32_t row, bool last, Scratch& scratch) const;
  Progress advance_in_steps(std::uint32_t row, double steps, bool last, Scratch& scratch) const;
  double advance_to_contact(std::uint32_t row, Progress& progress, double dt, bool last, Scratch& scratch) const;
  bool turn_in_contact(std::uint32_t row, Progress& progress, double dt, bool last, Scratch& scratch) const;
  bool push_off(std::uint32_t row, Progress& progress, double dt, bool last, Scratch& scratch) const;

  // Obstacles of a mover on its way from one pose to another.
  Stop stop_at(std::uint32_t row, const base::Pose& from, const base::Pose& to, bool last, Scratch& scratch) const;
  bool meets_priority_mover(std::uint32_t row, const base::Pose& from, const PlacedFootprint& next,
                            Scratch& scratch) const;
  bool is_stopped(std::uint32_t row, const base::Pose& from, const PlacedFootprint& next, std::uint32_t other,
                  const base::Pose& X_WO, Scratch& scratch) const;
  bool leaves(std::uint32_t row, const base::Pose& from, glm::dvec2 to, const world::Segment& wall,
              Scratch& scratch) const;

  /// @param struck others that touch it are marked there, where not empty
  BodyContact body_contact(std::uint32_t row, const base::Pose& X_WM, std::span<const base::Report> reports,
                           std::span<std::uint8_t> struck = {}) const;
  void update_contacts();
  void update_reported_contacts();
  template <class Body>
  void for_rows(std::size_t count, Body&& body);

  const world::World& world_;
  base::ThreadPool* thread_pool_;
  std::vector<Footprint> footprints_;
  world::WallGrid walls_;
  NeighbourGrid neighbours_;
  double widest_ = 0.0;    ///< [m] largest outline radius
  double farthest_ = 0.0;  ///< [m] that an origin may be from where `neighbours_` has it
  std::vector<base::Report> reports_;
  std::vector<base::Report> predicted_;
  std::vector<std::uint32_t> rank_;  ///< in order of ids, robots before tags
  std::vector<double> travels_;      ///< [m] farthest that its origin travels this tick
  std::vector<Progress> progress_;   ///< when the round begins; where others see it is in `reports_`
  std::vector<Progress> proposed_;
  std::vector<std::uint8_t> waiting_;      ///< 1: its tick is not over
  std::vector<std::uint8_t> yielded_;      ///< 1: in this round
  std::vector<std::uint8_t> changed_;      ///< 1: it moved or was beaten in this round
  std::vector<std::uint8_t> continues_;    ///< 1: in the next round
  std::vector<std::uint32_t> unfinished_;  ///< rows whose tick is not over
  std::vector<std::uint32_t> round_rows_;  ///< of these: rows of this round
  std::vector<Scratch> scratch_;           ///< per thread
  std::vector<std::uint8_t> contacts_;
  std::vector<std::uint8_t> refused_;   ///< 1: a step in the last `move`
  std::vector<std::uint8_t> struck_;    ///< 1: someone was refused a step and touches it; 0 between calls
  std::vector<std::uint8_t> reported_;  ///< 1: by a report, since the last `move`
  std::vector<std::uint8_t> absent_;    ///< 1: nobody meets it
};

template <class Body>
void Fleet::for_rows(std::size_t count, Body&& body) {
  constexpr std::size_t kGrain = 32;
  const auto piece = [&](std::size_t first, std::size_t end, unsigned thread) {
    for (std::size_t i = first; i < end; ++i) body(static_cast<std::uint32_t>(i), scratch_[thread]);
  };
  if (thread_pool_ != nullptr)
    thread_pool_->parallel_for(count, kGrain, piece);
  else
    piece(0, count, 0);
}

}  // namespace sf::robots
