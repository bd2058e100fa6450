#pragma once
// Lane edge sensors on hand-made roads, read once at their poses.

#include <string>
#include <utility>
#include <vector>

#include "sensors/laneedge.h"
#include "sensors/sensor_type.h"
#include "world/world.h"

namespace sf::trial {

/// Settings of a sensor as in a world file: metres and degrees.
using Settings = std::vector<std::pair<std::string, std::vector<double>>>;

/// Returns a sensor of type `laneedge`.
world::Sensor edge_sensor(const Settings& settings, const base::Pose& X_MS = {});

/// Adds a robot without a body with a sensor at its origin, facing the robot's +x. `perpendicular` defaults to 0
/// degrees.
std::uint32_t add_edge_eye(world::World& world, const base::Pose& X_WM, Settings settings = {});

/// Returns a straight marking.
world::LaneMarking marking(glm::dvec2 from, glm::dvec2 to, double width = 0.1);

/// Adds dashes along a straight line, starting at `from`: `paint` [m] painted, then `gap` [m] unpainted.
void add_dashes(world::World& world, glm::dvec2 from, glm::dvec2 to, double width, double paint, double gap);

/// Returns a marking along an arc around `centre`, in chords that stay within `sagitta` [m] of it.
world::LaneMarking arc(glm::dvec2 centre, double radius, double from, double to, double width, double sagitta = 1e-6);

/// The sensor backend of one world, driven without a farm.
class EdgeRig {
 public:
  /// @param on if not null: kernels run on this device
  explicit EdgeRig(const world::World& world, std::uint64_t seed = 0, unsigned threads = 0, bool noise = true,
                   gpu::Device* on = nullptr);
  ~EdgeRig();
  EdgeRig(const EdgeRig&) = delete;
  EdgeRig& operator=(const EdgeRig&) = delete;
  /// Returns one reading of each sensor, in order of rows. Poses default to those at load. With a raster, compares the
  /// bytes of the kernels and of the host.
  std::vector<sensors::EdgeReading> read(std::uint64_t sequence = 0, std::vector<base::Pose> poses = {});
  /// Returns readings of the given rows.
  std::vector<sensors::EdgeReading> read_some(const std::vector<sensors::DueSample>& due,
                                              const std::vector<base::Pose>& poses);
  /// Same without a copy, for counting allocations: spans are valid until the next call.
  const std::vector<base::ReadingBlock>& tick(const std::vector<sensors::DueSample>& due,
                                              const std::vector<base::Pose>& poses);

 private:
  struct State;
  std::unique_ptr<State> s_;
};

/// Returns one reading of each sensor of `world`.
std::vector<sensors::EdgeReading> read_edges(const world::World& world);

}  // namespace sf::trial
