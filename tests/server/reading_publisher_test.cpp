// Readings as packets: the bytes and numbers do not depend on how many are encoded at once.

#include "server/reading_publisher.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "netio/packets.h"
#include "netio/socket.h"
#include "sensors/camera.h"
#include "sensors/image_packets.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "tests/world/read_world.h"

namespace sf::server {
namespace {

constexpr std::uint32_t kBeams = 31;

/// Robots with only one laser each.
world::World fleet(std::uint32_t robots, std::uint32_t beams = kBeams) {
  world::World world;
  for (std::uint32_t i = 0; i < robots; ++i) {
    world::Mover mover;
    mover.name = "robot" + std::to_string(i + 1);
    mover.id = i + 1;
    mover.model = i;
    mover.sensors.push_back(sensors::laser_sensor({{.name = "laser", .samples = beams}}));
    world.models.push_back({mover.name, "position"});
    world.movers.push_back(mover);
  }
  return world;
}

/// Readings of all robots for some ticks; a few have a beam that is not a number, and are not sent.
struct Day {
  std::vector<std::vector<double>> values;
  std::vector<base::ReadingBlock> blocks;
  std::vector<std::size_t> ticks;  ///< end of each in `blocks`

  Day(std::uint32_t robots, int count) {
    for (int tick = 0; tick < count; ++tick) {
      for (std::uint32_t m = 0; m < robots; ++m) {
        std::vector<double>& ranges = values.emplace_back(kBeams);
        for (std::uint32_t k = 0; k < kBeams; ++k) ranges[k] = 0.001 * ((m * 131 + k * 17 + tick * 7) % 8000);
        if (tick == 2 && m % 97 == 5) ranges[3] = std::numeric_limits<double>::quiet_NaN();
        base::ReadingBlock block;
        block.mover = m;
        block.type = sensors::kLaser;
        block.time = tick * 100'000'000ll;
        blocks.push_back(block);
      }
      ticks.push_back(blocks.size());
    }
    for (std::size_t i = 0; i < blocks.size(); ++i) blocks[i].values = values[i];
  }
};

class PostTest : public testing::TestWithParam<std::uint32_t> {};

/// Boundary: few sensors are encoded by one thread, many on all cores and sent by a separate thread.
TEST_P(PostTest, ParallelEncodingGivesTheSameBytesAndNumbers) {
  const std::uint32_t robots = GetParam();
  const world::World world = fleet(robots);
  const sensors::SensorSet sensor_set(world);
  const netio::Socket receiver = netio::open_udp({netio::kLoopback, 0}, {.receive = 32u << 20});
  if (netio::receive_buffer(receiver) < 2'000 * robots) GTEST_SKIP() << "this user's receive buffers hold too little";
  StreamLayout layout;
  layout.stride = 0;  // all on one port
  layout.bases[sensors::kLaser] = netio::bound_endpoint(receiver).port;
  ReadingPublisher post(world, sensor_set, layout, netio::Outbox(outbox_options(sensor_set)));

  Day day(robots, 5);
  const sensors::SensorType& type = *sensor_set.group(sensors::kLaser)->type;
  std::map<std::uint32_t, std::uint32_t> sent;
  // Every third robot has a key. A reading that is not sent skips its counter.
  std::map<std::uint32_t, netio::PacketSigner> signers;
  std::map<std::uint32_t, std::uint64_t> counters;
  for (std::uint32_t robot = 0; robot < robots; robot += 3)
    signers.emplace(robot, netio::PacketSigner(netio::SigningKey{static_cast<std::uint8_t>(robot)}, 1000));
  netio::ReceiveBatch batch(64);
  std::size_t first = 0, lost = 0;
  for (const std::size_t end : day.ticks) {
    std::vector<AddressedReading> letters;
    std::vector<base::Bytes> expected;
    for (std::size_t i = first; i < end; ++i) {
      base::ReadingBlock& block = day.blocks[i];
      block.state = {.stated = true, .stale = i % 2 == 1, .age = 80'000'000, .covariance = {1e-4f}};
      const auto signer = signers.find(block.mover);
      const std::uint64_t counter = 1000 + counters[block.mover]++;
      letters.push_back({&block, netio::kLoopback, {7, 9}, signer != signers.end() ? &signer->second : nullptr});
      base::Bytes payload, packet;
      const std::uint8_t packet_type = type.encode(sensor_set.row(block), block, sensors::WireFormat::farm, 0, payload);
      if (packet_type == 0) continue;
      netio::Header header;
      header.robot = static_cast<std::uint16_t>(block.mover + 1);
      header.sequence = sent[block.mover]++;
      header.time = block.time;
      header.accuracy = netio::encode_accuracy({block.mode, false, block.bound});
      header.session = 7;
      header.token = 9;
      header.state = block.state;
      netio::encode_reading(header, packet_type, payload, packet);
      if (signer != signers.end()) netio::sign(packet, signer->second.key(), counter);
      expected.push_back(packet);
    }
    lost += letters.size() - expected.size();
    post.queue(letters);
    post.flush();
    EXPECT_EQ(post.counts().packets.dropped, 0u);
    EXPECT_EQ(post.counts().not_numbers, lost);
    std::size_t next = 0;
    while (const std::size_t taken = batch.fill(receiver))
      for (std::size_t i = 0; i < taken; ++i, ++next) {
        ASSERT_LT(next, expected.size());
        const auto bytes = batch.bytes(i);
        ASSERT_TRUE(std::equal(bytes.begin(), bytes.end(), expected[next].begin(), expected[next].end())) << next;
      }
    EXPECT_EQ(next, expected.size());
    first = end;
  }
  EXPECT_EQ(lost > 0, robots > 5);
}

/// Boundary: 400 beams take two datagrams.
TEST(ReadingPublisher, EachPartHasItsOwnCounter) {
  const world::World world = fleet(1, 400);
  const sensors::SensorSet sensor_set(world);
  const netio::Socket receiver = netio::open_udp({netio::kLoopback, 0});
  StreamLayout layout;
  layout.stride = 0;
  layout.bases[sensors::kLaser] = netio::bound_endpoint(receiver).port;
  ReadingPublisher publisher(world, sensor_set, layout, netio::Outbox(outbox_options(sensor_set)));
  netio::PacketSigner signer(netio::SigningKey{1}, 5);
  const std::vector<double> ranges(400, 1.0);
  base::ReadingBlock block;
  block.type = sensors::kLaser;
  block.values = ranges;
  const AddressedReading addressed{&block, netio::kLoopback, {7, 9}, &signer};
  for (int reading = 0; reading < 2; ++reading) {
    publisher.queue({&addressed, 1});
    publisher.flush();
  }
  netio::SignatureChecker checker(netio::SigningKey{1});
  netio::ReceiveBatch batch(8);
  ASSERT_EQ(batch.fill(receiver), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(checker.check(batch.bytes(i)), netio::PacketStatus::accepted) << i;
  EXPECT_EQ(signer.take(), 9u) << "as many as datagrams";
}

/// Boundary: a reading of two parts, and one that contains a value that is not a number and is encoded one by one.
TEST(ReadingPublisher, AMirrorReceivesACopyOfEachPacket) {
  const world::World world = fleet(2, 400);
  const sensors::SensorSet sensor_set(world);
  const netio::Socket receiver = netio::open_udp({netio::kLoopback, 0}),
                      mirror = netio::open_udp({netio::kLoopback, 0});
  StreamLayout layout;
  layout.stride = 0;
  layout.bases[sensors::kLaser] = netio::bound_endpoint(receiver).port;
  ReadingPublisher publisher(world, sensor_set, layout, netio::Outbox(outbox_options(sensor_set)),
                             netio::bound_endpoint(mirror));
  netio::PacketSigner signer(netio::SigningKey{1}, 5);
  std::vector<double> ranges(400, 1.0), broken(400, 2.0);
  broken[399] = NAN;
  base::ReadingBlock whole, half;
  whole.type = half.type = sensors::kLaser;
  half.mover = 1;
  whole.values = ranges, half.values = broken;
  for (const std::size_t readings : {1, 2}) {
    const std::vector<AddressedReading> addressed{{&whole, netio::kLoopback, {7, 9}, &signer},
                                                  {&half, netio::kLoopback, {7, 9}, nullptr}};
    publisher.queue(std::span(addressed).first(readings));
    publisher.flush();
  }
  netio::ReceiveBatch sent(16), copied(16);
  ASSERT_EQ(sent.fill(receiver), 5u);
  ASSERT_EQ(copied.fill(mirror), 5u);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_TRUE(std::ranges::equal(sent.bytes(i), copied.bytes(i))) << i << ": signatures too";
  EXPECT_EQ(publisher.counts().packets.sent, 10u);
}

/// The colours of a camera follow its depths as a file, also in the copies; signatures count them.
TEST(ReadingPublisher, ColoursAreSentAsAFile) {
  const world::World world = world::read_world("position( name \"a\" camera( resolution [32 16] rgb 1 ) )\n",
                                               {.sensors = sensors::world_file_words()});
  const sensors::SensorSet sensor_set(world);
  const netio::Socket receiver = netio::open_udp({netio::kLoopback, 0}),
                      mirror = netio::open_udp({netio::kLoopback, 0});
  StreamLayout layout;
  layout.stride = 0;
  layout.bases[sensors::kCamera] = netio::bound_endpoint(receiver).port;
  ReadingPublisher publisher(world, sensor_set, layout, netio::Outbox(outbox_options(sensor_set)),
                             netio::bound_endpoint(mirror));
  netio::PacketSigner signer(netio::SigningKey{1}, 5);
  std::vector<double> pixels;
  for (std::uint32_t i = 0; i < 32 * 16; ++i)
    pixels.insert(pixels.end(), {1.0, static_cast<double>((i * i * 2654435761u) >> 8)});
  base::ReadingBlock block;
  block.type = sensors::kCamera;
  block.values = pixels;
  const AddressedReading addressed{&block, netio::kLoopback, {7, 9}, &signer};
  publisher.queue({&addressed, 1});
  publisher.flush();

  netio::ReceiveBatch sent(8), copied(8);
  const std::string file = sensors::image_file(sensor_set, block).bytes;
  const std::size_t datagrams = 2 + sensors::image_parts(file.size());
  ASSERT_EQ(datagrams, 4u) << file.size() << " bytes of random colours";
  ASSERT_EQ(sent.fill(receiver), datagrams);
  ASSERT_EQ(copied.fill(mirror), datagrams);
  std::string received;
  for (std::size_t i = 0; i < datagrams; ++i) {
    EXPECT_TRUE(std::ranges::equal(sent.bytes(i), copied.bytes(i))) << i;
    netio::Packet packet;
    ASSERT_EQ(netio::decode(sent.bytes(i), packet), netio::PacketStatus::accepted);
    sensors::ImagePart image;
    if (i < 2) continue;
    ASSERT_EQ(sensors::read_image(std::get<netio::Reading>(packet.body).payload, image), sensors::PayloadError::none);
    received.append(image.bytes.begin(), image.bytes.end());
  }
  EXPECT_EQ(received, file);
  EXPECT_EQ(signer.take(), 5 + datagrams) << "as many as datagrams";
}

INSTANTIATE_TEST_SUITE_P(Fleets, PostTest, testing::Values(3u, 256u, 257u, 2500u));

}  // namespace
}  // namespace sf::server
