// The client printed in docs/packets.md is served; the client in examples/ decodes the page's examples.

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/apps/remote_robot.h"
#include "tests/netio/documented.h"

namespace sf {

namespace {

/// Returns the first client on the page.
std::string python_of_the_page() {
  const std::string page = read_file(SF_SOURCE_DIR "/docs/packets.md");
  const std::string open = "```python\n";
  const std::size_t at = page.find(open) + open.size();
  return page.substr(at, page.find("```", at) - at);
}

/// Runs `script` and returns its output.
std::string printed(const Folder& folder, const std::string& script) {
  const std::string file = folder.write("page.py", script);
  const std::string out = folder.path("out");
  EXPECT_EQ(std::system(("timeout 60 python3 " + file + " >" + out + " 2>&1").c_str()), 0) << read_file(out);
  return read_file(out);
}

std::string hex(const base::Bytes& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) text += "0123456789abcdef"[byte >> 4], text += "0123456789abcdef"[byte & 15];
  return text;
}

}  // namespace

TEST(PacketsPage, TheClientInPythonReadsItsExamples) {
  if (!have_python()) GTEST_SKIP() << "this machine has no python3";
  const Folder folder;
  std::string script = "import sys\nsys.path.insert(0, '" SF_SOURCE_DIR
                       "/examples/clients')\nsys.dont_write_bytecode = True\n"
                       "from sensorfarm_client import decode\n";
  for (const std::string name : {"laser", "laser_extended", "lane_edge", "magnetometer", "infrared", "gps", "occupancy",
                                 "challenge", "subscribe", "v2i", "neighbours"})
    script += "print('" + name + "', decode(bytes.fromhex('" + hex(test::documented(name)) + "')))\n";
  const std::string out = printed(folder, script);
  for (const std::string expected :
       {"laser {'type': 1, 'robot': 7, 'sensor': 0, 'sequence': 258, 'time_ns': 1500000000, 'session': 287454020, "
        "'token': 1432778632, ",
        "'range_m': [1.0, 0.25, 8.0]}", "'total': 312, 'first': 310, 'part': 1, 'parts': 2, 'range_m': [81.9175, inf]",
        "'distance_m': 0.25", "'value': [0, 767]", "'satellites': [3]", "'left_s': [6.5]", "'stop_point': [3, 1, 11]",
        "'word': [1, 2315255808]", "'token': 1432778632, 'challenge': 195948557",
        "neighbours {'type': 140, 'robot': 3, ", "'pose': [1.5, -2.25, 0.0, 0.5]", "'robot': 9, ",
        "'pose': [3.0, 0.0, "})
    EXPECT_NE(out.find(expected), std::string::npos) << expected << " is not in\n" << out;
}

TEST(PacketsPage, ItsRobotProvesItsAddressAndIsServed) {
  if (!have_python()) GTEST_SKIP() << "this machine has no python3";
  Service service;
  ASSERT_NE(service.port, 0u) << service.program.err();
  std::string script = python_of_the_page();
  const auto replace = [&](const std::string& from, const std::string& to) {
    ASSERT_NE(script.find(from), std::string::npos) << from;
    script.replace(script.find(from), from.size(), to);
  };
  replace("9000", std::to_string(service.port));
  replace("10000 + 7 * 8 + 0", std::to_string(service.laser_port(1)));
  replace("128, 7, 0", "128, 1, 0");
  const std::string out = printed(service.folder, script);
  EXPECT_EQ(out.front(), '[') << out;
  EXPECT_GT(count_lines(out), 5u) << out;
  const Json facts(service.program.stop().out);
  EXPECT_GE(facts.number("/received/unproven"), 1);
  EXPECT_GT(facts.number("/received/accepted"), 20);
}

}  // namespace sf
