#include "sensors/sideslip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/elementary.h"
#include "base/time.h"
#include "robots/car_dynamics.h"
#include "robots/estimation/sideslip.h"
#include "sensors/derived/derived_type.h"
#include "sensors/plain_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

using estimation::SideslipMeasurement;
using SideslipKind = SideslipMeasurement::Kind;

enum Port : std::uint8_t { kYawRates, kSpeeds, kWheels, kSteering, kCommands, kTorques };

/// Reads a tuple of numbers, each above 0.
template <std::size_t kSize>
std::array<double, kSize> positive(const world::Sensor& settings, std::string_view key, const std::string& meaning,
                                   std::array<double, kSize> fallback) {
  const auto numbers = tuple(settings, key, kSize, meaning);
  if (!numbers) return fallback;
  for (std::size_t k = 0; k < kSize; ++k) {
    fallback[k] = (*numbers)[k];
    if (!(fallback[k] > 0.0 && fallback[k] <= 1e6))
      refuse(settings, key, "'" + std::string(key) + "' expects numbers above 0: " + meaning);
  }
  return fallback;
}

estimation::SideslipModel model_of(const world::Sensor& s) {
  estimation::SideslipModel model;
  robots::CarModel& car = model.car;
  model.observer = static_cast<estimation::SideslipObserver>(
      choice(s, "observer", static_cast<std::size_t>(model.observer), estimation::kSideslipObservers));
  car.mass = number(s, "mass", car.mass, 1.0, 1e6);
  car.inertia = number(s, "inertia", car.inertia, 1e-3, 1e9);
  const double metre = 1.0 / s.metres_per_unit, radian = 1.0 / s.radians_per_unit;
  const auto axles = positive<2>(s, "axles", "[front rear]", {car.front * metre, car.rear * metre});
  car.front = axles[0] / metre, car.rear = axles[1] / metre;
  const auto stiffness = positive<2>(s, "stiffness", "[front rear]", {car.front_stiffness, car.rear_stiffness});
  car.front_stiffness = stiffness[0], car.rear_stiffness = stiffness[1];
  const auto friction = positive<3>(s, "friction", "[c1 c2 c3]", {car.friction.c1, car.friction.c2, car.friction.c3});
  car.friction = {friction[0], friction[1], friction[2]};
  if (car.friction.slope() <= 0.0) refuse(s, "friction", "'friction' expects [c1 c2 c3] with c1 c2 > c3");
  const auto noise =
      positive<2>(s, "noise", "[angle/s length/s]", {model.turn_noise * radian, model.speed_noise * metre});
  model.turn_noise = noise[0] / radian, model.speed_noise = noise[1] / metre;
  return model;
}

class SideslipSensor final : public sensorfarm::DerivedSensor {
 public:
  explicit SideslipSensor(const DerivedContext& context)
      : model_(model_of(context.settings)),
        start_speed_(length(context.settings, "start_speed", 0.0, 0.0, 1e3)),
        window_(kWindow, kCapacity) {
    for (const sensorfarm::DerivedInput& input : context.site.inputs) add_input(input);
  }

  void add_input(const sensorfarm::DerivedInput& input) final { ports_.push_back(input.port); }

  void take(std::uint32_t input, const sensorfarm::Reading& reading) override {
    const std::int64_t time = base::nanoseconds(reading.time);
    begin(time);
    const std::span<const double> v = reading.values;
    switch (ports_[input]) {
      case kYawRates:
        return add(time, SideslipKind::turn, v[0]);
      case kSpeeds:
        return add(time, SideslipKind::speed, v[0]);
      case kWheels:
        return take_wheels(time, 0.5 * (v[0] + v[1]));
      case kSteering:
        return add(time, SideslipKind::steer, v[0]);
      case kTorques:
        return add(time, SideslipKind::torque, v[0]);
      default:  // a command states the turn rate of a car without slip
        return add(time, SideslipKind::steer,
                   base::atan2(model_.car.wheelbase() * v[2], std::max(std::abs(v[0]), 1e-3)));
    }
  }

  void read(double seconds, sensorfarm::DerivedReading out) override {
    const std::int64_t time = base::nanoseconds(seconds);
    begin(time);
    out.valid[0] = 0;
    const estimation::SideslipState* last = window_.state_at(time);
    if (last == nullptr) return;
    const estimation::SideslipState state = estimation::predict(model_, *last, time);
    if (!state.known() || state.mean[estimation::kTrackForward] < robots::kSlipSpeed) return;
    const estimation::SideslipEstimate estimate = estimation::estimate_of(model_, state);
    out.valid[0] = 1;
    out.values[0] = estimate.sideslip;
    out.values[1] = estimate.force.front, out.values[2] = estimate.force.rear;
    std::ranges::copy(estimate.covariance, out.covariance.begin());
  }

 private:
  static constexpr std::int64_t kWindow = 1'000'000'000;  // [ns]
  static constexpr std::size_t kCapacity = 512;

  /// A known speed is that at the first call.
  void begin(std::int64_t time) {
    if (!std::exchange(begun_, true) && start_speed_ > 0.0) add(time, SideslipKind::speed, start_speed_);
  }

  void add(std::int64_t time, SideslipKind kind, double value) {
    window_.take({time, kind, sequence_++, value}, [&](const SideslipMeasurement& m, estimation::SideslipState& state) {
      return estimation::apply(model_, m, state);
    });
  }

  /// Late readings of encoders state no speed: the distance since the one before is unknown.
  void take_wheels(std::int64_t time, double distance) {
    if (rolled_ && time <= rolled_->first) return;
    if (rolled_)
      add(time, SideslipKind::speed, 1e9 * (distance - rolled_->second) / static_cast<double>(time - rolled_->first));
    rolled_.emplace(time, distance);
  }

  estimation::SideslipModel model_;
  double start_speed_;  ///< [m/s]; 0: unknown
  estimation::MeasurementWindow<SideslipMeasurement, estimation::SideslipState> window_;
  std::vector<std::uint32_t> ports_;                       ///< per input
  std::optional<std::pair<std::int64_t, double>> rolled_;  ///< [ns], [m] of the newest reading of the encoder
  std::uint32_t sequence_ = 0;
  bool begun_ = false;
};

std::unique_ptr<sensorfarm::DerivedSensor> make_sideslip(const DerivedContext& context) {
  bool steered = false, speed = find(context.settings, "start_speed") != nullptr;
  for (const WiredInput& input : context.inputs) {
    if (input.mover != context.spec.mover)
      refuse(context.settings, "inputs", "inputs of a sideslip sensor are those of its own robot");
    steered = steered || input.port == kSteering || input.port == kCommands;
    speed = speed || input.port == kSpeeds || input.port == kWheels;
  }
  if (!steered) refuse(context.settings, "inputs", "a sideslip sensor needs a steering angle (steer_rad) or 'command'");
  if (!speed)
    refuse(context.settings, "inputs",
           "a sideslip sensor needs a speed: an input (speed_m_s or an encoder) or 'start_speed'");
  return std::make_unique<SideslipSensor>(context);
}

constexpr std::string_view kRateColumns[] = {"rate_rad_s"}, kSpeedColumns[] = {"speed_m_s"},
                           kWheelColumns[] = {"left_m", "right_m"}, kSteerColumns[] = {"steer_rad"},
                           kCommandColumns[] = {"forward_m_s", "left_m_s", "turn_rad_s"},
                           kTorqueColumns[] = {"torque_n_m"};
constexpr DerivedPort kPorts[] = {{"gyro", kRateColumns},       {"speed", kSpeedColumns},
                                  {"encoder", kWheelColumns},   {"steering", kSteerColumns},
                                  {"command", kCommandColumns}, {"torque", kTorqueColumns}};
constexpr DerivedForm kDerived{.ports = kPorts, .quantities = 3, .covariance = true, .make = make_sideslip};

constexpr std::string_view kKeys[] = {"type",  "inputs",    "observer", "mass",        "inertia",
                                      "axles", "stiffness", "friction", "start_speed", "noise"};
constexpr Column kColumns[] = {{"sideslip_rad"},        {"front_force_n"},          {"rear_force_n"},
                               {"valid", 1, true},      {"sideslip_sideslip_rad2"}, {"sideslip_front_rad_n"},
                               {"sideslip_rear_rad_n"}, {"front_front_n2"},         {"front_rear_n2"},
                               {"rear_rear_n2"}};
constexpr PlainNumber kReal{.real = true};
constexpr PlainNumber kNumbers[] = {{1e-6}, {1e-2}, {1e-2}, {1.0, 0.0, 1.0}, kReal, kReal, kReal, kReal, kReal, kReal};
constexpr PlainForm kForm{kSideslip, "sideslip", kNumbers};

}  // namespace

constinit const SensorType sideslip_type = plain<kForm>({
    .word = {"sideslip", kKeys, {}, true},
    .base_port = 34000,
    .list = "",
    .columns = kColumns,
    .derived = &kDerived,
    .parse = [](const world::World& world) { return parse_derived(world, sideslip_type, 1, 50.0); },
    .make = no_backend,
});

}  // namespace sf::sensors
