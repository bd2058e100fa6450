#include "control/model_controllers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "control/controllers.h"
#include "control/own_controllers.h"
#include "tests/refusal.h"
#include "tests/robots/scenes.h"

namespace sf::control {
namespace {

using sensorfarm::Model;
using sensorfarm::ModelContact;

const std::string kModelPlugin = SF_BINARY_DIR "/test_plugin.so";

/// What all scripted controllers do in the current test; the model's row is in `site`.
struct ModelScript {
  std::function<void(const sensorfarm::ModelSite&, Model&)> tick = [](const auto&, Model&) {};
  std::function<void(const ModelContact&, Model&)> contact = [](const ModelContact&, Model&) {};
  double range = 0.0;
};
ModelScript model_script;

struct ScriptedModel : sensorfarm::ModelController {
  explicit ScriptedModel(sensorfarm::ModelSite made) : site(std::move(made)) {}
  void tick(Model& model) override { model_script.tick(site, model); }
  void contact(const ModelContact& contact, Model& model) override { model_script.contact(contact, model); }
  double range() const override { return model_script.range; }
  sensorfarm::ModelSite site;
};

/// Once per process: another test may have loaded a plug-in with model controllers before.
bool add_scripted() {
  add_own_model_controller({"scripted", "",
                            [](const sensorfarm::ModelSite& site, sensorfarm::Settings& settings) {
                              settings.number("speed", 1.0, 0.0, 2.0);
                              return std::make_unique<ScriptedModel>(site);
                            }},
                           "test");
  return true;
}

/// A robot (row 0), and two objects with scripted controllers (rows 1 and 2), in a row along x.
class ModelControllersTest : public ::testing::Test {
 protected:
  ModelControllersTest() : world_(scenes::empty_world()) {
    model_script = {};
    static const bool added = add_scripted();
    static_cast<void>(added);
    for (int k = 0; k < 3; ++k) scenes::add_mover(world_, {1.0 * k, 0, 0, 0}, scenes::rectangle({}, 0.4, 0.4));
    world_.movers[0].name = "r0";
    for (const std::uint32_t row : {1u, 2u}) {
      world_.movers[row].name = row == 1 ? "door" : "lift";
      world_.movers[row].is_tag = true;
      world_.movers[row].controller = "scripted";
      world_.movers[row].controller_at = "a.world:7: ";
    }
  }

  ModelControllers made() { return {world_, controlled_models(world_), {.seed = 5, .interval = 0.1}}; }
  std::string refused() {
    return refusal_of([&] { made(); });
  }
  std::span<const ModelControllers::Change> call(ModelControllers& models, const robots::Fleet& fleet) {
    return models.call({1'000'000'000, fleet.reports(), absent_, fleet});
  }

  world::World world_;
  std::vector<bool> absent_ = std::vector<bool>(3, false);
};

TEST_F(ModelControllersTest, CallsInOrderOfRowsWithTheStatesOfTheTick) {
  ModelControllers models = made();
  robots::Fleet fleet(world_);
  std::vector<std::string> calls;
  model_script.tick = [&](const sensorfarm::ModelSite& site, Model& model) {
    calls.push_back(site.name);
    EXPECT_EQ(model.time(), 1.0);
    EXPECT_EQ(model.pose().x, 1.0 * site.row);
    EXPECT_TRUE(model.present());
    if (site.row == 1) model.set_pose({5, 6, 0, 1}), model.set_velocity({0.3});
    if (site.row == 2) model.set_velocity({0.1}), model.set_present(false);
    EXPECT_EQ(model.pose().x, 1.0 * site.row) << "until the end of the tick";
  };
  const auto changes = call(models, fleet);
  EXPECT_EQ(calls, (std::vector<std::string>{"door", "lift"}));
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[0].X_WM->y, 6.0);
  EXPECT_EQ(changes[0].velocity->forward, 0.3);
  EXPECT_FALSE(changes[0].present.has_value());
  EXPECT_EQ(changes[1].present, false);
  EXPECT_EQ(changes[1].velocity->forward, 0.0) << "at rest where it returns";
  model_script.tick = [](const auto&, Model&) {};
  EXPECT_EQ(call(models, fleet)[0].velocity->forward, 0.3) << "until it is set again";
  EXPECT_FALSE(call(models, fleet)[0].X_WM.has_value());
  EXPECT_TRUE(models.remove(1));
  EXPECT_FALSE(models.remove(1)) << "once";
  ASSERT_EQ(call(models, fleet).size(), 1u);
  EXPECT_EQ(call(models, fleet)[0].mover, 2u);
}

/// The lift (row 2) moves the door (row 1), which has a controller, and a box, which has none.
TEST_F(ModelControllersTest, ReachesOtherObjectsByName) {
  scenes::add_mover(world_, {7, 0, 0, 0}, scenes::rectangle({}, 0.1, 0.1));
  world_.movers[3].name = "box";
  world_.movers[3].is_tag = true;
  absent_.resize(4);
  ModelControllers models = made();
  robots::Fleet fleet(world_);
  model_script.tick = [](const sensorfarm::ModelSite& site, Model& model) {
    if (site.row == 1) return model.set_velocity({0.1});
    EXPECT_EQ(model.object("box").pose().x, 7.0);
    EXPECT_EQ(model.object("lift").pose().x, 2.0) << "itself";
    model.object("door").set_velocity({0.4});
  };
  auto changes = call(models, fleet);
  ASSERT_EQ(changes.size(), 2u) << "the box is read, but not changed";
  EXPECT_EQ(changes[0].velocity->forward, 0.4) << "the later row's value counts";

  model_script.tick = [](const sensorfarm::ModelSite& site, Model& model) {
    if (site.row == 1) model.object("box").set_pose({8, 0, 0, 0});
    if (site.row == 2) model.object("box").set_velocity({0.2}), model.object("box").set_present(false);
  };
  changes = call(models, fleet);
  ASSERT_EQ(changes.size(), 3u);
  EXPECT_EQ(changes[2].mover, 3u);
  EXPECT_EQ(changes[2].X_WM->x, 8.0);
  EXPECT_EQ(changes[2].present, false);
  EXPECT_EQ(changes[2].velocity->forward, 0.0) << "at rest where it returns";

  model_script.tick = [](const sensorfarm::ModelSite&, Model& model) {
    EXPECT_FALSE(model.object("box").changeable());
    EXPECT_TRUE(model.object("door").changeable());
    model.object("box").set_pose({9, 0, 0, 0});
  };
  EXPECT_FALSE(models.remove(3)) << "it has no controller";
  EXPECT_EQ(call(models, fleet).size(), 2u) << "others move it";

  const auto failure = [&](const char* name) {
    model_script.tick = [name](const auto&, Model& model) { model.object(name); };
    return refusal_of([&] { call(models, fleet); });
  };
  expect_in("there is no object 'bok' that moves; did you mean 'box'? Expected a model named tag<N>", failure("bok"));
  expect_in("'r0' is a robot; expected an object", failure("r0"));
}

TEST_F(ModelControllersTest, RobotsInRangeAreSortedAndBounded) {
  model_script.range = 2.0;
  for (std::size_t k = 0; k < sensorfarm::kMostNearRobots + 3; ++k)
    scenes::add_mover(world_, {1.0, 1.9, 0, 0}, scenes::rectangle({}, 0.1, 0.1));
  scenes::add_mover(world_, {1.0, -2.1, 0, 0}, scenes::rectangle({}, 0.1, 0.1));
  absent_.resize(world_.movers.size());
  absent_[4] = true;
  ModelControllers models = made();
  robots::Fleet fleet(world_);
  model_script.tick = [&](const sensorfarm::ModelSite& site, Model& model) {
    if (site.row != 1) return;
    ASSERT_EQ(model.robots().size(), sensorfarm::kMostNearRobots);
    EXPECT_EQ(model.robots()[0].name, "r0");
    EXPECT_EQ(model.robots()[0].distance, 1.0);
    EXPECT_EQ(model.robots()[1].row, 3u) << "not the other object";
    EXPECT_EQ(model.robots()[2].row, 5u) << "not the absent one";
    EXPECT_EQ(model.robots()[1023].row, 1026u);
  };
  call(models, fleet);
}

TEST_F(ModelControllersTest, AContactIsReportedWhenItBegins) {
  ModelControllers models = made();
  robots::Fleet fleet(world_);
  std::vector<std::string> with;
  model_script.contact = [&](const ModelContact& contact, Model& model) {
    with.push_back(std::string(contact.name) + (contact.robot ? " robot" : ""));
    EXPECT_EQ(contact.row, 0u);
    EXPECT_NEAR(contact.x, 0.8, 0.21);
    EXPECT_EQ(model.time(), 1.0);
  };
  const auto robot_at = [&](double x) {
    const base::Report report{0, 0, {x, 0, 0, 0}, {}};
    fleet.apply({&report, 1});
    call(models, fleet);
  };
  world_.models[world_.movers[0].model].name = "r0";
  robot_at(0.0);
  EXPECT_EQ(with.size(), 0u);
  robot_at(0.6), robot_at(0.61);
  EXPECT_EQ(with, std::vector<std::string>{"r0 robot"});
  robot_at(0.5), robot_at(0.6);
  EXPECT_EQ(with.size(), 2u) << "after an end";
  absent_[1] = true;
  call(models, fleet);
  absent_[1] = false;
  call(models, fleet);
  EXPECT_EQ(with.size(), 3u) << "an absent model touches nothing";
}

/// A model's numbers depend on the seed and its row, not on other models.
TEST_F(ModelControllersTest, RandomNumbersAreTheModelsOwn) {
  std::vector<double> drawn;
  model_script.tick = [&](const sensorfarm::ModelSite& site, Model& model) {
    if (site.row == 2 || drawn.empty()) drawn.push_back(model.uniform());
    if (site.row == 2) drawn.push_back(model.normal());
  };
  robots::Fleet fleet(world_);
  ModelControllers both = made();
  call(both, fleet);
  const std::vector<double> first = drawn;
  ASSERT_EQ(first.size(), 3u);
  EXPECT_NE(first[0], first[1]);
  ModelControllers one = made();
  one.remove(1);
  drawn = {0.0};
  call(one, fleet);
  EXPECT_EQ(drawn[1], first[1]);
  EXPECT_EQ(drawn[2], first[2]);
  call(one, fleet);
  EXPECT_NE(drawn[3], first[1]) << "the next one";
}

TEST_F(ModelControllersTest, FailuresNameTheModel) {
  ModelControllers models = made();
  robots::Fleet fleet(world_);
  const auto failure = [&](std::function<void(Model&)> act) {
    model_script.tick = [act](const auto&, Model& model) { act(model); };
    return refusal_of([&] { call(models, fleet); });
  };
  const std::string who = "controller 'scripted' of model 'door' failed at 1.000 s: ";
  EXPECT_EQ(failure([](Model&) { throw std::runtime_error("it\nis stuck"); }), who + "it is stuck");
  EXPECT_EQ(failure([](Model&) { throw 3; }), who + "it threw something that is not a std::exception");
  expect_in(who + "set_pose(nan, 0, 0, 0): expected finite numbers", failure([](Model& m) { m.set_pose({NAN}); }));
  expect_in(who + "set_pose(20000000, 0, 0, 0)", failure([](Model& m) { m.set_pose({2e7}); }));
  expect_in(who + "set_pose(", failure([](Model& m) { m.set_pose({0, 0, 0, HUGE_VAL}); }));
  expect_in(who + "set_velocity(0, inf, 0)", failure([](Model& m) { m.set_velocity({0, HUGE_VAL}); }));
}

TEST_F(ModelControllersTest, RefusalsNameTheLineOfCtrl) {
  world_.movers[1].controller_settings = {{"sped", "1"}};
  expect_in("a.world:7: controller 'scripted' has no setting 'sped'", refused());
  world_.movers[1].controller_settings = {{"speed", "3"}};
  expect_in("a.world:7: ", refused());
  world_.movers[1].controller_settings.clear();
  model_script.range = 1e4;
  expect_in("a.world:7: controller 'scripted' of model 'door' has a range of 10000 m; expected 0 to 1000", refused());
  model_script.range = 0.0;
  world_.movers[1].controller = "wander";
  expect_in("a.world:7: there is no model controller 'wander'", refused());
  world_.movers[1].controller = kModelPlugin + ":test-straight";
  expect_in("has no model controller 'test-straight'", refused());
  world_.movers[1].controller = kModelPlugin + ":test-shy";
  expect_in("a.world:7: controller 'test-shy' refuses model 'door': not this one", refused());
  world_.movers[1].controller = kModelPlugin + ":test-slide";
  EXPECT_EQ(refused(), "");
}

TEST_F(ModelControllersTest, NamesDifferFromThoseOfAllControllers) {
  const auto add = [](const std::string& name) {
    return refusal_of([&] {
      add_own_model_controller({name, "", [](const auto&, auto&) { return nullptr; }}, "mine.so");
    });
  };
  expect_in("mine.so: a controller 'scripted' already exists", add("scripted"));
  expect_in("mine.so: a controller 'wander' already exists", add("wander"));
  expect_in("cannot be called", add("a b"));
  expect_in("has no function", refusal_of([] { add_own_model_controller({"new", "", {}}, "mine.so"); }));
}

}  // namespace
}  // namespace sf::control
