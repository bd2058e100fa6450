// `v2x` as users run it.

#include <gtest/gtest.h>

#include <fstream>

#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/refusal.h"

namespace sf {

namespace {

const char* const kVectors = SF_SOURCE_DIR "/tests/v2x/vectors/asn1c.txt";

/// The frames of the vectors, one per line.
std::string frames() {
  std::ifstream stream(kVectors);
  std::string all;
  for (std::string hex, xml; std::getline(stream, hex) && std::getline(stream, xml);) all += hex + "\n";
  return all;
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string binary(const std::string& hex) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return bytes;
}

const char* const kJson = R"({"messageId": 19, "value": {"SPAT": {"intersections": [{
  "id": {"id": 12111}, "revision": 0, "status": "0000000000000000", "timeStamp": 35176,
  "states": [{"signalGroup": 2, "state-time-speed": [
    {"eventState": "protected-Movement-Allowed", "timing": {"minEndTime": 22120, "maxEndTime": 22121}}]}]}]}}})";

/// Returns the error of `v2x encode` for kJson with `from` replaced by `to`.
std::string refusal(const std::string& from, const std::string& to) {
  const Folder folder;
  std::string json = kJson;
  json.replace(json.find(from), from.size(), to);
  const std::string file = folder.write("spat.json", json);
  const Outcome outcome = run_program({"v2x", "encode", file});
  EXPECT_EQ(outcome.code, 2) << outcome.out;
  EXPECT_EQ(outcome.out, "");
  const std::size_t at = outcome.err.find(": ", outcome.err.find(".json"));
  return at == std::string::npos ? outcome.err : outcome.err.substr(at + 2, outcome.err.size() - at - 3);
}

}  // namespace

TEST(V2x, FramesSurviveARoundTripThroughJson) {
  const Folder folder;
  const std::string hex = upper(frames());
  const Outcome decoded = run_successfully({"v2x", "decode", folder.write("frames.hex", hex)});
  EXPECT_EQ(decoded.err, "");
  EXPECT_EQ(count_lines(decoded.out), count_lines(hex));
  const Outcome encoded = run_successfully({"v2x", "encode", folder.write("frames.json", decoded.out)});
  EXPECT_EQ(encoded.out, hex);
}

TEST(V2x, BinaryFilesHoldFramesOneAfterAnother) {
  const Folder folder;
  const std::string hex = frames();
  std::string bytes;
  for (std::size_t at = 0; at < hex.size(); at = hex.find('\n', at) + 1)
    bytes += binary(hex.substr(at, hex.find('\n', at) - at));
  const Outcome of_binary = run_program({"v2x", "decode", folder.write("frames.bin", bytes)});
  const Outcome of_hex = run_program({"v2x", "decode", folder.write("frames.hex", hex)});
  EXPECT_EQ(of_binary.code, 0) << of_binary.err;
  EXPECT_EQ(of_binary.out, of_hex.out);
}

/// The first bit of a frame marks extensions.
TEST(V2x, AFrameWithExtensionsMayFollowAnother) {
  const Folder folder;
  std::string json = kJson;
  json.replace(json.rfind('}'), 1, ", \"extensions\": [\"0A\"]}");
  const Outcome encoded = run_program({"v2x", "encode", folder.write("two.json", kJson + json)});
  ASSERT_EQ(count_lines(encoded.out), 2u) << encoded.err;
  const std::size_t end = encoded.out.find('\n');
  EXPECT_EQ(encoded.out.substr(end + 1, 4), "8013");
  const std::string bytes = binary(encoded.out.substr(0, end)) + binary(encoded.out.substr(end + 1));
  const Outcome decoded = run_successfully({"v2x", "decode", folder.write("two.bin", bytes)});
  EXPECT_EQ(count_lines(decoded.out), 2u) << decoded.out;
  EXPECT_EQ(decoded.out.find("padding"), std::string::npos);
}

TEST(V2x, JsonUsesTheNamesOfTheStandard) {
  const Folder folder;
  const Outcome encoded = run_successfully({"v2x", "encode", folder.write("spat.json", kJson)});
  const std::string hex = encoded.out.substr(0, encoded.out.size() - 1);
  const Json json = run_json({"v2x", "decode", folder.write("spat.hex", "# a comment\r\n\r\n 0x" + hex + "00\r\n")});
  const std::string state = "/value/SPAT/intersections/0/states/0";
  EXPECT_EQ(json.number("/messageId"), 19);
  EXPECT_EQ(json.text("/value/SPAT/intersections/0/status"), "0000000000000000");
  EXPECT_EQ(json.number(state + "/signalGroup"), 2);
  EXPECT_EQ(json.text(state + "/state-time-speed/0/eventState"), "protected-Movement-Allowed");
  EXPECT_EQ(json.number(state + "/state-time-speed/0/timing/maxEndTime"), 22121);
  EXPECT_EQ(json.text("/padding"), "00");
}

TEST(V2x, XmlIsOneDocument) {
  const Folder folder;
  const std::string hex = frames().substr(0, frames().find('\n') + 1);
  const Outcome one = run_successfully({"v2x", "decode", "--xml", folder.write("one.hex", hex)});
  EXPECT_EQ(one.out.find("<?xml version=\"1.0\"?>\n<MessageFrame>\n  <messageId>"), 0u) << one.out;
  const Outcome two = run_program({"v2x", "decode", "--xml", folder.write("two.hex", hex + hex)});
  EXPECT_EQ(two.out.find("<?xml version=\"1.0\"?>\n<MessageFrames>\n  <MessageFrame>\n"), 0u) << two.out;
  EXPECT_EQ(two.out.substr(two.out.size() - 17), "</MessageFrames>\n");
  const auto frames_in = [](const std::string& text) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find("<MessageFrame>", at)) != std::string::npos; ++at) ++count;
    return count;
  };
  EXPECT_EQ(frames_in(one.out), 1u);
  EXPECT_EQ(frames_in(two.out), 2u);
  const Outcome three = run_program({"v2x", "decode", "--xml", folder.write("three.hex", hex + hex + hex)});
  EXPECT_EQ(frames_in(three.out), 3u);
}

TEST(V2x, BadFramesAreReportedAndTheOthersDecoded) {
  const Folder folder;
  const std::string good = frames().substr(0, frames().find('\n'));
  const std::string file =
      folder.write("bad.hex", good + "\n0014010\nhello\n00140100\n" + good.substr(0, 20) + "\n" + good);
  const Outcome outcome = run_program({"v2x", "decode", file});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(count_lines(outcome.out), 2u);
  EXPECT_NE(outcome.err.find(file + ":2: 7 hexadecimal digits; expected two per byte\n"), std::string::npos);
  EXPECT_NE(outcome.err.find(file + ":3: expected hexadecimal digits, one frame per line\n"), std::string::npos);
  EXPECT_NE(outcome.err.find(file + ":4: messageId: 20 (BasicSafetyMessage) is neither SPaT (19) nor MAP (18)\n"),
            std::string::npos);
  EXPECT_NE(outcome.err.find(file + ":5: "), std::string::npos);
  EXPECT_EQ(count_lines(outcome.err), 4u) << outcome.err;
}

TEST(V2x, ManyBadFramesAreCounted) {
  const Folder folder;
  std::string bad;
  for (int i = 0; i < 100; ++i) bad += "00140100\n";
  const Outcome outcome = run_program({"v2x", "decode", folder.write("bad.hex", bad)});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(count_lines(outcome.err), 11u) << outcome.err;
  EXPECT_NE(outcome.err.find("90 more frames are not decoded\n"), std::string::npos) << outcome.err;
}

TEST(V2x, FilesWithoutAFrameAreRejected) {
  const Folder folder;
  for (const std::string content : {"\n\n", "# nothing\n"}) {
    expect_refused({"v2x", "decode", folder.write("none.hex", content)}, "no frame");
  }
  EXPECT_EQ(run_program({"v2x", "decode", folder.path("missing")}).code, 2);
  EXPECT_EQ(run_program({"v2x", "encode", folder.write("blank", " \n")}).code, 2);
}

TEST(V2x, JsonErrorsNameTheirComponent) {
  const std::string spat = "value.SPAT.intersections[0]";
  EXPECT_EQ(refusal("35176", "65536"), spat + ".timeStamp: found 65536; expected a whole number from 0 to 65535");
  EXPECT_EQ(refusal("35176", "-1"), spat + ".timeStamp: found -1; expected a whole number from 0 to 65535");
  EXPECT_EQ(refusal("35176", "1.5"), spat + ".timeStamp: found 1.5; expected a whole number from 0 to 65535");
  EXPECT_EQ(refusal("35176", "18446744073709551615"),
            spat + ".timeStamp: found 18446744073709551615; expected a whole number from 0 to 65535");
  EXPECT_EQ(refusal("\"signalGroup\": 2, ", ""), spat + ".states[0]: 'signalGroup' is missing");
  EXPECT_EQ(refusal("signalGroup", "signalGrup"), spat + ".states[0]: 'signalGroup' is missing");
  EXPECT_EQ(refusal("\"timeStamp\"", "\"timestamp\""),
            spat + ": 'timestamp' is not a component here; did you mean 'timeStamp'?");
  EXPECT_EQ(refusal("0000000000000000", "000000000000000"),
            spat + ".status: found \"000000000000000\"; expected a text of 16 digits 0 and 1");
  expect_in("eventState: found \"green\"; expected one of unavailable, ",
            refusal("protected-Movement-Allowed", "green"));
  EXPECT_EQ(refusal("\"SPAT\"", "\"MapData\""), "value: 'SPAT' is missing");
  EXPECT_EQ(refusal("\"messageId\": 19", "\"messageId\": 20"), "messageId is 20; expected 19 (SPaT) or 18 (MAP)");
  EXPECT_EQ(refusal("[{\n", "7, [{\n").find("not JSON from here on: "), 0u);
  EXPECT_EQ(refusal("}]}]}]}}}", "}]}]}]}}").find("not JSON from here on: "), 0u);
}

/// In place of a frame, its id and a component: recursion must not be as deep as the nesting of a stranger's lists.
TEST(V2x, DeeplyNestedJsonIsRejected) {
  const std::string open(200'000, '['), closed = open + std::string(200'000, ']');
  EXPECT_EQ(refusal(kJson, closed), "found a list of 1; expected an object");
  EXPECT_EQ(refusal("19", closed), "messageId is a list of 1; expected 19 (SPaT) or 18 (MAP)");
  EXPECT_EQ(refusal("35176", closed),
            "value.SPAT.intersections[0].timeStamp: found a list of 1; expected a whole number from 0 to 65535");
  EXPECT_EQ(refusal("\"revision\"", "\"x\": " + closed + ", \"revision\""),
            "value.SPAT.intersections[0]: 'x' is not a component here");
  EXPECT_EQ(refusal(kJson, open).find("not JSON from here on: "), 0u);
}

TEST(V2x, ExportsTheLightsOfAWorld) {
  const Folder folder;
  const Outcome exported = run_successfully({"v2x", "export", our_world("simville/simville.world"), "--time", "9"});
  EXPECT_EQ(count_lines(exported.out), 4u);
  EXPECT_NE(exported.err.find("intersection 1: light1, light2, light3, light4; 4 stop lines\n"), std::string::npos);
  const Outcome decoded = run_successfully({"v2x", "decode", folder.write("lights.hex", exported.out)});
  const Json map(decoded.out.substr(0, decoded.out.find('\n')));
  EXPECT_EQ(map.number("/value/MapData/intersections/0/laneSet/0/connectsTo/0/signalGroup"), 1);
  const std::string rest = decoded.out.substr(decoded.out.find('\n') + 1);
  const Json spat(rest.substr(0, rest.find('\n')));
  // Light 1 is green for 8 s, then yellow for 2 s.
  const std::string events = "/value/SPAT/intersections/0/states/0/state-time-speed/";
  EXPECT_EQ(spat.text(events + "0/eventState"), "permissive-clearance");
  EXPECT_EQ(spat.number(events + "0/timing/minEndTime"), 100);
  EXPECT_EQ(spat.text(events + "1/eventState"), "stop-And-Remain");

  expect_refused({"v2x", "export", our_world("rooms.world")}, "no traffic lights in this world");
}

TEST(V2x, WrongArgumentsAreRejected) {
  const Folder folder;
  const std::string file = folder.write("spat.json", kJson);
  for (const Words& words : std::vector<Words>{{"v2x"},
                                               {"v2x", "decode"},
                                               {"v2x", "decipher", file},
                                               {"v2x", "encode", "--xml", file},
                                               {"v2x", "decode", file, file},
                                               {"v2x", "decode", "--time", "3", file}}) {
    expect_refused(words, "see `sensorfarm v2x --help`");
  }
}

}  // namespace sf
