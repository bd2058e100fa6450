#pragma once
// Reads UDP datagrams from a capture file in the classic pcap format (tcpdump -w): both byte orders, micro- and
// nanoseconds; Ethernet with VLAN tags, Linux "cooked" captures (SLL, SLL2), BSD loopback, and raw IP; IPv4 and IPv6.
//
// Fragments are not reassembled: the farm sends no fragmented packets.

#include <cstdint>
#include <span>
#include <string>

namespace sf::netio {

struct CapturedDatagram {
  std::int64_t time = 0;                  ///< [ns] since 1970, as captured
  std::string source, destination;        ///< "127.0.0.1:9000", "[::1]:9000"
  std::uint32_t sent_bytes = 0;           ///< size of the payload; larger than `payload` if the capture truncated it
  std::span<const std::uint8_t> payload;  ///< views the file
};

/// Single-threaded. Reads any content without a fault: checks all sizes and offsets against the file's size.
class PcapReader {
 public:
  static constexpr std::uint32_t kMaxRecord = 262'144;  ///< [byte] the largest record that tcpdump writes

  /// @param file content, which must outlive the reader  @param name of the file, for messages
  /// @throws base::InputError for another format, including pcapng, and for other link types
  PcapReader(std::span<const std::uint8_t> file, const std::string& name);

  /// Reads the next UDP datagram over IP. Returns false at the end.
  bool next(CapturedDatagram& datagram);

  std::uint64_t records() const { return records_; }       ///< read so far
  std::uint64_t other_records() const { return others_; }  ///< not UDP over IP, fragments, or damaged headers
  bool is_damaged() const { return damaged_; }             ///< the file ends within a record, or a record is too long

 private:
  std::uint32_t word(std::size_t at) const;  ///< reads a word of the file's own headers
  bool read_frame(std::span<const std::uint8_t> frame, CapturedDatagram& datagram) const;

  std::span<const std::uint8_t> rest_;
  bool swapped_ = false;       ///< the file is big-endian
  std::int64_t fraction_ = 0;  ///< [ns] unit of the second word of a time
  std::uint32_t link_ = 0;
  std::uint64_t records_ = 0, others_ = 0;
  bool damaged_ = false;
};

}  // namespace sf::netio
