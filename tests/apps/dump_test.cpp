// `dump`: prints packets from a capture file or live.

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <cstring>
#include <sstream>

#include "netio/outbox.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/netio/pcap_file.h"
#include "tests/netio/vectors.h"
#include "tests/refusal.h"

namespace sf {

namespace {

base::Bytes vector_of(const std::string& name, std::size_t i = 0) {
  return test::read_vectors(SF_SOURCE_DIR "/tests/netio/vectors/" + name + ".txt").at(i).bytes;
}

/// All golden packets, a microsecond apart.
std::string all_vectors() {
  test::PcapFile file;
  std::uint32_t time = 0;
  for (const std::string& path : test::vector_files())
    for (const test::PacketVector& vector : test::read_vectors(path))
      file.add(test::ethernet(test::ipv4(test::udp(9000, 10'056, vector.bytes))), 1'700'000'000, time++);
  return file.text();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// One J2735 datagram, followed by `more` octets.
std::string signal_capture(const std::string& hex, std::size_t more = 0) {
  base::Bytes frame;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    frame.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  frame.resize(frame.size() + more);
  test::PcapFile file;
  file.add(test::ethernet(test::ipv4(test::udp(9010, 9010, frame))), 1'700'000'000, 0);
  return file.text();
}

}  // namespace

/// Real traffic lights send J2735 messages on the same networks.
TEST(Dump, SignalMessagesArePrintedAsText) {
  const Folder folder;
  const Outcome frames = run_program({"v2x", "export", our_world("simville/simville.world")});
  const std::vector<std::string> hex = lines_of(frames.out);
  ASSERT_GE(hex.size(), 2u);
  std::string text;
  for (std::size_t i = 0; i < 2; ++i)
    text += run_program({"dump", folder.write("lights.pcap", signal_capture(hex[i]))}).out;
  EXPECT_NE(text.find(": MAP of intersection 1: "), std::string::npos) << text;
  EXPECT_NE(text.find(": SPaT of intersection 1: group 1 "), std::string::npos) << text;
  const Outcome json = run_successfully({"dump", "--json", folder.write("lights.pcap", signal_capture(hex[0]))});
  EXPECT_EQ(Json(json.out).text("/name"), "MAP");
  // Bytes after a frame are not part of it, and the datagram is not a farm packet either.
  EXPECT_EQ(run_program({"dump", folder.write("lights.pcap", signal_capture(hex[0], 1))}).code, 1);
}

// `serve` before it has accepted a state of the robot.
TEST(Dump, ReportsThatNoStateHasArrived) {
  base::Bytes packet = vector_of("laser", 1);
  packet[62] |= 2;
  test::PcapFile file({.big_endian = true, .nanoseconds = true, .link = 101});
  file.add(test::ipv4(test::udp(9000, 10'056, packet)), 1'700'000'000, 1000);
  const Folder folder;
  const Outcome outcome = run_program({"dump", folder.write("a.pcap", file.text())});
  EXPECT_NE(outcome.out.find("; no state of the robot has arrived yet\n"), std::string::npos) << outcome.out;
}

TEST(Dump, ACaptureIsPrintedAsText) {
  const Folder folder;
  test::PcapFile file({.big_endian = true, .nanoseconds = true, .link = 101});
  std::uint32_t time = 0;
  for (const base::Bytes& packet :
       {vector_of("laser", 1), vector_of("laser", 2), vector_of("gps", 1), vector_of("v2v"), vector_of("tag"),
        vector_of("start"), vector_of("neighbours"), base::Bytes{'S', 'F', 'P', 'K'}, base::Bytes(70, 7)})
    file.add(test::ipv4(test::udp(9000, 10'056, packet)), 1'700'000'000, 1000 * ++time);
  file.add(test::ipv4(test::udp(1, 2, {}), 0, 6));
  const Outcome outcome = run_successfully({"dump", folder.write("a.pcap", file.text())});
  const std::string way = " 10.0.0.1:9000 > 10.0.0.2:10056: ";
  const std::vector<std::string> expected{
      "1700000000.000001" + way +
          "laser 3 of robot 7, sequence 258, 1.500 s; range_m = 0 65.535; mode 2, error up to 0.00102, not for every "
          "element; state 12.3 ms old, stale, sigma 0.5 m, 0.707 m, 0.0312 rad",
      "1700000000.000002" + way +
          "laser 0 of robot 7, sequence 258, 1.500 s; range_m = 361 numbers, 0 to 2; mode 0, error up to 1.06e-08; "
          "state 0.0 ms old",
      "1700000000.000003" + way +
          "gps 0 of robot 7, sequence 258, 1.500 s; x_m = none; y_m = none; hdop = none; satellites = 3; mode 0",
      "1700000000.000004" + way +
          "V2V of robot 7, sequence 258, 1.500 s; follows = 3; checkpoint = none; docking = 1; pose = 1.5 -2.25 0 0.5; "
          "velocity = 0.25 0 -0.125",
      "1700000000.000005" + way +
          "TAG of tag 12, sequence 1, 0.066 s; position = 3 4 0.5; orientation = 0 0 0.6 0.8; linear = 0.5 0 0; "
          "angular = 0 0 0.25",
      "1700000000.000006" + way + "START to all robots, sequence 0, 0.000 s",
      "1700000000.000007" + way +
          "NEIGHBOURS to robot 3, sequence 15, 1.600 s; 0.robot = 7; 0.sequence = 258; 0.time_ns = 1500000000; "
          "0.follows = 3;",
      "1700000000.000008" + way + "too short, 4 bytes",
      "1700000000.000009" + way + "bad magic, 70 bytes"};
  const std::vector<std::string> found = lines_of(outcome.out);
  ASSERT_EQ(found.size(), expected.size()) << outcome.out;
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_EQ(found[i].substr(0, i == 6 ? expected[i].size() : std::string::npos), expected[i]);
  EXPECT_EQ(outcome.err,
            "sensorfarm: 1 record without a complete UDP datagram\n"
            "sensorfarm: 9 datagrams: accepted 7, too short 1, bad magic 1\n");
}

TEST(Dump, JsonHasOneObjectPerDatagram) {
  const Folder folder;
  const Outcome outcome = run_successfully({"dump", folder.write("a.pcap", all_vectors()), "--json"});
  const std::vector<std::string> found = lines_of(outcome.out);
  std::size_t i = 0;
  for (const std::string& path : test::vector_files()) {
    for (const test::PacketVector& vector : test::read_vectors(path)) {
      ASSERT_LT(i, found.size());
      const Json json(found[i]);
      EXPECT_EQ(json.number("/received_ns"), 1.7e18 + 1e3 * static_cast<double>(i));
      EXPECT_EQ(json.text("/from"), "10.0.0.1:9000");
      EXPECT_EQ(json.number("/bytes"), static_cast<double>(vector.bytes.size()));
      const bool malformed = vector.text.rfind("status = ", 0) == 0;
      EXPECT_EQ(json.text("/status"), malformed ? vector.text.substr(9, vector.text.size() - 10) : "accepted");
      for (const std::string& line : lines_of(malformed ? "" : vector.text))
        EXPECT_TRUE(json.has("/" + line.substr(0, line.find(' ')))) << line << " is not in " << found[i];
      ++i;
    }
  }
  EXPECT_EQ(i, found.size());
}

TEST(Dump, ATruncatedDatagramIsReported) {
  const Folder folder;
  base::Bytes frame = test::ethernet(test::ipv4(test::udp(1, 2, vector_of("laser"))));
  frame.resize(frame.size() - 3);
  test::PcapFile file;
  file.add(frame);
  std::string text = file.text();
  const Outcome outcome = run_program({"dump", folder.write("a.pcap", text + "rest")});
  EXPECT_EQ(outcome.code, 1) << "no valid datagram";
  EXPECT_NE(outcome.out.find(": cut off by the capture, 69 bytes\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("a.pcap: damaged after 1 record\n"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("nothing received, cut off by the capture 1\n"), std::string::npos) << outcome.err;
}

/// VALUES packets state the error of their numbers, so all digits are printed.
TEST(Dump, ValuesKeepAllDigits) {
  const Folder folder;
  base::Bytes third = vector_of("values");
  const double value = 1.0 / 3.0;
  std::memcpy(third.data() + 136, &value, sizeof value);
  test::PcapFile file;
  file.add(test::ethernet(test::ipv4(test::udp(9000, 9000, third))), 1'700'000'000, 0);
  file.add(test::ethernet(test::ipv4(test::udp(9000, 9000, vector_of("values", 3)))), 1'700'000'000, 1);
  const std::vector<std::string> lines = lines_of(run_program({"dump", folder.write("a.pcap", file.text())}).out);
  ASSERT_EQ(lines.size(), 2u);
  expect_in("; error = 1e-09; value = 0.3333333333333333 0.2503 inf; mode 0, error up to 1.02e-09", lines[0]);
  expect_in("; error = none; value = 1 2 4; mode 2, error up to 1.02e-09, not for every element", lines[1]);
}

TEST(Dump, WrongFilesAndArgumentsAreRejected) {
  const Folder folder;
  const std::string pipe = folder.path("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const Words& words : std::vector<Words>{{"dump"},
                                               {"dump", pipe},
                                               {"dump", "/dev/zero"},
                                               {"dump", folder.path()},
                                               {"dump", folder.path("none.pcap")},
                                               {"dump", folder.write("empty.pcap", "")},
                                               {"dump", folder.write("text.pcap", "no capture at all, only words")},
                                               {"dump", "a.pcap", "--port", "9000"},
                                               {"dump", "a.pcap", "--bind", "0.0.0.0"},
                                               {"dump", "--port", "0"}}) {
    expect_refused(words);
  }
}

TEST(Dump, ReceivedDatagramsArePrinted) {
  const unsigned port = free_ports(2);
  Program dump({"dump", "--port", std::to_string(port) + "-" + std::to_string(port + 1), "--count", "5"});
  ASSERT_TRUE(dump.prints("listening on 2 ports")) << dump.err();
  netio::Outbox outbox;
  for (const base::Bytes& packet :
       {vector_of("leave"), vector_of("challenge"), base::Bytes(1500, 1), vector_of("command"), vector_of("values")}) {
    outbox.queue({netio::kLoopback, static_cast<std::uint16_t>(port)}, packet);
    outbox.flush();
  }
  const Outcome outcome = dump.wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(count_lines(outcome.out), 5u) << outcome.out;
  const std::string to = " > 127.0.0.1:" + std::to_string(port) + ": ";
  for (const std::string line :
       {"LEAVE of robot 7, ", "CHALLENGE to robot 7, ", "bad magic, 1500 bytes",
        "COMMAND of robot 7, sequence 240, 0.000 s; tick = 120; robots = 7 9; twists = 0.25 0 ",
        "VALUES of sensor 0 to robot 7, "})
    EXPECT_NE(outcome.out.find(to + line), std::string::npos) << outcome.out;
}

}  // namespace sf
