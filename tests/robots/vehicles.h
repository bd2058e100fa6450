#pragma once
// Cars for tests, and ground below them.

#include <cmath>
#include <vector>

#include "robots/vehicle.h"
#include "world/ground.h"

namespace sf::robots {

inline constexpr double kWheelbase = 2.39268, kTrack = 1.4;
inline const world::Ground kFloor({});

/// A preset, with the distances of its wheels.
struct Preset {
  const char* name;
  double wheelbase, track;
};
inline constexpr Preset kPresets[] = {{"family", kWheelbase, kTrack}, {"small", 0.4, 0.26}, {"pioneer", 0.268, 0.394}};

inline VehicleModel family_model() { return vehicle_preset("family", kWheelbase, kTrack); }
inline VehicleModel family_without_resistance() {
  VehicleModel model = family_model();
  model.car.drag = model.car.rolling = 0.0;
  return model;
}

/// A terrain of 201 x 201 points, 1 m apart. @param height of (x, y)
inline world::Terrain terrain_of(const auto& height) {
  world::Terrain terrain{.cell = {1.0, 1.0}, .columns = 201, .rows = 201};
  for (int y = -100; y <= 100; ++y)
    for (int x = -100; x <= 100; ++x) terrain.heights.push_back(static_cast<float>(height(x, y)));
  return terrain;
}

/// One car that follows commands.
struct Drive {
  explicit Drive(const VehicleModel& model, double speed = 0.0, const world::Mover& limits = {},
                 const world::Ground& on = kFloor)
      : vehicle(model, limits), ground(on), state(vehicle.state_size()) {
    report.velocity.forward = speed;
    vehicle.place(report, state);
  }
  base::Report go(const base::Twist& command, double seconds) {
    for (double t = 0.0; t < seconds - 1e-9; t += 0.1) report = vehicle.move(report, command, 0.1, ground, state);
    return report;
  }
  Vehicle vehicle;
  const world::Ground& ground;
  std::vector<double> state;
  base::Report report;
};

}  // namespace sf::robots
