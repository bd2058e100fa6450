#include "bridges/player/requests.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/elementary.h"
#include "base/report.h"
#include "bridges/player/wall_map.h"

namespace sf::bridges::player {

namespace {

using Kind = Answer::Kind;
constexpr std::size_t kMostName = 1024;  // [byte]

/// Request subtypes shared by several interfaces; 0: not supported.
struct SensorRequests {
  Interface interf;
  std::uint32_t geometry = 0, get_config = 0, set_config = 0, power = 0;
};
constexpr std::array<SensorRequests, 6> kSensorRequests{{{Interface::position2d, 1},
                                                         {Interface::laser, 1, 3, 2, 4},
                                                         {Interface::ranger, 1, 5, 4, 2},
                                                         {Interface::sonar, 1, 0, 0, 2},
                                                         {Interface::ir, 1, 0, 0, 2},
                                                         {Interface::bumper, 1}}};

Answer granted_if(bool well_formed) { return {well_formed ? Kind::granted : Kind::malformed, {}}; }

base::Pose get_pose2d(XdrReader& xdr) {
  base::Pose pose;
  pose.x = xdr.get_double(), pose.y = xdr.get_double(), pose.yaw = xdr.get_double();
  return pose;
}

/// [m] Beyond this, distances lose millimetre resolution.
bool is_usable(const base::Pose& pose) {
  constexpr double kFarthest = 1e6;
  return std::abs(pose.x) <= kFarthest && std::abs(pose.y) <= kFarthest && std::abs(pose.z) <= kFarthest &&
         std::isfinite(pose.yaw);
}

}  // namespace

Requester::Requester(const Scene& scene, const Devices& devices, Exchange& exchange, const Follows& follows)
    : scene_(scene), devices_(devices), exchange_(exchange), follows_(follows), on_(devices.rows().size(), 1) {}

/// Returns whether commands move the robot now.
bool Requester::moves(std::uint32_t mover) const { return scene_.simulated || (follows_ && follows_(mover)); }

Answer Requester::request(std::uint32_t device, std::uint32_t subtype, std::span<const std::uint8_t> payload) {
  const Device& known = devices_.rows()[device];
  if (known.interf == Interface::simulation) return to_simulation(subtype, payload);
  if (known.interf == Interface::map) return to_map(subtype, payload);
  if (known.interf == Interface::position2d && subtype > 1) return to_position(known, subtype, payload);
  return to_sensor(device, subtype, payload);
}

Answer Requester::to_sensor(std::uint32_t device, std::uint32_t subtype, std::span<const std::uint8_t> payload) {
  const Device& known = devices_.rows()[device];
  const auto row = std::find_if(kSensorRequests.begin(), kSensorRequests.end(),
                                [&](const SensorRequests& each) { return each.interf == known.interf; });
  if (row == kSensorRequests.end() || subtype == 0) return {};
  if (subtype == row->geometry) return {Kind::granted, known.geometry};
  if (subtype == row->get_config) return {Kind::granted, known.config};
  if (subtype == row->set_config)  // answered by the configuration, which remains unchanged
    return payload.size() == known.config.size() ? Answer{Kind::granted, known.config} : Answer{Kind::malformed, {}};
  if (subtype != row->power) return {};
  XdrReader xdr(payload);
  const bool on = xdr.get() != 0;
  if (xdr.done()) on_[device] = on ? 1 : 0;
  return granted_if(xdr.done());
}

Answer Requester::to_position(const Device& device, std::uint32_t subtype, std::span<const std::uint8_t> payload) {
  using Request = position2d::Request;
  const auto request = static_cast<Request>(subtype);
  XdrReader xdr(payload);
  if (request == Request::reset_odometry) return exchange_.set_odometry(device.mover, {}), granted_if(true);
  if (request == Request::set_odometry) {
    const base::Pose X_OM = get_pose2d(xdr);
    if (!xdr.done()) return granted_if(false);
    if (!is_usable(X_OM)) return {};
    return exchange_.set_odometry(device.mover, X_OM), granted_if(true);
  }
  const bool known =
      request == Request::motors || request == Request::velocity_mode || request == Request::position_mode;
  if (!known || !moves(device.mover)) return {};
  const bool on = xdr.get() != 0;
  // Accept velocities and positions in any mode.
  if (xdr.done() && request == Request::motors) exchange_.set_motors(device.mover, on);
  return granted_if(xdr.done());
}

std::optional<std::uint32_t> Requester::find_mover(const std::string& name) const {
  const auto& movers = scene_.world.movers;
  const auto mover =
      std::find_if(movers.begin(), movers.end(), [&](const world::Mover& each) { return each.name == name; });
  if (mover == movers.end()) return std::nullopt;
  return static_cast<std::uint32_t>(mover - movers.begin());
}

/// Returns the pose of a mover or of a static model.
std::optional<base::Pose> Requester::pose_of(const std::string& name) {
  if (const auto mover = find_mover(name)) {
    const base::Pose X_WM = exchange_.pose_of(*mover);
    return base::is_absent(X_WM) ? std::nullopt : std::optional(X_WM);
  }
  for (const world::Model& model : scene_.world.models)
    if (model.name == name && model.mover == world::kNone) return model.X_WM;
  return std::nullopt;
}

Answer Requester::to_simulation(std::uint32_t subtype, std::span<const std::uint8_t> payload) {
  if (subtype < 1 || subtype > 4) return {};
  const bool flat = subtype <= 2, get = subtype % 2 == 1;
  XdrReader xdr(payload);
  const std::string name = xdr.get_text(kMostName);
  if (!xdr.good()) return {Kind::malformed, {}};
  Answer answer{Kind::granted, {}};
  if (get) {  // the pose in the request is unused
    const auto X_WM = pose_of(name);
    if (!X_WM) return {};
    XdrWriter out(answer.payload);
    out.put_text(name);
    if (flat) return put_pose2d(*X_WM, out), answer;
    put_pose(*X_WM, out);
    out.put(exchange_.seconds());
    return answer;
  }
  base::Pose X_WM = get_pose2d(xdr);
  const auto mover = find_mover(name);
  if (mover) X_WM.z = exchange_.pose_of(*mover).z;
  if (!flat) {
    xdr.get_double(), xdr.get_double();  // roll and pitch; the value parsed as yaw is the height
    X_WM.z = X_WM.yaw, X_WM.yaw = xdr.get_double();
    xdr.get_double();
  }
  if (!xdr.done()) return {Kind::malformed, {}};
  if (!scene_.simulated || !mover || !is_usable(X_WM)) return {};
  exchange_.place(*mover, X_WM);
  return answer;
}

Answer Requester::to_map(std::uint32_t subtype, std::span<const std::uint8_t> payload) {
  const record::WorldShape& shape = scene_.info.shape;
  Answer answer{Kind::granted, {}};
  XdrWriter out(answer.payload);
  if (subtype == 1) return put_map_info(shape, out), answer;
  if (subtype == 3) return put_map_segments(scene_.world, out), answer;
  if (subtype != 2) return {};
  XdrReader xdr(payload);
  Tile tile;
  for (std::uint32_t* part : {&tile.col, &tile.row, &tile.width, &tile.height}) *part = xdr.get();
  if (!xdr.good()) return {Kind::malformed, {}};
  if (!put_map_tile(shape, tile, out)) answer.kind = Kind::refused;
  return answer;
}

bool Requester::command(std::uint32_t device, std::uint32_t subtype, std::span<const std::uint8_t> payload) {
  const Device& known = devices_.rows()[device];
  XdrReader xdr(payload);
  if (known.interf == Interface::position2d) return drive(known, subtype, xdr);
  if (known.interf != Interface::simulation || !scene_.simulated) return true;
  if (subtype == 1) exchange_.toggle_pause();
  if (subtype == 2) exchange_.reset();
  return true;
}

bool Requester::drive(const Device& device, std::uint32_t subtype, XdrReader& xdr) {
  using Command = position2d::Command;
  const auto command = static_cast<Command>(subtype);
  if (subtype < 1 || subtype > 4) return true;
  std::array<double, 6> numbers{};
  const std::size_t count = command == Command::velocity ? 3 : command == Command::position ? 6 : 2;
  for (std::size_t i = 0; i < count; ++i) numbers[i] = xdr.get_double();
  if (count > 2) xdr.get();  // the motor state, which has its own request
  if (!xdr.done()) return false;
  const bool usable = std::all_of(numbers.begin(), numbers.end(), [](double v) { return std::abs(v) <= 1e6; });
  // A service reports commands that it cannot forward.
  if ((scene_.simulated || follows_ != nullptr) && usable) drive(device.mover, command, numbers);
  return true;
}

void Requester::drive(std::uint32_t mover, position2d::Command command, const std::array<double, 6>& numbers) {
  using Command = position2d::Command;
  const world::Mover& robot = scene_.world.movers[mover];
  const bool car = robot.drive == world::Drive::car;
  const double speed = numbers[0], angle = numbers[1];
  if (command == Command::velocity) exchange_.drive(mover, base::Twist{numbers[0], numbers[1], numbers[2]});
  if (command == Command::car)
    exchange_.drive(mover, base::Twist{speed, 0.0, car ? speed * base::tan(angle) / robot.wheelbase : angle});
  if (command == Command::heading) exchange_.drive(mover, Goal{{0.0, 0.0, 0.0, angle}, speed, true});
  if (command != Command::position || car) return;  // cars cannot turn in place to a goal
  const double most = numbers[3] > 0.0 ? std::min(numbers[3], robot.max_forward) : robot.max_forward;
  exchange_.drive(mover, Goal{{numbers[0], numbers[1], 0.0, numbers[2]}, most});
}

}  // namespace sf::bridges::player
