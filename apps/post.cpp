#include "apps/post.h"

#include <limits>

#include "netio/packets.h"
#include "sensors/laser_shape.h"

namespace sf::apps {

std::span<const base::ReadingBlock> NoReturn::apply(std::span<const base::ReadingBlock> readings) {
  if (!infinite_) return readings;
  std::size_t count = 0;
  for (const base::ReadingBlock& r : readings) count += r.hits.size();
  ranges_.resize(count);
  blocks_.assign(readings.begin(), readings.end());
  double* at = ranges_.data();
  for (base::ReadingBlock& r : blocks_) {
    if (r.hits.empty()) continue;  // no beams
    sensors::mark_no_return(r, roster_.row(r).limit, {at, r.values.size()});
    r.values = {at, r.values.size()};
    at += r.values.size();
  }
  return blocks_;
}

Post::Post(const world::World& world, const sensors::Roster& roster, SendPlan plan, netio::Outbox outbox)
    : world_(world), roster_(roster), plan_(std::move(plan)), outbox_(std::move(outbox)) {
  for (const sensors::Roster::Group& group : roster.groups()) sent_[group.kind->id].resize(group.rows.size());
  payload_.reserve(netio::kMaxPlain);
  packet_.reserve(netio::kMaxDatagram);
}

void Post::queue(const base::ReadingBlock& reading, std::uint32_t address, const netio::Stamp& stamp) {
  const sensors::Roster::Group& group = *roster_.group(reading.kind);
  const sensors::SensorKind& kind = *group.kind;
  const sensors::SensorRow& row = roster_.row(reading);
  if (!plan_.sends(kind, row)) return;
  std::uint32_t& sent = sent_[reading.kind][static_cast<std::size_t>(&row - group.rows.data())];
  netio::Header header;
  header.robot = static_cast<std::uint16_t>(world_.movers[reading.mover].id);
  header.sensor = static_cast<std::uint16_t>(reading.sensor);
  header.sequence = sent;
  header.time = reading.time;
  header.accuracy = netio::accuracy_word({reading.mode, !reading.unsure.empty(), reading.bound});
  header.session = stamp.session;
  header.token = stamp.token;
  const auto port = static_cast<std::uint16_t>(netio::port(plan_.ports(kind), header.robot, reading.sensor));

  const std::uint32_t parts = kind.parts(row, plan_.wire);
  bool any = false;
  for (std::uint32_t part = 0; part < parts; ++part) {
    payload_.clear();
    const std::uint8_t type = kind.encode(row, reading, plan_.wire, part, payload_);
    any = any || type != 0;
    if (type == 0) {
      ++not_numbers_;
    } else if (plan_.wire == sensors::Wire::thesis) {
      outbox_.queue({address, port}, payload_);
    } else {
      netio::frame(header, type, payload_, packet_);
      outbox_.queue({address, port}, packet_);
    }
  }
  sent += any ? 1 : 0;
}

}  // namespace sf::apps
