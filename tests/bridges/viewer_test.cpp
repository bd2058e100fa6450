// The live view's server as seen by its clients.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

#include "bridges/scene_json.h"
#include "bridges/view_intents.h"
#include "record/cdr.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "tests/bridges/viewer_fixture.h"
#include "world/roads/roads.h"

namespace sf::bridges {

namespace {

std::string le32(std::uint32_t value) { return {reinterpret_cast<const char*>(&value), 4}; }

std::string call_bytes(std::uint32_t service, const std::string& encoding, const std::string& payload) {
  return "\x02" + le32(service) + le32(5) + le32(static_cast<std::uint32_t>(encoding.size())) + encoding + payload;
}

std::string twist_cdr(double forward, double turn) {
  base::Bytes bytes;
  record::CdrWriter cdr(bytes);
  for (const double value : {forward, 0.0, 0.0, 0.0, 0.0, turn}) cdr.put(value);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

TEST(Viewer, SelectsTheFirstKnownSubProtocol) {
  const ViewerFixture fixture;
  const auto chosen = [&](const char* offered) {
    RawClient client(fixture.port());
    const std::string status = client.upgrade(offered);
    const std::size_t at = client.head().find("Sec-WebSocket-Protocol: ");
    return at == std::string::npos ? status : client.head().substr(at + 24, client.head().find('\r', at) - at - 24);
  };
  EXPECT_EQ(chosen("foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(chosen("foxglove.sdk.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(chosen("foxglove.websocket.v1, foxglove.sdk.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(chosen("chat, foxglove.sdk.v1, foxglove.websocket.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(chosen("chat"), "HTTP/1.1 400 Bad Request");
  EXPECT_EQ(chosen(""), "HTTP/1.1 400 Bad Request");
}

TEST(Viewer, ServesThePageAndTheScene) {
  const ViewerFixture fixture;
  const auto get = [&](const char* target) { return RawClient(fixture.port()).request(target, "Host: localhost\r\n"); };
  EXPECT_NE(get("/").find("200 OK\r\nContent-Type: text/html"), std::string::npos) << get("/");
  EXPECT_NE(get("/main.js").find("200 OK\r\nContent-Type: text/javascript"), std::string::npos);
  EXPECT_NE(get("/scene.json").find("200 OK\r\nContent-Type: application/json"), std::string::npos);
  for (const char* none : {"/none", "/../etc/passwd", "//", "/main.js/", "http://localhost/"})
    EXPECT_EQ(get(none).substr(9, 3), "404") << none;
  EXPECT_EQ(RawClient(fixture.port()).request("/", "Host: localhost\r\n", "POST").substr(9, 3), "405");
}

TEST(Viewer, ClosesAConnectionOnRequest) {
  const ViewerFixture fixture;
  RawClient client(fixture.port());
  const auto head = [&](const std::string& more) { return client.request("/", "Host: localhost\r\n" + more, "HEAD"); };
  for (int i = 0; i < 2; ++i) EXPECT_EQ(head("").substr(9, 3), "200") << "one after another";
  EXPECT_NE(head("Connection: close\r\n").find("\r\nConnection: close\r\n"), std::string::npos);
  EXPECT_EQ(head(""), "");
}

TEST(Viewer, RejectsForeignPagesAndNames) {
  const ViewerFixture fixture;
  const auto status = [&](const std::string& more, const std::string& target = "/", const char* host = "localhost") {
    return RawClient(fixture.port()).upgrade(kSdkV1, more, target, host).substr(9, 3);
  };
  EXPECT_EQ(status(""), "101");                                      // not a browser
  EXPECT_EQ(status("Origin: http://localhost\r\n"), "101");          // its own page
  EXPECT_EQ(status("Origin: https://app.foxglove.dev\r\n"), "101");  // Foxglove's viewer
  EXPECT_EQ(status("Origin: https://evil.example\r\n"), "403");
  EXPECT_EQ(status("Origin: null\r\n"), "403");
  EXPECT_EQ(status("", "/", "evil.example"), "403");  // DNS rebinding
  EXPECT_EQ(status("Origin: http://evil.example\r\n", "/", "evil.example"), "403");
  const std::string token = "/?token=" + fixture.viewer->server().token();
  EXPECT_EQ(status("Origin: https://evil.example\r\n", token), "101");  // the user gave it the token
  EXPECT_EQ(RawClient(fixture.port()).request("/scene.json", "Host: evil.example\r\n").substr(9, 3), "403");
}

TEST(Viewer, RequiresTheTokenBeyondLoopback) {
  const ViewerFixture fixture(ViewerMode::run, 2, {}, "0.0.0.0");
  const std::string token = "token=" + fixture.viewer->server().token();
  EXPECT_NE(fixture.viewer->describe().find(token), std::string::npos);
  const auto status = [&](const std::string& target) {
    return RawClient(fixture.port()).request(target, "Host: localhost\r\n").substr(9, 3);
  };
  EXPECT_EQ(status("/"), "200");  // the page itself is public
  EXPECT_EQ(status("/scene.json"), "403");
  EXPECT_EQ(status("/scene.json?token=0"), "403");
  EXPECT_EQ(status("/scene.json?" + token), "200");
  EXPECT_EQ(RawClient(fixture.port()).upgrade(kSdkV1).substr(9, 3), "403");
  EXPECT_EQ(RawClient(fixture.port()).upgrade(kSdkV1, "", "/?" + token, "192.168.1.5").substr(9, 3), "101");
}

TEST(Viewer, AnnouncesItsCapabilities) {
  const auto greeting = [](ViewerMode mode, const char* protocol) {
    return Watcher(ViewerFixture(mode), {}, protocol).greeting;
  };
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  const std::string run = greeting(ViewerMode::run, kSdkV1);
  for (const char* part :
       {"\"op\":\"serverInfo\"", "sensorfarm: few", "clientPublish", "parametersSubscribe", "\"time\"", "services",
        "\"op\":\"advertise\"", "\"topic\":\"/fleet\"", "ros2msg", "\"/step\"", "std_srvs/srv/Trigger"})
    EXPECT_TRUE(has(run, part)) << part << " in " << run;
  EXPECT_FALSE(has(run, "playbackControl"));
  const std::string service = greeting(ViewerMode::service, kSdkV1);
  EXPECT_FALSE(has(service, "clientPublish") || has(service, "services"))
      << "viewers cannot command the robots of a service";
  const std::string recording = greeting(ViewerMode::recording, kSdkV1);
  EXPECT_TRUE(has(recording, "playbackControl") && has(recording, "\"dataEndTime\":{\"sec\":5,\"nsec\":0}"))
      << recording;
  EXPECT_FALSE(has(greeting(ViewerMode::recording, kWebSocketV1), "playbackControl")) << "it does not know that";
}

/// Readings are drawn at the poses of the same tick, however the two are timed.
TEST(Viewer, TopicsAreSentWithTheStatesOfTheirTick) {
  ViewerFixture fixture;
  Watcher watcher(fixture, {"/clock"});
  std::atomic<bool> stop = false;
  std::thread run([&] {
    for (std::uint64_t number = 1; !stop; ++number) {
      fixture.tick(number, false);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  for (int i = 0; i < 3; ++i) EXPECT_EQ(subscription_tick(watcher.receive_binary(1)).substr(0, 4), "101@");
  watcher.subscribe(102, fixture.channel("/fleet"));
  std::string last = subscription_tick(watcher.receive_binary(1));
  while (last.substr(0, 4) != "102@") last = subscription_tick(watcher.receive_binary(1));
  int clocks = 0;
  for (int i = 0; i < 40; ++i) {
    const std::string now = subscription_tick(watcher.receive_binary(1));
    if (now.substr(0, 4) == "101@") {
      EXPECT_EQ(now.substr(4), last.substr(4)) << "after " << last;
      ++clocks;
    }
    last = now;
  }
  EXPECT_GT(clocks, 10) << "each topic has its turn";
  stop = true;
  run.join();
}

TEST(Viewer, SendsSubscribedTopicsAndTheTime) {
  ViewerFixture fixture;
  Watcher one(fixture, {"/fleet"}), both(fixture, {"/clock", "/fleet"});
  fixture.tick(3);
  EXPECT_EQ(subscription_tick(one.receive_binary(1)), "101@3");
  const std::string fleet = both.receive_binary(1), clock = both.receive_binary(1);
  EXPECT_EQ(subscription_tick(fleet), "102@3") << "the client's own number";
  EXPECT_EQ(clock.substr(0, 4), le32(101));
  std::int64_t time = 0;
  std::memcpy(&time, fleet.data() + 4, 8);
  EXPECT_EQ(time, 300'000'000);
  fixture.tick(4);
  const std::string now = one.receive_binary(2);
  ASSERT_EQ(now.size(), 8u);
  std::memcpy(&time, now.data(), 8);
  EXPECT_EQ(time, 400'000'000);
  EXPECT_EQ(subscription_tick(one.receive_binary(1)), "101@4") << "/clock was never subscribed";
  one.text(R"({"op":"unsubscribe","subscriptionIds":[101]})");
  one.subscribe(9, fixture.channel("/left/odom"));
  one.settle();
  fixture.tick(5);
  EXPECT_EQ(subscription_tick(one.receive_binary(1)), "9@5");
}

TEST(Viewer, SendsLatchedTopicsImmediately) {
  const ViewerFixture fixture;
  RawClient client(fixture.port());
  client.upgrade(kSdkV1);
  client.text(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":)" + std::to_string(fixture.channel("/run")) +
              "}]}");
  EXPECT_NE(client.receive_binary(1).find("few"), std::string::npos);
}

TEST(Viewer, ShowsAPausedRunToNewSubscribers) {
  ViewerFixture fixture;
  fixture.tick(7);  // no client is watching
  Watcher late(fixture, {"/fleet"});
  fixture.viewer->publish(RunState{.paused = true});
  EXPECT_EQ(subscription_tick(late.receive_binary(1)), "101@7");
}

TEST(Viewer, ShowsTheTickBeforeAPauseAfterSkippedTicks) {
  ViewerFixture fixture;
  Watcher client(fixture, {"/fleet"});
  const std::vector<base::Report> reports = fixture.states();
  base::TickRecord tick;
  tick.reports = reports;
  for (tick.tick = 1; tick.tick <= 50; ++tick.tick) {  // far more than are sent
    tick.time = static_cast<std::int64_t>(tick.tick) * 100'000'000;
    fixture.viewer->publish(tick, {});
  }
  fixture.viewer->publish(RunState{.paused = true});
  std::string last;
  while (last != "101@50") {
    last = subscription_tick(client.receive_binary(1));
    ASSERT_FALSE(last.empty()) << "the last tick did not arrive";
  }
}

TEST(Viewer, ShowsARestartedRun) {
  ViewerFixture fixture;
  Watcher client(fixture, {"/left/odom"});
  for (const int tick : {5, 6, 0, 1}) {
    fixture.tick(static_cast<std::uint64_t>(tick));
    EXPECT_EQ(subscription_tick(client.receive_binary(1)), "101@" + std::to_string(tick));
  }
}

TEST(Viewer, AcceptsParametersAndServices) {
  ViewerFixture fixture;
  Watcher client(fixture);
  client.text(
      R"({"op":"setParameters","id":"s","parameters":[{"name":"/paused","value":true},{"name":"/speed","value":2.5}]})");
  EXPECT_NE(client.receive_with("\"id\":\"s\"").find("2.5"), std::string::npos);
  Requests requests = fixture.requests();
  EXPECT_EQ(requests.paused, true);
  EXPECT_EQ(requests.speed, 2.5);
  EXPECT_FALSE(fixture.requests().paused) << "requested once";

  client.text(R"({"op":"setParameters","parameters":[{"name":"/speed","value":0}]})");
  client.text(R"({"op":"getParameters","id":"g","parameterNames":["/speed"]})");
  EXPECT_NE(client.receive_with("parameterValues").find("\"id\":\"g\""), std::string::npos) << "no id, no answer";
  client.send_frame(2, call_bytes(2, "json", "{}"));
  client.send_frame(2, call_bytes(2, "cdr", std::string("\0\1\0\0", 4)));
  client.send_frame(2, call_bytes(3, "json", "{}"));
  client.send_frame(2, call_bytes(1, "cdr", std::string("\0\1\0\0\1", 5)));
  const std::string json = client.receive_binary(3), cdr = client.receive_binary(3);
  EXPECT_EQ(json, le32(2) + le32(5) + le32(4) + "json" + R"({"success":true,"message":""})");
  EXPECT_EQ(cdr.substr(15), std::string("\0\1\0\0\1\0\0\0\1\0\0\0\0", 13)) << "true, and an empty text";
  client.settle();
  requests = fixture.requests();
  EXPECT_TRUE(std::isinf(*requests.speed)) << "0: as fast as possible";
  EXPECT_EQ(requests.steps, 2u);
  EXPECT_TRUE(requests.reset);
  EXPECT_EQ(requests.paused, true);
}

TEST(Viewer, PausesAfterOneMoreTick) {
  ViewerFixture fixture;
  const std::vector<base::Report> reports = fixture.states();
  base::TickRecord tick;
  tick.reports = reports;
  fixture.viewer->publish(tick, {});
  Watcher client(fixture);
  client.text(R"({"op":"setParameters","id":"s","parameters":[{"name":"/paused","value":true}]})");
  client.settle();
  EXPECT_FALSE(fixture.requests().paused) << "the next tick's readings must be stored";
  fixture.viewer->publish(tick, {});
  EXPECT_EQ(fixture.requests().paused, true);
  EXPECT_FALSE(fixture.requests().paused);
}

TEST(Viewer, RejectsInvalidParameters) {
  ViewerFixture fixture;
  Watcher client(fixture);
  for (const char* wrong :
       {R"({"name":"/speed","value":-1})", R"({"name":"/speed","value":"fast"})", R"({"name":"/paused","value":1})",
        R"({"name":"/measured_speed","value":1})", R"({"name":"/x","value":1})", R"({"value":1})"}) {
    client.text(R"({"op":"setParameters","parameters":[)" + std::string(wrong) + "]}");
    EXPECT_NE(client.receive_with("\"op\":\"status\""), "") << wrong;
  }
  client.send_frame(2, call_bytes(4, "json", "{}"));
  EXPECT_NE(client.receive_with("serviceCallFailure"), "");
  client.send_frame(2, call_bytes(1, "json", "{\"data\":1}"));
  EXPECT_NE(client.receive_with("SetBool"), "");
  const Requests requests = fixture.requests();
  EXPECT_FALSE(requests.paused || requests.speed || requests.reset || requests.steps > 0);
}

TEST(Viewer, SendsChangesToWatchers) {
  ViewerFixture fixture;
  Watcher client(fixture);
  client.text(R"({"op":"subscribeParameterUpdates","parameterNames":["/paused","/runs","/none"]})");
  client.settle();
  fixture.viewer->publish(RunState{.paused = true, .speed = 3.0, .runs = 1});
  const std::string update = client.receive_with("parameterValues");
  EXPECT_NE(update.find(R"({"name":"/paused","value":true})"), std::string::npos) << update;
  EXPECT_NE(update.find(R"("/runs","value":1)"), std::string::npos) << update;
  EXPECT_EQ(update.find("/speed"), std::string::npos) << "not watched";
}

/// Clients that open the page later get the new scene at once; others are told to load it.
TEST(Viewer, ShowsNewShapes) {
  ViewerFixture fixture;
  const auto scene = [&] { return RawClient(fixture.port()).request("/scene.json", "Host: localhost\r\n"); };
  Watcher client(fixture);
  client.text(R"({"op":"subscribeParameterUpdates","parameterNames":["/shapes"]})");
  client.settle();
  const std::string before = scene();
  EXPECT_EQ(scene(), before);
  fixture.world.movers[1].radius = 0.75;
  const std::vector<base::Report> reports = fixture.states();
  const base::ShapeState changed{.mover = 1};
  fixture.viewer->publish(base::TickRecord{.tick = 1, .time = 100'000'000, .reports = reports, .shapes = {&changed, 1}},
                          {.paused = true});
  const std::string update = client.receive_with("parameterValues");
  EXPECT_NE(update.find(R"("/shapes","value":1)"), std::string::npos) << update;
  EXPECT_NE(scene(), before) << "its length";
}

TEST(Viewer, DrivesRobots) {
  ViewerFixture fixture;
  Watcher client(fixture);
  client.text(
      R"({"op":"advertise","channels":[{"id":1,"topic":"/right/cmd_vel","encoding":"cdr","schemaName":"geometry_msgs/msg/Twist"},{"id":2,"topic":"/left/cmd_vel","encoding":"json","schemaName":"geometry_msgs/Twist"}]})");
  client.send_frame(2, "\x01" + le32(1) + twist_cdr(0.5, -1.0));
  client.send_frame(2, "\x01" + le32(2) + R"({"linear":{"x":0.25}})");
  client.send_frame(2, "\x01" + le32(1) + twist_cdr(0.75, 2.0));  // replaces the first
  EXPECT_EQ(client.settle(), "");
  const Requests requests = fixture.requests();
  ASSERT_EQ(requests.commands.size(), 2u);
  EXPECT_EQ(requests.commands[0].mover, 0u);
  EXPECT_EQ(requests.commands[0].twist.forward, 0.25);
  EXPECT_EQ(requests.commands[1].mover, 1u);
  EXPECT_EQ(requests.commands[1].twist.forward, 0.75);
  EXPECT_EQ(requests.commands[1].twist.turn, 2.0);
}

TEST(Viewer, RejectsOtherCommands) {
  ViewerFixture fixture;
  Watcher client(fixture);
  const auto advertise = [&](const char* topic, const char* encoding, const char* type) {
    client.text(std::string(R"({"op":"advertise","channels":[{"id":1,"topic":")") + topic + R"(","encoding":")" +
                encoding + R"(","schemaName":")" + type + "\"}]}");
    return client.settle();
  };
  EXPECT_NE(advertise("/none/cmd_vel", "cdr", "geometry_msgs/msg/Twist"), "");
  EXPECT_NE(advertise("/left/cmd_vel", "ros1", "geometry_msgs/msg/Twist"), "");
  EXPECT_NE(advertise("/left/cmd_vel", "cdr", "std_msgs/msg/String"), "");
  client.send_frame(2, "\x01" + le32(1) + twist_cdr(1, 1));
  EXPECT_NE(client.settle().find("was not advertised"), std::string::npos);
  EXPECT_EQ(advertise("/left/cmd_vel", "cdr", "geometry_msgs/msg/Twist"), "");
  for (const std::string& wrong :
       {twist_cdr(NAN, 0), twist_cdr(0, INFINITY), twist_cdr(1, 1).substr(0, 51), std::string()}) {
    client.send_frame(2, "\x01" + le32(1) + wrong);
    EXPECT_NE(client.settle(), "") << wrong.size();
  }
  EXPECT_TRUE(fixture.requests().commands.empty());
}

TEST(Viewer, ServicesAcceptNoCommands) {
  ViewerFixture fixture(ViewerMode::service);
  Watcher client(fixture);
  client.text(
      R"({"op":"advertise","channels":[{"id":1,"topic":"/left/cmd_vel","encoding":"cdr","schemaName":"geometry_msgs/msg/Twist"}]})");
  client.send_frame(2, "\x01" + le32(1) + twist_cdr(1, 1));
  client.text(R"({"op":"setParameters","parameters":[{"name":"/paused","value":true}]})");
  client.send_frame(2, call_bytes(3, "json", "{}"));
  EXPECT_NE(client.settle(), "");
  const Requests requests = fixture.requests();
  EXPECT_TRUE(requests.commands.empty());
  EXPECT_FALSE(requests.paused || requests.reset);
}

TEST(Viewer, PlaysRecordings) {
  ViewerFixture fixture(ViewerMode::recording);
  Watcher client(fixture, {}, kSdkV1);
  const std::string play("\x03\x00\x00\x00\x00\x40\x01", 7);  // play at speed 2, jumping to
  const std::int64_t times[] = {2'500'000'000, 99'000'000'000};
  for (const std::int64_t time : times) {
    client.send_frame(2, play + std::string(reinterpret_cast<const char*>(&time), 8) + le32(2) + "id");
    const std::string answer = client.receive_binary(5);
    std::int64_t at = 0;
    std::memcpy(&at, answer.data() + 1, 8);
    const std::int64_t expected = std::min<std::int64_t>(time, 5'000'000'000);  // its end
    EXPECT_EQ(at, expected);
    EXPECT_EQ(answer.substr(18), "id");
    const Requests requests = fixture.requests();
    EXPECT_EQ(requests.time, expected);
    EXPECT_EQ(requests.speed, 2.0);
    EXPECT_EQ(requests.paused, false);
  }
}

/// Of a camera that looks to the left of its sensor, which looks to the left of its robot: backwards.
TEST(SceneJson, CamerasHaveTheirLensAndOpticalFrame) {
  const world::World world = ViewerFixture::world_of(1);
  const sensors::SensorSet sensor_set(world);
  record::RunInfo info = ViewerFixture::run_info_of(world);
  info.sensor_types = {{45, "camera", "pixels", {}, false}};
  record::SensorInfo sensor{45, "eye", "/left/camera", {1, 2, 0.5, M_PI / 2}};
  record::StandardTopic image{.message = record::StandardTopic::Message::color_file, .topic = "/left/image"};
  image.X_SE = {0, 0, 0, M_PI / 2};
  image.range_max = 20, image.columns = 64, image.rows = 48;
  image.lens = {{50, 51}, {31.5, 23.5}, {0.1}};
  sensor.standard = {image};
  info.movers[0].sensors = {sensor};
  const std::string json = scene_json({world, sensor_set, info}, ViewerMode::run);
  const std::size_t begin = json.find("\"camera\":{\"image\"");
  ASSERT_LT(begin, json.size());
  const std::string camera = json.substr(begin, json.find('}', begin) - begin);
  for (const char* const part : {"\"image\":\"/left/image\"", "\"size\":[64,48]", "\"focal\":[50.0,51.0]",
                                 "\"center\":[31.5,23.5]", "\"fisheye\":false", "\"distortion\":[0.1,0.0,",
                                 "\"range_max\":20.0", "\"p\":[1.0,2.0,0.5]", "\"axes\":[[-1.0,"})
    EXPECT_NE(camera.find(part), std::string::npos) << part << " in " << camera;
}

/// Movers without an intent are left out; the place of a checkpoint is that of the road network.
TEST(ViewIntents, HaveThePlacesOfCheckpoints) {
  world::World world;
  world.road_files = {SF_SOURCE_DIR "/worlds/simville/simville.rndf"};
  const world::RoadNetwork roads = *world::roads_of(world);
  const world::RoadCheckpoint& last = roads.checkpoints.back();
  const auto id = static_cast<std::uint32_t>(last.id);
  const std::vector<base::Intent> intents{
      {.checkpoint = id}, {}, {.follows = 7}, {.checkpoint = id + 1}, {.docking = true}};
  ViewIntents view(world);
  view.take(intents);
  base::Bytes bytes;
  view.encode(2'000'000'000, bytes);
  record::CdrReader cdr(bytes);
  EXPECT_EQ(cdr.get<std::int32_t>(), 2);
  cdr.get<std::uint32_t>(), cdr.get_string();
  ASSERT_EQ(cdr.get_count(29), 4u);
  for (const std::uint32_t mover : {0u, 2u, 3u, 4u}) {
    EXPECT_EQ(cdr.get<std::uint32_t>(), mover);
    EXPECT_EQ(cdr.get<std::uint32_t>(), intents[mover].follows);
    EXPECT_EQ(cdr.get<std::uint32_t>(), intents[mover].checkpoint);
    const double x = cdr.get<double>(), y = cdr.get<double>();
    EXPECT_EQ(glm::dvec2(x, y) == last.p, mover == 0);
    EXPECT_EQ(std::isnan(x) && std::isnan(y), mover != 0) << "mover " << mover << " has no known checkpoint";
    EXPECT_EQ(cdr.get<bool>(), mover == 4);
  }
  EXPECT_TRUE(cdr.good());
  EXPECT_EQ(cdr.left(), 0u);
}

/// In file order, by sensor; other sensor types have no colour.
TEST(SceneJson, LasersHaveTheirColours) {
  world::World world = ViewerFixture::world_of(2);
  for (const std::uint32_t color : {0xFF00FF00u, 0x80A0B0C0u}) {
    sensors::LaserSettings laser;
    laser.name = "eye" + std::to_string(world.movers[0].sensors.size());
    laser.color = color;
    world.movers[0].sensors.push_back(sensors::laser_sensor(laser));
  }
  const sensors::SensorSet sensor_set(world);
  record::RunInfo info = ViewerFixture::run_info_of(world);
  const record::SensorTypeInfo lasers{sensors::kLaser, "laser", "", {}, true}, other{200, "other", "", {}, false};
  info.sensor_types = {lasers, other};
  for (const std::uint8_t type : {std::uint8_t{200}, sensors::kLaser, sensors::kLaser})
    info.movers[0].sensors.push_back({type, "s", "/s"});
  const std::string json = scene_json({world, sensor_set, info}, ViewerMode::run);
  const std::size_t first = json.find("\"color\":\"#00ff00\""), second = json.find("\"color\":\"#a0b0c0\"");
  EXPECT_LT(first, second) << json;
  EXPECT_LT(second, json.size()) << json;
  EXPECT_GT(first, json.find("\"type\":\"other\"")) << "not that of another type";
}

}  // namespace sf::bridges
