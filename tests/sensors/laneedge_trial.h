#pragma once
// Lane edge sensors on roads made by hand, read once from where they stand.

#include <string>
#include <utility>
#include <vector>

#include "sensors/laneedge.h"
#include "sensors/sensor_type.h"
#include "world/world.h"

namespace sf::trial {

/// Settings of a sensor as a world file would have them: metres and degrees.
using Settings = std::vector<std::pair<std::string, std::vector<double>>>;

/// A sensor of type `laneedge`.
world::Sensor edge_sensor(const Settings& settings, const base::Pose& X_MS = {});

/// Adds a robot without a body that carries one at its origin, looking along the robot's +x. `perpendicular` follows:
/// 0 degrees unless the settings say otherwise.
std::uint32_t add_edge_eye(world::World& world, const base::Pose& X_WM, Settings settings = {});

/// A straight stripe.
world::LaneMarking marking(glm::dvec2 from, glm::dvec2 to, double width = 0.1);

/// Dashes along a straight line: `paint` metres of it, then `gap` without, from `from` on.
void add_dashes(world::World& world, glm::dvec2 from, glm::dvec2 to, double width, double paint, double gap);

/// A stripe along an arc about `centre`, in chords that stay within `sagitta` of it [m].
world::LaneMarking arc(glm::dvec2 centre, double radius, double from, double to, double width, double sagitta = 1e-6);

/// The instruments of one world, driven without a farm.
class EdgeRig {
 public:
  explicit EdgeRig(const world::World& world, std::uint64_t seed = 0, unsigned threads = 0, bool noise = true,
                   gpu::Device* on = nullptr);
  ~EdgeRig();
  EdgeRig(const EdgeRig&) = delete;
  EdgeRig& operator=(const EdgeRig&) = delete;
  /// One reading of each sensor, in order of rows; poses are those of the load unless given.
  std::vector<sensors::EdgeReading> read(std::uint64_t sequence = 0, std::vector<base::Pose> poses = {});
  /// Of the rows given.
  std::vector<sensors::EdgeReading> read_some(const std::vector<sensors::DueSample>& due,
                                              const std::vector<base::Pose>& poses);
  /// The same without a copy, for counting allocations: spans live until the next call.
  const std::vector<base::ReadingBlock>& tick(const std::vector<sensors::DueSample>& due,
                                              const std::vector<base::Pose>& poses);

 private:
  struct State;
  std::unique_ptr<State> s_;
};

/// One reading of each sensor of `world`.
std::vector<sensors::EdgeReading> read_edges(const world::World& world);

}  // namespace sf::trial
