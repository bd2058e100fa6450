#include "bench/large_fleet.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/hash.h"
#include "bench/tiles.h"
#include "scenarios/simulation.h"
#include "server/reading_publisher.h"
#include "tests/sensors/scenes.h"

namespace sf::bench {

namespace {

constexpr const char* kStages[] = {"move", "place", "scans", "device", "collect", "encode", "send"};
constexpr std::size_t kWarmUp = 10;
constexpr std::size_t kReceiveBuffer = 256u << 20;  // [byte] more than two ticks of packets

/// Receives all packets. Emptied between ticks, outside of the measurement.
class Sink {
 public:
  Sink() : socket_(netio::open_udp({netio::kLoopback, 0}, {.receive = kReceiveBuffer})), batch_(1024) {}

  std::uint16_t port() const { return netio::bound_endpoint(socket_).port; }
  std::uint64_t drain() {
    std::uint64_t count = 0;
    while (const std::size_t taken = batch_.fill(socket_)) count += taken;
    return count;
  }

 private:
  netio::Socket socket_;
  netio::ReceiveBatch batch_;
};

/// Sends all packets to one port: stride 0.
server::StreamLayout plan_for(const sensors::SensorSet& sensor_set, std::uint16_t port) {
  server::StreamLayout layout;
  layout.stride = 0;
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) layout.bases[group.type->id] = port;
  return layout;
}

double percentile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(part * static_cast<double>(values.size())))];
}

farm::FarmStats minus(const farm::FarmStats& p, const farm::FarmStats& q) {
  farm::FarmStats d = p;
  d.readings -= q.readings;
  d.work = p.work - q.work;
  d.place_s -= q.place_s, d.lists_s -= q.lists_s, d.device_s -= q.device_s, d.collect_s -= q.collect_s;
  return d;
}

class LargeFleet {
 public:
  LargeFleet(gpu::Device& device, std::uint32_t robots)
      : world_(made(robots)),
        sensor_set_(world_),
        simulation_(world_, device, {.seed = 7}),
        publisher_(world_, sensor_set_, plan_for(sensor_set_, sink_.port()),
                   netio::Outbox(server::outbox_options(sensor_set_))) {}

  /// @return cost of the tick
  Cost tick() {
    const Cost start = now();
    const base::TickRecord record = simulation_.step();
    const double sensed = now().wall_s;
    addressed_readings_.clear();
    for (const base::ReadingBlock& reading : record.readings)
      addressed_readings_.push_back({&reading, netio::kLoopback, {1, 1}});
    publisher_.queue(addressed_readings_);
    publisher_.flush();
    encode_s_ += now().wall_s - sensed;
    const Cost cost = since(start);
    received_ += sink_.drain();
    return cost;
  }

  /// Waits until all packets are sent.
  netio::OutboxCounts sent() {
    const netio::OutboxCounts counts = publisher_.counts().packets;
    received_ += sink_.drain();
    return counts;
  }
  const scenarios::Simulation& simulation() const { return simulation_; }
  double encode_s() const { return encode_s_; }
  std::uint64_t received() const { return received_; }

 private:
  static world::World made(std::uint32_t robots) {
    world::World world = tiled_cave(robots, scenes::laser());
    add_lanes_and_magnets(world);
    return world;
  }

  world::World world_;
  sensors::SensorSet sensor_set_;
  scenarios::Simulation simulation_;
  Sink sink_;
  server::ReadingPublisher publisher_;
  std::vector<server::AddressedReading> addressed_readings_;
  double encode_s_ = 0.0;
  std::uint64_t received_ = 0;
};

}  // namespace

Report drive_large_fleet(gpu::Device& device, std::uint32_t robots, std::size_t ticks) {
  LargeFleet fleet(device, robots);
  for (std::size_t k = 0; k < kWarmUp; ++k) fleet.tick();
  const netio::OutboxCounts sent = fleet.sent();
  const farm::FarmStats stages = fleet.simulation().farm().stats();
  const double move_s = fleet.simulation().move_seconds(), encode_s = fleet.encode_s();
  const std::uint64_t received = fleet.received();

  std::vector<Cost> costs;
  std::vector<double> walls;
  for (std::size_t k = 0; k < ticks; ++k) {
    costs.push_back(fleet.tick());
    walls.push_back(costs.back().wall_s);
  }
  const netio::OutboxCounts after = fleet.sent();
  SF_CHECK(after.failed == 0, after.first_failure);
  const farm::FarmStats sum = minus(fleet.simulation().farm().stats(), stages);
  const auto n = static_cast<double>(ticks);
  const double p50 = 1e3 * percentile(walls, 0.5), p99 = 1e3 * percentile(walls, 0.99), cpu = 1e3 * median(costs).cpu_s;
  // [ms] of `kStages`; move: decisions, motion and contacts; send: the sending thread
  const double times[] = {1e3 * (fleet.simulation().move_seconds() - move_s) / n,
                          1e3 * sum.place_s / n,
                          1e3 * sum.lists_s / n,
                          1e3 * sum.device_s / n,
                          1e3 * sum.collect_s / n,
                          1e3 * (fleet.encode_s() - encode_s) / n,
                          1e3 * (after.busy_s - sent.busy_s) / n};
  const std::uint64_t datagrams = after.sent - sent.sent, lost = datagrams - (fleet.received() - received);
  const std::uint64_t dropped = after.dropped - sent.dropped;
  const double packets = static_cast<double>(datagrams) / n;
  const double bytes = static_cast<double>(after.sent_bytes - sent.sent_bytes) / n;
  const std::string hash = base::hash_hex(fleet.simulation().farm().hash());
  return {
      "large_fleet",
      fmt::format("\nlarge fleets: laser, lane edge, magnetometers, packets\n{:<8} {:>8} {:>8} {:>8} | {:>7} | "
                  "{:>10} {:>9} {:>8}  {}\n",
                  "robots", "p50 ms", "p99 ms", "cpu ms", fmt::join(kStages, " "), "packets/t", "MB/t", "lost", "hash"),
      "robots,ticks,wall_ms_p50,wall_ms_p99,cpu_ms_median,move_ms,place_ms,scans_ms,device_ms,collect_ms,encode_ms,"
      "send_ms,packets_per_tick,bytes_per_tick,never_sent,not_received,hash",
      fmt::format("{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.0f},{},{},{},{}\n", robots, ticks, p50, p99, cpu,
                  fmt::join(times, ","), packets, bytes, dropped, lost, hash),
      fmt::format("{:<8} {:>8.2f} {:>8.2f} {:>8.2f} | {:>7.2f} | {:>10.0f} {:>9.2f} {:>8}  {}\n", robots, p50, p99, cpu,
                  fmt::join(times, " "), packets, 1e-6 * bytes, dropped + lost, hash),
      {{"p50 [ms]", p50}, {"p99 [ms]", p99}}};
}

}  // namespace sf::bench
