#include "netio/ports.h"

#include <gtest/gtest.h>

#include <vector>

#include "base/error.h"
#include "tests/refusal.h"

namespace sf::netio {
namespace {

std::string refusal(const std::vector<SensorPorts>& uses) {
  return refusal_of([&] { require_ports(uses); });
}

SensorPorts use(std::uint32_t robot, std::uint32_t sensors, PortRule rule = {}) {
  return {robot, sensors, rule, "roomba"};
}

TEST(Ports, ComputesBasePlusRobotTimesStridePlusSensor) {
  EXPECT_EQ(port({}, 0, 0), 10000u);
  EXPECT_EQ(port({}, 7, 0), 10056u);
  EXPECT_EQ(port({}, 7, 3), 10059u);
  EXPECT_EQ(port({20000, 2}, 5, 1), 20011u);
  EXPECT_EQ(port({65535, 65535}, 0xFFFFFFFFu, 7), 65535u + 0xFFFFFFFFull * 65535u + 7u);  // no wrap
}

TEST(Ports, AcceptsAFleetWithinTheLimits) {
  std::vector<SensorPorts> fleet;
  for (std::uint32_t id = 0; id <= 6941; ++id) fleet.push_back(use(id, 8));  // the last port is 65535
  EXPECT_EQ(refusal(fleet), "");
  EXPECT_EQ(refusal({use(65'535, 1, {0, 1})}), "");  // the last id, on the last port
  EXPECT_EQ(refusal({}), "");
  EXPECT_EQ(refusal({use(70'000, 0)}), "");  // a robot without sensors needs no port
}

TEST(Ports, RejectsPortsBeyondTheLast) {
  EXPECT_NE(refusal({use(6942, 1)}).find("needs port 65536"), std::string::npos);
  EXPECT_EQ(refusal({use(6941, 8)}), "");
  EXPECT_NE(refusal({use(6941, 9)}).find("sensor 8 needs port 65536"), std::string::npos);
  EXPECT_NE(refusal({use(70'000, 1, {1000, 0})}), "");  // an id that does not fit a packet
  EXPECT_NE(refusal({use(0, 1, {0, 8})}).find("needs port 0"), std::string::npos);
}

TEST(Ports, RejectsTwoSensorsOnOnePort) {
  EXPECT_EQ(refusal({use(1, 9), use(3, 1)}), "");  // beyond its stride, on free ports
  EXPECT_NE(refusal({use(1, 9), use(2, 1)}).find("raise the stride to at least 9"), std::string::npos);
  EXPECT_NE(refusal({use(4, 1), use(4, 1)}).find("share port 10032"), std::string::npos);
  EXPECT_NE(refusal({use(4, 1), use(4, 1)}).find("its own id"), std::string::npos);
}

TEST(Ports, FindsTheSmallestStrideThatFits) {
  EXPECT_EQ(smallest_stride({}, 8), 8u);
  const std::vector<SensorPorts> few{use(1, 8), use(2, 3)};
  EXPECT_EQ(smallest_stride(few, 8), 8u);
  const std::vector<SensorPorts> many{use(1, 17), use(2, 17)};  // more than the usual number
  EXPECT_EQ(smallest_stride(many, 8), 17u);
  const std::vector<SensorPorts> last{use(1, 17), use(2, 1), use(4, 1)};  // from 27 on the ports are free up to robot 4
  EXPECT_EQ(smallest_stride(last, 8), 17u);
  const std::vector<SensorPorts> large{use(0, 1), use(8000, 2)};  // with stride 8 the port exceeds 65535
  EXPECT_EQ(smallest_stride(large, 8), 1u);
  const SensorPorts other{1, 1, {10010, 8}, "tug", 0, "sonar"};
  const std::vector<SensorPorts> types{use(1, 3), use(2, 3),
                                       other};                // sonar at 10010 + stride, lasers at 10000 + stride ...
  EXPECT_EQ(smallest_stride(types, 8), 3u);                   // 8: robot 2's third laser would collide with the sonar
  const std::vector<SensorPorts> none{use(4, 1), use(4, 1)};  // no stride helps
  EXPECT_EQ(smallest_stride(none, 8), 8u);
}

TEST(Ports, NamesBothTypesInTheMessage) {
  const SensorPorts lasers{1, 1, {10000, 8}, "roomba", 0, "laser"};
  const SensorPorts others{0, 9, {10000, 8}, "tug", 0, "magnetometer"};
  EXPECT_EQ(refusal({lasers, {0, 9, {20000, 8}, "tug", 0, "magnetometer"}}), "");
  const std::string text = refusal({lasers, others});
  expect_in("'roomba' (id 1) laser 0 and robot 'tug' (id 0) magnetometer 8 share port 10008", text);
  EXPECT_NE(text.find("change the base port of laser or the base port of magnetometer"), std::string::npos) << text;
  // Two types of one robot on one base port: the message does not blame its id.
  SensorPorts scan{1, 1, {52000, 8}, "roomba", 0, "laser", "--laser-port"};
  const SensorPorts map{1, 1, {52000, 8}, "roomba", 0, "occupancy", "--occupancy-port"};
  const std::string both = refusal({scan, map});
  EXPECT_NE(both.find("change --laser-port or --occupancy-port"), std::string::npos) << both;
  scan.rule.base = 51999;
  scan.sensors = 2;
  const std::string near = refusal({scan, map});
  EXPECT_NE(near.find("move --laser-port and --occupancy-port apart"), std::string::npos) << near;
}

}  // namespace
}  // namespace sf::netio
