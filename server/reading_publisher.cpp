#include "server/reading_publisher.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "netio/packets.h"
#include "sensors/image_packets.h"

namespace sf::server {

namespace {

/// Returns the accuracy of the values in packets, which includes their rounding.
netio::Accuracy accuracy_on_wire(const sensors::SensorType& type, const sensors::SensorSpec& row,
                                 const base::ReadingBlock& reading) {
  const bool stated = type.wire_error != nullptr && std::isfinite(reading.bound);
  const double error = stated ? type.wire_error(row, reading) : 0.0;
  return {reading.mode, base::is_unsure(reading) || std::isinf(error), reading.bound + error};
}

}  // namespace

netio::OutboxOptions outbox_options(const sensors::SensorSet& sensor_set) {
  netio::OutboxOptions options;
  if (sensor_set.count() <= kLargeFleet) return options;
  options.backlog = 64;
  options.patience_ms = 50;
  return options;
}

ReadingPublisher::ReadingPublisher(const world::World& world, const sensors::SensorSet& sensor_set, StreamLayout layout,
                                   netio::Outbox outbox, std::optional<netio::Endpoint> mirror)
    : world_(world),
      sensor_set_(sensor_set),
      layout_(std::move(layout)),
      outbox_(std::move(outbox)),
      mirror_(mirror),
      thread_pool_(sensor_set.count() > kLargeFleet ? 0 : 1),
      memory_(thread_pool_.threads()) {
  SF_CHECK(!mirror_ || layout_.wire == sensors::WireFormat::farm, "copies of packets without headers");
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    for (const sensors::SensorSpec& row : group.rows)
      streams_[group.type->id].push_back(
          {.parts = layout_.sends(*group.type, row) ? group.type->parts(row, layout_.wire) : 0});
  for (Memory& memory : memory_) {
    memory.payload.reserve(netio::kMaxHeaderlessDatagram);
    memory.packet.reserve(netio::kMaxDatagram);
  }
}

ReadingPublisher::Stream& ReadingPublisher::stream_of(const base::ReadingBlock& reading) {
  const std::vector<sensors::SensorSpec>& rows = sensor_set_.group(reading.type)->rows;
  return streams_.at(reading.type)[static_cast<std::size_t>(&sensor_set_.row(reading) - rows.data())];
}

ReadingPublisher::Job ReadingPublisher::make_job(const AddressedReading& addressed) {
  const base::ReadingBlock& reading = *addressed.reading;
  Stream& stream = stream_of(reading);
  Job job{addressed, sensor_set_.group(reading.type)->type, &sensor_set_.row(reading), &stream, stream.sent};
  if (stream.parts > 0 && layout_.wire == sensors::WireFormat::farm)
    job.image = sensors::image_file(sensor_set_, reading);
  job.parts = stream.parts + sensors::image_parts(job.image.bytes.size());
  return job;
}

/// Returns the readings for which bytes are left, in their order.
std::span<const AddressedReading> ReadingPublisher::admit(std::span<const AddressedReading> readings,
                                                          std::int64_t now) {
  dropped_.clear();
  if (!bucket_) return readings;
  bucket_->refill(now);
  ++calls_;
  order_.clear(), admitted_readings_.clear();
  for (std::uint32_t i = 0; i < readings.size(); ++i)
    if (stream_of(*readings[i].reading).parts > 0) order_.push_back(i);
  std::ranges::stable_sort(order_, {}, [&](std::uint32_t i) {
    const base::ReadingBlock& reading = *readings[i].reading;
    return std::pair(-int{sensor_set_.row(reading).priority}, stream_of(reading).last);
  });
  admitted_.assign(readings.size(), 0);
  bool dropping = false;  // nothing is sent in place of a reading with a higher priority
  for (const std::uint32_t i : order_) {
    Stream& stream = stream_of(*readings[i].reading);
    const double bytes = std::max<double>(stream.bytes, least_bytes(stream));
    admitted_[i] = !dropping && bucket_->has(bytes);
    dropping = dropping || (admitted_[i] == 0 && bucket_->may_have(bytes));
    if (admitted_[i] == 0) {
      dropped_.push_back(readings[i].reading);
      continue;
    }
    stream.last = calls_;
    bucket_->spend(bytes);
  }
  dropped_readings_ += dropped_.size();
  for (std::size_t i = 0; i < readings.size(); ++i)
    if (admitted_[i] != 0) admitted_readings_.push_back(readings[i]);
  return admitted_readings_;
}

/// Corrects what `admit` expected by what was sent.
void ReadingPublisher::charge() {
  if (!bucket_) return;
  for (const Job& job : jobs_) {
    bucket_->spend(job.bytes - std::max<double>(job.stream->bytes, least_bytes(*job.stream)));
    job.stream->bytes = job.bytes;
  }
}

/// Calls `put` (datagram, endpoint, bytes) for each part.
/// @return number of parts that could not be encoded
template <class Put>
std::uint32_t ReadingPublisher::encode(Job& job, Memory& memory, Put&& put) const {
  const base::ReadingBlock& reading = *job.addressed.reading;
  netio::Header header;
  header.robot = static_cast<std::uint16_t>(world_.movers[reading.mover].id);
  header.sensor = static_cast<std::uint16_t>(reading.sensor);
  header.sequence = job.sequence;
  header.time = reading.time;
  header.accuracy = netio::encode_accuracy(accuracy_on_wire(*job.type, *job.row, reading));
  header.session = job.addressed.session_token.session;
  header.token = job.addressed.session_token.token;
  header.state = job.addressed.reading->state;
  header.fused = reading.fused;
  const auto port = static_cast<std::uint16_t>(netio::port(layout_.ports(*job.type), header.robot, reading.sensor));

  std::uint32_t failed = 0;
  job.bytes = 0;
  const auto send = [&](std::uint32_t place, const netio::Endpoint& to, const base::Bytes& bytes) {
    job.bytes += static_cast<std::uint32_t>(bytes.size());
    put(place, to, bytes);
  };
  for (std::uint32_t part = 0; part < job.parts; ++part) {
    memory.payload.clear();
    const std::uint8_t type = part < job.stream->parts
                                  ? job.type->encode(*job.row, reading, layout_.wire, part, memory.payload)
                                  : sensors::encode_image(job.image, part - job.stream->parts, memory.payload);
    if (type == 0) {
      ++failed;
    } else if (layout_.wire == sensors::WireFormat::thesis) {
      send(part, netio::Endpoint{job.addressed.address, port}, memory.payload);
    } else {
      netio::encode_reading(header, type, memory.payload, memory.packet);
      const netio::PacketSigner* signer = job.addressed.signer;
      if (signer != nullptr) netio::sign(memory.packet, signer->key(), job.counter + part);
      send(part, netio::Endpoint{job.addressed.address, port}, memory.packet);
      if (mirror_) send(job.parts + part, *mirror_, memory.packet);
    }
  }
  return failed;
}

void ReadingPublisher::queue(std::span<const AddressedReading> readings, std::int64_t now) {
  std::size_t datagrams = 0;
  jobs_.clear();
  for (const AddressedReading& addressed : admit(readings, now)) {
    Job job = make_job(addressed);
    if (job.stream->parts == 0) continue;
    if (datagrams + datagrams_of(job.parts) > outbox_.capacity()) {
      encode_all();
      datagrams = 0;
    }
    job.place = datagrams;
    // Take counters before the threads start: signatures do not depend on the order of the threads.
    if (job.addressed.signer != nullptr) job.counter = job.addressed.signer->take(job.parts);
    datagrams += datagrams_of(job.parts);
    ++job.stream->sent;
    jobs_.push_back(std::move(job));
  }
  encode_all();
}

/// Encodes all readings in parallel. Falls back to one by one if a part contains a value that is not a number, because
/// unsent packets are not numbered.
void ReadingPublisher::encode_all() {
  if (jobs_.empty()) return;
  const std::size_t datagrams = jobs_.back().place + datagrams_of(jobs_.back().parts);
  const bool fits = datagrams <= outbox_.capacity();
  const std::size_t first = fits ? outbox_.claim(datagrams) : 0;
  if (fits)
    thread_pool_.parallel_for(jobs_.size(), 16, [&](std::size_t begin, std::size_t end, unsigned thread) {
      for (Job& job : std::span(jobs_).subspan(begin, end - begin))
        job.whole = encode(job, memory_[thread], [&](std::uint32_t part, const netio::Endpoint& to, const auto& bytes) {
                      outbox_.put(first + job.place + part, to, bytes);
                    }) == 0;
    });
  if (!fits || std::any_of(jobs_.begin(), jobs_.end(), [](const Job& job) { return !job.whole; })) {
    if (fits) outbox_.give_back(datagrams);
    for (auto job = jobs_.rbegin(); job != jobs_.rend(); ++job) --job->stream->sent;
    for (Job& job : jobs_) encode_and_queue(job);
  }
  charge();
  jobs_.clear();
}

void ReadingPublisher::encode_and_queue(Job& job) {
  job.sequence = job.stream->sent;
  const std::uint32_t failed = encode(
      job, memory_[0], [&](std::uint32_t, const netio::Endpoint& to, const auto& bytes) { outbox_.queue(to, bytes); });
  not_numbers_ += failed;
  job.stream->sent += failed < job.parts ? 1 : 0;
}

}  // namespace sf::server
