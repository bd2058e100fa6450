#pragma once
// Movers as obstacles: where their outlines are this tick, who is near whom, and what each sensor may meet of them.

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "base/pose.h"
#include "raycast/depth.h"
#include "raycast/sectors.h"
#include "world/world.h"

namespace sf::raycast {

using base::Pose;

inline constexpr double kLookout = 0.05;  ///< [m] how near a mover comes to others is not measured beyond

/// All movers' outlines in the world frame. Exact segments of movers follow those of the walls: id = walls + row.
class Bodies {
 public:
  Bodies(const world::World& world, const Sight* any_wall);

  /// Moves every outline to its mover's pose. One pose per mover; a mover whose x is not a number is nowhere.
  void place(std::span<const Pose> poses, base::Workers& workers);

  /// Exact outlines in the world frame, in order of id, as of the last `place`.
  std::span<const ExactSegment> segments() const { return segments_; }
  /// For each, how near other parts of the same mover come, as `wall_clearances` gives it [m].
  std::vector<float> own_clearances(double cap) const;
  /// How near walls and other movers come to the mover of segment `row`, at least, as of the last `place` [m].
  float clearance_of(std::size_t row) const { return clearances_[owners_[row]].anyone; }
  std::size_t count() const { return bodies_.size(); }
  double largest_radius() const { return largest_; }  ///< [m]
  /// What beams report that meet them, in the same order.
  const std::vector<std::uint32_t>& models() const { return models_; }

  /// Prepares for views at world height `z` [m]: to be called for each before the first `collect`. Gives its number.
  std::uint32_t watch_height(double z);

  /// A viewpoint among the movers, or a small disc of them: the lasers of one robot.
  struct View {
    Vec2 origin;                   ///< [m] world; entries are relative to it
    double radius = 0.0;           ///< [m] of the disc round the origin that holds all viewpoints; 0: the origin alone
    std::uint32_t height = 0;      ///< as `watch_height` numbers it
    double yaw = 0.0;              ///< [rad]
    double fov = 0.0;              ///< [rad] nothing outside of yaw +- fov / 2 is looked at
    double range = 0.0;            ///< [m]
    double spread = 0.0;           ///< [rad] as in CellShape
    std::uint32_t self = 0;        ///< mover that carries the sensor, and is never seen
    const Depth* depth = nullptr;  ///< of the walls at this height; none when the view lies in a solid
    std::size_t most = SIZE_MAX;   ///< entries of all its lists together
  };
  /// Scratch of one thread.
  struct Near {
    double nearest;  ///< [m] from the view to the circle round the body
    std::uint32_t body;
  };
  struct Scratch {
    std::vector<Near> near;
    std::vector<Near> sorted;
    std::vector<std::uint32_t> counts;
    Sight::Nearby walls;
    std::uint64_t movers_near = 0;  ///< ever
    std::uint64_t movers_met = 0;   ///< of these
  };
  /// Collects what `view` may meet of other movers, and for each sector how near to walls any of it is,
  /// at least [m].
  /// Movers that nearer ones hide are left out.
  /// @return false, with lists that are not whole, when they would have more than `view.most` entries.
  bool collect(const View& view, Scratch& scratch, SectorLists& lists, float clearances[SF_SECTORS]) const;

 private:
  struct Body {
    std::uint32_t first = 0, count = 0;  ///< rows of local_ and segments_
    double radius = 0.0;
  };
  bool is_met(std::size_t body) const { return bodies_[body].count > 0 && !std::isnan(poses_[body].x); }
  void index();
  void measure_clearances(std::size_t first, std::size_t last, Sight::Nearby& nearby);
  void find_near(const View& view, Scratch& scratch) const;
  void add_body(const View& view, std::uint32_t body, double bearing, double wide, SectorLists& lists) const;
  template <class Visit>
  void each_near(Vec2 p, double reach, Visit visit) const;

  std::vector<Body> bodies_;
  std::vector<world::Segment> local_;   ///< mover frame
  std::vector<ExactSegment> segments_;  ///< world frame
  std::vector<std::uint32_t> models_;
  std::vector<std::uint32_t> owners_;  ///< mover of each segment
  std::vector<Pose> poses_;
  struct Clearance {
    float walls;   ///< [m] to the nearest wall, at least
    float anyone;  ///< [m] to the nearest wall or mover, at least
  };
  std::vector<Clearance> clearances_;  ///< per mover, as of the last `place`
  std::vector<Sight::Nearby> nearby_;  ///< per thread
  const Sight* walls_;
  std::uint32_t wall_count_;
  double largest_ = 0.0;  ///< [m] radius
  struct Height {
    double z;
    std::vector<float> opaque;  ///< [m] per mover: radius about its origin that no beam at this height passes
  };
  std::vector<Height> heights_;
  std::vector<double> loaded_z_;  ///< [m] per mover: heights are those at load, the world is 2.5-D

  // Movers by cell of a grid over where they are.
  Vec2 low_;
  double cell_ = 1.0;
  int columns_ = 1, rows_ = 1;
  std::vector<std::uint32_t> cell_first_, cell_items_, cell_next_;
};

}  // namespace sf::raycast
