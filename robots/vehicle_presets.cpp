// Presets of cars, and the settings of `dynamics "car ..."`.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/number_text.h"
#include "base/suggest.h"
#include "robots/vehicle.h"

namespace sf::robots {

namespace {

constexpr auto kPresets = std::to_array<std::string_view>({"family", "small", "pioneer"});
constexpr auto kDrives = std::to_array<std::string_view>({"front", "rear", "all"});

/// A setting with a number: multiplies or replaces parameters.
struct Number {
  std::string_view key;
  double least, most;
  void (*set)(VehicleModel&, double);
};

constexpr auto kNumbers = std::to_array<Number>({
    {"mass", 0.1, 1e5,
     [](VehicleModel& m, double kg) {
       for (double* part : {&m.car.inertia, &m.roll_inertia, &m.pitch_inertia}) *part *= kg / m.car.mass;
       m.car.mass = kg;
     }},
    {"height", 0.0, 10.0, [](VehicleModel& m, double metres) { m.car.height = metres; }},
    {"spring", 1.0, 1e8, [](VehicleModel& m, double rate) { m.spring = rate; }},
    {"damper", 0.0, 1e6, [](VehicleModel& m, double rate) { m.damper = rate; }},
    {"travel", 1e-4, 10.0, [](VehicleModel& m, double metres) { m.travel = metres; }},
    {"friction", 0.01, 2.0,
     [](VehicleModel& m, double factor) { m.car.friction.c1 *= factor, m.car.friction.c3 *= factor; }},
    {"power", 1e-3, 1e7, [](VehicleModel& m, double watts) { m.power = watts; }},
    {"torque", 1e-3, 1e6, [](VehicleModel& m, double newton_metres) { m.car.drive_limit = newton_metres; }},
    {"brake", 0.0, 1e6, [](VehicleModel& m, double newton_metres) { m.car.brake_limit = newton_metres; }},
    {"drag", 0.0, 100.0, [](VehicleModel& m, double factor) { m.car.drag = factor; }},
    {"rolling", 0.0, 0.5, [](VehicleModel& m, double part) { m.car.rolling = part; }},
});

/// At 1/7 scale: a model car of 4.5 kg with all wheels driven. All numbers but scale and mass are assumptions.
void make_small(VehicleModel& m) {
  CarModel& car = m.car;
  car.mass = 4.5, car.inertia = 0.12, car.height = 0.05, car.wheel_radius = 0.05, car.wheel_inertia = 1e-4;
  car.drag = 0.02, car.steer_limit = 0.5, car.steer_rate = 6.0, car.drive_limit = 1.8, car.brake_limit = 2.5;
  m.roll_inertia = 0.03, m.pitch_inertia = 0.1, m.spring = 600.0, m.damper = 20.0, m.travel = 0.015;
  m.box = {0.3, 0.15, 0.2}, m.power = 800.0, m.drive_share = 0.5, car.brake_share = 0.6;
}

/// Mass and wheels as Player and the maker state them; stiffness, inertia and motors are assumptions. Its tyres are its
/// springs. `turn_factor` makes turns at 0.5 m/s about as quick as commanded.
void make_pioneer(VehicleModel& m) {
  CarModel& car = m.car;
  car.mass = 14.0, car.inertia = 0.5, car.height = 0.15, car.wheel_radius = 0.111, car.wheel_inertia = 0.01;
  car.front_stiffness = car.rear_stiffness = 1.0, car.drag = 0.0, car.rolling = 0.02;
  car.drive_limit = 40.0, car.brake_limit = 40.0, car.brake_share = 0.5;
  m.roll_inertia = 0.26, m.pitch_inertia = 0.36, m.spring = 2e4, m.damper = 150.0, m.travel = 0.02, m.skid = true;
  m.box = {0.313, 0.2525, 0.28}, m.turn_factor = 1.6;
}

/// Rounds a limit > 0 to three digits, so that it holds as written.
double written(double limit, bool up) {
  double unit = 1.0;
  while (limit >= 1000.0 * unit) unit *= 10.0;
  while (limit < 100.0 * unit) unit /= 10.0;
  return unit * (up ? std::ceil(limit / unit) : std::floor(limit / unit));
}

/// Throws unless the wheels turn more easily than the car moves.
void require_light_wheels(const VehicleModel& m, const std::string& at) {
  const CarModel& car = m.car;
  const double least = 4.0 * car.wheel_inertia / (car.wheel_radius * car.wheel_radius);
  if (car.mass < least)
    throw base::InputError(
        fmt::format("{}'dynamics': a car of {:g} kg is too light for the wheels of its preset; "
                    "expected at least {:g} kg: choose a smaller preset",
                    at, car.mass, written(least, true)));
}

/// Throws unless springs and dampers are soft enough for kVehicleStep.
void require_stable(const VehicleModel& m, const std::string& at) {
  const CarModel& car = m.car;
  const double track = std::max(car.front_track, car.rear_track), length = car.wheelbase();
  const double least =
      std::min({0.25 * car.mass, m.roll_inertia / (track * track), m.pitch_inertia / (length * length)});
  const double spring = least / ((1.0 + kBumpStiffness) * kVehicleStep * kVehicleStep),
               damper = 0.25 * least / kVehicleStep;
  if (m.spring > spring || m.damper > damper)
    throw base::InputError(
        fmt::format("{}'dynamics': springs of {:g} N/m and dampers of {:g} N s/m are too stiff for this car of {:g} "
                    "kg; expected at most {:g} N/m and {:g} N s/m",
                    at, m.spring, m.damper, car.mass, written(spring, false), written(damper, false)));
}

/// Throws unless the car stands on its springs: without bump stops, leaning by less than they compress.
void require_standing(const VehicleModel& m, const std::string& at) {
  const CarModel& car = m.car;
  if (car.height > m.box.z)
    throw base::InputError(fmt::format(
        "{}'dynamics': the centre of gravity is {:g} m high, above the body; expected at most {:g} m: lower "
        "'height', or raise the model's 'size'",
        at, car.height, m.box.z));
  const double side = std::min({car.front_track, car.rear_track, car.wheelbase()});
  const double least = car.mass * kGravity * std::max(1.5 * car.height / side, 0.5) / side;
  if (m.spring < least)
    throw base::InputError(fmt::format(
        "{}'dynamics': springs of {:g} N/m are too soft for this car of {:g} kg, whose centre of gravity is "
        "{:g} m high; expected at least {:g} N/m: set 'spring', and 'damper' in proportion",
        at, m.spring, car.mass, car.height, written(least, true)));
}

}  // namespace

VehicleModel vehicle_preset(std::string_view name, double wheelbase, double track) {
  VehicleModel model;
  if (name == "small") make_small(model);
  if (name == "pioneer") make_pioneer(model);
  const double front = name == "family" ? model.car.front / model.car.wheelbase() : 0.5;
  model.car.front = front * wheelbase, model.car.rear = wheelbase - model.car.front;
  model.car.front_track = model.car.rear_track = track;
  return model;
}

VehicleModel vehicle_of(const world::Mover& mover) {
  const world::DynamicsChoice& choice = mover.dynamics;
  const auto refuse = [&](const std::string& why) { throw base::InputError(choice.at + "'dynamics': " + why); };
  const auto one_of = [&](std::string_view key, const std::string& word, std::span<const std::string_view> words) {
    const auto found = std::ranges::find(words, word);
    if (found == words.end()) refuse(fmt::format("'{}' is '{}'{}", key, word, base::expected_one_of(word, words)));
    return found - words.begin();
  };
  std::string preset = "family";
  for (const auto& [key, value] : choice.settings)
    if (key == "preset") preset = kPresets[one_of(key, value, kPresets)];
  VehicleModel model = vehicle_preset(preset, mover.wheelbase, mover.track);
  std::vector<std::string_view> keys{"preset", "drive"};
  for (const Number& number : kNumbers) keys.push_back(number.key);
  for (const auto& [key, value] : choice.settings) {
    const auto number = std::ranges::find(kNumbers, key, &Number::key);
    if (key == "drive") {
      model.drive_share = std::array{1.0, 0.0, 0.5}[one_of(key, value, kDrives)];
    } else if (number != kNumbers.end()) {
      const auto said = base::number_of<double>(value);
      if (!said || !(*said >= number->least && *said <= number->most))
        refuse(
            fmt::format("'{}' is '{}'; expected a number from {:g} to {:g}", key, value, number->least, number->most));
      number->set(model, *said);
    } else if (key != "preset") {
      refuse(fmt::format("a car has no setting '{}'{}", key, base::expected_one_of(key, keys)));
    }
  }
  if (model.skid != (mover.drive != world::Drive::car) || mover.drive == world::Drive::omni)
    refuse(model.skid ? "the preset \"pioneer\" expects drive \"skid\" or \"diff\""
                      : fmt::format("the preset \"{}\" expects drive \"car\"", preset));
  if (!mover.body.empty()) model.box = {};
  for (const world::Segment& side : mover.body)
    model.box = glm::max(model.box, glm::dvec3{std::abs(side.a.x), std::abs(side.a.y), side.z_max});
  require_light_wheels(model, choice.at);
  require_standing(model, choice.at);
  require_stable(model, choice.at);
  return model;
}

}  // namespace sf::robots
