#include "server/create_drive.h"

#include <cmath>

#include "sensors/analog.h"
#include "sensors/battery.h"
#include "sensors/bumper.h"
#include "sensors/cliff.h"
#include "sensors/irreceiver.h"

namespace sf::server {

namespace {

robots::CreateOdometry odometry_of(const RealRobotType& type) {
  return type.angle == 0.0 ? robots::CreateOdometry::wheels : robots::CreateOdometry::motion;
}

/// A Create 2 has no cargo bay.
bool has_cargo_bay(const RealRobotType& type) { return odometry_of(type) == robots::CreateOdometry::motion; }

/// Returns voltage and number of each input: those of the cargo bay (the analogue one, then the digital ones), then the
/// wall sensor, the buttons Play and Advance, and the overcurrents of the left and the right wheel (5 V: on).
std::vector<double> inputs_of(const robots::CreateFrame& frame, bool cargo_bay) {
  std::vector<double> inputs;
  const auto add = [&](bool on) { inputs.insert(inputs.end(), {on ? 5.0 : 0.0, on ? 1.0 : 0.0}); };
  if (cargo_bay) {
    inputs = {5.0 * frame.analog / 1023.0, static_cast<double>(frame.analog)};
    for (int pin = 0; pin < 4; ++pin) add((frame.inputs >> pin & 1) != 0);
  }
  for (const bool on : {frame.wall, (frame.buttons & 0x01) != 0, (frame.buttons & 0x04) != 0,
                        (frame.overcurrents & 0x10) != 0, (frame.overcurrents & 0x08) != 0})
    add(on);
  return inputs;
}

/// Returns voltage, current, charge and whether it is at a charger: in the states 1 to 4 (reconditioning, full, trickle
/// and waiting).
std::vector<double> battery_of(const robots::CreateFrame& frame) {
  const bool charging = frame.charging >= 1 && frame.charging <= 4;
  return {1e-3 * frame.voltage, 1e-3 * frame.current, 1e-3 * frame.charge, charging ? 1.0 : 0.0};
}

}  // namespace

CreateDrive::CreateDrive(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM,
                         double track)
    : RealRobot(type, options, X_WM), track_(track), stream_(odometry_of(type)) {
  start(0);
}

void CreateDrive::start(std::int64_t) {
  stream_.reset();
  lifted_ = counting_ = false;
  counts_.starts += write(robots::create_start(odometry_of(type())));
}

void CreateDrive::take(std::span<const std::uint8_t> bytes, std::int64_t now) {
  for (const std::uint8_t byte : bytes)
    if (const auto frame = stream_.take(byte)) take_frame(*frame, now);
}

void CreateDrive::take_frame(const robots::CreateFrame& frame, std::int64_t now) {
  heard(now);
  add_motion(frame);
  frame_ = frame;
  touch(frame.bumped_left || frame.bumped_right || frame.wheel_drop);
  measured(sensors::kBumper, {frame.bumped_left ? 1.0 : 0.0, frame.bumped_right ? 1.0 : 0.0}, now);
  measured(sensors::kCliff, {frame.cliffs.begin(), frame.cliffs.end()}, now);
  const bool dock = frame.infrared > sensors::kDockByte && frame.infrared < sensors::kNoIrByte;
  measured(sensors::kIrReceiver,
           {frame.virtual_wall ? 1.0 : 0.0, static_cast<double>(dock ? frame.infrared : sensors::kNoIrByte)}, now);
  measured(sensors::kAnalog, inputs_of(frame, has_cargo_bay(type())), now);
  measured(sensors::kBattery, battery_of(frame), now);
  // People put a lifted robot down where it may drive, so it resumes. At a cliff, it waits for them.
  lifted_ = (lifted_ || frame.wheel_drop) && frame.mode != robots::CreateFrame::safe;
  if (lifted_ && !frame.wheel_drop && frame.mode == robots::CreateFrame::passive) write(robots::create_safe());
}

void CreateDrive::add_motion(const robots::CreateFrame& frame) {
  if (odometry_of(type()) == robots::CreateOdometry::motion)
    return advance(1e-3 * frame.distance, frame.angle * M_PI / 180.0);
  const auto rolled = [](std::uint16_t after, std::uint16_t before) {
    return robots::kCreate2Count * static_cast<std::int16_t>(after - before);
  };
  const double left = rolled(frame.left, frame_.left), right = rolled(frame.right, frame_.right);
  if (counting_) advance(0.5 * (left + right), (right - left) / track_);
  counting_ = true;
}

void CreateDrive::drive(const base::Twist& twist, std::int64_t now) {
  write(robots::create_drive(ready(now) ? robots::create_wheels(twist, track_) : robots::CreateWheels{}));
  if (outputs_) write(robots::create_outputs(*outputs_));
}

bool CreateDrive::set_outputs(std::uint8_t bits) {
  if (!has_cargo_bay(type())) return false;
  if (bits != 0 || outputs_) outputs_ = bits;
  return true;
}

void CreateDrive::stop() {
  if (line() == nullptr) return;
  if (outputs_) line()->write(robots::create_outputs(0));
  line()->write(robots::create_stop());
  line()->drain();
}

std::string CreateDrive::fault() const {
  if (frame_.wheel_drop) return "the Create is lifted";
  if (frame_.mode == robots::CreateFrame::passive || frame_.mode == robots::CreateFrame::off)
    return lifted_ ? "the Create was lifted"
                   : "the Create has left safe mode: at a cliff, or its charger is plugged in";
  return {};
}

std::vector<RobotFact> CreateDrive::facts() const {
  if (stream_.frames() == 0) return {};
  const robots::CreateFrame& f = frame_;
  return {{"battery_V", 1e-3 * f.voltage},
          {"battery_A", 1e-3 * f.current},
          {"battery_C", static_cast<double>(f.temperature)},
          {"charge_Ah", 1e-3 * f.charge},
          {"capacity_Ah", 1e-3 * f.capacity},
          {"charging", static_cast<double>(f.charging)},
          {"left_wheel_overcurrent", f.overcurrents & 0x10 ? 1.0 : 0.0},
          {"right_wheel_overcurrent", f.overcurrents & 0x08 ? 1.0 : 0.0},
          {"wall", f.wall ? 1.0 : 0.0},
          {"buttons", static_cast<double>(f.buttons)},
          {"infrared_byte", static_cast<double>(f.infrared)}};
}

}  // namespace sf::server
