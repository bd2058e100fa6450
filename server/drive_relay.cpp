#include "server/drive_relay.h"

#include <algorithm>

#include <fmt/format.h>

namespace sf::server {

namespace {

constexpr std::int64_t kRestFor = 1'000'000'000;     ///< [ns]
constexpr std::int64_t kLineEvery = 10'000'000'000;  ///< [ns]

base::Twist clamped(const base::Twist& twist) {
  const auto clamp = [](double v) { return std::clamp(v, -netio::kMaxSpeed, netio::kMaxSpeed); };
  return {clamp(twist.forward), clamp(twist.left), clamp(twist.turn)};
}

bool is_rest(const base::Twist& twist) { return twist.forward == 0.0 && twist.left == 0.0 && twist.turn == 0.0; }

}  // namespace

DriveRelay::DriveRelay(const world::World& world) : world_(world), rows_(world.movers.size()) {}

void DriveRelay::command(std::uint32_t mover, const base::Twist& twist) {
  rows_[mover].twist = clamped(twist);
  rows_[mover].rests_since = -1;
}

void DriveRelay::send(std::int64_t now, StateReceiver& receiver) {
  for (const auto& [id, mover] : receiver.robots()) {
    Row& row = rows_[mover];
    row.follows = receiver.inbox().follows_drive(id, now);
    if (!row.twist) continue;
    if (!row.follows) {
      refuse(row, mover, now, receiver);
      continue;
    }
    netio::encode({.robot = static_cast<std::uint16_t>(id), .sequence = row.sequence++, .time = now},
                  netio::Drive{*row.twist}, packet_);
    receiver.queue(id, packet_);
    ++counts_.sent;
    if (!is_rest(*row.twist)) continue;
    if (row.rests_since < 0) row.rests_since = now;
    if (now - row.rests_since >= kRestFor) row.twist.reset();
  }
}

void DriveRelay::refuse(Row& row, std::uint32_t mover, std::int64_t now, StateReceiver& receiver) {
  const bool rests = is_rest(*row.twist);
  row.twist.reset();
  ++counts_.dropped;
  if (rests || now < row.next_line) return;
  row.next_line = now + kLineEvery;
  const world::Mover& robot = world_.movers[mover];
  const std::string event =
      fmt::format("commands of Player clients for {} (id {}) are dropped: ", robot.name, robot.id);
  receiver.log().write(
      event +
          (receiver.inbox().is_active(robot.id, now)
               ? "its process runs another controller; start it with `robot --controller remote`"
               : fmt::format("no process sends its state; start `robot --name {} --controller remote`", robot.name)),
      now);
}

}  // namespace sf::server
