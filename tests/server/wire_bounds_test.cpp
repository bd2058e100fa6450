// The bound in a packet covers its values: every sensor type and wire form, decoded by the test's own decoder, which
// follows docs/packets.md.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "netio/packets.h"
#include "netio/socket.h"
#include "sensors/laneedge.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "sensors/magnetometer.h"
#include "server/reading_publisher.h"

namespace sf::server {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();

/// A packet's type, accuracy word and first column; NaN for words that do not encode a number.
struct Seen {
  unsigned type = 0, bit = 0;
  double bound = kInf;
  std::vector<double> first;
};

std::uint64_t word_at(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t size) {
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < size; ++i) word |= std::uint64_t{bytes[at + i]} << 8 * i;
  return word;
}

Seen decode(std::span<const std::uint8_t> bytes) {
  const auto accuracy = static_cast<unsigned>(word_at(bytes, 10, 2));
  const auto words = [&](std::size_t at, std::size_t size) {
    return static_cast<std::size_t>(word_at(bytes, at, size));
  };
  Seen seen{bytes[5], accuracy >> 4 & 1, accuracy >> 5 == 0 ? kInf : std::exp2(((accuracy >> 5) - 1024.0) / 16.0), {}};
  const auto number = [&](std::uint64_t word, std::uint64_t none, double per_unit) {
    seen.first.push_back(word == none ? kNan : static_cast<double>(word) / per_unit);
  };
  if (seen.type == 1)
    for (std::size_t i = 0; i < words(64, 2); ++i) number(words(66 + 2 * i, 2), 65'535, 1e3);
  if (seen.type == 65)
    for (std::size_t i = 0; i < words(76, 2); ++i) number(words(80 + 4 * i, 4), 4'294'967'295, 1e4);
  if (seen.type == 2) number(words(64, 2), 65'535, 1e3);
  if (seen.type == 3)
    for (std::size_t i = 0; i < words(64, 2); ++i)
      seen.first.push_back(static_cast<std::int32_t>(word_at(bytes, 68 + 16 * i, 4)) * 1e-8);
  return seen;
}

/// A robot with one sensor, whose readings are sent to a socket of the test.
class Wire {
 public:
  explicit Wire(const world::Sensor& sensor, sensors::WireFormat wire = sensors::WireFormat::farm)
      : world_(with(sensor)), sensor_set_(world_), inlet_(netio::open_udp({netio::kLoopback, 0})) {
    StreamLayout layout;
    layout.stride = 0;  // all on one port
    layout.wire = wire;
    for (const auto& group : sensor_set_.groups()) layout.bases[group.type->id] = netio::bound_endpoint(inlet_).port;
    publisher_.emplace(world_, sensor_set_, layout, netio::Outbox(outbox_options(sensor_set_)));
  }
  const sensors::SensorSet& sensor_set() const { return sensor_set_; }
  std::vector<base::Bytes> send(const base::ReadingBlock& reading) {
    const AddressedReading addressed{&reading, netio::kLoopback, {7, 9}, nullptr};
    publisher_->queue({&addressed, 1});
    publisher_->flush();
    netio::ReceiveBatch batch(64);
    std::vector<base::Bytes> all;
    const std::size_t count = batch.fill(inlet_);
    for (std::size_t i = 0; i < count; ++i) all.emplace_back(batch.bytes(i).begin(), batch.bytes(i).end());
    return all;
  }

 private:
  static world::World with(const world::Sensor& sensor) {
    world::World world;
    world::Mover mover;
    mover.name = "robot1";
    mover.id = 1;
    if (sensor.type == "occupancy") mover.sensors.push_back(sensors::laser_sensor({{.name = "laser"}}));
    mover.sensors.push_back(sensor);
    world.models.push_back({mover.name, "position"});
    world.movers.push_back(mover);
    return world;
  }

  world::World world_;
  sensors::SensorSet sensor_set_;
  netio::Socket inlet_;
  std::optional<ReadingPublisher> publisher_;
};

world::Sensor laser(std::uint32_t samples, double range_max) {
  return sensors::laser_sensor({{.name = "laser", .samples = samples, .range_max = range_max}});
}
world::Sensor plain(const std::string& type) { return {type, type, {}, 0.1, 1.0, 1.0, {}, 0, ""}; }

/// A reading with given first columns; the others are 0.
struct Made {
  Made(std::uint8_t type, std::vector<double> first, double bound, std::size_t width = 1)
      : values(first.size() * width) {
    for (std::size_t i = 0; i < first.size(); ++i) values[i * width] = first[i];
    block.type = type;
    block.values = values;
    block.bound = block.bound_without_noise = bound;
  }
  std::vector<double> values;
  base::ReadingBlock block;
};

std::vector<Seen> sent(Wire& wire, const Made& made) {
  std::vector<Seen> all;
  for (const base::Bytes& bytes : wire.send(made.block)) all.push_back(decode(bytes));
  return all;
}

/// Checks for any values: the farm's are within `bound` of the truth, and the packet's within the bound in the packet.
void covers(const world::Sensor& sensor, std::uint8_t type, std::size_t width, double largest, double half) {
  Wire wire(sensor);
  const std::size_t count = wire.sensor_set().group(type)->rows[0].elements;
  std::mt19937_64 engine(type);
  for (const double bound : {0.0, 1e-12, 1.06e-9, 4e-6, 0.3}) {
    std::vector<double> truth(count);
    for (double& each : truth) each = std::uniform_real_distribution(0.0, largest)(engine);
    truth[0] = largest, truth[count / 2] = 3.5 * half * 2.0;  // half way between two words
    const std::vector<Seen> parts = sent(wire, {type, truth, bound, width});
    std::size_t at = 0;
    for (const Seen& seen : parts) {
      EXPECT_EQ(seen.bit, 0u);
      EXPECT_LE(seen.bound, 1.05 * (bound + half + 1e-15 * largest)) << "no larger than need be";
      for (const double number : seen.first) ASSERT_LE(std::abs(number - truth[at++]) + bound, seen.bound) << bound;
    }
    EXPECT_EQ(at, count);
  }
}

TEST(WireBounds, CoverRoundedNumbers) {
  covers(laser(181, 8.0), sensors::kLaser, 1, 8.0, 0.5e-3);
  covers(laser(361, 65.535), sensors::kLaser, 1, 65.534, 0.5e-3);  // 65.535 is the word for no return
  covers(laser(362, 8.0), sensors::kLaser, 1, 8.0, 0.5e-4);        // extended: two parts
  covers(laser(700, 4e5), sensors::kLaser, 1, 4e5, 0.5e-4);
  covers(plain("laneedge"), sensors::kLaneEdge, 4, 1.0, 0.5e-3);
  covers(plain("magnetometer"), sensors::kMagnetometer, 4, 1e-4, 0.5e-8);
}

/// Returns the accuracy word of one reading.
Seen word_of(const world::Sensor& sensor, const Made& made) {
  Wire wire(sensor);
  const std::vector<Seen> all = sent(wire, made);
  EXPECT_EQ(all.size(), 1u);
  return all.empty() ? Seen{} : all[0];
}

void states_none(const Seen& seen, unsigned bit, const char* why) {
  EXPECT_TRUE(std::isinf(seen.bound)) << why;
  EXPECT_EQ(seen.bit, bit) << why;
}

/// A word may represent all larger values, which no bound covers.
TEST(WireBounds, AreOmittedIfAWordSaturates) {
  const auto lane_edge = [](double distance) {
    return word_of(plain("laneedge"), {sensors::kLaneEdge, {distance}, 1e-8, 4});
  };
  states_none(lane_edge(-0.0501), 1, "sent as 0");
  states_none(lane_edge(-0.00051), 1, "sent as 0, half a millimetre and more off");
  EXPECT_LT(lane_edge(-0.00049).bound, 0.6e-3) << "rounds to 0";
  EXPECT_LT(lane_edge(65.5344).bound, 0.6e-3) << "rounds to the largest word";
  states_none(lane_edge(65.5346), 1, "sent as 65.534");
  const auto field = [](double tesla) {
    return word_of(plain("magnetometer"), {sensors::kMagnetometer, {tesla}, 1e-12, 4});
  };
  EXPECT_LT(field(21.47483647).bound, 6e-9) << "the largest word";
  states_none(field(21.4748366), 1, "one more");
  states_none(field(-22.0), 1, "less than the least");
  const auto far = [](double metres) { return word_of(laser(1, 1e6), {sensors::kLaser, {metres}, 1e-6}); };
  EXPECT_LT(far(429'496.7294).bound, 0.6e-4) << "the largest word that is a number";
  states_none(far(429'496.7295), 1, "one more");
  EXPECT_LT(far(kInf).bound, 0.6e-4) << "no return is not a number";
  EXPECT_TRUE(std::isnan(far(kInf).first.at(0)));
}

/// The same rule for all types: noise, and readings without any element within the bound.
TEST(WireBounds, AreOmittedForNoiseAndFlaggedReadings) {
  Made noisy(sensors::kLaser, {1.0, 2.0, 3.0}, kInf);
  noisy.block.bound_without_noise = 1.06e-9;
  noisy.block.sigma = 0.2;
  states_none(word_of(laser(3, 8.0), noisy), 1, "noise");
  Made bend(sensors::kLaneEdge, {0.3}, kInf, 4);
  const base::QualityFlag why = base::QualityFlag::not_straight;
  bend.block.quality = {&why, 1};
  states_none(word_of(plain("laneedge"), bend), 1, "a bend");
  states_none(word_of(plain("laneedge"), {sensors::kLaneEdge, {kNan}, kInf, 4}), 0, "no edge in sight");
  Made some(sensors::kLaser, {1.0, 2.0, 3.0}, 1e-9);
  const base::QualityFlag flags[] = {base::QualityFlag::none, base::QualityFlag::not_cast, base::QualityFlag::none};
  some.block.quality = flags;
  EXPECT_EQ(word_of(laser(3, 8.0), some).bit, 1u);
  EXPECT_LT(word_of(laser(3, 8.0), some).bound, 0.6e-3) << "of the beams that were cast";
}

/// Types without a bound have none in their packets, with or without noise.
TEST(WireBounds, AreOmittedForTypesWithoutOne) {
  for (const sensors::SensorType* type : sensors::built_in_sensor_types()) {
    if (type->derived != nullptr) continue;  // they need other sensors
    if (type->bound != nullptr) {
      EXPECT_NE(type->wire_error, nullptr) << type->name;
      continue;
    }
    world::Sensor sensor = plain(std::string(type->word.type));
    Wire wire(sensor);
    const sensors::SensorSpec& row = wire.sensor_set().group(type->id)->rows[0];
    Made made(type->id, std::vector<double>(row.elements, 0.0), kInf, sensors::element_width(*type, row));
    made.block.X_WS = row.X_MS;
    for (const double sigma : {0.0, 0.1}) {
      made.block.sigma = sigma;
      const std::vector<Seen> all = sent(wire, made);
      EXPECT_FALSE(all.empty()) << type->name;
      for (const Seen& seen : all) states_none(seen, sigma > 0.0 ? 1 : 0, type->name.data());
    }
  }
}

/// The thesis' layout consists only of numbers.
TEST(WireBounds, AreOmittedInTheThesisLayout) {
  const auto bytes = [](const world::Sensor& sensor, const Made& made) {
    Wire wire(sensor, sensors::WireFormat::thesis);
    const auto all = wire.send(made.block);
    return all.size() == 1 ? all[0].size() : 0;
  };
  EXPECT_EQ(bytes(laser(3, 8.0), {sensors::kLaser, {1.0, 2.0, 3.0}, 1e-9}), 8u) << "count and ranges";
  EXPECT_EQ(bytes(plain("laneedge"), {sensors::kLaneEdge, {0.3}, 1e-8, 4}), 2u) << "distance";
  EXPECT_EQ(bytes(plain("magnetometer"), {sensors::kMagnetometer, {1e-5}, 1e-12, 4}), 4u) << "field";
}

}  // namespace
}  // namespace sf::server
