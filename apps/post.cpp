#include "apps/post.h"

#include <limits>

#include "base/error.h"
#include "netio/packets.h"
#include "sensors/laser_shape.h"

namespace sf::apps {

namespace {

void require_wire(const world::World& world, const sensors::Roster::Group& group, sensors::Wire wire) {
  for (const sensors::SensorRow& row : group.rows) {
    const std::string why = group.kind->refuse(row, wire);
    if (!why.empty()) throw base::InputError(world.movers[row.mover].name + "." + row.name + ": " + why);
  }
}

std::string port_option(const sensors::SensorKind& kind) { return "--" + std::string(kind.name) + "-port"; }

std::vector<netio::PortUse> uses_of(const world::World& world, const sensors::Roster& roster, const Options& options) {
  std::vector<netio::PortUse> uses;
  for (const sensors::Roster::Group& group : roster.groups())
    for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
      const auto rows = roster.of(group.kind->id, m);
      if (rows.empty()) continue;
      uses.push_back({world.movers[m].id, static_cast<std::uint32_t>(rows.size()), port_rule(options, *group.kind),
                      world.movers[m].name, 0, std::string(group.kind->name), port_option(*group.kind)});
    }
  return uses;
}

}  // namespace

netio::PortRule port_rule(const Options& options, const sensors::SensorKind& kind) {
  return {options.base_ports.at(kind.id), options.ports_per_robot};
}

void require_sendable(const world::World& world, const sensors::Roster& roster, const Options& options) {
  std::string bases;
  for (const sensors::Roster::Group& group : roster.groups()) {
    require_wire(world, group, options.wire);
    bases += (bases.empty() ? "" : ", ") + port_option(*group.kind);
  }
  try {
    netio::require_ports(uses_of(world, roster, options));
  } catch (const base::InputError& error) {
    throw base::InputError(std::string(error.what()) + " (base: " + bases + "; stride: --ports-per-robot)");
  }
}

std::span<const base::ReadingBlock> NoReturn::apply(std::span<const base::ReadingBlock> readings) {
  if (!infinite_) return readings;
  std::size_t count = 0;
  for (const base::ReadingBlock& r : readings) count += r.hits.size();
  ranges_.resize(count);
  blocks_.assign(readings.begin(), readings.end());
  double* at = ranges_.data();
  for (base::ReadingBlock& r : blocks_) {
    if (r.hits.empty()) continue;  // no beams
    const double range_max = roster_.row(r).limit;
    for (std::size_t i = 0; i < r.values.size(); ++i) at[i] = sensors::or_infinite(r.values[i], r.hits[i], range_max);
    r.values = {at, r.values.size()};
    at += r.values.size();
  }
  return blocks_;
}

Post::Post(const world::World& world, const sensors::Roster& roster, const Options& options)
    : world_(world), roster_(roster), options_(options) {
  for (const sensors::Roster::Group& group : roster.groups()) sent_[group.kind->id].resize(group.rows.size());
  payload_.reserve(netio::kMaxPlain);
  packet_.reserve(netio::kMaxDatagram);
}

void Post::queue(const base::ReadingBlock& reading, std::uint32_t address) {
  const sensors::Roster::Group& group = *roster_.group(reading.kind);
  const sensors::SensorKind& kind = *group.kind;
  const sensors::SensorRow& row = roster_.row(reading);
  std::uint32_t& sent = sent_[reading.kind][static_cast<std::size_t>(&row - group.rows.data())];
  netio::Header header;
  header.robot = static_cast<std::uint16_t>(world_.movers[reading.mover].id);
  header.sensor = static_cast<std::uint16_t>(reading.sensor);
  header.sequence = sent;
  header.time = reading.time;
  header.accuracy = netio::accuracy_word({reading.mode, !reading.unsure.empty(), reading.bound});
  const auto port = static_cast<std::uint16_t>(netio::port(port_rule(options_, kind), header.robot, reading.sensor));

  const std::uint32_t parts = kind.parts(row, options_.wire);
  bool any = false;
  for (std::uint32_t part = 0; part < parts; ++part) {
    payload_.clear();
    const std::uint8_t type = kind.encode(row, reading, options_.wire, part, payload_);
    any = any || type != 0;
    if (type == 0) {
      ++not_numbers_;
    } else if (options_.wire == sensors::Wire::thesis) {
      outbox_.queue({address, port}, payload_);
    } else {
      netio::frame(header, type, payload_, packet_);
      outbox_.queue({address, port}, packet_);
    }
  }
  sent += any ? 1 : 0;
}

}  // namespace sf::apps
