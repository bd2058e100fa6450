#include "server/robot_link.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "netio/own_end.h"
#include "sensors/camera.h"
#include "sensors/laser.h"
#include "server/wire_ids.h"

namespace sf::server {

namespace {

constexpr std::int64_t kMilli = 1'000'000;            ///< [ns]
constexpr std::int64_t kRequest = 500 * kMilli;       ///< [ns] between SUBSCRIBEs: four within the farm's timeout
constexpr std::int64_t kLongestSleep = 100 * kMilli;  ///< [ns] bounds the delay of a stop request
constexpr std::uint32_t kRelayed = 1;                 ///< stream number for packets relayed by the farm
constexpr std::uint32_t kDirect = 2;                  ///< stream number for V2V without the farm
constexpr std::size_t kToFarm = 0, kToPeers = 1;      ///< tags of sent packets

std::uint32_t stream_number(netio::Type type, std::uint32_t low) {
  return static_cast<std::uint32_t>(type) << 16 | low;
}

std::vector<std::uint32_t> others_of(const world::World& world, std::uint32_t id) {
  std::vector<std::uint32_t> ids = ids_of(wire_names(world).robots);
  ids.erase(std::remove(ids.begin(), ids.end(), id), ids.end());
  return ids;
}

std::optional<netio::DirectV2v> direct_of(const LinkOptions& options, const world::World& world, std::uint32_t id) {
  if (!options.direct) return std::nullopt;
  netio::DirectV2vOptions direct = *options.direct;
  direct.robot = id;
  direct.others = others_of(world, id);
  return std::optional<netio::DirectV2v>(std::in_place, direct);
}

}  // namespace

RobotLink::RobotLink(const world::World& world, const sensors::SensorSet& sensor_set, std::uint32_t mover,
                     const StreamLayout& layout, const LinkOptions& options, PacketHandler handler)
    : mover_(mover),
      id_(world.movers[mover].id),
      streams_(streams_of(sensor_set, layout, mover)),
      farm_(options.farm),
      v2v_socket_(
          {.farm = farm_, .robot = id_, .others = others_of(world, id_), .key = options.key, .lights = options.lights}),
      direct_(direct_of(options, world, id_)),
      port_listener_(netio::own_end_for(farm_.address).address, std::size_t{1} << 20, specs(layout)),
      receiver_(receiver_options(layout, options)),
      out_(options.model),
      in_(options.model),
      handler_(std::move(handler)) {
  receiver_.set_session(v2v_socket_.farm_session_token());
}

std::vector<RobotLink::Stream> RobotLink::streams_of(const sensors::SensorSet& sensor_set, const StreamLayout& layout,
                                                     std::uint32_t mover) {
  std::vector<Stream> streams;
  for (const SensorStream& source : sensor_streams(sensor_set, layout, mover))
    if (source.type->read != nullptr) streams.push_back({source});
  const auto cameras = sensor_set.settings_of<sensors::CameraSettings>(sensors::kCamera, mover);
  for (Stream& stream : streams)
    if (stream.source.type->id == sensors::kCamera && cameras[stream.source.row->sensor].rgb)
      stream.camera.emplace(cameras[stream.source.row->sensor]);
  return streams;
}

std::vector<netio::StreamSpec> RobotLink::specs(const StreamLayout& layout) const {
  std::vector<netio::StreamSpec> specs;
  for (const Stream& stream : streams_) {
    const sensors::SensorType& type = *stream.source.type;
    specs.push_back({id_, stream.source.row->sensor, layout.ports(type), std::string(type.name)});
  }
  return specs;
}

netio::ReceiverOptions RobotLink::receiver_options(const StreamLayout& layout, const LinkOptions& options) {
  netio::ReceiverOptions receiver;
  receiver.key = options.key;
  const std::vector<netio::StreamSpec> all = specs(layout);
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    const SensorStream& source = streams_[i].source;
    receiver.streams.push_back({all[i], source.row->elements * element_width(*source.type, *source.row)});
  }
  receiver.headerless = layout.wire == sensors::WireFormat::thesis;
  const sensors::WireFormat wire = layout.wire;
  receiver.inspect = [this, wire](std::size_t i, const netio::Header& header, std::span<const std::uint8_t> payload) {
    return inspect_payload(streams_[i].source, wire, header, payload);
  };
  receiver.read = [this, wire](std::size_t i, const netio::Header& header, std::span<const std::uint8_t> payload,
                               std::span<double> values) {
    part_is_stale_ = header.state.stated && header.state.stale;
    part_is_fused_ = header.fused;
    decode_payload(streams_[i].source, wire, header, payload, values);
  };
  receiver.read_file = [this](std::size_t i, const netio::Header& header, std::span<const std::uint8_t> payload) {
    if (streams_[i].camera) streams_[i].camera->take_part(header.sequence, payload);
  };
  return receiver;
}

void RobotLink::send_request(std::int64_t now) {
  if (now < next_request_) return;
  netio::Subscribe request{netio::kNeighboursBit};
  for (const Stream& stream : streams_) request.types |= base::only(stream.source.type->id);
  const std::uint16_t drive = follows_drive_ ? netio::kFollowsDrive : 0;
  netio::encode({.robot = static_cast<std::uint16_t>(id_), .sensor = drive, .sequence = requests_, .time = now},
                request, packet_);
  send(netio::Type::subscribe, requests_++, now);
  next_request_ = now + kRequest;
}

void RobotLink::send_state(const netio::V2v& state, std::int64_t now, const netio::StateQuality& quality) {
  send_request(now);
  netio::Header header;
  header.robot = static_cast<std::uint16_t>(id_);
  header.time = now;
  header.sequence = states_;
  header.state = quality;
  netio::encode(header, state, packet_);
  if (direct_) {
    direct_->set_position({state.X_WR.x, state.X_WR.y});
    out_.send({id_, stream_number(netio::Type::v2v, kDirect), states_}, now, kToPeers, packet_);
  }
  send(netio::Type::v2v, states_++, now);
}

void RobotLink::send_map(const netio::TeamMap& map, std::int64_t now) {
  netio::encode({.robot = static_cast<std::uint16_t>(id_), .sequence = maps_, .time = now}, map, packet_);
  out_.send({id_, stream_number(netio::Type::team_map, kDirect), maps_++}, now, kToPeers, packet_);
  flush_due(now);
}

void RobotLink::send_own_reading(const OwnReading& own, std::int64_t now) {
  const std::size_t width = sensors::element_width(*sensors::find_sensor_type(own.type));
  netio::OwnReadings part{.type = own.type,
                          .total = static_cast<std::uint32_t>(own.values.size() / width),
                          .fov = static_cast<std::uint32_t>(std::lround(own.fov / netio::kOwnFovUnit))};
  for (; part.first < part.total; part.first += netio::kOwnReadingsPart) {
    part.count = static_cast<std::uint16_t>(std::min(netio::kOwnReadingsPart, part.total - part.first));
    words_.clear();
    std::uint32_t pressed = 0;
    for (std::size_t k = 0; k < part.count; ++k) {
      const double value = own.values[width * (part.first + k)];
      if (own.type == netio::kOwnBumper)
        pressed |= std::uint32_t{value > 0.0} << k;
      else
        netio::put_own_range(value < own.limit || std::isnan(value) ? value : HUGE_VAL, words_);
    }
    if (own.type == netio::kOwnBumper) base::ByteWriter(words_).put(pressed);
    part.words = words_;
    netio::encode(
        {.robot = static_cast<std::uint16_t>(id_), .sensor = own.sensor, .sequence = own_readings_, .time = own.time},
        part, packet_);
    send(netio::Type::own_readings, own_readings_++, now);
  }
}

void RobotLink::send(netio::Type type, std::uint32_t sequence, std::int64_t now) {
  out_.send({id_, stream_number(type, 0), sequence}, now, kToFarm, packet_);
  flush_due(now);
}

void RobotLink::flush_due(std::int64_t until) {
  out_.release(until, [&](std::size_t tag, std::span<const std::uint8_t> bytes) {
    if (tag == kToPeers) return direct_->send(bytes);
    v2v_socket_.send(bytes);
  });
}

void RobotLink::leave(std::int64_t now) {
  if (states_ + requests_ == 0) return;
  netio::Header header;
  header.robot = static_cast<std::uint16_t>(id_);
  header.time = now;
  netio::encode(header, netio::Leave{}, packet_);
  out_.send({id_, stream_number(netio::Type::leave, 0), 0}, now, kToFarm, packet_);
  flush_due(std::numeric_limits<std::int64_t>::max());
}

void RobotLink::wait(std::int64_t now, std::int64_t until) const {
  const std::int64_t next = std::min({until, out_.next(), in_.next(), now + kLongestSleep});
  if (next <= now) return;
  const int timeout_ms = static_cast<int>((next - now + kMilli - 1) / kMilli);
  if (direct_) return direct_->wait(v2v_socket_.socket(), port_listener_.epoll(), timeout_ms);
  netio::wait_readable(v2v_socket_.socket(), port_listener_.epoll(), timeout_ms);
}

void RobotLink::run(std::int64_t now) {
  flush_due(now);
  port_listener_.drain(0, [&](std::size_t i, std::span<const std::uint8_t> bytes, const netio::Endpoint& source) {
    if (source != farm_) return receiver_.reject_source();
    in_.send(reading_id(streams_[i], bytes), now, i, bytes);
  });
  v2v_socket_.receive(
      [&](std::span<const std::uint8_t> bytes) { in_.send(packet_id(bytes, kRelayed), now, streams_.size(), bytes); });
  if (direct_)
    direct_->receive(now, [&](std::span<const std::uint8_t> bytes) {
      in_.send(packet_id(bytes, kDirect), now, streams_.size() + 1, bytes);
    });
  in_.release(now, [&](std::size_t tag, std::span<const std::uint8_t> bytes) { take(tag, bytes, now); });
}

/// The first datagram of a reading is delayed or lost exactly as the reading is in a simulation with the same link.
netio::MessageId RobotLink::reading_id(Stream& stream, std::span<const std::uint8_t> bytes) const {
  netio::Packet packet;
  if (netio::decode(bytes, packet) == netio::PacketStatus::accepted && packet.header.sequence != stream.sequence) {
    stream.sequence = packet.header.sequence;
    stream.piece = 0;
  }
  const std::uint32_t low = stream.source.row->sensor;
  return {id_, std::uint32_t{stream.source.type->id} << 16 | low, stream.piece++ << 32 | stream.sequence};
}

netio::MessageId RobotLink::packet_id(std::span<const std::uint8_t> bytes, std::uint32_t low) {
  netio::Packet packet;
  const bool good = netio::decode(bytes, packet) == netio::PacketStatus::accepted;
  const netio::Type type = packet.header.type;
  if (good && (type == netio::Type::v2v || type == netio::Type::team_map))
    return {id_, stream_number(type, low), std::uint64_t{packet.header.robot} << 32 | packet.header.sequence};
  return {id_, stream_number(netio::Type::start, kRelayed), other_packets_++};
}

void RobotLink::take(std::size_t tag, std::span<const std::uint8_t> bytes, std::int64_t now) {
  if (tag == streams_.size()) return take_packet(bytes, now);
  if (tag > streams_.size()) return take_direct(bytes, now);
  const netio::PartStatus part_status = receiver_.accept(tag, bytes, now);
  if (part_status == netio::PartStatus::rejected) return;
  last_answer_ = now;
  if (part_status != netio::PartStatus::complete) return;
  last_reading_ = now;
  if (streams_[tag].camera) streams_[tag].camera->take_depths(*receiver_.newest(tag));
  ++streams_[tag].whole;
  streams_[tag].fused = part_is_fused_;
  stale_ += part_is_stale_ ? 1 : 0;
  clock_.update(receiver_.newest(tag)->time, now);
}

void RobotLink::take_packet(std::span<const std::uint8_t> bytes, std::int64_t now) {
  netio::Packet packet;
  const netio::SessionToken before = v2v_socket_.farm_session_token();
  if (v2v_socket_.accept(bytes, now, packet) != netio::PacketStatus::accepted) return;
  if (std::holds_alternative<netio::Challenge>(packet.body)) return handle_challenge(before);
  last_answer_ = now;
  if (direct_ && packet.header.type == netio::Type::v2v && !direct_->admit(packet.header, now)) return;
  handler_(packet, now);
}

/// Decodes again, because the injected link may have flipped a bit.
void RobotLink::take_direct(std::span<const std::uint8_t> bytes, std::int64_t now) {
  netio::Packet packet;
  if (netio::decode(bytes, packet) != netio::PacketStatus::accepted) return;
  const bool is_map = packet.header.type == netio::Type::team_map;
  if (!is_map && packet.header.type != netio::Type::v2v) return;
  if (is_map ? direct_->is_active(packet.header.robot, now) : direct_->admit(packet.header, now)) handler_(packet, now);
}

/// Earlier requests were dropped. A new session means a new farm, with its own clock and sequences.
void RobotLink::handle_challenge(const netio::SessionToken& before) {
  next_request_ = 0;
  if (v2v_socket_.farm_session_token().session == before.session) return;
  receiver_.set_session(v2v_socket_.farm_session_token());
  for (Stream& stream : streams_)
    if (stream.camera) stream.camera->restart();
  clock_ = {};
}

std::uint64_t RobotLink::whole(std::uint8_t type, std::uint32_t sensor) const {
  for (const Stream& stream : streams_)
    if (stream.source.type->id == type && stream.source.row->sensor == sensor) return stream.whole;
  return 0;
}

std::uint64_t RobotLink::scans() const {
  std::uint64_t scans = 0;
  for (const Stream& stream : streams_)
    if (stream.source.type->id == sensors::kLaser) scans += stream.whole;
  return scans;
}

namespace {

/// Packets do not show which elements are flagged, so a bound is given only if it holds for all of them. Without one,
/// the sensor may be noisy.
void state_bound(const netio::Accuracy& accuracy, double sigma, base::ReadingBlock& block) {
  block.bound = block.bound_without_noise = accuracy.unsure ? HUGE_VAL : accuracy.bound;
  block.sigma = std::isinf(block.bound) ? sigma : 0.0;
}

}  // namespace

std::span<RobotLink::Newest> RobotLink::readings() {
  newest_.clear();
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    const auto whole = streams_[i].camera ? streams_[i].camera->newest() : receiver_.newest(i);
    if (!whole) continue;
    const SensorStream& source = streams_[i].source;
    Newest& newest = newest_.emplace_back();
    newest.row = source.row;
    newest.block.mover = mover_;
    newest.block.sensor = source.row->sensor;
    newest.block.type = source.type->id;
    newest.block.sequence = whole->sequence;
    newest.block.time = clock_.to_own(whole->time);
    newest.block.values = whole->values;
    newest.block.fused = streams_[i].fused;
    state_bound(netio::decode_accuracy(whole->accuracy), source.row->sigma, newest.block);
  }
  return newest_;
}

LinkCounts RobotLink::counts() const {
  LinkCounts counts{
      v2v_socket_.sent(), out_.counts(), in_.counts(), receiver_.counts(), v2v_socket_.counts(), 0, {}, stale_, {}, {}};
  counts.socket_drops = port_listener_.socket_drops() + netio::socket_drops(v2v_socket_.socket());
  for (const Stream& stream : streams_) {
    counts.whole[std::string(stream.source.type->name)] += stream.whole;
    if (!stream.camera) continue;
    if (!counts.images) counts.images.emplace();
    counts.images->whole += stream.camera->counts().whole, counts.images->invalid += stream.camera->counts().invalid;
  }
  if (direct_) counts.direct = direct_->counts();
  return counts;
}

}  // namespace sf::server
