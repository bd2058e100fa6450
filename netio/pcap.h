#pragma once
// UDP datagrams of a capture file in the classic pcap format (tcpdump -w): both byte orders, micro- and nanoseconds;
// Ethernet with VLAN tags, Linux "cooked" captures (SLL, SLL2), BSD loopback, and raw IP; IPv4 and IPv6.
//
// Fragments are not joined: no packet of the farm is fragmented.

#include <cstdint>
#include <span>
#include <string>

namespace sf::netio {

struct CapturedDatagram {
  std::int64_t time = 0;                  ///< [ns] since 1970, as captured
  std::string source, destination;        ///< "127.0.0.1:9000", "[::1]:9000"
  std::uint32_t sent_bytes = 0;           ///< of the payload; more than there are where the capture cut it off
  std::span<const std::uint8_t> payload;  ///< views the file
};

/// One thread. Any content is read without a fault: what it claims is checked against the file's size.
class PcapReader {
 public:
  static constexpr std::uint32_t kMaxRecord = 262'144;  ///< [byte] the largest that tcpdump writes

  /// @param file content, which must outlive the reader  @param name of it, for messages
  /// @throws base::InputError for another format, pcapng among them, and for other link types
  PcapReader(std::span<const std::uint8_t> file, const std::string& name);

  /// The next UDP datagram over IP; false at the end.
  bool next(CapturedDatagram& datagram);

  std::uint64_t records() const { return records_; }       ///< read so far
  std::uint64_t other_records() const { return others_; }  ///< of these: no UDP over IP, fragments, damaged headers
  bool is_damaged() const { return damaged_; }             ///< the file ends within a record, or one is too long

 private:
  std::uint32_t word(std::size_t at) const;  ///< of the file's own headers
  bool read_frame(std::span<const std::uint8_t> frame, CapturedDatagram& datagram) const;

  std::span<const std::uint8_t> rest_;
  bool swapped_ = false;       ///< the file is big-endian
  std::int64_t fraction_ = 0;  ///< [ns] unit of the second word of a time
  std::uint32_t link_ = 0;
  std::uint64_t records_ = 0, others_ = 0;
  bool damaged_ = false;
};

}  // namespace sf::netio
