// Everything that a viewer sends to a scripted client, compared with a golden record.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <regex>

#include "tests/bridges/viewer_fixture.h"
#include "tests/golden.h"

namespace sf::bridges {

namespace {

std::string four_bytes(std::uint32_t value) { return {reinterpret_cast<const char*>(&value), 4}; }

std::string call_of(std::uint32_t service, const std::string& encoding, const std::string& payload) {
  return "\x02" + four_bytes(service) + four_bytes(9) + four_bytes(static_cast<std::uint32_t>(encoding.size())) +
         encoding + payload;
}

/// Play (0) or pause (1), a speed, an optional time to jump to, and the request's id.
std::string playback(char command, float speed, std::optional<std::int64_t> time) {
  const std::int64_t to = time.value_or(0);
  std::string text = {'\x03', command};
  text.append(reinterpret_cast<const char*>(&speed), 4);
  text += time ? '\x01' : '\x00';
  return text.append(reinterpret_cast<const char*>(&to), 8) + four_bytes(2) + "id";
}

std::string record_of(const RawClient::Message& message) {
  if (message.opcode == 1) {
    static const std::regex session(R"("sessionId":"[^"]*")"), schema(R"("schema":"[^"]{60,}")");
    const std::string named = std::regex_replace(message.payload, session, R"("sessionId":"SESSION")");
    return "  " + std::regex_replace(named, schema, R"("schema":"LONG")") + "\n";
  }
  std::string text = " ";
  for (const char byte : message.payload) text += fmt::format(" {:02x}", static_cast<std::uint8_t>(byte));
  return text + "\n";
}

/// Returns all messages before the answer to a query with its own id.
std::string said_until_settled(RawClient& client) {
  client.text(R"({"op":"getParameters","parameterNames":[],"id":"settle"})");
  std::string text;
  while (const auto message = client.receive()) {
    if (message->payload.find("settle") != std::string::npos) return text;
    text += record_of(*message);
  }
  return text + "  (end)\n";
}

std::string record_of(const Requests& r) {
  return fmt::format("  asked: paused {} speed {} time {} steps {} reset {} commands {}\n",
                     r.paused ? std::to_string(*r.paused) : "-", r.speed ? fmt::format("{:g}", *r.speed) : "-",
                     r.time ? std::to_string(*r.time) : "-", r.steps, r.reset, r.commands.size());
}

const std::vector<std::string> kTexts = {
    R"({"op":"getParameters","parameterNames":[],"id":"all"})",
    R"({"op":"getParameters","parameterNames":["/speed","/none","/runs"],"id":"some"})",
    R"({"op":"setParameters","id":"s","parameters":[{"name":"/speed","value":2.5}]})",
    R"({"op":"setParameters","parameters":[{"name":"/speed","value":0}]})",
    R"({"op":"setParameters","parameters":[{"name":"/speed","value":-1}]})",
    R"({"op":"setParameters","parameters":[{"name":"/paused","value":true},{"name":"/runs","value":3}]})",
    R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":999}]})",
    R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0},{"id":1,"channelId":1},{"id":2,"channelId":0}]})",
    R"({"op":"unsubscribe","subscriptionIds":[1,77]})",
    R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0}]})",
    R"({"op":"advertise","channels":[{"id":1,"topic":"/none/cmd_vel","encoding":"cdr","schemaName":"geometry_msgs/Twist"}]})",
    R"({"op":"advertise","channels":[{"id":1,"topic":"/left/cmd_vel","encoding":"xml","schemaName":"geometry_msgs/Twist"}]})",
    R"({"op":"advertise","channels":[{"id":1,"topic":"/left/cmd_vel","encoding":"json","schemaName":"geometry_msgs/Twist"}]})",
    R"({"op":"unknown"})",
    "no JSON",
};

std::string transcript(ViewerMode mode, const char* protocol) {
  ViewerFixture fixture(mode);
  RawClient client(fixture.port());
  std::string text = client.upgrade(protocol) + "\n";
  text += said_until_settled(client);
  const auto show = [&](const std::string& what) {
    text += what + "\n";
    text += said_until_settled(client);
    text += record_of(fixture.requests());
  };
  for (const std::string& message : kTexts) client.text(message), show("> " + message);
  const std::pair<const char*, std::string> binaries[] = {
      {"pause by json", call_of(1, "json", R"({"data":true})")},
      {"pause by a wrong json", call_of(1, "json", R"({"data":1})")},
      {"pause without a value", call_of(1, "json", "{}")},
      {"go on by cdr", call_of(1, "cdr", std::string("\0\1\0\0\0", 5))},
      {"pause by a cut cdr", call_of(1, "cdr", std::string("\0\1\0\0", 4))},
      {"step", call_of(2, "json", "{}")},
      {"reset", call_of(3, "cdr", std::string("\0\1\0\0", 4))},
      {"no such service", call_of(4, "json", "{}")},
      {"a twist", "\x01" + four_bytes(1) + R"({"linear":{"x":0.25}})"},
      {"no twist", "\x01" + four_bytes(1) + "{"},
      {"an unknown channel", "\x01" + four_bytes(7) + "{}"},
      {"play at 2 from 2.5 s", playback('\0', 2.0F, 2'500'000'000)},
      {"pause where it is", playback('\1', 1.0F, std::nullopt)},
      {"play at 0 from before the start", playback('\0', 0.0F, 5)},
      {"no message", "\x09"},
  };
  for (const auto& [what, bytes] : binaries) client.send_frame(2, bytes), show(std::string("> ") + what);
  return text;
}

void expect_record(const std::string& name, const std::string& text) { golden::expect(text, "bridges", name, 1e-6); }

}  // namespace

TEST(ViewerRecords, ARunMatchesItsRecord) { expect_record("run", transcript(ViewerMode::run, kWebSocketV1)); }

TEST(ViewerRecords, AServiceMatchesItsRecord) { expect_record("service", transcript(ViewerMode::service, kSdkV1)); }

TEST(ViewerRecords, ARecordingMatchesItsRecord) {
  expect_record("recording", transcript(ViewerMode::recording, kSdkV1));
}

/// Each change is sent once, and an unchanged value is not sent.
TEST(ViewerRecords, EachChangedParameterIsSentAlone) {
  ViewerFixture fixture;
  Watcher client(fixture);
  client.text(R"({"op":"subscribeParameterUpdates","parameterNames":["/paused","/speed","/runs"]})");
  client.settle();
  const std::pair<RunState, std::string> changes[] = {
      {{.paused = true, .speed = 1.0, .runs = 0}, R"({"name":"/paused","value":true})"},
      {{.paused = true, .speed = 3.0, .runs = 0}, R"({"name":"/speed","value":3.0,"type":"float64"})"},
      {{.paused = true, .speed = 3.0, .runs = 1}, R"({"name":"/runs","value":1.0,"type":"float64"})"},
      {{.paused = false, .speed = 3.0, .runs = 1}, R"({"name":"/paused","value":false})"},
  };
  for (const auto& [state, changed] : changes) {
    fixture.viewer->publish(state);
    EXPECT_EQ(client.receive_with("parameterValues"), R"({"op":"parameterValues","parameters":[)" + changed + "]}");
  }
}

}  // namespace sf::bridges
