#include "netio/pcap.h"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "base/bytes.h"
#include "base/error.h"

namespace sf::netio {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kFileHeader = 24, kRecordHeader = 16;  // [byte]
constexpr std::uint32_t kMicroseconds = 0xA1B2C3D4u, kNanoseconds = 0xA1B23C4Du, kPcapng = 0x0A0D0D0Au;
constexpr std::uint8_t kUdp = 17;

/// Link types: the bytes before the IP header (https://www.tcpdump.org/linktypes.html).
struct Link {
  std::uint32_t type;
  std::size_t header;    ///< [byte]
  std::size_t protocol;  ///< [byte] offset of the EtherType; kNoProtocol: the IP header contains its version
};
constexpr std::size_t kNoProtocol = SIZE_MAX;
constexpr Link kLinks[] = {{0, 4, kNoProtocol}, {1, 14, 12},           {12, 0, kNoProtocol},  {101, 0, kNoProtocol},
                           {113, 16, 14},       {228, 0, kNoProtocol}, {229, 0, kNoProtocol}, {276, 20, 0}};

const Link* find_link(std::uint32_t type) {
  const auto* const found =
      std::find_if(std::begin(kLinks), std::end(kLinks), [&](const Link& l) { return l.type == type; });
  return found == std::end(kLinks) ? nullptr : found;
}

/// Reads a value in network order. @pre the bytes exist
std::uint32_t u16(Bytes bytes, std::size_t at) { return std::uint32_t{bytes[at]} << 8 | bytes[at + 1]; }

std::uint32_t reversed(std::uint32_t v) { return v >> 24 | (v >> 8 & 0xFF00u) | (v << 8 & 0xFF0000u) | v << 24; }

/// Returns the IP packet in a frame; empty if there is none.
Bytes ip_packet(Bytes frame, const Link& link) {
  if (frame.size() < link.header) return {};
  if (link.protocol == kNoProtocol) return frame.subspan(link.header);
  std::size_t header = link.header;
  std::uint32_t protocol = u16(frame, link.protocol);
  for (; (protocol == 0x8100 || protocol == 0x88A8) && frame.size() >= header + 4; header += 4)
    protocol = u16(frame, header + 2);
  return protocol == 0x0800 || protocol == 0x86DD ? frame.subspan(header) : Bytes{};
}

std::string address_text(int family, Bytes address, std::uint32_t port) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  inet_ntop(family, address.data(), text.data(), text.size());
  const std::string host = text.data();
  return (family == AF_INET6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

/// Addresses and UDP segment of an IP packet.
struct Segment {
  int family = 0;
  Bytes source, destination, udp;
};

bool read_ipv4(Bytes ip, Segment& segment) {
  const std::size_t header = 4 * std::size_t{ip[0] & 0x0Fu};
  if (ip.size() < 20 || header < 20 || ip.size() < header || ip[9] != kUdp) return false;
  if ((u16(ip, 6) & 0x3FFFu) != 0) return false;  // a fragment
  segment = {AF_INET, ip.subspan(12, 4), ip.subspan(16, 4), ip.subspan(header)};
  return true;
}

bool read_ipv6(Bytes ip, Segment& segment) {
  constexpr std::size_t kHeader = 40;
  if (ip.size() < kHeader) return false;
  std::uint8_t next = ip[6];
  Bytes rest = ip.subspan(kHeader);
  while (next == 0 || next == 43 || next == 60) {  // hop-by-hop, routing and destination options
    if (rest.size() < 8 || rest.size() < 8 * (std::size_t{rest[1]} + 1)) return false;
    next = rest[0];
    rest = rest.subspan(8 * (std::size_t{rest[1]} + 1));
  }
  segment = {AF_INET6, ip.subspan(8, 16), ip.subspan(24, 16), rest};
  return next == kUdp;
}

}  // namespace

PcapReader::PcapReader(std::span<const std::uint8_t> file, const std::string& name) : rest_(file) {
  const std::uint32_t magic = file.size() >= kFileHeader ? word(0) : 0;
  swapped_ = magic == reversed(kMicroseconds) || magic == reversed(kNanoseconds);
  if (magic == kPcapng)
    throw base::InputError(name, 0, "a pcapng file; convert it: tcpdump -r FILE -w FILE.pcap, or editcap -F pcap");
  const std::uint32_t kind = swapped_ ? reversed(magic) : magic;
  if (kind != kMicroseconds && kind != kNanoseconds) throw base::InputError(name, 0, "is not a pcap file (tcpdump -w)");
  fraction_ = kind == kMicroseconds ? 1000 : 1;
  link_ = word(20) & 0xFFFFu;  // the upper bits contain the length of a frame's checksum
  if (find_link(link_) == nullptr)
    throw base::InputError(name, 0,
                           "captured on a link of type " + std::to_string(link_) +
                               "; expected Ethernet, Linux cooked, loopback or raw IP");
  rest_ = file.subspan(kFileHeader);
}

std::uint32_t PcapReader::word(std::size_t at) const {
  const auto value = base::ByteReader(rest_.subspan(at)).get<std::uint32_t>();
  return swapped_ ? reversed(value) : value;
}

bool PcapReader::next(CapturedDatagram& datagram) {
  while (!rest_.empty() && !damaged_) {
    const std::uint32_t size = rest_.size() >= kRecordHeader ? word(8) : 0;
    damaged_ = rest_.size() < kRecordHeader || size > kMaxRecord || size > rest_.size() - kRecordHeader;
    if (damaged_) break;
    datagram.time = std::int64_t{word(0)} * 1'000'000'000 + fraction_ * word(4);
    const Bytes frame = rest_.subspan(kRecordHeader, size);
    rest_ = rest_.subspan(kRecordHeader + size);
    ++records_;
    if (read_frame(frame, datagram)) return true;
    ++others_;
  }
  return false;
}

bool PcapReader::read_frame(std::span<const std::uint8_t> frame, CapturedDatagram& datagram) const {
  const Bytes ip = ip_packet(frame, *find_link(link_));
  Segment segment;
  const unsigned version = ip.empty() ? 0 : ip[0] >> 4;
  const bool is_udp = (version == 4 && read_ipv4(ip, segment)) || (version == 6 && read_ipv6(ip, segment));
  constexpr std::uint32_t kHeader = 8;
  if (!is_udp || segment.udp.size() < kHeader || u16(segment.udp, 4) < kHeader) return false;
  datagram.source = address_text(segment.family, segment.source, u16(segment.udp, 0));
  datagram.destination = address_text(segment.family, segment.destination, u16(segment.udp, 2));
  datagram.sent_bytes = u16(segment.udp, 4) - kHeader;
  datagram.payload = segment.udp.subspan(kHeader);  // Ethernet pads short frames after it
  datagram.payload = datagram.payload.first(std::min<std::size_t>(datagram.payload.size(), datagram.sent_bytes));
  return true;
}

}  // namespace sf::netio
