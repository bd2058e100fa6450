// Every answer of the ROS 2 services that describe or change entities, places and worlds.

#include "bridges/world_services.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/bridges/ros_services_fixture.h"

namespace sf::bridges {
namespace {

struct WorldServicesTest : RosServicesTest {
  WorldServicesTest() { step(false)(); }

  /// Fields of a SpawnEntity.
  struct Wanted {
    std::string name = "new_one";
    bool renaming = false;
    std::string uri = "scout", text, space, frame;
    double x = 0.0, w = 1.0, tilt = 0.0;
  };
  static void put(record::CdrWriter& cdr, const Wanted& wanted) {
    cdr.put(wanted.name);
    cdr.put(wanted.renaming);
    cdr.put(wanted.uri);
    cdr.put(wanted.text);
    cdr.put(wanted.space);
    record::put_header(cdr, 0, wanted.frame);
    for (const double value : {wanted.x, 2.0, 0.0, wanted.tilt, 0.0, 0.0, wanted.w}) cdr.put(value);
  }
  static Fields spawn(const Wanted& wanted) {
    return [wanted](record::CdrWriter& cdr) { put(cdr, wanted); };
  }
  /// Returns code and name of an answer that is given immediately, as a refusal is.
  std::string spawned(
      const Wanted& wanted, const std::function<void()>& then = [] {}) {
    Reply reply(ask("/spawn_entity", spawn(wanted), then));
    const std::string result = reply.result();
    return result.substr(0, result.find(' ') + 1) + reply.cdr.get_string();
  }
  /// Returns how the run handles a request.
  std::function<void()> done(bool good = true) {
    return [this, good] {
      const Outcome outcome{true, good ? Outcome::Fault::none : Outcome::Fault::failed, good ? "" : "no room"};
      for (const Joining& each : asked.joining) *each.outcome = outcome;
      for (const Leaving& each : asked.leaving) *each.outcome = outcome;
      if (asked.world) *asked.world->outcome = outcome;
      step(false)();
    };
  }
  std::string bounds(Reply& reply) {
    std::string text = std::to_string(reply.cdr.get<std::uint8_t>());
    for (std::uint32_t left = 3 * reply.cdr.get_count(24); left > 0; --left)
      text += " " + std::to_string(reply.cdr.get<double>()).substr(0, 5);
    return text;
  }
};

const char* const kBox = "1 0.750 0.250 0.500 -0.50 -0.25 0.125";

TEST_F(WorldServicesTest, EntitiesHaveInfoAndBounds) {
  for (const auto& [name, code, category, expected] :
       {std::tuple{"scout", 1, 1, "probe"}, {"tag", 1, 4, "model"}, {"robot_2", 2, 0, ""}, {"", 2, 0, ""}}) {
    Reply facts(ask("/get_entity_info", text(name)));
    EXPECT_EQ(facts.result(), code == 1 ? "1 " : "2 no entity of that name is present");
    EXPECT_EQ(facts.cdr.get<std::uint8_t>(), category);
    EXPECT_EQ(facts.cdr.get_string(), expected);
    EXPECT_EQ(facts.cdr.get_count(5), 0u);
    Reply box(ask("/get_entity_bounds", text(name)));
    EXPECT_EQ(box.result(), code == 1 ? "1 " : "2 no entity of that name is present");
    EXPECT_EQ(bounds(box), name == std::string("scout") ? kBox : "0");
  }
}

TEST_F(WorldServicesTest, NamedPosesMatchTheirTags) {
  const auto names = [&](const std::vector<const char*>& tags, int mode) {
    Reply reply(ask("/get_named_poses", [&](record::CdrWriter& cdr) {
      cdr.put_count(tags.size());
      for (const char* tag : tags) cdr.put(tag);
      cdr.put(static_cast<std::uint8_t>(mode));
    }));
    EXPECT_EQ(reply.result(), "1 ");
    std::string all;
    for (std::uint32_t left = reply.cdr.get_count(70); left > 0; --left) {
      all += reply.cdr.get_string() + " ";
      reply.cdr.get_string();
      for (std::uint32_t tags_left = reply.cdr.get_count(5); tags_left > 0; --tags_left) reply.cdr.get_string();
      for (int i = 0; i < 7; ++i) reply.cdr.get<double>();
    }
    return all;
  };
  EXPECT_EQ(names({}, 0), "start_scout dock_tag path_tour ");
  EXPECT_EQ(names({"dock", "path"}, 0), "dock_tag path_tour ");
  EXPECT_EQ(names({"spawn", "start"}, 1), "start_scout ");
  EXPECT_EQ(names({"dock", "path"}, 1), "");
  for (const auto& [name, code, box] : {std::tuple{"start_scout", "1 ", kBox},
                                        {"dock_tag", "1 ", "0"},
                                        {"start_tag", "2 no pose has that name", "0"}}) {
    Reply reply(ask("/get_named_pose_bounds", text(name)));
    EXPECT_EQ(reply.result(), code);
    EXPECT_EQ(bounds(reply), box);
  }
}

/// Robots of one kind are one spawnable. The answer names the sources that it omits.
TEST_F(WorldServicesTest, SpawnablesAreKindsOfRobots) {
  Reply reply(ask("/get_spawnables", [](record::CdrWriter& cdr) {
    cdr.put_count(1);
    cdr.put("https://models");
  }));
  EXPECT_EQ(reply.result(), "1 not searched: https://models");
  ASSERT_EQ(reply.cdr.get_count(20), 1u);
  EXPECT_EQ(reply.cdr.get_string(), "scout");
  EXPECT_EQ(reply.cdr.get_string(), "");
  EXPECT_EQ(reply.cdr.get_string(), "probe");
  EXPECT_EQ(bounds(reply), kBox);
}

TEST_F(WorldServicesTest, SpawnsOrGivesAReason) {
  EXPECT_EQ(spawned({}, done()), "1 new_one");
  ASSERT_EQ(asked.joining.size(), 1u);
  EXPECT_EQ(asked.joining[0].like, "scout");
  EXPECT_EQ(asked.joining[0].X_WM.y, 2.0);
  EXPECT_EQ(spawned({.uri = "probe"}, done()), "1 new_one") << "the word of a type";
  EXPECT_EQ(spawned({}, done(false)), "4 ") << "the run refuses";
  EXPECT_EQ(spawned({.name = "robot 2"}, done()), "1 robot 2") << "one that left returns";
  EXPECT_EQ(spawned({.name = "", .renaming = true}, done()), "1 scout1");
  EXPECT_EQ(spawned({.name = "scout", .renaming = true}, done()), "1 scout1");
  EXPECT_EQ(spawned({.name = "tag", .renaming = true}, done()), "1 tag1");
  const std::pair<Wanted, const char*> kRefused[] = {
      {{.name = "scout"}, "101 "},
      {{.name = "tag"}, "101 "},
      {{.name = "clock"}, "101 "},  // a topic
      {{.name = ""}, "102 "},
      {{.name = "a b"}, "102 "},
      {{.name = "a b", .renaming = true}, "102 "},
      {{.name = "1a"}, "102 "},
      {{.name = std::string(65, 'a')}, "102 "},
      {{.uri = "robot.sdf"}, "103 "},
      {{.uri = "file:///robot.URDF"}, "103 "},
      {{.uri = "", .text = ""}, "104 "},
      {{.uri = "", .text = "<sdf/>"}, "0 "},
      {{.space = "a/1b"}, "105 "},
      {{.space = "a//b"}, "105 "},
      {{.space = "/fleet"}, "0 "},
      {{.uri = "missing"}, "2 "},
      {{.frame = "scout"}, "109 "},
      {{.x = NAN}, "109 "},
      {{.x = 1.1e7}, "109 "},
      {{.w = 0.0}, "109 "},
      {{.w = 0.8, .tilt = 0.6}, "109 "},  // robots join level
  };
  for (const auto& [wanted, code] : kRefused) {
    EXPECT_EQ(spawned(wanted), code) << wanted.name << wanted.uri << wanted.space;
    EXPECT_TRUE(asked.joining.empty());
  }
}

/// Each has its own result, and their names are unique.
TEST_F(WorldServicesTest, SpawnsSeveral) {
  const auto several = [&](std::size_t count, bool good) {
    Reply reply(ask(
        "/spawn_entities",
        [&](record::CdrWriter& cdr) {
          cdr.put_count(count);
          for (std::size_t i = 0; i < count; ++i) put(cdr, {.name = i == 0 ? "one" : "two"});
        },
        done(good)));
    std::string text = reply.result();
    for (std::uint32_t left = reply.cdr.get_count(10); left > 0; --left) {
      text += ", " + std::to_string(reply.cdr.get<std::uint8_t>());
      reply.cdr.get_string();
      text += " " + reply.cdr.get_string();
    }
    return text;
  };
  EXPECT_EQ(several(2, true), "1 , 1 one, 1 two");
  EXPECT_EQ(several(3, true), "150 see the results, 1 one, 1 two, 101 ");
  EXPECT_EQ(several(2, false), "150 see the results, 4 , 4 ");
  EXPECT_EQ(several(0, true), "1 ");
}

/// Further ones are refused while 64 are waiting.
TEST_F(WorldServicesTest, WaitingRobotsAreBounded) {
  Reply many(ask(
      "/spawn_entities",
      [&](record::CdrWriter& cdr) {
        cdr.put_count(66);
        for (int i = 0; i < 66; ++i) put(cdr, {.name = "late" + std::to_string(i)});
      },
      [&] {
        EXPECT_EQ(asked.joining.size(), 64u);
        for (const Joining& each : asked.joining) each.outcome->done = true;
        step(false)();
      }));
  EXPECT_EQ(many.result(), "150 see the results");
  std::string codes;
  for (std::uint32_t left = many.cdr.get_count(10); left > 0; --left) {
    codes += std::to_string(many.cdr.get<std::uint8_t>());
    many.cdr.get_string(), many.cdr.get_string();
  }
  EXPECT_EQ(codes, std::string(64, '1') + "44");
}

TEST_F(WorldServicesTest, DeletesEntities) {
  EXPECT_EQ(result("/delete_entity", text("missing")), "2 no entity of that name is present");
  EXPECT_EQ(result("/delete_entity", text("robot_2")), "2 no entity of that name is present");
  EXPECT_EQ(result("/delete_entity", text("scout"), done(false)), "4 no room");
  EXPECT_EQ(result("/delete_entity", text("scout"),
                   [&] {
                     *asked.leaving.at(0).outcome = {true};
                     look(false)();
                   }),
            "1 ");
  EXPECT_EQ(asked.leaving[0].mover, 0u);
  Reply left(ask("/get_entities", [](record::CdrWriter& cdr) {
    cdr.put("");
    for (int i = 0; i < 2; ++i) cdr.put_count(0);
    cdr.put(std::uint8_t{0});
    cdr.put(std::uint8_t{0});
    cdr.put_count(0);
  }));
  EXPECT_EQ(left.result(), "1 ");
  EXPECT_EQ(left.names(), "tag ");
}

/// Only files in folders of worlds can be named.
TEST_F(WorldServicesTest, LoadsOnlyListedWorlds) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / "world_services";
  fs::remove_all(folder);
  fs::create_directories(folder / "maps");
  for (const char* file : {"a.world", "maps/b.yaml", "c.txt", "../secret.world"}) std::ofstream(folder / file) << "";
  std::error_code ignored;
  fs::create_symlink(folder / "../secret.world", folder / "link.world", ignored);
  std::destroy_at(&services);
  std::construct_at(&services, Scene{world, sensor_set, info, true, {folder.string()}});
  const Fields all = [](record::CdrWriter& cdr) {
    cdr.put_count(0);
    cdr.put_count(0);
    cdr.put(std::uint8_t{0});
    cdr.put(true);
    cdr.put(false);
  };
  Reply list(ask("/get_available_worlds", all));
  EXPECT_EQ(list.result(), "1 ");
  std::string uris;
  for (std::uint32_t left = list.cdr.get_count(20); left > 0; --left) {
    list.cdr.get_string();
    uris += list.cdr.get_string() + " ";
    list.cdr.get_string(), list.cdr.get_string();
    EXPECT_EQ(list.cdr.get_count(5), 0u);
  }
  EXPECT_EQ(uris, "a.world maps/b.yaml ");

  const auto load = [&](
                        const std::string& uri, const std::string& text, const std::function<void()>& then = [] {}) {
    Reply reply(ask(
        "/load_world",
        [&](record::CdrWriter& cdr) {
          cdr.put(uri);
          cdr.put(text);
          cdr.put(false);
          cdr.put(false);
        },
        then));
    const std::string result = reply.result();
    for (int i = 0; i < 4; ++i) reply.cdr.get_string();
    EXPECT_EQ(reply.cdr.get_count(5), 0u);
    return result.substr(0, result.find(' '));
  };
  EXPECT_EQ(load("", ""), "102");
  EXPECT_EQ(load("", "model( )"), "0");
  EXPECT_EQ(load("c.txt", ""), "101");
  for (const char* uri : {"../secret.world", "link.world", "/etc/x.world", "b.yaml"}) EXPECT_EQ(load(uri, ""), "2");
  EXPECT_FALSE(asked.world);
  const auto answer = [&](Outcome::Fault fault) {
    return [this, fault] {
      *asked.world->outcome = {true, fault, "why"};
      look(true, 1)();
    };
  };
  EXPECT_EQ(load("a.world", "", answer(Outcome::Fault::unreadable)), "103");
  EXPECT_EQ(load("a.world", "", answer(Outcome::Fault::unsupported)), "106");
  EXPECT_EQ(load("a.world", "", answer(Outcome::Fault::failed)), "4");
  EXPECT_EQ(load("a.world", "", answer(Outcome::Fault::none)), "1");
  EXPECT_EQ(fs::path(asked.world->file), folder / "a.world");
  Reply present(ask("/get_simulation_state"));
  EXPECT_EQ(present.cdr.get<std::uint8_t>(), 0) << "stopped";
  EXPECT_EQ(present.result(), "1 ");
}

TEST_F(WorldServicesTest, TheWorldCanBeUnloadedOnce) {
  const auto current = [&] {
    Reply reply(ask("/get_current_world"));
    const std::string result = reply.result();
    for (int i = 0; i < 4; ++i) reply.cdr.get_string();
    reply.cdr.get_count(5);
    return result;
  };
  EXPECT_EQ(current(), "1 ");
  EXPECT_EQ(result(
                "/unload_world", [](auto&) {}, done()),
            "1 ");
  EXPECT_EQ(asked.world->file, "");
  EXPECT_EQ(current(), "101 no world is loaded");
  EXPECT_EQ(result("/unload_world"), "101 no world is loaded");
}

struct StepsActionTest : WorldServicesTest {
  static Fields goal(std::uint8_t id, std::uint64_t steps) {
    return [=](record::CdrWriter& cdr) {
      for (int i = 0; i < 16; ++i) cdr.put(i == 0 ? id : std::uint8_t{0});
      cdr.put(steps);
    };
  }
  bool send(std::uint8_t id, std::uint64_t steps) {
    Reply reply(ask("/simulate_steps/_action/send_goal", goal(id, steps)));
    const bool accepted = reply.cdr.get<bool>();
    EXPECT_EQ(reply.cdr.get<std::int32_t>(), 0);
    EXPECT_EQ(reply.cdr.get<std::uint32_t>(), 250'000'000u);
    return accepted;
  }
  /// Returns status, code and text.
  std::string ended(
      std::uint8_t id, const std::function<void()>& then = [] {}) {
    Reply reply(ask(
        "/simulate_steps/_action/get_result",
        [=](record::CdrWriter& cdr) {
          for (int i = 0; i < 16; ++i) cdr.put(i == 0 ? id : std::uint8_t{0});
        },
        then));
    const int status = reply.cdr.get<std::int8_t>();
    return std::to_string(status) + " " + reply.result();
  }
  /// Returns code and number of goals.
  std::string cancel(std::uint8_t id) {
    Reply reply(ask("/simulate_steps/_action/cancel_goal", [=](record::CdrWriter& cdr) {
      for (int i = 0; i < 16; ++i) cdr.put(i == 0 ? id : std::uint8_t{0});
      cdr.put(std::int32_t{0});
      cdr.put(std::uint32_t{0});
    }));
    const int code = reply.cdr.get<std::int8_t>();
    const std::uint32_t count = reply.cdr.get_count(24);
    for (std::uint32_t i = 0; i < 24 * count; ++i) reply.cdr.get<std::uint8_t>();
    return std::to_string(code) + " " + std::to_string(count);
  }
  /// Returns steps done and left, from all feedback since the last call.
  std::string feedback() {
    std::string text;
    for (const ActionMessage& message : services.messages()) {
      if (message.topic != 0) continue;
      record::CdrReader cdr(message.bytes);
      for (int i = 0; i < 16; ++i) cdr.get<std::uint8_t>();
      const auto completed = cdr.get<std::uint64_t>(), left = cdr.get<std::uint64_t>();
      EXPECT_TRUE(cdr.good() && cdr.left() == 0);
      text += std::to_string(completed) + "/" + std::to_string(left) + " ";
    }
    return text;
  }
};

TEST_F(StepsActionTest, EveryGoalEnds) {
  EXPECT_TRUE(send(1, 3));
  EXPECT_EQ(ended(1), "6 4 the run is not paused");
  look(true)();
  EXPECT_FALSE(send(1, 3)) << "the id is known";
  for (const std::uint64_t steps : {0ull, 1'000'001ull, 1ull << 32}) {
    const auto id = static_cast<std::uint8_t>(10 + steps % 7);
    EXPECT_TRUE(send(id, steps));
    EXPECT_EQ(ended(id), "6 4 expected 1 to 1000000 steps");
    EXPECT_EQ(asked.steps, 0u);
  }
  feedback();
  EXPECT_TRUE(send(2, 2));
  EXPECT_EQ(asked.steps, 2u);
  step(true)();
  EXPECT_EQ(feedback(), "1/1 ");
  EXPECT_EQ(ended(2, step(true)), "4 1 ") << "the result waits for the last step";
  EXPECT_EQ(feedback(), "2/0 ");
  EXPECT_EQ(ended(2), "4 1 ") << "it can be requested again";
  EXPECT_EQ(ended(99), "0 0 ") << "unknown";
  EXPECT_TRUE(send(3, 5));
  EXPECT_EQ(ended(3, look(false)), "6 4 the run continued or restarted");
}

TEST_F(StepsActionTest, GoalsAreCanceled) {
  look(true)();
  EXPECT_EQ(cancel(1), "2 0") << "unknown";
  EXPECT_EQ(cancel(0), "1 0") << "no goal exists";
  EXPECT_TRUE(send(1, 5) && send(2, 7) && send(3, 1));
  step(true)();
  EXPECT_EQ(cancel(1), "0 1");
  EXPECT_EQ(asked.dropped_steps, 4u);
  EXPECT_EQ(ended(1), "5 4 canceled");
  EXPECT_EQ(cancel(1), "3 0") << "it has ended";
  EXPECT_EQ(cancel(0), "0 2") << "all that are left";
  EXPECT_EQ(asked.dropped_steps, 8u);
  EXPECT_EQ(ended(3), "5 4 canceled");
}

/// Goals are bounded, and late clients read the status of all that are kept.
TEST_F(StepsActionTest, GoalsAreBounded) {
  look(true)();
  for (std::uint8_t id = 1; id <= 16; ++id) EXPECT_TRUE(send(id, 1));
  EXPECT_FALSE(send(17, 1));
  for (int i = 0; i < 16; ++i) step(true)();
  for (std::uint8_t id = 20; id < 120; ++id) {
    EXPECT_TRUE(send(id, 1));
    step(true)();
  }
  EXPECT_EQ(ended(1), "0 0 ") << "forgotten";
  EXPECT_EQ(ended(119), "4 1 ");
  const std::vector<ActionMessage> messages = services.messages();
  ASSERT_FALSE(messages.empty());
  EXPECT_EQ(messages.back().topic, 1u);
  record::CdrReader cdr(messages.back().bytes);
  EXPECT_EQ(cdr.get_count(25), 64u);
}

/// Requests cut at any byte are dropped and have no effect.
TEST_F(WorldServicesTest, TruncatedRequestsAreDropped) {
  base::Bytes whole;
  record::CdrWriter cdr(whole);
  cdr.put(std::uint64_t{17});
  cdr.put(std::int64_t{7});
  put(cdr, {});
  const auto types = services.types();
  const auto row = std::find_if(types.begin(), types.end(), [](const auto& t) { return t.name == "/spawn_entity"; });
  for (std::size_t size = 0; size < whole.size(); ++size) {
    Requests requests;
    EXPECT_FALSE(
        services.take(static_cast<std::size_t>(row - types.begin()), std::span(whole).first(size), 1, requests));
    EXPECT_TRUE(requests.joining.empty());
  }
  EXPECT_TRUE(services.answers().empty());
}

}  // namespace
}  // namespace sf::bridges
