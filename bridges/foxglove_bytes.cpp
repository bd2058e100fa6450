#include "bridges/foxglove_bytes.h"

#include <cstring>
#include <limits>

#include "record/ros_messages.h"

namespace sf::bridges {

namespace {

enum class ServerOp : std::uint8_t { message_data = 1, time = 2, service_response = 3, playback_state = 5 };
enum class ClientOp : std::uint8_t { message_data = 1, service_request = 2, playback_request = 3 };

std::string get_text(base::ByteReader& bytes) {
  const auto size = bytes.get<std::uint32_t>();
  const auto text = bytes.get_bytes(size);
  return {text.begin(), text.end()};
}

ServiceCall read_service_call(base::ByteReader& bytes) {
  ServiceCall call;
  call.service = bytes.get<std::uint32_t>();
  call.call = bytes.get<std::uint32_t>();
  call.encoding = get_text(bytes);
  if (bytes.good()) call.payload = bytes.get_bytes(bytes.left());
  return call;
}

std::optional<PlaybackRequest> read_playback_request(base::ByteReader& bytes) {
  const auto command = bytes.get<std::uint8_t>();
  PlaybackRequest request{.pause = command == 1, .speed = bytes.get<float>()};
  const bool seeks = bytes.get<std::uint8_t>() != 0;
  const auto time = bytes.get<std::uint64_t>();
  if (command > 1 || time > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) return std::nullopt;
  if (seeks) request.time = static_cast<std::int64_t>(time);
  request.id = get_text(bytes);
  return request;
}

}  // namespace

std::array<std::uint8_t, 13> message_head(std::uint32_t subscription, std::int64_t time) {
  std::array<std::uint8_t, 13> head{static_cast<std::uint8_t>(ServerOp::message_data)};
  std::memcpy(head.data() + 1, &subscription, sizeof(subscription));
  std::memcpy(head.data() + 5, &time, sizeof(time));
  return head;
}

base::Bytes time_bytes(std::int64_t time) {
  base::Bytes bytes;
  base::ByteWriter out(bytes);
  out.put(static_cast<std::uint8_t>(ServerOp::time));
  out.put(time);
  return bytes;
}

base::Bytes service_response_bytes(std::uint32_t service, std::uint32_t call, std::string_view encoding,
                                   std::span<const std::uint8_t> payload) {
  base::Bytes bytes;
  base::ByteWriter out(bytes);
  out.put(static_cast<std::uint8_t>(ServerOp::service_response));
  out.put(service);
  out.put(call);
  out.put_string(encoding);
  out.put_bytes(payload.data(), payload.size());
  return bytes;
}

base::Bytes playback_state_bytes(const PlaybackState& state) {
  base::Bytes bytes;
  base::ByteWriter out(bytes);
  out.put(static_cast<std::uint8_t>(ServerOp::playback_state));
  out.put(static_cast<std::uint8_t>(state.status));
  out.put(state.time);
  out.put(state.speed);
  out.put(static_cast<std::uint8_t>(state.did_seek ? 1 : 0));
  out.put_string(state.request);
  return bytes;
}

std::optional<ClientBinary> parse_client_binary(std::span<const std::uint8_t> message) {
  base::ByteReader bytes(message);
  std::optional<ClientBinary> parsed;
  switch (static_cast<ClientOp>(bytes.get<std::uint8_t>())) {
    case ClientOp::message_data: {
      ClientPublish publish{bytes.get<std::uint32_t>(), {}};
      if (bytes.good()) publish.payload = bytes.get_bytes(bytes.left());
      parsed = publish;
      break;
    }
    case ClientOp::service_request:
      parsed = read_service_call(bytes);
      break;
    case ClientOp::playback_request:
      if (auto request = read_playback_request(bytes)) parsed = std::move(*request);
      break;
  }
  return bytes.good() ? parsed : std::nullopt;
}

std::optional<base::Twist> read_cdr_twist(std::span<const std::uint8_t> message, bool stamped) {
  record::CdrReader cdr(message);
  std::int64_t time = 0;
  if (stamped) record::get_header(cdr, time);
  std::array<double, 6> values{};
  for (double& value : values) value = cdr.get<double>();
  if (!cdr.good()) return std::nullopt;
  return base::Twist{values[0], values[1], values[5]};
}

}  // namespace sf::bridges
