// NaN, infinity, denormals and limits in packets, poses and commands.

#include <fmt/format.h>

#include <cstring>

#include "netio/packets.h"
#include "robots/fleet.h"
#include "selftest/fixture.h"
#include "selftest/suite.h"

namespace sf::selftest {

namespace {

using netio::PacketStatus;

constexpr double kDenormal = std::numeric_limits<double>::denorm_min();

base::Bytes with(base::Bytes bytes, std::size_t at, double value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
  return bytes;
}

/// Tests one field of a packet; `most` is the limit of its magnitude.
void try_field(Checks& checks, const base::Bytes& good, std::size_t at, double most, const std::string& what) {
  netio::Packet packet;
  const auto expect = [&](double value, PacketStatus status) {
    const PacketStatus decoded = netio::decode(with(good, at, value), packet);
    checks.holds(decoded == status,
                 fmt::format("{} = {:g}: {}, expected {}", what, value, name(decoded), name(status)));
  };
  for (const double value : {kNan, -kNan, std::numeric_limits<double>::signaling_NaN(), kInfinity, -kInfinity})
    expect(value, PacketStatus::not_finite);
  for (const double value : {0.0, -0.0, kDenormal, -kDenormal, std::numeric_limits<double>::min(), most, -most})
    expect(value, PacketStatus::accepted);
  const double beyond = std::nextafter(most, kInfinity);
  for (const double value : {beyond, -beyond, kHuge, -kHuge}) expect(value, PacketStatus::out_of_range);
}

void packets(Fixture&, Checks& checks) {
  using namespace netio;
  base::Bytes v2v, tag;
  encode({.robot = 7}, V2v{}, v2v);
  encode({.robot = 7}, Tag{}, tag);
  constexpr double kV2v[] = {kMaxPosition, kMaxPosition, kMaxPosition, kMaxYaw, kMaxSpeed, kMaxSpeed, kMaxSpeed};
  for (std::size_t i = 0; i < std::size(kV2v); ++i)
    try_field(checks, v2v, kHeaderBytes + 8 * i, kV2v[i], fmt::format("number {} of V2V", i));
  for (const std::size_t i : {0, 1, 2}) {
    try_field(checks, tag, kHeaderBytes + 8 * i, kMaxPosition, fmt::format("position {} of TAG", i));
    try_field(checks, tag, kHeaderBytes + 8 * (7 + i), kMaxSpeed, fmt::format("velocity {} of TAG", i));
    try_field(checks, tag, kHeaderBytes + 8 * (10 + i), kMaxSpeed, fmt::format("turning {} of TAG", i));
  }
  Packet packet;
  for (const double value : {kNan, kInfinity})
    checks.holds(decode(with(tag, kHeaderBytes + 48, value), packet) == PacketStatus::not_finite, "orientation of TAG");
  for (const double value : {0.0, kDenormal, 2.0, kHuge})
    checks.holds(decode(with(tag, kHeaderBytes + 48, value), packet) == PacketStatus::out_of_range,
                 "no unit quaternion");
}

/// From the bytes of a packet to readings: the smallest and largest values of a pose.
void poses(Fixture& fixture, Checks& checks) {
  for (const double x : {kDenormal, -kDenormal, 1e-310, std::numeric_limits<double>::min(), 1e7, -1e7})
    for (const double yaw : {0.0, kDenormal, -1e-310}) {
      world::World world;
      add_wall(world, {x + 2.0, -1.0}, {x + 2.0, 1.0});
      add_laser_mover(world, {}, laser(1, 0.0, 8.0));
      TestFarm test = fixture.measure(world);
      base::Bytes bytes;
      netio::Packet packet;
      netio::encode({.robot = 0}, netio::V2v{.X_WR = {x, kDenormal, 0.0, yaw}}, bytes);
      checks.holds(netio::decode(bytes, packet) == PacketStatus::accepted, "taken");
      const base::Report report = netio::report(packet.header, std::get<netio::V2v>(packet.body), 0);
      const auto readings = test.farm->tick(1'000'000'000, {&report, 1});
      checks.same(readings[0].values[0], 2.0, fmt::format("x {:g}, yaw {:g}", x, yaw));
    }
}

/// A controller's commands may be any numbers.
void commands(Fixture&, Checks& checks) {
  world::World world;
  add_mover(world, {1.0, 2.0, 0.0, 0.5});
  for (const double bad : {kNan, kInfinity, -kInfinity, kHuge, kDenormal}) {
    robots::Fleet fleet(world);
    const base::Twist command{bad, bad, bad};
    fleet.move({&command, 1}, 100'000'000);
    const base::Pose& X = fleet.reports()[0].X_WM;
    checks.holds(std::isfinite(X.x) && std::isfinite(X.y) && std::isfinite(X.yaw),
                 fmt::format("a command of {:g}", bad));
    const bool stands = !(bad == kHuge || bad == kDenormal);
    if (stands) checks.holds(X.x == 1.0 && X.y == 2.0 && X.yaw == 0.5, fmt::format("{:g} is no command", bad));
    checks.holds(std::hypot(X.x - 1.0, X.y - 2.0) <= 0.1 * world.movers[0].max_forward * (1.0 + 1e-12),
                 "no faster than it can");
  }
}

constexpr Case kNumberCases[] = {
    {"numbers", "in-packets", "", "each number of V2V and TAG: NaN and infinity dropped, limits exact to the last bit",
     packets},
    {"numbers", "in-poses", "m", "denormal and largest poses from bytes to readings: sums are exact, so no bit is off",
     poses},
    {"numbers", "in-commands", "", "NaN and infinity are ignored; the largest number stays within the robot's limits",
     commands},
};

}  // namespace

std::span<const Case> number_cases() { return kNumberCases; }

}  // namespace sf::selftest
