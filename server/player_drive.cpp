#include "server/player_drive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "netio/endpoint.h"
#include "sensors/battery.h"
#include "sensors/bumper.h"
#include "sensors/infrared.h"
#include "sensors/sonar.h"

namespace sf::server {

namespace {

using namespace netio::player;

constexpr Address kServer{Interface::player, 0};
constexpr Address kWheels{Interface::position2d, 0};
constexpr double kMostStep = 2.0;     // [m] between two states; beyond it, the odometry was set
constexpr double kMostVoltage = 5.0;  // [V] of an infrared sensor's analogue output
constexpr std::uint32_t kState = 1;   // subtype of the data of all interfaces that are read
constexpr std::uint32_t kMostElements = 1024;
/// Interfaces that are opened if the server has them. A laser's beams have directions that controllers read from the
/// world file, so lasers are not opened.
constexpr Interface kRead[] = {Interface::position2d, Interface::power, Interface::sonar, Interface::bumper,
                               Interface::ir};

/// Reads ranges or voltages. @return false: malformed
bool get_floats(XdrReader& xdr, std::vector<double>& values) {
  const std::size_t count = xdr.get_count(4);
  if (!xdr.good() || count > kMostElements) return false;
  values.resize(count);
  for (double& value : values) value = xdr.get_float();
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value) && value >= 0.0; });
}

}  // namespace

PlayerDrive::PlayerDrive(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM, double)
    : RealRobot(type, options, X_WM) {
  start(0);
}

void PlayerDrive::start(std::int64_t) {
  in_.clear();
  greeted_ = opened_ = stalled_ = bumped_ = false;
  X_OM_.reset();
  ++counts_.starts;
}

void PlayerDrive::give_up(std::string trouble) {
  ++counts_.wrong;
  trouble_ = std::move(trouble);
  opened_ = false;
  hang_up();
}

void PlayerDrive::send(MessageType type, const Address& to, std::uint32_t subtype, const base::Bytes& payload) {
  base::Bytes bytes;
  put_header({.host = server().address,
              .robot = server().port,
              .address = to,
              .type = type,
              .subtype = subtype,
              .size = static_cast<std::uint32_t>(payload.size())},
             bytes);
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  write(bytes);
}

/// Returns whether the banner was received.
bool PlayerDrive::greet() {
  constexpr std::string_view kGreeting = "Player v.";
  if (greeted_) return true;
  if (!std::equal(in_.begin(), in_.begin() + std::min(in_.size(), kGreeting.size()), kGreeting.begin())) {
    give_up(fmt::format("the server at {} is not a Player server", netio::endpoint_text(server())));
    return false;
  }
  if (in_.size() < kBannerBytes) return false;
  in_.erase(in_.begin(), in_.begin() + kBannerBytes);
  trouble_.clear();
  greeted_ = true;
  send(MessageType::request, kServer, server_request::device_list, {});
  return true;
}

void PlayerDrive::take(std::span<const std::uint8_t> bytes, std::int64_t now) {
  in_.insert(in_.end(), bytes.begin(), bytes.end());
  if (!greet()) return;
  std::size_t at = 0;
  while (in_.size() - at >= kHeaderBytes) {
    const Header header = read_header(std::span(in_).subspan(at));
    if (header.size > kMostPayload)
      return give_up(fmt::format("the Player server at {} sent a message of {} bytes", netio::endpoint_text(server()),
                                 header.size));
    if (in_.size() - at < kHeaderBytes + header.size) break;
    const bool good = take_message(
        header, XdrReader(std::span<const std::uint8_t>(in_).subspan(at + kHeaderBytes, header.size)), now);
    ++(good ? counts_.frames : counts_.wrong);
    at += kHeaderBytes + header.size;
  }
  in_.erase(in_.begin(), in_.begin() + static_cast<std::ptrdiff_t>(at));
}

bool PlayerDrive::take_message(const Header& header, XdrReader xdr, std::int64_t now) {
  if (header.address.index != 0) return true;
  if (header.type == MessageType::data) return header.subtype != kState || take_data(header.address.interf, xdr, now);
  const bool answers = header.type == MessageType::ack || header.type == MessageType::nack;
  return !answers || take_answer(header, xdr);
}

bool PlayerDrive::take_answer(const Header& header, XdrReader& xdr) {
  const bool granted = header.type == MessageType::ack;
  const bool geometry = header.address == kWheels && header.subtype == 1;
  if (geometry) return !granted || take_geometry(xdr);
  if (header.address.interf != Interface::player) return true;  // many drivers refuse to switch motors
  if (header.subtype == server_request::device_list) return granted && take_list(xdr);
  return header.subtype != server_request::device || take_opened(xdr);
}

/// Opens the devices with index 0.
bool PlayerDrive::take_list(XdrReader& xdr) {
  const std::size_t count = xdr.get_count(16);
  std::vector<Interface> found;
  for (std::size_t i = 0; i < count; ++i) {
    xdr.get(), xdr.get();
    const auto interf = static_cast<Interface>(xdr.get());
    if (xdr.get() == 0) found.push_back(interf);
  }
  if (!xdr.done()) return false;
  for (const Interface interf : kRead) {
    if (std::find(found.begin(), found.end(), interf) == found.end()) continue;
    base::Bytes payload;
    XdrWriter out(payload);
    out.put_all({server().address, std::uint32_t{server().port}, static_cast<std::uint32_t>(interf), 0u,
                 static_cast<std::uint32_t>(Access::open)});
    out.put_count(0);
    send(MessageType::request, kServer, server_request::device, payload);
  }
  if (std::find(found.begin(), found.end(), Interface::position2d) == found.end())
    trouble_ = fmt::format("the Player server at {} has no device position2d:0", netio::endpoint_text(server()));
  return true;
}

bool PlayerDrive::take_opened(XdrReader& xdr) {
  xdr.get(), xdr.get();
  const Address device{static_cast<Interface>(xdr.get()), xdr.get()};
  const auto access = static_cast<Access>(xdr.get());
  if (!xdr.good()) return false;
  if (device != kWheels) return true;
  if (access != Access::open) {
    trouble_ = fmt::format("the Player server at {} does not open position2d:0", netio::endpoint_text(server()));
    return true;
  }
  opened_ = true;
  base::Bytes on;
  XdrWriter(on).put(1u);
  send(MessageType::request, kWheels, static_cast<std::uint32_t>(position2d::Request::motors), on);
  send(MessageType::request, kWheels, static_cast<std::uint32_t>(position2d::Request::geometry), {});
  return true;
}

bool PlayerDrive::take_geometry(XdrReader& xdr) {
  for (int i = 0; i < 6; ++i) xdr.get_double();  // pose of the base
  const double width = xdr.get_double(), length = xdr.get_double();
  xdr.get_double();
  const bool good = xdr.done() && std::isfinite(width) && std::isfinite(length);
  if (good) size_ = {length, width};
  return good;
}

bool PlayerDrive::take_data(Interface interf, XdrReader& xdr, std::int64_t now) {
  switch (interf) {
    case Interface::position2d:
      return take_state(xdr, now);
    case Interface::sonar:
      return take_sonar(xdr, now);
    case Interface::ir:
      return take_infrared(xdr, now);
    case Interface::bumper:
      return take_bumpers(xdr, now);
    case Interface::power:
      return take_power(xdr, now);
    default:
      return true;
  }
}

bool PlayerDrive::take_state(XdrReader& xdr, std::int64_t now) {
  base::Pose X_OM;
  X_OM.x = xdr.get_double(), X_OM.y = xdr.get_double(), X_OM.yaw = xdr.get_double();
  for (int i = 0; i < 3; ++i) xdr.get_double();  // velocity, which some drivers leave at 0
  const bool stalled = xdr.get() != 0;
  if (!xdr.done() || !std::isfinite(X_OM.x) || !std::isfinite(X_OM.y) || !std::isfinite(X_OM.yaw)) return false;
  heard(now);
  if (X_OM_) {
    const double x = X_OM.x - X_OM_->x, y = X_OM.y - X_OM_->y;
    const double turn = base::wrap_angle(X_OM.yaw - X_OM_->yaw);
    const double middle = X_OM_->yaw + 0.5 * turn;
    if (base::hypot(x, y) <= kMostStep) advance(x * base::cos(middle) + y * base::sin(middle), turn);
  }
  X_OM_ = X_OM;
  stalled_ = stalled;
  touch(stalled_ || bumped_);
  return true;
}

bool PlayerDrive::take_sonar(XdrReader& xdr, std::int64_t now) {
  std::vector<double> ranges;
  if (!get_floats(xdr, ranges) || !xdr.done()) return false;
  measured(sensors::kSonar, std::move(ranges), now);
  return true;
}

/// Voltages become responses of 10 bits.
bool PlayerDrive::take_infrared(XdrReader& xdr, std::int64_t now) {
  std::vector<double> volts, ranges, values;
  if (!get_floats(xdr, volts) || !get_floats(xdr, ranges) || !xdr.done()) return false;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double share = i < volts.size() ? std::min(volts[i] / kMostVoltage, 1.0) : 0.0;
    values.insert(values.end(), {ranges[i], std::round(sensors::kMostResponse * share)});
  }
  measured(sensors::kInfrared, std::move(values), now);
  return true;
}

bool PlayerDrive::take_bumpers(XdrReader& xdr, std::int64_t now) {
  const std::span<const std::uint8_t> bytes = xdr.get_opaque();
  if (!xdr.done() || bytes.size() > kMostElements) return false;
  std::vector<double> pressed;
  for (const std::uint8_t byte : bytes) pressed.push_back(byte != 0 ? 1.0 : 0.0);
  bumped_ = std::find(pressed.begin(), pressed.end(), 1.0) != pressed.end();
  touch(stalled_ || bumped_);
  measured(sensors::kBumper, std::move(pressed), now);
  return true;
}

/// The sign of the power and the capacity in ampere hours are unknown, and so are current and charge.
bool PlayerDrive::take_power(XdrReader& xdr, std::int64_t now) {
  Power power;
  power.valid = xdr.get();
  for (float* value : {&power.volts, &power.percent, &power.joules, &power.watts}) {
    *value = xdr.get_float();
    if (!std::isfinite(*value)) return false;
  }
  power.charging = static_cast<std::int32_t>(xdr.get());
  if (!xdr.done()) return false;
  power_ = power;
  const auto known = [&](std::uint32_t bit, double value) { return power.valid & bit ? value : std::nan(""); };
  measured(sensors::kBattery,
           {known(1, power.volts), std::nan(""), std::nan(""), known(16, power.charging == 1 ? 1.0 : 0.0)}, now);
  return true;
}

void PlayerDrive::drive(const base::Twist& twist, std::int64_t now) {
  if (!opened_) return;
  const base::Twist wanted = ready(now) ? twist : base::Twist{};
  base::Bytes payload;
  XdrWriter xdr(payload);
  xdr.put_all({wanted.forward, wanted.left, wanted.turn});
  xdr.put(1u);  // motors on
  send(MessageType::command, kWheels, static_cast<std::uint32_t>(position2d::Command::velocity), payload);
}

void PlayerDrive::stop() {
  if (line() == nullptr || !opened_) return;
  drive({}, INT64_MAX);
  line()->drain();
}

std::string PlayerDrive::silence(bool connected) const {
  if (!trouble_.empty()) return trouble_;
  if (!connected)
    return fmt::format("the connection to the Player server at {} was lost", netio::endpoint_text(server()));
  return fmt::format(
      "the Player server at {} sends no state of position2d:0: its robot is off, or its driver is starting",
      netio::endpoint_text(server()));
}

std::vector<RobotFact> PlayerDrive::facts() const {
  std::vector<RobotFact> facts;
  const auto add = [&](bool known, std::string_view name, double value) {
    if (known) facts.push_back({name, value});
  };
  const Power power = power_.value_or(Power{});
  add(power.valid & 1, "battery_V", power.volts);
  add(power.valid & 2, "battery_W", power.watts);
  add(power.valid & 4, "battery_J", power.joules);
  add(power.valid & 8, "charge_percent", power.percent);
  add(power.valid & 16, "charging", power.charging);
  add(X_OM_.has_value(), "stall", stalled_ ? 1.0 : 0.0);
  add(size_[0] > 0.0, "length_m", size_[0]);
  add(size_[1] > 0.0, "width_m", size_[1]);
  return facts;
}

}  // namespace sf::server
