// Capture files in every supported format, damaged files, and files of other kinds.

#include "netio/pcap.h"

#include <gtest/gtest.h>

#include <random>

#include "base/error.h"
#include "tests/netio/pcap_file.h"
#include "tests/refusal.h"

namespace sf::netio {
namespace {

using base::Bytes;
using namespace test;

const Bytes kPayload{'S', 'F', 'P', 'K'};
const Bytes kUdp = udp(9000, 10'056, kPayload);

Bytes joined(Bytes first, const Bytes& second) {
  append(first, second);
  return first;
}

struct Contents {
  std::vector<CapturedDatagram> datagrams;
  std::uint64_t records = 0, others = 0;
  bool damaged = false;
};

Contents contents_of(const Bytes& file) {
  PcapReader reader(file, "file");
  Contents out;
  for (CapturedDatagram datagram; reader.next(datagram);) out.datagrams.push_back(datagram);
  out.records = reader.records();
  out.others = reader.other_records();
  out.damaged = reader.is_damaged();
  return out;
}

void expect_datagram(const Bytes& file, const std::string& source, const std::string& destination) {
  const Contents contents = contents_of(file);
  ASSERT_EQ(contents.datagrams.size(), 1u);
  const CapturedDatagram& datagram = contents.datagrams[0];
  EXPECT_EQ(datagram.source, source);
  EXPECT_EQ(datagram.destination, destination);
  EXPECT_EQ(Bytes(datagram.payload.begin(), datagram.payload.end()), kPayload);
  EXPECT_EQ(datagram.sent_bytes, kPayload.size());
  EXPECT_FALSE(contents.damaged);
}

Bytes file_of(std::uint32_t link, const Bytes& frame) {
  PcapFile file({.link = link});
  file.add(frame);
  return file.bytes();
}

std::string pcap_refusal(const Bytes& file) {
  return refusal_of([&] { PcapReader(file, "file"); });
}

TEST(Pcap, ReadsBothByteOrdersAndTimeUnits) {
  for (const bool big_endian : {false, true}) {
    for (const bool nanoseconds : {false, true}) {
      PcapFile file({.big_endian = big_endian, .nanoseconds = nanoseconds});
      file.add(ethernet(ipv4(kUdp)), 4'294'967'295u, 7);  // the last second
      expect_datagram(file.bytes(), "10.0.0.1:9000", "10.0.0.2:10056");
      EXPECT_EQ(contents_of(file.bytes()).datagrams[0].time, 4'294'967'295'000'000'000 + (nanoseconds ? 7 : 7000));
    }
  }
}

TEST(Pcap, ReadsEveryLinkType) {
  const Bytes four = ipv4(kUdp), six = ipv6(kUdp);
  const std::string a = "10.0.0.1:9000", b = "10.0.0.2:10056", c = "[2001:db8::1]:9000", d = "[::1]:10056";
  expect_datagram(file_of(1, ethernet(four)), a, b);
  expect_datagram(file_of(1, ethernet(six, {0x86, 0xDD})), c, d);
  expect_datagram(file_of(1, ethernet(four, {0x81, 0, 0, 5, 8, 0})), a, b);                    // VLAN 5
  expect_datagram(file_of(1, ethernet(four, {0x88, 0xA8, 0, 5, 0x81, 0, 0, 6, 8, 0})), a, b);  // VLAN 6 in 5
  expect_datagram(file_of(1, joined(ethernet(four), Bytes(14, 0))), a, b);                     // padded
  expect_datagram(file_of(0xF000'0001, ethernet(four)), a, b);                                 // states the length of a
                                                                                               // checksum
  expect_datagram(file_of(0, joined({2, 0, 0, 0}, four)), a, b);                               // BSD loopback
  expect_datagram(file_of(113, joined(Bytes(14, 0), joined({8, 0}, four))), a, b);             // SLL
  expect_datagram(file_of(276, joined({0x86, 0xDD}, joined(Bytes(18, 0), six))), c, d);        // SLL2
  for (const std::uint32_t raw : {12u, 101u, 228u}) expect_datagram(file_of(raw, four), a, b);
  for (const std::uint32_t raw : {12u, 101u, 229u}) expect_datagram(file_of(raw, six), c, d);
}

TEST(Pcap, SkipsExtensionHeaders) {
  const Bytes hop_by_hop{60, 0, 0, 0, 0, 0, 0, 0}, destination{17, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  expect_datagram(file_of(101, ipv6(kUdp, joined(hop_by_hop, destination), 0)), "[2001:db8::1]:9000", "[::1]:10056");
}

TEST(Pcap, CountsRecordsWithoutAWholeUdpDatagram) {
  PcapFile file;
  file.add(ethernet(ipv4(kUdp)));
  file.add(ethernet(ipv4(kUdp, 0x2000)));                // the first fragment
  file.add(ethernet(ipv4(kUdp, 0x0001)));                // a later one
  file.add(ethernet(ipv4(kUdp, 0, 6)));                  // TCP
  file.add(ethernet(Bytes(28, 0), {0x08, 0x06}));        // ARP
  file.add(ethernet(ipv6(kUdp, {}, 44), {0x86, 0xDD}));  // a fragment
  file.add(ethernet(Bytes(kUdp)));                       // not IP
  file.add(Bytes(13, 0));                                // shorter than Ethernet's header
  file.add({});
  Bytes short_udp = kUdp;
  short_udp[5] = 7;  // less than the header
  file.add(ethernet(ipv4(short_udp)));
  const Contents contents = contents_of(file.bytes());
  EXPECT_EQ(contents.datagrams.size(), 1u);
  EXPECT_EQ(contents.records, 10u);
  EXPECT_EQ(contents.others, 9u);
  EXPECT_FALSE(contents.damaged);
}

TEST(Pcap, TruncatedDatagramStatesItsSize) {
  Bytes frame = ethernet(ipv4(kUdp));
  frame.pop_back();
  const Bytes file = file_of(1, frame);
  const Contents contents = contents_of(file);
  ASSERT_EQ(contents.datagrams.size(), 1u);
  EXPECT_EQ(contents.datagrams[0].payload.size(), 3u);
  EXPECT_EQ(contents.datagrams[0].sent_bytes, 4u);
}

TEST(Pcap, ReadsADamagedFileUpToTheDamage) {
  PcapFile file;
  file.add(ethernet(ipv4(kUdp)));
  for (const std::size_t left : {1, 15, 16, 40}) {  // within the header of the second record, and within its frame
    PcapFile longer = file;
    longer.add(ethernet(ipv4(kUdp)));
    const Bytes& all = longer.bytes();
    const Contents contents =
        contents_of({all.begin(), all.begin() + static_cast<std::ptrdiff_t>(file.bytes().size() + left)});
    EXPECT_EQ(contents.datagrams.size(), 1u) << left;
    EXPECT_TRUE(contents.damaged) << left;
  }
  for (const std::int64_t claimed : {std::int64_t{PcapReader::kMaxRecord} + 1, std::int64_t{0xFFFFFFFF}}) {
    PcapFile longer = file;
    longer.add(Bytes(PcapReader::kMaxRecord + 2, 0), 0, 0, claimed);
    EXPECT_TRUE(contents_of(longer.bytes()).damaged) << claimed;
  }
  PcapFile largest = file;
  largest.add(Bytes(PcapReader::kMaxRecord, 0));
  EXPECT_FALSE(contents_of(largest.bytes()).damaged);
}

TEST(Pcap, RejectsOtherFilesByName) {
  EXPECT_EQ(pcap_refusal(PcapFile().bytes()), "");
  EXPECT_NE(pcap_refusal({}).find("file: is not a pcap file"), std::string::npos);
  EXPECT_NE(pcap_refusal(Bytes(24, 0)).find("file: is not a pcap file"), std::string::npos);
  const Bytes header = PcapFile().bytes();
  EXPECT_NE(pcap_refusal({header.begin(), header.end() - 1}).find("file: is not a pcap file"), std::string::npos);
  EXPECT_NE(pcap_refusal(joined({0x0A, 0x0D, 0x0D, 0x0A}, Bytes(24, 0))).find("file: a pcapng file"),
            std::string::npos);
  EXPECT_NE(pcap_refusal(PcapFile({.link = 105}).bytes()).find("file: captured on a link of type 105"),
            std::string::npos);
}

/// Whatever the damage, nothing outside the file is read (the sanitizers check this).
TEST(Pcap, ReadsAnyBytes) {
  PcapFile whole;
  for (const Bytes& frame : {ethernet(ipv4(kUdp)), ethernet(ipv6(kUdp, {17, 0, 0, 0, 0, 0, 0, 0}, 0), {0x86, 0xDD})})
    whole.add(frame);
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes = whole.bytes();
    for (int k = 0; k < 3; ++k) bytes[24 + random() % (bytes.size() - 24)] = static_cast<std::uint8_t>(random());
    bytes.resize(24 + random() % (bytes.size() - 23));
    bytes.shrink_to_fit();
    EXPECT_LE(contents_of(bytes).records, 8u);
  }
}

}  // namespace
}  // namespace sf::netio
