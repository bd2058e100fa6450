#include "v2x/frame.h"

#include <fmt/format.h>

#include <algorithm>

#include "v2x/map_fields.h"
#include "v2x/spat_fields.h"
#include "v2x/uper_decoder.h"
#include "v2x/uper_encoder.h"

namespace sf::v2x {

namespace {

template <class Message>
std::string decode_message(const base::Bytes& value, Frame& frame) {
  BitReader in(value);
  uper::decode(in, frame.message.emplace<Message>(), Described{});
  if (!in.good()) in.fail_within(Message::kTag);
  const std::size_t used = (in.position() + 7) / 8;
  frame.rest.assign(value.begin() + static_cast<std::ptrdiff_t>(used), value.end());
  return in.fault();
}

/// Meaning of other first two bytes; empty: unknown.
std::string_view message_id_name(std::uint64_t id) {
  switch (id) {
    case 20:
      return " (BasicSafetyMessage)";
    case 27:
      return " (ProbeVehicleData)";
    case 28:
      return " (RTCMcorrections)";
    case 29:
      return " (SignalRequestMessage)";
    case 30:
      return " (SignalStatusMessage)";
    case 31:
      return " (TravelerInformation)";
    case 32:
      return " (PersonalSafetyMessage)";
    case 0x0104:
    case 0x0204:
      return " (an ETSI SPATEM, whose header is not supported)";
    case 0x0105:
    case 0x0205:
      return " (an ETSI MAPEM, whose header is not supported)";
    case 0x0380:
    case 0x0381:
      return " (a message of IEEE 1609.2; expected the frame within it)";
    default:
      return "";
  }
}

}  // namespace

DecodeResult decode(std::span<const std::uint8_t> bytes, Frame& frame) {
  BitReader in(bytes.first(std::min(bytes.size(), kMaxFrame)));
  const bool is_extended = in.bit();
  const std::uint64_t id = in.bits(15);
  if (!in.good()) return {0, in.fault()};
  // Check before the length: data other than a frame rarely has a valid one.
  const bool is_spat = id == Spat::kMessageId;
  if (!is_spat && id != MapData::kMessageId)
    return {0, fmt::format("messageId: {}{} is neither SPaT (19) nor MAP (18)", id, message_id_name(id))};
  const base::Bytes value = in.octets();
  frame.additions.values.clear();
  frame.padding.clear();
  if (is_extended && in.good()) uper::decode(in, frame.additions);
  if (!in.good()) return {0, in.fault()};
  return {(in.position() + 7) / 8,
          is_spat ? decode_message<Spat>(value, frame) : decode_message<MapData>(value, frame)};
}

void encode(const Frame& frame, base::Bytes& out) {
  base::Bytes value;
  std::visit(
      [&](const auto& message) {
        BitWriter content(value);
        uper::encode(content, message, Described{});
      },
      frame.message);
  value.insert(value.end(), frame.rest.begin(), frame.rest.end());

  out.clear();
  BitWriter writer(out);
  writer.put(!frame.additions.values.empty(), 1);
  writer.put(std::holds_alternative<Spat>(frame.message) ? Spat::kMessageId : MapData::kMessageId, 15);
  writer.put_octets(value);
  if (!frame.additions.values.empty()) uper::encode(writer, frame.additions);
  out.insert(out.end(), frame.padding.begin(), frame.padding.end());
}

}  // namespace sf::v2x
