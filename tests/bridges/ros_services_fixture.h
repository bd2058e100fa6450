#pragma once
// The ROS 2 services of a run with two robots, one of them absent, and a tag. Answers are decoded completely.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "bridges/ros_services.h"
#include "record/ros_messages.h"

namespace sf::bridges {

using Fields = std::function<void(record::CdrWriter&)>;

/// An answer, read from after the caller's numbers to its end.
struct Reply {
  explicit Reply(base::Bytes message) : bytes(std::move(message)), cdr(bytes) {
    EXPECT_EQ(cdr.get<std::uint64_t>(), 17u);
    EXPECT_EQ(cdr.get<std::int64_t>(), 7);
  }
  ~Reply() { EXPECT_TRUE(cdr.good() && cdr.left() == 0) << cdr.left() << " bytes left"; }
  Reply(const Reply&) = delete;
  Reply& operator=(const Reply&) = delete;

  /// Returns code and text.
  std::string result() {
    const int code = cdr.get<std::uint8_t>();
    return std::to_string(code) + " " + cdr.get_string();
  }
  std::string names() {
    std::string all;
    for (std::uint32_t left = cdr.get_count(5); left > 0; --left) all += cdr.get_string() + " ";
    return all;
  }
  void expect_state(std::int64_t time, const base::Report& state) {
    std::int64_t stamp = 0;
    EXPECT_EQ(record::get_header(cdr, stamp), "world");
    EXPECT_EQ(stamp, time);
    const base::Pose& X = state.X_WM;
    const glm::dvec2 v = base::rotate(X.yaw, {state.velocity.forward, state.velocity.left});
    for (const double value : {X.x, X.y, X.z, 0.0, 0.0, std::sin(X.yaw / 2.0), std::cos(X.yaw / 2.0), v.x, v.y, 0.0,
                               0.0, 0.0, state.velocity.turn, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0})
      EXPECT_EQ(cdr.get<double>(), value);
  }
  base::Bytes bytes;
  record::CdrReader cdr;
};

struct RosServicesTest : testing::Test {
  RosServicesTest() { tick.time = 250'000'000, tick.reports = reports; }
  /// Returns the answer to a request. `then` triggers it if the request waits.
  base::Bytes ask(
      const std::string& name, const Fields& fields = [](auto&) {}, const std::function<void()>& then = [] {}) {
    const auto types = services.types();
    const auto row = std::find_if(types.begin(), types.end(), [&](const auto& type) { return type.name == name; });
    base::Bytes bytes;
    record::CdrWriter cdr(bytes);
    cdr.put(std::uint64_t{17});
    cdr.put(std::int64_t{7});
    fields(cdr);
    asked = {};
    EXPECT_TRUE(services.take(static_cast<std::size_t>(row - types.begin()), bytes, 1, asked)) << name;
    then();
    const std::vector<Answer> answers = services.answers();
    EXPECT_EQ(answers.size(), 1u) << name;
    return answers.empty() ? base::Bytes() : answers[0].message;
  }
  std::string result(
      const std::string& name, const Fields& fields = [](auto&) {}, const std::function<void()>& then = [] {}) {
    return Reply(ask(name, fields, then)).result();
  }
  template <class Value>
  static Fields number(Value value) {
    return [value](record::CdrWriter& cdr) { cdr.put(value); };
  }
  static Fields text(std::string_view value) { return number(value); }
  static Fields state(int value) { return number(static_cast<std::uint8_t>(value)); }
  std::function<void()> look(bool paused, std::uint32_t runs = 0) {
    return [=, this] { services.observe(nullptr, {.paused = paused, .runs = runs}); };
  }
  std::function<void()> step(bool paused, std::uint32_t runs = 0) {
    return [=, this] { services.observe(&tick, {.paused = paused, .runs = runs}); };
  }

  const std::vector<base::Report> reports{
      {0, 0, {3.0, -1.0, 0.1, 0.75}, {0.5, 0.25, -1.5}}, {1, 0, base::kAbsent, {}}, {2, 0, {-4.0, 5.0, 0.5, 2.0}, {}}};
  base::TickRecord tick;
  const world::World world = [] {
    world::World made;
    made.file = "room.world";
    made.models = {{.name = "scout", .type = "probe", .mover = 0},
                   {.name = "robot 2", .type = "probe", .mover = 1},
                   {.name = "tag", .type = "model", .mover = 2}};
    made.movers.resize(3);
    for (std::uint32_t row = 0; row < 3; ++row) {
      made.movers[row].name = made.models[row].name;
      made.movers[row].model = row;
      made.movers[row].id = row + 1;
      if (row < 2) made.movers[row].body = {{.a = {-0.5, -0.25}, .b = {0.75, 0.25}, .z_min = 0.125, .z_max = 0.5}};
    }
    made.movers[0].X_WM = {1.0, 2.0, 0.0, 0.5};
    made.movers[1].X_WM = base::kAbsent;
    made.movers[2].is_tag = true;
    made.emitters.push_back({.kind = world::Emitter::Kind::dock, .model = 2, .X_WE = {3.0, 0.0, 0.0, 0.0}});
    made.paths.push_back({.name = "tour", .pieces = {{.X_WP = {4.0, 0.0, 0.0, 0.0}}}});
    return made;
  }();
  sensors::SensorSet sensor_set{world};
  const record::RunInfo info = [] {
    record::RunInfo made;
    made.movers = {{"scout", "", 1, {}, {}}, {"robot 2", "", 2, {}, {}}, {"tag", "", 3, {}, {}}};
    record::name_frames(made);
    return made;
  }();
  RosServices services{Scene{world, sensor_set, info, true}};
  Requests asked;  ///< of the last request
};

}  // namespace sf::bridges
