#include "netio/receiver.h"

#include "base/error.h"

namespace sf::netio {

Receiver::Receiver(const ReceiverOptions& options)
    : headerless_(options.headerless), inspect_(options.inspect), read_(options.read), read_file_(options.read_file) {
  SF_CHECK(inspect_ != nullptr && read_ != nullptr, "a receiver without a judge or a reader");
  SF_CHECK(!options.key || !headerless_, "signatures without headers");
  for (const ReceiverStream& stream : options.streams) {
    streams_.push_back({stream.spec, ReadingAssembler(stream.value_count), {}});
    if (options.key) streams_.back().checker.emplace(*options.key);
  }
}

void Receiver::set_session(const SessionToken& farm) {
  if (farm_ && farm_->session != 0 && farm_->session != farm.session) {
    for (Stream& stream : streams_) stream.assembler.restart();
  }
  farm_ = farm;
}

PartStatus Receiver::accept(std::size_t i, std::span<const std::uint8_t> bytes, std::int64_t now) {
  Stream& stream = streams_[i];
  Header header;
  std::span<const std::uint8_t> payload = bytes;
  PayloadInfo info;
  if (!headerless_) info.status = decode_reading(bytes, stream.spec, header, payload);
  const bool other_session =
      farm_ && !headerless_ && (header.session != farm_->session || header.token != farm_->token);
  if (info.status == PacketStatus::accepted && other_session) info.status = PacketStatus::wrong_source;
  if (info.status == PacketStatus::accepted && stream.checker) info.status = stream.checker->check(bytes);
  if (info.status == PacketStatus::accepted) info = inspect_(i, header, payload);
  counts_.packets.add(info.status);
  if (info.status != PacketStatus::accepted) return PartStatus::rejected;
  if (info.parts == 0) {
    if (read_file_) read_file_(i, header, payload);
    return PartStatus::incomplete;
  }

  if (headerless_) synthesise_header(stream, info.part, now, header);
  const ReadingPart part{header.sequence, info.part, info.parts, header.time, header.accuracy};
  const PartStatus part_status =
      stream.assembler.take(part, now, [&](std::span<double> values) { read_(i, header, payload, values); });
  counts_.late += part_status == PartStatus::late;
  counts_.duplicates += part_status == PartStatus::duplicate;
  counts_.jumps += part_status == PartStatus::jump;
  return part_status;
}

void Receiver::synthesise_header(Stream& stream, std::uint32_t part, std::int64_t now, Header& header) {
  if (stream.readings == 0 || part <= stream.part) {
    ++stream.readings;
    stream.started = now;
  }
  stream.part = part;
  header.sequence = stream.readings - 1;
  header.time = stream.started;
}

ReceiverCounts Receiver::counts() const {
  ReceiverCounts counts = counts_;
  for (const Stream& stream : streams_) {
    counts.lost += stream.assembler.lost();
    counts.restarts += stream.assembler.restarts();
  }
  return counts;
}

}  // namespace sf::netio
