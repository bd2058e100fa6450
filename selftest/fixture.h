#pragma once
// Helpers for the cases: worlds created in memory, and farms ticked once.

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "farm/farm.h"
#include "gpu/device.h"
#include "selftest/case.h"
#include "sensors/laser_settings.h"
#include "world/world.h"

namespace sf::selftest {

using base::Pose;

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kHuge = std::numeric_limits<double>::max();
inline constexpr double kTurn = 2.0 * M_PI;      ///< [rad]
inline constexpr double kDegree = M_PI / 180.0;  ///< [rad]

/// A farm on its own world, with all sensors subscribed.
struct TestFarm {
  std::unique_ptr<world::World> world;
  std::unique_ptr<farm::Farm> farm;
  std::span<const base::ReadingBlock> readings;  ///< of the tick at time 0; valid until the next one
};

/// Returns the settings of the laser that produced a scan.
const sensors::LaserSettings& laser_of(const TestFarm& test, const base::ReadingBlock& scan);

/// Not thread-safe. The device must outlive it.
class Fixture {
 public:
  /// @param stop ends a case soon after it returns true; empty: never
  explicit Fixture(gpu::Device& device, std::function<bool()> stop = {}) : device_(device), stop_(std::move(stop)) {}

  const std::function<bool()>& stop() const { return stop_; }

  gpu::Device& device() const { return device_; }
  /// Creates a farm with small pools and ticks it once at time 0.
  TestFarm measure(world::World world, farm::FarmOptions options = {}) const;

 private:
  gpu::Device& device_;
  std::function<bool()> stop_;
};

/// [m] Returns the allowed difference of a scan from plain C++ (sensors/laser_reference.h): 0, or the bounds of both
/// if the chosen caster has its own bytes.
double allowed_from_plain_cpp(const Fixture& fixture, const TestFarm& test, const base::ReadingBlock& scan);
/// Compares a range with that of plain C++, bitwise if `allowed` is 0.
void check_range(double got, double plain_cpp, double allowed, Checks& checks, std::string_view what, std::uint64_t i);
/// Returns whether the chosen caster accepts worlds of any size and returns the bytes of plain C++.
bool casts_any_world(const Fixture& fixture);

/// Adds a thin wall, visible from both sides, 1 m high.
void add_wall(world::World& world, glm::dvec2 a, glm::dvec2 b);
/// Adds a closed outline, solid on the left of its edges: counter-clockwise a block, clockwise a room.
void add_outline(world::World& world, const std::vector<glm::dvec2>& corners);
/// Adds the inside of a square of `width` [m] with lower corner `low`, as a hole in a block half as wide again.
void add_room(world::World& world, glm::dvec2 low, double width);
/// Adds a solid block from `low` to `high`.
void add_block(world::World& world, glm::dvec2 low, glm::dvec2 high);

/// A laser at its mover's origin, 0.1 m high, with yaw 0.
sensors::LaserSettings laser(std::uint32_t samples, double fov, double range_max);
/// Adds a mover without a body.
/// @return its row
std::uint32_t add_laser_mover(world::World& world, const Pose& X_WM, const sensors::LaserSettings& laser);
std::uint32_t add_mover(world::World& world, const Pose& X_WM);
/// Gives a mover a square body with half side length `half` [m].
void add_body(world::World& world, std::uint32_t mover, double half);

using Settings = std::vector<std::pair<std::string, std::vector<double>>>;  ///< in metres and degrees
world::Sensor sensor(const std::string& type, const Settings& settings, double height = 0.0);

}  // namespace sf::selftest
