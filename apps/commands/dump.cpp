// `dump`: prints one line for each datagram received on a port or read from a capture file.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>

#include "apps/commands/commands.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/exposure_warning.h"
#include "apps/reports/text.h"
#include "apps/reports/v2x_json.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "base/files.h"
#include "netio/pcap.h"
#include "netio/port_listener.h"
#include "server/packet_fields.h"
#include "server/signal_messages.h"
#include "v2x/frame.h"
#include "world/fields.h"

namespace sf::apps {

namespace {

constexpr std::size_t kMaxFile = 512u << 20;      ///< [byte]
constexpr std::size_t kReceiveBuffer = 1u << 22;  ///< [byte] requested from the kernel
constexpr std::size_t kMaxNumbers = 8;            ///< longest list that is printed in full; longer lists are summarized
constexpr int kPatience = 100;                    ///< [ms]

/// Packet type, sensor and robot.
std::string subject_of(const server::PacketDescription& packet) {
  const netio::Header& header = packet.header;
  switch (header.type) {
    case netio::Type::tag:
    case netio::Type::object:
      return fmt::format("{} of tag {}", packet.name, header.robot);
    case netio::Type::v2i:
      return fmt::format("V2I of intersection {}", header.robot);
    case netio::Type::start:
      if (header.robot == netio::kBroadcastId) return "START to all robots";
      return fmt::format("START to robot {}", header.robot);
    case netio::Type::lane:
      if (header.robot == netio::kBroadcastId) return "LANE to the farm";
      return fmt::format("LANE to robot {}", header.robot);
    case netio::Type::values:
      return fmt::format("VALUES of sensor {} to robot {}", header.sensor, header.robot);
    case netio::Type::own_readings:
      return fmt::format("OWN_READINGS of sensor {} of robot {}", header.sensor, header.robot);
    case netio::Type::dropped:
      return fmt::format("DROPPED readings of sensor {} to robot {}", header.sensor, header.robot);
    case netio::Type::challenge:
    case netio::Type::neighbours:
    case netio::Type::state:
    case netio::Type::drive:
      return fmt::format("{} to robot {}", packet.name, header.robot);
    default:
      break;
  }
  if (netio::sensor_type_of(header.type) == 0) return fmt::format("{} of robot {}", packet.name, header.robot);
  return fmt::format("{} {} of robot {}", packet.name, header.sensor, header.robot);
}

/// @param exact prints all digits: VALUES packets carry unrounded values with error bounds
std::string words_of(double number, bool exact) {
  if (std::isnan(number)) return "none";
  return exact ? fmt::format("{}", number) : fmt::format("{:.10g}", number);
}

/// "range_m = 1 0.25 8"; for a long list, its length, minimum and maximum.
std::string words_of(const server::PacketField& field, bool exact) {
  if (std::holds_alternative<std::int64_t>(field.value) || std::holds_alternative<std::string>(field.value))
    return field.name + " = " + packet_field_text(field);
  if (const auto* number = std::get_if<double>(&field.value)) return field.name + " = " + words_of(*number, exact);
  const auto& list = std::get<std::vector<double>>(field.value);
  std::string text = field.name + " =";
  if (list.size() <= kMaxNumbers) {
    for (const double number : list) text += " " + words_of(number, exact);
    return text;
  }
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (const double number : list) least = std::fmin(least, number), most = std::fmax(most, number);
  return fmt::format("{} {} numbers, {} to {}", text, list.size(), words_of(least, exact), words_of(most, exact));
}

/// Accuracy of the reading and quality of the state that it was computed from.
std::string quality_words(const netio::Header& header) {
  std::string text;
  if (netio::sensor_type_of(header.type) != 0 || header.type == netio::Type::values) {
    const netio::Accuracy accuracy = netio::decode_accuracy(header.accuracy);
    text = fmt::format("; mode {}", accuracy.mode);
    if (!std::isinf(accuracy.bound)) text += ", error up to " + rounded_up(accuracy.bound);
    if (accuracy.unsure) text += ", not for every element";
  }
  const netio::StateQuality& state = header.state;
  if (!state.stated) return text;
  if (state.age == base::kNoStateYet) return text + "; no state of the robot has arrived yet";
  text += fmt::format("; state {:.1f} ms old{}", 1e-6 * static_cast<double>(state.age), state.stale ? ", stale" : "");
  const auto& c = state.covariance;
  if (c[0] + c[3] + c[5] > 0.0f)
    text += fmt::format(", sigma {:.3g} m, {:.3g} m, {:.3g} rad", std::sqrt(c[0]), std::sqrt(c[3]), std::sqrt(c[5]));
  return text;
}

/// Header fields of the states in a NEIGHBOURS packet, equal in all of them.
bool is_repeated(const std::string& name) {
  return name.ends_with(".type") || name.ends_with(".sensor") || name.ends_with(".session") || name.ends_with(".token");
}

std::string words_of(const server::PacketDescription& packet) {
  std::string text = fmt::format("{}, sequence {}, {:.3f} s", subject_of(packet), packet.header.sequence,
                                 1e-9 * static_cast<double>(packet.header.time));
  for (const server::PacketField& field : std::span(packet.fields).subspan(packet.header_fields))
    if (!is_repeated(field.name)) text += "; " + words_of(field, packet.header.type == netio::Type::values);
  return text + quality_words(packet.header);
}

std::string json_number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : "null"; }

std::string json_value(const server::PacketField& field) {
  if (const auto* whole = std::get_if<std::int64_t>(&field.value)) return std::to_string(*whole);
  if (const auto* number = std::get_if<double>(&field.value)) return json_number(*number);
  if (const auto* name = std::get_if<std::string>(&field.value)) return "\"" + *name + "\"";
  std::string text;
  for (const double number : std::get<std::vector<double>>(field.value))
    text += (text.empty() ? "" : ",") + json_number(number);
  return "[" + text + "]";
}

std::string words_of(v2x::PhaseState phase) {
  if (phase == v2x::PhaseState::unavailable) return "unavailable";
  return std::string(world::words_of(world::LightState{})[static_cast<std::size_t>(server::light_of(phase))]);
}

/// "SPaT of intersection 2: group 1 green, group 2 red", or "MAP of intersection 2: 8 lanes".
std::string words_of(const v2x::Frame& frame) {
  std::vector<std::string> parts;
  if (const auto* map = std::get_if<v2x::MapData>(&frame.message)) {
    for (const v2x::IntersectionGeometry& each : map->intersections)
      parts.push_back(fmt::format("intersection {}: {}", each.id.id, counted(each.lanes.size(), "lane")));
    return fmt::format("MAP of {}", parts.empty() ? "no intersection" : fmt::format("{}", fmt::join(parts, "; ")));
  }
  for (const v2x::IntersectionState& each : std::get<v2x::Spat>(frame.message).intersections) {
    std::vector<std::string> groups;
    for (const v2x::MovementState& group : each.states)
      groups.push_back(fmt::format("group {} {}", group.signal_group, words_of(group.events.front().state)));
    parts.push_back(fmt::format("intersection {}: {}", each.id.id, fmt::join(groups, ", ")));
  }
  return fmt::format("SPaT of {}", fmt::join(parts, "; "));
}

/// Returns the frame if the datagram consists of exactly one J2735 frame.
std::optional<v2x::Frame> whole_frame(std::span<const std::uint8_t> bytes) {
  v2x::Frame frame;
  const v2x::DecodeResult result = v2x::decode(bytes, frame);
  if (!result.ok() || result.size != bytes.size()) return std::nullopt;
  return frame;
}

class Printer {
 public:
  explicit Printer(bool json) : json_(json) {}

  void print(const netio::CapturedDatagram& datagram) {
    server::PacketDescription packet;
    const bool cut = datagram.sent_bytes > datagram.payload.size();
    if (!cut) packet = server::describe_packet(datagram.payload);
    const bool good = !cut && packet.status == netio::PacketStatus::accepted;
    if (!cut && !good) {
      if (const auto frame = whole_frame(datagram.payload)) return print(datagram, *frame);
    }
    cut ? void(++cut_) : counts_.add(packet.status);
    const std::string status = cut ? "cut off by the capture" : std::string(netio::name(packet.status));
    apps::print(json_ ? json_line(datagram, packet, status, good) : words_line(datagram, packet, status, good));
  }
  void print(const netio::CapturedDatagram& datagram, const v2x::Frame& frame) {
    counts_.add(netio::PacketStatus::accepted);
    const bool spat = std::holds_alternative<v2x::Spat>(frame.message);
    apps::print(json_ ? fmt::format("{},\"name\":\"{}\",\"frame\":{}}}\n", json_head(datagram, "accepted"),
                                    spat ? "SPaT" : "MAP", v2x_frame_json(frame))
                      : words_head(datagram) + words_of(frame) + "\n");
  }
  std::uint64_t datagrams() const { return counts_.total() + cut_; }
  bool any_good() const { return counts_[netio::PacketStatus::accepted] > 0; }
  std::string summary() const {
    return netio::packet_counts_text(counts_) + (cut_ > 0 ? fmt::format(", cut off by the capture {}", cut_) : "");
  }

 private:
  static std::string words_head(const netio::CapturedDatagram& datagram) {
    return fmt::format("{}.{:06} {} > {}: ", datagram.time / 1'000'000'000, datagram.time % 1'000'000'000 / 1000,
                       datagram.source, datagram.destination);
  }
  static std::string json_head(const netio::CapturedDatagram& datagram, const std::string& status) {
    return fmt::format(R"({{"received_ns":{},"from":"{}","to":"{}","bytes":{},"status":"{}")", datagram.time,
                       datagram.source, datagram.destination, datagram.sent_bytes, status);
  }
  static std::string words_line(const netio::CapturedDatagram& datagram, const server::PacketDescription& packet,
                                const std::string& status, bool good) {
    const std::string text = good ? words_of(packet) : fmt::format("{}, {} bytes", status, datagram.payload.size());
    return words_head(datagram) + text + "\n";
  }
  static std::string json_line(const netio::CapturedDatagram& datagram, const server::PacketDescription& packet,
                               const std::string& status, bool good) {
    std::string text = json_head(datagram, status);
    if (good) text += fmt::format(R"(,"name":"{}")", packet.name);
    if (good)
      for (const server::PacketField& field : packet.fields)
        text += fmt::format(R"(,"{}":{})", field.name, json_value(field));
    return text + "}\n";
  }

  bool json_;
  netio::PacketCounts counts_;
  std::uint64_t cut_ = 0;
};

void dump_file(const DumpOptions& options, Printer& printer) {
  const std::string content = base::read_bytes(options.file, kMaxFile);
  netio::PcapReader reader({reinterpret_cast<const std::uint8_t*>(content.data()), content.size()}, options.file);
  install_stop_handlers();
  netio::CapturedDatagram datagram;
  while (!stop_requested() && (options.count == 0 || printer.datagrams() < options.count) && reader.next(datagram))
    printer.print(datagram);
  if (reader.other_records() > 0)
    print_message("{} without a complete UDP datagram", counted(reader.other_records(), "record"));
  if (reader.is_damaged()) print_message("{}: damaged after {}", options.file, counted(reader.records(), "record"));
}

void dump_ports(const DumpOptions& options, Printer& printer) {
  std::vector<std::uint16_t> ports = options.ports;
  std::sort(ports.begin(), ports.end());
  ports.erase(std::unique(ports.begin(), ports.end()), ports.end());
  std::vector<netio::StreamSpec> streams;
  for (const std::uint16_t port : ports) streams.push_back({0, 0, netio::PortRule{port, 1}, "datagram"});
  const std::uint32_t address = netio::resolve(options.bind);
  netio::PortListener listener(address, kReceiveBuffer, streams);
  warn_of_exposure(address, "send packets");
  install_stop_handlers();
  print_message("listening on {} of {}", counted(ports.size(), "port"), options.bind);
  const auto start = std::chrono::steady_clock::now();
  const auto is_over = [&] {
    return stop_requested() || (options.count > 0 && printer.datagrams() >= options.count) ||
           (options.duration > 0.0 && base::seconds_since(start) >= options.duration);
  };
  while (!is_over()) {
    listener.drain(kPatience, [&](std::size_t i, std::span<const std::uint8_t> bytes, const netio::Endpoint& source) {
      if (options.count > 0 && printer.datagrams() >= options.count) return;
      printer.print({base::unix_time(), netio::endpoint_text(source),
                     netio::endpoint_text(netio::Endpoint{address, ports[i]}), static_cast<std::uint32_t>(bytes.size()),
                     bytes});
    });
    flush_output();
  }
  if (const std::uint64_t drops = listener.socket_drops(); drops > 0)
    print_message("{} dropped by the operating system", counted(drops, "datagram"));
}

}  // namespace

int dump(const DumpOptions& options) {
  Printer printer(options.json);
  options.file.empty() ? dump_ports(options, printer) : dump_file(options, printer);
  print_message("{}: {}", counted(printer.datagrams(), "datagram"), printer.summary());
  const bool counted_out = options.count > 0 && printer.datagrams() >= options.count;
  const bool has_end = !options.file.empty() || options.count > 0;
  if (stop_requested() && has_end && !counted_out) return interrupted_code();
  return printer.any_good() ? 0 : 1;
}

}  // namespace sf::apps
