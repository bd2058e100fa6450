#include "bridges/world_services.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>

#include "base/elementary.h"
#include "base/error.h"
#include "bridges/ros_entities.h"
#include "world/append_robot.h"

namespace sf::bridges {

using record::CdrReader;
using record::CdrWriter;

namespace {

namespace fs = std::filesystem;

// simulation_interfaces/msg/EntityCategory and Bounds
constexpr std::uint8_t kRobotCategory = 1, kDynamicObject = 4, kEmpty = 0, kBox = 1;
constexpr std::size_t kLeastText = 5;        // [byte] of a string
constexpr std::size_t kMostVisited = 5'000;  // maximum number of files visited in folders of worlds

void put_texts(CdrWriter& cdr, const std::vector<std::string>& texts) {
  cdr.put_count(texts.size());
  for (const std::string& text : texts) cdr.put(text);
}

void put_pose_of_place(CdrWriter& cdr, const base::Pose& X) {
  for (const double value : {X.x, X.y, X.z, 0.0, 0.0, base::sin(0.5 * X.yaw), base::cos(0.5 * X.yaw)}) cdr.put(value);
}

std::string described(const Scene& scene, std::uint32_t row) {
  const world::Mover& mover = scene.world.movers[row];
  std::map<std::string, int> sensors;
  for (const world::Sensor& sensor : mover.sensors) ++sensors[sensor.type];
  std::string text = mover.model < scene.world.models.size() ? scene.world.models[mover.model].type : "";
  for (const auto& [type, count] : sensors) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, type);
  return text;
}

/// Returns a name built from the letters of `like` that no model, topic or earlier request uses.
std::string free_name(const std::string& like, const Scene& scene, const std::set<std::string>& taken) {
  std::string stem = like.substr(0, std::min<std::size_t>(like.find_last_not_of("0123456789") + 1, 40));
  for (char& c : stem) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  if (stem.empty() || std::isdigit(static_cast<unsigned char>(stem[0])) != 0) stem = "robot";
  std::set<std::string> names = taken;
  for (const world::Model& model : scene.world.models) names.insert(model.name);
  for (const record::MoverInfo& mover : scene.info.movers) names.insert(mover.frame);
  std::size_t number = 1;
  while (names.contains(stem + std::to_string(number))) ++number;
  return stem + std::to_string(number);
}

bool is_removed(const std::string& name, std::uint32_t like, const Scene& scene,
                const std::vector<base::Report>& movers) {
  for (std::uint32_t row = 0; row < movers.size(); ++row)
    if (scene.world.movers[row].name == name)
      return base::is_absent(movers[row].X_WM) && world::is_same_kind(scene.world, row, like);
  return false;
}

/// Returns whether a name is that of a topic, or its frame belongs to another mover.
bool is_reserved(const std::string& name, const Scene& scene) {
  static const std::set<std::string> kTopics = {"world", "run",    "fleet",     "clock",  "map",       "walls",
                                                "tf",    "bodies", "tf_static", "lights", "sensorfarm"};
  return kTopics.contains(name) || std::any_of(scene.info.movers.begin(), scene.info.movers.end(),
                                               [&](const record::MoverInfo& m) { return m.frame == name; });
}

/// Returns whether the text has the form [/]name[/name ...] that ROS accepts.
bool is_namespace(std::string_view text) {
  if (text.starts_with('/')) text.remove_prefix(1);
  bool begins = true;
  for (const char c : text) {
    const bool letter = std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
    const bool digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
    if (begins ? !letter : !letter && !digit && c != '/') return false;
    begins = c == '/';
  }
  return !begins;
}

std::string lower_extension(const fs::path& path) {
  std::string text = path.extension().string();
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool is_model_file(const std::string& uri) {
  static const std::set<std::string> kFiles = {".sdf", ".urdf", ".xacro", ".usd", ".usda", ".usdz", ".xml", ".world"};
  return kFiles.contains(lower_extension(uri));
}

}  // namespace

bool TagsFilter::matches(const std::vector<std::string>& of) const {
  const auto has = [&](const std::string& tag) { return std::find(of.begin(), of.end(), tag) != of.end(); };
  if (tags.empty()) return true;
  return all ? std::all_of(tags.begin(), tags.end(), has) : std::any_of(tags.begin(), tags.end(), has);
}

TagsFilter get_tags_filter(CdrReader& cdr) {
  TagsFilter filter;
  for (std::uint32_t left = cdr.get_count(kLeastText); left > 0 && cdr.good(); --left)
    filter.tags.insert(cdr.get_string());
  filter.all = cdr.get<std::uint8_t>() == 1;
  return filter;
}

void put_entity_info(CdrWriter& cdr, const Scene& scene, std::uint32_t row) {
  cdr.put(scene.world.movers[row].is_tag ? kDynamicObject : kRobotCategory);
  cdr.put(described(scene, row));
  cdr.put_count(0);
}

void put_bounds(CdrWriter& cdr, const Scene& scene, std::uint32_t row) {
  const std::vector<world::Segment> none;
  const auto& body = row < scene.world.movers.size() ? scene.world.movers[row].body : none;
  cdr.put(body.empty() ? kEmpty : kBox);
  cdr.put_count(body.empty() ? 0 : 2);
  if (body.empty()) return;
  glm::dvec3 low{HUGE_VAL}, high{-HUGE_VAL};
  for (const world::Segment& side : body)
    for (const glm::dvec2& p : {side.a, side.b}) {
      low = glm::min(low, glm::dvec3(p, side.z_min));
      high = glm::max(high, glm::dvec3(p, side.z_max));
    }
  for (const glm::dvec3& corner : {high, low})
    for (const double value : {corner.x, corner.y, corner.z}) cdr.put(value);
}

std::vector<NamedPose> named_poses_of(const Scene& scene) {
  std::vector<NamedPose> poses;
  for (std::uint32_t row = 0; row < scene.world.movers.size(); ++row) {
    const world::Mover& mover = scene.world.movers[row];
    if (!mover.is_tag && !base::is_absent(mover.X_WM))
      poses.push_back({"start_" + scene.info.movers[row].frame,
                       "where " + mover.name + " starts",
                       {"spawn", "start"},
                       mover.X_WM,
                       row});
  }
  for (const world::Emitter& dock : scene.world.emitters)
    if (dock.kind == world::Emitter::Kind::dock)
      poses.push_back({"dock_" + scene.world.models[dock.model].name, "a dock's beam", {"dock"}, dock.X_WE});
  for (const world::Path& path : scene.world.paths)
    poses.push_back({"path_" + path.name, "the start of a path", {"path"}, path.pieces.front().X_WP});
  return poses;
}

void put_named_pose(CdrWriter& cdr, const NamedPose& pose) {
  cdr.put(pose.name);
  cdr.put(pose.description);
  put_texts(cdr, pose.tags);
  put_pose_of_place(cdr, pose.X_W);
}

std::vector<std::uint32_t> kinds_of(const world::World& world) {
  std::vector<std::uint32_t> kinds;
  for (std::uint32_t row = 0; row < world.movers.size() && kinds.size() < kMostKinds; ++row) {
    const auto same = [&](std::uint32_t other) { return world::is_same_kind(world, other, row); };
    if (!world.movers[row].is_tag && std::none_of(kinds.begin(), kinds.end(), same)) kinds.push_back(row);
  }
  return kinds;
}

void put_spawnable(CdrWriter& cdr, const Scene& scene, std::uint32_t row) {
  cdr.put(scene.world.movers[row].name);
  cdr.put("");
  cdr.put(described(scene, row));
  put_bounds(cdr, scene, row);
}

Spawn get_spawn(CdrReader& cdr, const Scene& scene, const std::vector<base::Report>& movers,
                std::set<std::string>& taken) {
  const std::string name = cdr.get_string();
  const bool renaming = cdr.get<bool>();
  const std::string uri = cdr.get_string(), text = cdr.get_string(), space = cdr.get_string();
  const EntityState pose = get_stamped_pose(cdr);
  const auto refused = [](std::uint8_t code, const std::string& why) { return Spawn{code, why, {}}; };
  if (uri.empty() && text.empty()) return refused(kNoResource, "expected a URI that /get_spawnables lists");
  if (uri.empty())
    return refused(kUnsupported, "robots are spawned by a URI that /get_spawnables lists, not from text");
  if (!is_namespace(space) && !space.empty()) return refused(kNamespaceInvalid, "expected names separated by '/'");
  if (!space.empty())
    return refused(kUnsupported, "an entity's topics are in the namespace of its name; expected no other");
  std::uint32_t like = 0;
  try {
    like = world::robot_like(scene.world, uri);
  } catch (const base::InputError& error) {
    if (is_model_file(uri)) return refused(kUnsupportedFormat, "files cannot be spawned: see /get_spawnables");
    return refused(kNotFound, error.what());
  }
  if (!pose.frame.empty() && pose.frame != "world") return refused(kPoseInvalid, "poses are in the frame \"world\"");
  constexpr double kLevel = 2e-3;  // [rad] rounded quaternions
  if (!pose.valid || !(base::hypot(pose.tilt.roll, pose.tilt.pitch) <= kLevel))
    return refused(kPoseInvalid, "expected a finite position, and a turn about z of length 1: robots join level");

  Spawn spawn;
  spawn.joining = {name, uri, pose.X_WM, std::make_shared<Outcome>()};
  std::string& chosen = spawn.joining.name;
  if (name.empty()) {
    if (!renaming) return refused(kNameInvalid, "a name is required unless renaming is allowed");
    chosen = free_name(uri, scene, taken);
  }
  const bool returns = is_removed(chosen, like, scene, movers) && !taken.contains(chosen);
  if (!returns && !world::is_robot_name(chosen)) return refused(kNameInvalid, world::kNameRule);
  const bool unique = !taken.contains(chosen) && !is_reserved(chosen, scene) &&
                      std::none_of(scene.world.models.begin(), scene.world.models.end(),
                                   [&](const world::Model& model) { return model.name == chosen; });
  if (!returns && !unique) {
    if (!renaming) return refused(kNameTaken, fmt::format("the name '{}' is taken", chosen));
    chosen = free_name(chosen, scene, taken);
  }
  taken.insert(chosen);
  return spawn;
}

std::vector<AvailableWorld> worlds_in(const std::vector<std::string>& folders) {
  std::map<std::string, std::string> found;
  std::size_t visited = 0;
  for (const std::string& folder : folders) {
    std::error_code error;
    for (fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error), end;
         !error && at != end && ++visited < kMostVisited && found.size() < kMostWorlds; at.increment(error)) {
      if (at.depth() > 2) at.disable_recursion_pending();
      const std::string kind = lower_extension(at->path());
      if ((kind != ".world" && kind != ".yaml") || !at->is_regular_file(error) || at->is_symlink(error)) continue;
      found.try_emplace(at->path().lexically_relative(folder).string(), at->path().string());
    }
  }
  std::vector<AvailableWorld> worlds;
  for (const auto& [uri, file] : found) worlds.push_back({uri, file});
  return worlds;
}

void put_world(CdrWriter& cdr, const std::string& uri, const std::string& name) {
  cdr.put(name);
  cdr.put(uri);
  cdr.put("");
  cdr.put("");
  cdr.put_count(0);
}

}  // namespace sf::bridges
