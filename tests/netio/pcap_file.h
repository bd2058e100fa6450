#pragma once
// Capture files in the classic pcap format, written byte by byte.

#include <string>

#include "base/bytes.h"

namespace sf::test {

struct PcapForm {
  bool big_endian = false;
  bool nanoseconds = false;
  std::uint32_t link = 1;  ///< Ethernet
};

inline void append(base::Bytes& out, const base::Bytes& bytes) { out.insert(out.end(), bytes.begin(), bytes.end()); }

/// Returns `value` in `size` bytes.
inline base::Bytes integer(std::uint64_t value, int size, bool big_endian = true) {
  base::Bytes bytes;
  for (int i = 0; i < size; ++i)
    bytes.push_back(static_cast<std::uint8_t>(value >> 8 * (big_endian ? size - 1 - i : i)));
  return bytes;
}

inline base::Bytes udp(std::uint16_t source, std::uint16_t destination, const base::Bytes& payload) {
  base::Bytes bytes;
  for (const std::size_t word : {std::size_t{source}, std::size_t{destination}, 8 + payload.size(), std::size_t{0}})
    append(bytes, integer(word, 2));
  append(bytes, payload);
  return bytes;
}

/// From 10.0.0.1 to 10.0.0.2. @param fragment flags and offset
inline base::Bytes ipv4(const base::Bytes& segment, std::uint16_t fragment = 0x4000, std::uint8_t protocol = 17) {
  base::Bytes bytes{0x45, 0};
  append(bytes, integer(20 + segment.size(), 2));
  append(bytes, {0, 0});
  append(bytes, integer(fragment, 2));
  append(bytes, {64, protocol, 0, 0, 10, 0, 0, 1, 10, 0, 0, 2});
  append(bytes, segment);
  return bytes;
}

/// From 2001:db8::1 to ::1. @param options bytes of extension headers  @param next the first header
inline base::Bytes ipv6(const base::Bytes& segment, const base::Bytes& options = {}, std::uint8_t next = 17) {
  base::Bytes bytes{0x60, 0, 0, 0};
  append(bytes, integer(options.size() + segment.size(), 2));
  append(bytes, {next, 64, 0x20, 0x01, 0x0d, 0xb8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1});
  append(bytes, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1});
  append(bytes, options);
  append(bytes, segment);
  return bytes;
}

inline base::Bytes ethernet(const base::Bytes& packet, const base::Bytes& type = {0x08, 0x00}) {
  base::Bytes bytes(12, 0xEE);
  append(bytes, type);
  append(bytes, packet);
  return bytes;
}

class PcapFile {
 public:
  explicit PcapFile(const PcapForm& form = {}) : form_(form) {
    word(form.nanoseconds ? 0xA1B23C4D : 0xA1B2C3D4);
    append(bytes_, integer(2, 2, form.big_endian));
    append(bytes_, integer(4, 2, form.big_endian));
    for (const std::uint32_t each : {0u, 0u, 262'144u, form.link}) word(each);
  }
  /// @param fraction of the second, in the file's unit  @param claimed [byte] captured; by default all
  void add(const base::Bytes& frame, std::uint32_t second = 0, std::uint32_t fraction = 0, std::int64_t claimed = -1) {
    const auto size = static_cast<std::uint32_t>(claimed < 0 ? static_cast<std::int64_t>(frame.size()) : claimed);
    for (const std::uint32_t each : {second, fraction, size, size}) word(each);
    append(bytes_, frame);
  }
  const base::Bytes& bytes() const { return bytes_; }
  std::string text() const { return {bytes_.begin(), bytes_.end()}; }

 private:
  void word(std::uint32_t value) { append(bytes_, integer(value, 4, form_.big_endian)); }

  PcapForm form_;
  base::Bytes bytes_;
};

}  // namespace sf::test
