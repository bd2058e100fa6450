#pragma once
// World and states of a recording, in the form that a farm accepts.

#include <cstdint>
#include <span>
#include <vector>

#include "base/report.h"
#include "farm/farm.h"
#include "record/recording.h"
#include "world/world.h"

namespace sf::scenarios {

/// @throws base::InputError if the world cannot be read, or does not match the recorded movers
world::World recorded_world(const record::Recording& recording);

/// Returns whether each tick has the states of all movers.
bool has_all_states(const record::Recording& recording);

/// Returns the states of all movers at a tick, by mover.
/// @pre has_all_states
void recorded_reports(const record::Recording& recording, std::size_t tick, std::vector<base::Report>& reports);

/// The shapes of movers in the course of a recording. Recording and world must outlive it.
class RecordedShapes {
 public:
  /// @param world of the recording; changes with `go_to`
  RecordedShapes(const record::Recording& recording, world::World& world) : shapes_(recording.shapes), world_(world) {}

  /// Gives the movers the shapes that they have at `time` [ns], which may be earlier than before.
  /// @return whether an outline changed
  /// @throws base::InputError for shapes that do not belong to the world
  bool go_to(std::int64_t time);
  /// Returns the states that the last `go_to` set.
  std::span<const base::ShapeState> changed() const { return changed_; }

 private:
  std::span<const record::ShapesSample> shapes_;
  world::World& world_;
  std::size_t next_ = 0;
  std::vector<base::ShapeState> changed_;
};

/// Removes absent movers from the farm, and subscribes all sensors of the others.
void set_absent(std::span<const base::Report> reports, farm::Farm& farm);

}  // namespace sf::scenarios
