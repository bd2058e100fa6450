#include "server/pioneer_drive.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "sensors/battery.h"
#include "sensors/bumper.h"
#include "sensors/sonar.h"

namespace sf::server {

namespace {

using robots::ArcosCommand;

constexpr std::int64_t kPulse = 500'000'000;     // [ns] the watchdog stops a robot after two seconds without a command
constexpr std::int64_t kEnable = 1'000'000'000;  // [ns] between attempts to switch the motors on
constexpr double kNoEcho = 5.0;                  // [m]
constexpr double kMostForward = 2000.0;          // [mm/s] the robot has lower limits of its own
constexpr double kMostTurn = 360.0;              // [degree/s]

/// Returns the difference of two counters that restart at `wrap`, in [-wrap/2, wrap/2).
int difference(int after, int before, int wrap) {
  const int ahead = ((after - before) % wrap + wrap) % wrap;
  return ahead < wrap / 2 ? ahead : ahead - wrap;
}

int whole(double value, double most) {
  return std::isfinite(value) ? static_cast<int>(std::lround(std::clamp(value, -most, most))) : 0;
}

}  // namespace

PioneerDrive::PioneerDrive(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM, double)
    : RealRobot(type, options, X_WM) {
  ranges_.fill(kNoEcho);
  start(0);
}

/// A robot in a session of an earlier program takes packets 0 and 1 for other commands, so that session is closed
/// first.
void PioneerDrive::start(std::int64_t now) {
  stream_.reset();
  sip_.reset();
  powered_ = false;
  stage_ = 0;
  sent_ = now;
  write(robots::arcos_command(ArcosCommand::close));
  counts_.starts += write(robots::arcos_sync(0));
}

void PioneerDrive::take(std::span<const std::uint8_t> bytes, std::int64_t now) {
  stream_.add(bytes);
  while (const auto payload = stream_.next()) {
    if (stage_ != kOpen) {
      synchronize(*payload, now);
    } else if (const auto sip = robots::parse_arcos_sip(*payload)) {
      take_sip(*sip, now);
    }
  }
}

void PioneerDrive::synchronize(std::span<const std::uint8_t> payload, std::int64_t now) {
  if (payload[0] != stage_) return;
  heard(now);
  if (stage_ < 2) {
    write(robots::arcos_sync(++stage_));
    return;
  }
  name_ = robots::parse_arcos_name(payload).value_or(robots::ArcosName{});
  stage_ = kOpen;
  sent_ = now;
  write(robots::arcos_command(ArcosCommand::open));
  enable(now);
}

void PioneerDrive::enable(std::int64_t now) {
  enabled_ = now;
  write(robots::arcos_command(ArcosCommand::sonar, 1));
  write(robots::arcos_command(ArcosCommand::enable, 1));
}

void PioneerDrive::take_sip(const robots::ArcosSip& sip, std::int64_t now) {
  heard(now);
  if (sip_) {
    const double turn = robots::kArcosAngle * difference(sip.heading, sip_->heading, robots::kArcosTurn);
    const double x = name_.distance * difference(sip.x, sip_->x, robots::kArcosWrap);
    const double y = name_.distance * difference(sip.y, sip_->y, robots::kArcosWrap);
    const double middle = robots::kArcosAngle * sip_->heading + 0.5 * turn;
    advance(x * base::cos(middle) + y * base::sin(middle), turn);
  }
  sip_ = sip;
  powered_ = powered_ || sip.motors;
  touch(sip.left_stall || sip.right_stall ||
        std::any_of(sip.bumpers.begin(), sip.bumpers.end(), [](std::uint8_t pressed) { return pressed != 0; }));
  measured(sensors::kBumper, {sip.bumpers.begin(), sip.bumpers.end()}, now);
  measured(sensors::kBattery, {sip.volts, std::nan(""), std::nan(""), std::nan("")}, now);
  if (sip.sonar_count == 0) return;
  for (std::size_t i = 0; i < ranges_.size(); ++i) ranges_[i] = std::min(sip.ranges[i].value_or(ranges_[i]), kNoEcho);
  measured({.type = sensors::kSonar, .time = now, .values = {ranges_.begin(), ranges_.end()}, .limit = kNoEcho});
}

void PioneerDrive::run(std::int64_t now) {
  if (stage_ != kOpen) return;
  // The command may be lost. Motors that people switch off stay off.
  if (!powered_ && sip_ && !sip_->stop_button && now - enabled_ >= kEnable) enable(now);
  if (now - sent_ < kPulse) return;
  sent_ = now;
  write(robots::arcos_command(ArcosCommand::pulse));
}

void PioneerDrive::drive(const base::Twist& twist, std::int64_t now) {
  if (stage_ != kOpen) return;
  const base::Twist wanted = ready(now) ? twist : base::Twist{};
  sent_ = now;
  write(robots::arcos_command(ArcosCommand::vel, whole(1e3 * wanted.forward, kMostForward)));
  write(robots::arcos_command(ArcosCommand::rvel, whole(wanted.turn * 180.0 / M_PI, kMostTurn)));
}

void PioneerDrive::stop() {
  if (line() == nullptr) return;
  for (const ArcosCommand command : {ArcosCommand::stop, ArcosCommand::close})
    line()->write(robots::arcos_command(command));
  line()->drain();
}

std::string PioneerDrive::fault() const {
  if (!sip_) return "the Pioneer is starting";
  if (sip_->stop_button) return "the stop button of the Pioneer is pressed";
  if (!sip_->motors) return "the motors of the Pioneer are off: press its MOTORS button";
  return {};
}

std::vector<RobotFact> PioneerDrive::facts() const {
  if (!sip_) return {};
  return {{"battery_V", sip_->volts},
          {"left_wheel_m_s", 1e-3 * sip_->left},
          {"right_wheel_m_s", 1e-3 * sip_->right},
          {"left_stall", sip_->left_stall ? 1.0 : 0.0},
          {"right_stall", sip_->right_stall ? 1.0 : 0.0},
          {"motors", sip_->motors ? 1.0 : 0.0}};
}

}  // namespace sf::server
