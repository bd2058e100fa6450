#include "netio/receiver.h"

#include "base/error.h"

namespace sf::netio {

Receiver::Receiver(const ReceiverOptions& options)
    : headerless_(options.headerless), judge_(options.judge), read_(options.read) {
  SF_CHECK(judge_ != nullptr && read_ != nullptr, "a receiver without a judge or a reader");
  for (const ReceiverStream& stream : options.streams) streams_.push_back({stream.plan, Assembler(stream.numbers)});
}

void Receiver::bind(const Stamp& farm) {
  if (farm_ && farm_->session != 0 && farm_->session != farm.session) {
    for (Stream& stream : streams_) stream.assembler.restart();
  }
  farm_ = farm;
}

Taken Receiver::accept(std::size_t i, std::span<const std::uint8_t> bytes, std::int64_t now) {
  Stream& stream = streams_[i];
  Header header;
  std::span<const std::uint8_t> payload = bytes;
  Verdict verdict;
  if (!headerless_) verdict.reason = unframe(bytes, stream.plan, header, payload);
  const bool strange = farm_ && !headerless_ && (header.session != farm_->session || header.token != farm_->token);
  if (verdict.reason == Reason::accepted && strange) verdict.reason = Reason::wrong_source;
  if (verdict.reason == Reason::accepted) verdict = judge_(i, header, payload);
  counts_.reasons.add(verdict.reason);
  if (verdict.reason != Reason::accepted) return Taken::refused;

  if (headerless_) number(stream, verdict.part, now, header);
  const Piece piece{header.sequence, verdict.part, verdict.parts, header.time};
  const Taken taken =
      stream.assembler.take(piece, now, [&](std::span<double> values) { read_(i, header, payload, values); });
  counts_.late += taken == Taken::late;
  counts_.duplicates += taken == Taken::duplicate;
  counts_.leaps += taken == Taken::leap;
  return taken;
}

void Receiver::number(Stream& stream, std::uint32_t part, std::int64_t now, Header& header) {
  if (stream.readings == 0 || part <= stream.part) {
    ++stream.readings;
    stream.began = now;
  }
  stream.part = part;
  header.sequence = stream.readings - 1;
  header.time = stream.began;
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
