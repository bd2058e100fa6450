// Reader of scenario files.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <span>

#include "base/error.h"
#include "base/files.h"
#include "base/installation.h"
#include "base/suggest.h"
#include "base/tilted_pose.h"
#include "control/own_controllers.h"
#include "scenarios/fault_tables.h"
#include "scenarios/scenario.h"
#include "world/toml_reader.h"

namespace sf::scenarios {

namespace {

using world::TomlNode;
using NodeKind = TomlNode::Kind;

constexpr double kLongest = 1e9;          // [s]
constexpr double kMostWhole = 9.0e15;     // limit up to which a double represents all whole numbers exactly
constexpr double kMostPosition = 1e7;     // [m]
constexpr double kLongestDelay = 3600.0;  // [s]

constexpr std::array<std::string_view, 19> kKeys{
    "name",    "world",  "duration", "seed", "tick",  "robots", "of",    "place",       "plant", "start_at",
    "default", "states", "v2v",      "link", "robot", "expect", "event", "positioning", "fault"};
constexpr std::array<std::string_view, 7> kEventKeys{"at", "object", "present", "pose", "shape", "color", "size"};
constexpr std::array<std::string_view, 8> kAddKeys{"at",         "add",  "like",     "pose",
                                                   "controller", "rate", "settings", "link"};
constexpr std::array<std::string_view, 2> kRemoveKeys{"at", "remove"};
constexpr std::array<std::string_view, 3> kLaneKeys{"at", "lane", "use"};
constexpr std::array<std::string_view, 3> kDefaultKeys{"controller", "rate", "settings"};
constexpr std::array<std::string_view, 6> kRobotKeys{"name", "controller", "rate", "settings", "link", "pose"};
constexpr std::array<std::string_view, 7> kStatesKeys{"rate",   "delay",          "jitter",   "loss",
                                                      "filter", "position_sigma", "yaw_sigma"};
constexpr std::array<std::string_view, 10> kPositioningKeys{"start",
                                                            "rate",
                                                            "delay",
                                                            "jitter",
                                                            "loss",
                                                            "position_sigma",
                                                            "yaw_sigma",
                                                            "stated_position_sigma",
                                                            "stated_yaw_sigma",
                                                            "outages"};
constexpr std::array<std::string_view, 5> kV2vKeys{"rate", "delay", "jitter", "loss", "forget"};
constexpr std::array<std::string_view, 3> kLinkKeys{"delay", "jitter", "loss"};

using Reader = world::TomlReader;

control::Value value_of(const Reader& reader, const TomlNode& node) {
  const auto all = [&](NodeKind kind) {
    return std::all_of(node.items.begin(), node.items.end(), [&](const TomlNode& item) { return item.kind == kind; });
  };
  if (node.kind == NodeKind::flag) return node.flag;
  if (node.kind == NodeKind::number) return node.number;
  if (node.kind == NodeKind::text) return node.text;
  if (node.kind == NodeKind::list && all(NodeKind::number)) {
    std::vector<double> numbers;
    for (const TomlNode& item : node.items) numbers.push_back(item.number);
    return numbers;
  }
  if (node.kind == NodeKind::list && all(NodeKind::text)) {
    std::vector<std::string> texts;
    for (const TomlNode& item : node.items) texts.push_back(item.text);
    return texts;
  }
  reader.fail(node,
              fmt::format("'{}' expects true, false, a number, a text, or a list of numbers or of texts", node.key));
}

control::Settings settings_of(const Reader& reader, const TomlNode* table, const std::string& controller) {
  std::vector<control::Setting> settings;
  if (table != nullptr)
    for (const TomlNode& node : table->items)
      settings.push_back({node.key, value_of(reader, node),
                          node.line > 0 ? fmt::format("{}:{}: ", reader.file(), node.line) : reader.file() + ": "});
  return {fmt::format("controller '{}'", controller), std::move(settings)};
}

/// Returns a plug-in's file, relative to the scenario's.
std::string plugin_of(const Reader& reader, const TomlNode& node, const std::string& name) {
  const std::string file = (std::filesystem::path(reader.file()).parent_path() / name).string();
  try {
    control::find_controller(file);
  } catch (const base::InputError& error) {
    reader.fail(node, error.what());
  }
  return file;
}

/// Returns the name of the controller; empty for "none".
std::string controller_of(const Reader& reader, const TomlNode& table, const std::string& fallback) {
  const TomlNode* const node = world::find(table, "controller");
  if (node == nullptr) return fallback;
  const std::string name = reader.text(table, "controller", "");
  if (name == "none" || name.empty()) return "";
  if (base::names_a_plugin(name)) return plugin_of(reader, *node, name);
  if (control::find_controller(name) != nullptr) return name;
  std::vector<std::string_view> names{"none"};
  for (const control::ControllerType* type : control::controllers()) names.push_back(type->name);
  reader.fail(*node, fmt::format("there is no controller '{}'{}", name, base::expected_one_of(name, names)));
}

/// If the table has no controller, the fallback's applies. Settings are replaced as a whole, not key by key.
control::ControllerConfig controller_config_of(const Reader& reader, const TomlNode& table,
                                               const control::ControllerConfig& fallback) {
  control::ControllerConfig config = fallback;
  config.name = controller_of(reader, table, fallback.name);
  config.rate = reader.number(table, "rate", config.name == fallback.name ? fallback.rate : 0.0, 0.01, 1e4, "Hz");
  const TomlNode* settings = reader.table(table, "settings");
  if (settings != nullptr || config.name != fallback.name) config.settings = settings_of(reader, settings, config.name);
  return config;
}

netio::LinkModel read_link(const Reader& reader, const TomlNode& table) {
  return {reader.number(table, "delay", 0.0, 0.0, kLongestDelay, "seconds"),
          reader.number(table, "jitter", 0.0, 0.0, kLongestDelay, "seconds"),
          reader.number(table, "loss", 0.0, 0.0, 1.0)};
}

netio::LinkModel link_of(const Reader& reader, const TomlNode* table, const netio::LinkModel& fallback) {
  if (table == nullptr) return fallback;
  reader.require_known(*table, kLinkKeys);
  return read_link(reader, *table);
}

/// Reads the rate and the link of states that robots send. Returns nullopt without the table.
template <class Options>
std::optional<Options> sent_states_of(const Reader& reader, const TomlNode* table,
                                      std::span<const std::string_view> keys) {
  if (table == nullptr) return std::nullopt;
  reader.require_known(*table, keys);
  Options options;
  options.rate = reader.number(*table, "rate", options.rate, 0.01, 1e4, "Hz");
  options.link = read_link(reader, *table);
  return options;
}

std::optional<V2vLinkOptions> v2v_of(const Reader& reader, const TomlNode* table) {
  auto v2v = sent_states_of<V2vLinkOptions>(reader, table, kV2vKeys);
  if (v2v) v2v->forget = reader.number(*table, "forget", v2v->forget, 0.0, kLongestDelay, "seconds");
  return v2v;
}

std::optional<StateLinkOptions> states_of(const Reader& reader, const TomlNode* table) {
  auto states = sent_states_of<StateLinkOptions>(reader, table, kStatesKeys);
  if (!states) return states;
  states->filter = reader.flag(*table, "filter");
  states->position_sigma = reader.number(*table, "position_sigma", 0.0, 0.0, 1.0, "metres");
  states->yaw_sigma = reader.number(*table, "yaw_sigma", 0.0, 0.0, 1.0, "radians");
  return states;
}

PositioningOptions::Outage outage_of(const Reader& reader, const TomlNode& node) {
  if (node.kind != NodeKind::list || node.items.size() != 2)
    reader.fail(node, "'outages' expects a list of intervals [begin, end] in seconds");
  const double begin = reader.number(node.items[0], "outages", 0.0, kLongest);
  return {begin, reader.number(node.items[1], "outages", begin, kLongest)};
}

constexpr double kLeastStatedSigma = 1e-4;  // packets state no less

std::optional<PositioningOptions> positioning_of(const Reader& reader, const TomlNode* table) {
  auto positioning = sent_states_of<PositioningOptions>(reader, table, kPositioningKeys);
  if (!positioning) return positioning;
  const std::string start = reader.text(*table, "start", "known");
  if (start != "known" && start != "unknown")
    reader.fail(*world::find(*table, "start"),
                fmt::format("'start' is '{}'; expected \"known\" or \"unknown\"", start));
  positioning->known_start = start == "known";
  positioning->position_sigma = reader.number(*table, "position_sigma", 0.0, 0.0, 1.0, "metres");
  positioning->yaw_sigma = reader.number(*table, "yaw_sigma", 0.0, 0.0, 1.0, "radians");
  positioning->stated_position_sigma =
      reader.number(*table, "stated_position_sigma", 0.0, kLeastStatedSigma, 1.0, "metres");
  positioning->stated_yaw_sigma = reader.number(*table, "stated_yaw_sigma", 0.0, kLeastStatedSigma, 1.0, "radians");
  if (const TomlNode* outages = world::find(*table, "outages")) {
    if (outages->kind != NodeKind::list)
      reader.fail(*outages, "'outages' expects a list of intervals [begin, end] in seconds");
    for (const TomlNode& node : outages->items) positioning->outages.push_back(outage_of(reader, node));
  }
  return positioning;
}

/// @param with_z z may be stated  @return z is NaN if it is not stated
base::TiltedPose pose_of(const Reader& reader, const TomlNode& node, bool spatial) {
  const std::size_t count = node.items.size();
  if (node.kind != NodeKind::list || (count != 3 && !(spatial && (count == 4 || count == 6))))
    reader.fail(node, fmt::format("'pose' expects [x, y, yaw]{} in metres and degrees",
                                  spatial ? ", [x, y, z, yaw] or [x, y, z, roll, pitch, yaw]" : ""));
  const auto at = [&](std::size_t i, double most) { return reader.number(node.items[i], "pose", -most, most); };
  const auto angle = [&](std::size_t i, double most) { return at(i, most) * M_PI / 180.0; };
  base::TiltedPose pose{
      {at(0, kMostPosition), at(1, kMostPosition), count > 3 ? at(2, kMostPosition) : NAN, angle(count - 1, 1e6)}};
  if (count == 6) pose.tilt = {angle(3, 180.0), angle(4, 90.0)};
  return pose;
}

FleetSpawn crowd_of(const Reader& reader, const TomlNode& root) {
  FleetSpawn fleet;
  fleet.robots = static_cast<std::uint32_t>(reader.whole(root, "robots", 0, 65535.0));
  fleet.of = reader.text(root, "of", "");
  const std::string place = reader.text(root, "place", "free");
  if (place != "free" && place != "lanes")
    reader.fail(*world::find(root, "place"), "'place' expects \"free\" or \"lanes\"");
  fleet.place = place == "lanes" ? FleetSpawn::Placement::lanes : FleetSpawn::Placement::free;
  if (const TomlNode* robots = world::find(root, "robots")) fleet.line = robots->line;
  for (const std::string_view key : {"of", "place"})
    if (const TomlNode* node = world::find(root, key); node != nullptr && fleet.robots == 0)
      reader.fail(*node, fmt::format("'{}' applies to copies, but there are none; expected robots = N as well", key));
  return fleet;
}

void read_robots(const Reader& reader, const TomlNode& root, Scenario& scenario) {
  const TomlNode* list = world::find(root, "robot");
  if (list == nullptr) return;
  if (list->kind != NodeKind::list) reader.fail(*list, "'robot' expects [[robot]] tables");
  std::map<std::string, int> lines;  // line by robot
  for (const TomlNode& node : list->items) {
    if (node.kind != NodeKind::table) reader.fail(node, "'robot' expects [[robot]] tables");
    reader.require_known(node, kRobotKeys);
    RobotSetup setup{.name = reader.text(node, "name", ""), .line = node.line};
    if (setup.name.empty())
      reader.fail(node, "a robot without a name; expected name = \"...\" of a robot of the world");
    const bool sets_actor = std::any_of(node.items.begin(), node.items.end(),
                                        [](const TomlNode& item) { return item.key != "name" && item.key != "pose"; });
    if (sets_actor)
      setup.actor = Actor{controller_config_of(reader, node, scenario.actor.controller),
                          link_of(reader, reader.table(node, "link"), scenario.actor.link)};
    if (const TomlNode* node_of_pose = world::find(node, "pose")) {
      const base::TiltedPose pose = pose_of(reader, *node_of_pose, true);
      setup.pose = pose.X, setup.tilt = pose.tilt;
    }
    const TomlNode* driver = world::find(node, "controller");
    setup.controller_line = driver == nullptr ? node.line : driver->line;
    const auto [other, fresh] = lines.emplace(setup.name, setup.line);
    if (!fresh)
      reader.fail(node, fmt::format("the robot '{}' is already configured at line {}; expected one [[robot]] per robot",
                                    setup.name, other->second));
    scenario.robot_setups.push_back(std::move(setup));
  }
}

/// Key and value range of an expectation.
struct Rule {
  std::string_view key;
  bool is_flag;
  double most;
};
/// By Expectation::Kind.
constexpr Rule kRules[] = {{"no_collision", true, 0.0},  {"contacts", false, 1e9},
                           {"mean_error", false, 1e6},   {"mean_abs_error", false, 1e6},
                           {"map_coverage", false, 1.0}, {"lights_obeyed", true, 0.0},
                           {"done", true, 0.0},          {"distance", false, 1e9},
                           {"checkpoints", false, 1e9},  {"all_checkpoints", false, 1e9},
                           {"tick_p99_ms", false, 1e9}};

/// Reads `key = value`, for the worst of all robots, or `key = { robot = value, ... }`.
void read_expectation(const Reader& reader, const TomlNode& node, Expectation::Kind kind, Scenario& scenario) {
  const Rule& rule = kRules[static_cast<std::size_t>(kind)];
  if (rule.is_flag) {
    if (node.kind != NodeKind::flag || !node.flag) reader.fail(node, fmt::format("'{}' expects true", node.key));
    scenario.expect.push_back({kind, "", 0.0, node.line});
    return;
  }
  if (node.kind != NodeKind::table) {
    scenario.expect.push_back({kind, "", reader.number(node, node.key, 0.0, rule.most), node.line});
    return;
  }
  if (kind == Expectation::Kind::tick_p99 || kind == Expectation::Kind::all_checkpoints)
    reader.fail(node, fmt::format("'{}' expects a number", node.key));
  for (const TomlNode& item : node.items)
    scenario.expect.push_back({kind, item.key, reader.number(item, node.key, 0.0, rule.most), item.line});
}

void read_expectations(const Reader& reader, const TomlNode& root, Scenario& scenario) {
  const TomlNode* table = reader.table(root, "expect");
  if (table == nullptr) return;
  std::vector<std::string_view> keys;
  for (const Rule& rule : kRules) keys.push_back(rule.key);
  reader.require_known(*table, keys);
  for (const TomlNode& node : table->items)
    read_expectation(reader, node, static_cast<Expectation::Kind>(std::ranges::find(keys, node.key) - keys.begin()),
                     scenario);
}

void read_plant(const Reader& reader, const TomlNode& root, Scenario& scenario) {
  const TomlNode* node = world::find(root, "plant");
  if (node == nullptr) return;
  scenario.plant = plant_of(node->text);
  if (!scenario.plant) reader.fail(*node, "'plant' expects \"thesis\" or \"ideal\"");
}

void require_keys(const Reader& reader, const TomlNode& table, std::span<const std::string_view> known,
                  std::span<const std::string_view> needed, const std::string& form) {
  reader.require_known(table, known);
  for (const std::string_view key : needed)
    if (world::find(table, key) == nullptr)
      reader.fail(table, fmt::format("'{}' is missing; an event has {}", key, form));
}

/// A robot that joins has the scenario's controller unless the event names another.
ObjectEvent read_joining(const Reader& reader, const TomlNode& table, const Scenario& scenario) {
  require_keys(reader, table, kAddKeys, std::span(kAddKeys).first(4),
               "at = SECONDS, add = \"NAME\", like = \"ROBOT\" and pose = [x, y, yaw]");
  ObjectEvent event{reader.text(table, "add", ""), reader.number(table, "at", 0.0, 0.0, kLongest, "seconds"), true,
                    table.line, ObjectEvent::Kind::add};
  event.joining = {event.object, reader.text(table, "like", ""), pose_of(reader, *world::find(table, "pose"), false).X,
                   Actor{controller_config_of(reader, table, scenario.actor.controller),
                         link_of(reader, reader.table(table, "link"), scenario.actor.link)}};
  event.joining.actor.link.seed = scenario.seed;
  return event;
}

world::ShapeChange read_shape(const Reader& reader, const TomlNode& table) {
  world::ShapeChange change;
  if (world::find(table, "shape") != nullptr) change.shape = reader.text(table, "shape", "");
  const TomlNode* const color = world::find(table, "color");
  try {
    if (color != nullptr) change.color = world::color_named(reader.text(table, "color", ""));
  } catch (const base::InputError& error) {
    reader.fail(*color, error.what());
  }
  const TomlNode* const size = world::find(table, "size");
  if (size == nullptr) return change;
  const auto is_number = [](const TomlNode& item) { return item.kind == NodeKind::number; };
  if (size->kind != NodeKind::list || size->items.size() != 3 || !std::ranges::all_of(size->items, is_number))
    reader.fail(*size, "'size' expects a list [x, y, z] in metres");
  change.size = glm::dvec3{size->items[0].number, size->items[1].number, size->items[2].number};
  return change;
}

/// Presence, pose and shape of one object are separate events.
void read_object(const Reader& reader, const TomlNode& table, Scenario& scenario) {
  constexpr const char* kForm =
      "at = SECONDS, object = \"NAME\" and present = true or false, pose = [x, y, yaw], shape = \"NAME\", color = "
      "\"NAME\" or size = [x, "
      "y, z]";
  const world::ShapeChange shape = read_shape(reader, table);
  const bool presence = world::find(table, "present") != nullptr;
  const TomlNode* const pose = world::find(table, "pose");
  require_keys(reader, table, kEventKeys,
               std::span(kEventKeys).first(presence || (pose == nullptr && !shape.any()) ? 3 : 2), kForm);
  ObjectEvent event{reader.text(table, "object", ""), reader.number(table, "at", 0.0, 0.0, kLongest, "seconds"),
                    presence && reader.flag(table, "present"), table.line};
  if (presence) scenario.events.push_back(event);
  if (pose != nullptr) {
    event.kind = ObjectEvent::Kind::pose;
    const base::TiltedPose placed = pose_of(reader, *pose, true);
    event.X_WM = placed.X, event.tilt = placed.tilt;
    scenario.events.push_back(event);
  }
  if (!shape.any()) return;
  event.kind = ObjectEvent::Kind::shape;
  event.shape = shape;
  scenario.events.push_back(std::move(event));
}

void read_events(const Reader& reader, const TomlNode& root, Scenario& scenario) {
  for (const TomlNode* table : reader.tables(root, "event")) {
    if (world::find(*table, "add") != nullptr) {
      scenario.events.push_back(read_joining(reader, *table, scenario));
    } else if (world::find(*table, "remove") != nullptr) {
      require_keys(reader, *table, kRemoveKeys, kRemoveKeys, "at = SECONDS and remove = \"NAME\"");
      scenario.events.push_back({reader.text(*table, "remove", ""),
                                 reader.number(*table, "at", 0.0, 0.0, kLongest, "seconds"), false, table->line,
                                 ObjectEvent::Kind::remove});
    } else if (world::find(*table, "lane") != nullptr) {
      require_keys(reader, *table, kLaneKeys, kLaneKeys, "at = SECONDS, lane = \"SEGMENT.LANE\" and use = \"USE\"");
      scenario.events.push_back({reader.text(*table, "lane", ""),
                                 reader.number(*table, "at", 0.0, 0.0, kLongest, "seconds"),
                                 true,
                                 table->line,
                                 ObjectEvent::Kind::lane,
                                 {},
                                 reader.text(*table, "use", "")});
    } else {
      read_object(reader, *table, scenario);
    }
  }
  std::stable_sort(scenario.events.begin(), scenario.events.end(),
                   [](const ObjectEvent& a, const ObjectEvent& b) { return a.at < b.at; });
}

/// Returns a path relative to the scenario's file, else among the installed worlds.
std::string world_file(const Reader& reader, const TomlNode& root) {
  const std::string file = reader.text(root, "world", "");
  if (file.empty()) throw base::InputError(reader.file(), 0, "has no world; expected world = \"FILE\"");
  const std::filesystem::path beside = std::filesystem::path(reader.file()).parent_path() / file;
  const std::string installed = base::installed_file(file);
  return installed != file && !std::filesystem::exists(beside) ? installed : beside.lexically_normal().string();
}

}  // namespace

std::string_view expectation_kind_name(Expectation::Kind kind) { return kRules[static_cast<std::size_t>(kind)].key; }

std::string_view plant_name(Plant plant) { return plant == Plant::ideal ? "ideal" : "thesis"; }

std::optional<Plant> plant_of(std::string_view name) {
  if (name == "ideal") return Plant::ideal;
  if (name == "thesis") return Plant::thesis;
  return std::nullopt;
}

Scenario parse_scenario(const std::string& file, std::string_view text) {
  return parse_scenario(file, world::parse_toml(file, text));
}

Scenario parse_scenario(const std::string& file, const TomlNode& root) {
  const Reader reader(file);
  reader.require_kind(root, "a scenario");
  reader.require_known(root, kKeys);
  Scenario scenario{.file = file};
  scenario.name = reader.text(root, "name", std::filesystem::path(file).stem().string());
  scenario.world = world_file(reader, root);
  scenario.world_line = world::find(root, "world")->line;
  scenario.duration = reader.number(root, "duration", scenario.duration, 0.0, kLongest, "seconds");
  if (const TomlNode* duration = world::find(root, "duration")) scenario.duration_line = duration->line;
  scenario.seed = reader.whole(root, "seed", scenario.seed, kMostWhole);
  if (world::find(root, "tick") != nullptr) scenario.tick = reader.number(root, "tick", 0.0, 1e-3, 10.0, "seconds");
  scenario.fleet = crowd_of(reader, root);
  scenario.start_at = reader.number(root, "start_at", 0.0, 0.0, kLongest, "seconds");
  read_plant(reader, root, scenario);
  scenario.states = states_of(reader, reader.table(root, "states"));
  scenario.positioning = positioning_of(reader, reader.table(root, "positioning"));
  scenario.v2v = v2v_of(reader, reader.table(root, "v2v"));
  scenario.actor.link = link_of(reader, reader.table(root, "link"), {});
  if (const TomlNode* table = reader.table(root, "default")) {
    reader.require_known(*table, kDefaultKeys);
    scenario.actor.controller = controller_config_of(reader, *table, scenario.actor.controller);
    const TomlNode* driver = world::find(*table, "controller");
    scenario.default_line = driver == nullptr ? table->line : driver->line;
  }
  read_robots(reader, root, scenario);
  read_expectations(reader, root, scenario);
  read_events(reader, root, scenario);
  scenario.faults = read_faults(reader, root);
  return scenario;
}

PositioningOptions parse_positioning(const std::string& file, std::string_view text) {
  const TomlNode root = world::parse_toml(file, text);
  return positioning_of(Reader(file), &root).value();
}

Scenario read_scenario(const std::string& file) {
  for (const char* ending : {".world", ".yaml", ".yml"})
    if (file.ends_with(ending))
      throw base::InputError(file, 0, "is a world; expected a scenario (.toml), which names it: world = \"FILE\"");
  return parse_scenario(file, base::read_text(file));
}

}  // namespace sf::scenarios
