// Readings, packets and recordings do not change a byte. A change here is a change of a format: packets.md,
// recordings.md and the CHANGELOG must describe it, and the format version must be incremented.

#include <gtest/gtest.h>

#include "base/hash.h"
#include "gpu/device.h"
#include "netio/socket.h"
#include "record/mcap_reader.h"
#include "scenarios/simulation.h"
#include "sensors/sensor_type.h"
#include "server/reading_publisher.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "world/world.h"

namespace sf {
namespace {

const std::string kTown = SF_SOURCE_DIR "/worlds/simville/simville.world";  // every sensor type except sonar
const std::string kCave = SF_SOURCE_DIR "/worlds/cave.world";

std::uint64_t chain(std::span<const std::uint8_t> bytes, std::uint64_t hash) {
  return base::hash_bytes(bytes.data(), bytes.size(), hash);
}

std::uint64_t chain(const std::string& text, std::uint64_t hash) {
  return base::hash_bytes(text.data(), text.size(), hash);
}

struct HeldBytes : testing::Test {
  Folder folder;
};

TEST_F(HeldBytes, Readings) {
  const Outcome cave = run_program({"run", kCave, "--robots", "50", "--duration", "5", "--json"});
  EXPECT_EQ(Json(cave.out).text("/hash"), "82f13e157232718b");
  const Outcome town = run_program({"run", kTown, "--duration", "5", "--json"});
  EXPECT_EQ(Json(town.out).text("/hash"), "3c47de0fcc9ba2af");
}

/// The header contains the version of the program, and for the host caster the name of the processor.
TEST_F(HeldBytes, Recordings) {
  ASSERT_EQ(run_program(
                {"run", kTown, "--duration", "3", "--caster", "vulkan", "--record", folder.path(), "--record-readings"})
                .code,
            0);
  const std::string file = read_file(folder.path("run.mcap"));
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(file.data()), file.size());
  const record::McapContents contents = record::read_mcap(bytes, "run.mcap");
  std::uint64_t hash = 0;
  for (const auto& [id, schema] : contents.schemas) hash = chain(schema.text, chain(schema.name, hash));
  for (const auto& [id, channel] : contents.channels) hash = chain(channel.topic, hash);
  for (const record::McapMessage& m : contents.messages) {
    const std::uint64_t head[] = {m.channel, m.sequence, m.log_time, m.publish_time};
    hash = chain(m.data, base::hash_bytes(head, sizeof head, hash));
  }
  for (const record::McapAttachment& a : contents.attachments) hash = chain(a.data, chain(a.name, hash));
  EXPECT_GT(contents.messages.size(), 1000u);
  EXPECT_EQ(base::hash_hex(hash), "6333d68f5d92553b");
}

/// Every datagram of two seconds, in the order of transmission.
TEST_F(HeldBytes, Packets) {
  const world::World world = world::load_world(kTown, {.sensors = sensors::world_file_words()});
  const sensors::SensorSet sensor_set(world);
  gpu::Device device;
  scenarios::Simulation simulation(world, device, {.seed = 1});
  const netio::Socket sink = netio::open_udp({netio::kLoopback, 0}, {.receive = 4u << 20});
  server::StreamLayout layout;
  layout.stride = 0;  // all to one port
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    layout.bases[group.type->id] = netio::bound_endpoint(sink).port;
  server::ReadingPublisher post(world, sensor_set, layout, netio::Outbox(server::outbox_options(sensor_set)));

  netio::ReceiveBatch batch(64);
  std::uint64_t hash = 0;
  std::size_t count = 0;
  for (int tick = 0; tick < 20; ++tick) {
    std::vector<server::AddressedReading> letters;
    for (const base::ReadingBlock& reading : simulation.step().readings)
      letters.push_back({&reading, netio::kLoopback, {7, 9}});
    post.queue(letters);
    post.flush();
    while (const std::size_t taken = batch.fill(sink))
      for (std::size_t i = 0; i < taken; ++i, ++count) hash = chain(batch.bytes(i), hash);
  }
  EXPECT_EQ(count, post.counts().packets.sent);
  EXPECT_EQ(base::hash_hex(hash), "951a26b9fb09b76d");
}

}  // namespace
}  // namespace sf
