// The process with Fast DDS (bridges/fast_services.h). Reads settings and replies from standard input, writes requests
// to standard output, and exits when its input ends.

#include <cstdio>
#include <mutex>
#include <stdexcept>
#include <string>

#include "bridges/dds_outbox.h"
#include "bridges/fastdds/participant.h"
#include "bridges/pipe_frames.h"
#include "netio/open_sockets.h"

namespace sf::bridges {

namespace {

constexpr std::uint32_t kMaxFrame = 1u << 30;  // [byte] from the farm
constexpr unsigned kMaxStart = 20;             // [s]

/// Thread-safe.
void send(const Frame& frame) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  write_frame(1, frame);
}

void send(FrameKind kind, std::string_view text) { send({kind, 0, 0, {text.begin(), text.end()}}); }

DdsEndpoint read_endpoint(base::ByteReader& in) {
  DdsEndpoint endpoint;
  for (std::string* text : {&endpoint.topic, &endpoint.type, &endpoint.user_data}) *text = in.get_string();
  endpoint.depth = static_cast<int>(in.get<std::uint32_t>());
  return endpoint;
}

std::unique_ptr<DdsParticipant> open(const base::Bytes& settings) {
  base::ByteReader in(settings);
  DdsOptions options;
  options.domain = in.get<std::uint32_t>();
  options.loopback = in.get<std::uint8_t>() != 0;
  options.user_data = in.get_string();
  for (auto left = in.get<std::uint32_t>(); left > 0 && in.good(); --left) options.addresses.insert(in.get_string());
  options.receive = [](DdsMessage&& message) {
    send({FrameKind::request, message.reader, message.sender.writer, std::move(message.bytes)});
  };
  options.log = [](std::string_view line) { send(FrameKind::log, line); };
  const netio::OpenSockets before;
  auto participant = open_fast_dds(options);
  DdsGuid guid{};
  while (in.left() > 0 && in.good()) {
    participant->add_reader(read_endpoint(in), guid);
    participant->add_writer(read_endpoint(in), guid);
  }
  if (options.loopback) before.keep_new_ones_to_loopback();
  return participant;
}

int serve() {
  Frame frame;
  if (!read_frame(0, frame, kMaxFrame) || frame.kind != FrameKind::open) {
    std::fprintf(stderr, "sensorfarm_fastdds: started by `sensorfarm run --ros2`; not for direct use\n");
    return 2;
  }
  ::alarm(kMaxStart);
  std::unique_ptr<DdsParticipant> participant;
  try {
    participant = open(frame.bytes);
  } catch (const std::runtime_error& error) {
    send(FrameKind::failed, error.what());
    return 1;
  }
  ::alarm(0);
  DdsOutbox outbox(*participant);
  send({FrameKind::ready});
  while (read_frame(0, frame, kMaxFrame))
    outbox.add(DdsReply{static_cast<std::size_t>(frame.service), static_cast<std::size_t>(frame.service), frame.sender,
                        std::move(frame.bytes)});
  return 0;
}

}  // namespace
}  // namespace sf::bridges

int main() { return sf::bridges::serve(); }
