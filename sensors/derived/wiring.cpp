#include "sensors/derived/wiring.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <ranges>
#include <tuple>

#include "base/suggest.h"
#include "sensors/pose_sensor.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kMostLevels = 64;

constexpr Column kCommandColumns[] = {{"forward_m_s"}, {"left_m_s"}, {"turn_rad_s"}};
constexpr auto kV2vColumns = joined(kPoseRow, std::array<Column, 3>{{{"forward_m_s"}, {"left_m_s"}, {"turn_rad_s"}}});
constexpr SensorType kReceivedTypes[] = {{.id = kCommandInput, .name = "command", .columns = kCommandColumns},
                                         {.id = kCameraInput, .name = "camera", .columns = kPoseRow},
                                         {.id = kV2vInput, .name = "v2v", .columns = kV2vColumns}};

std::vector<std::string> column_names(const SensorType& type) {
  std::vector<std::string> names;
  for (const Column& column : type.columns) names.emplace_back(column.name);
  return names;
}

bool accepts(const DerivedPort& port, const SensorType& type) {
  if (port.columns.size() > type.columns.size()) return false;
  return std::equal(port.columns.begin(), port.columns.end(), type.columns.begin(),
                    [](std::string_view wanted, const Column& column) { return wanted == column.name; });
}

/// Returns whether both are the same sensor at the same port.
bool is_same(const WiredInput& one, const WiredInput& other) {
  return one.port == other.port && one.mover == other.mover && one.type == other.type && one.sensor == other.sensor;
}

class Wiring {
 public:
  Wiring(const world::World& world, std::span<const WiredGroup> groups) : world_(world), groups_(groups) {
    for (const WiredGroup& group : groups) {
      if (group.type->derived == nullptr) continue;
      std::uint32_t row = 0;
      for_each_of(world, group.type->word.type, [&](const world::Sensor& sensor, std::uint32_t, std::uint32_t) {
        nodes_.push_back({group.type, &sensor, group.rows[row], row, 0, {}});
        ++row;
      });
    }
    for (DerivedNode& node : nodes_) add_inputs(node);
    number_levels();
  }
  std::vector<DerivedNode> nodes() && { return std::move(nodes_); }

 private:
  void add_inputs(DerivedNode& node);
  void add_input(DerivedNode& node, std::string_view text, std::uint32_t place);
  std::uint32_t port_of(const DerivedNode& node, const InputText& parts, const SensorType& type) const;
  const WiredGroup& group_of(const DerivedNode& node, std::string_view type) const;
  std::vector<std::uint32_t> movers_of(const DerivedNode& node, const InputText& parts) const;
  void number_levels();
  std::uint32_t level_of(std::size_t node, std::vector<std::size_t>& path);
  [[noreturn]] void refuse_input(const DerivedNode& node, const std::string& why) const {
    refuse(*node.settings, "inputs", fmt::format("{}: {}", derived_name(world_, node), why));
  }

  const world::World& world_;
  std::span<const WiredGroup> groups_;
  std::vector<DerivedNode> nodes_;
  std::map<std::tuple<std::uint8_t, std::uint32_t, std::uint32_t>, std::size_t> node_of_;  ///< by type, mover, sensor
  enum class Visit : std::uint8_t { open, under_way, done };
  std::vector<Visit> visits_;
};

const WiredGroup& Wiring::group_of(const DerivedNode& node, std::string_view type) const {
  std::vector<std::string_view> names;
  const WiredGroup* called = nullptr;  // "camera": the robot's, or poses from overhead ones, as a port accepts
  for (const WiredGroup& group : groups_) {
    names.push_back(group.type->name);
    if (!is_called(*group.type, type)) continue;
    const auto fits = [&](const DerivedPort& port) { return accepts(port, *group.type); };
    if (std::ranges::any_of(node.type->derived->ports, fits)) return group;
    if (called == nullptr) called = &group;
  }
  if (called != nullptr) return *called;
  refuse_input(node, fmt::format("no robot of this world has a sensor of type '{}'; there are: {}{}", type,
                                 fmt::join(names, ", "), base::suggest(type, names)));
}

std::vector<std::uint32_t> Wiring::movers_of(const DerivedNode& node, const InputText& parts) const {
  std::string why;
  const std::vector<std::uint32_t> found = movers_named(world_, node.spec.mover, parts.robot, why);
  if (found.empty()) refuse_input(node, why);
  return found;
}

std::uint32_t Wiring::port_of(const DerivedNode& node, const InputText& parts, const SensorType& type) const {
  const auto& ports = node.type->derived->ports;
  const auto names = std::views::transform(ports, &DerivedPort::name);
  if (!parts.port.empty() && std::ranges::find(names, parts.port) == names.end())
    refuse_input(node, fmt::format("there is no port '{}'; expected one of {}", parts.port, fmt::join(names, ", ")));
  std::string expected;
  for (std::uint32_t k = 0; k < ports.size(); ++k) {
    const bool named = parts.port.empty() || parts.port == ports[k].name;
    if (named && accepts(ports[k], type)) return k;
    expected += fmt::format("{}{}{}", expected.empty() ? "" : " or ", ports[k].name,
                            ports[k].columns.empty() ? "" : fmt::format(" ({})", fmt::join(ports[k].columns, ", ")));
  }
  refuse_input(node, fmt::format("{} has {}; expected {}", type.name, fmt::join(column_names(type), ", "), expected));
}

void Wiring::add_input(DerivedNode& node, std::string_view text, std::uint32_t place) {
  const InputText parts = read_input(text);
  const WiredGroup& group = group_of(node, parts.type);
  const std::uint32_t port = port_of(node, parts, *group.type);
  if (!parts.number)
    refuse_input(node, fmt::format("'{}' is not an input: expected [port=][robot/]type[:number]", text));
  if (group.type->id == kV2vInput && parts.robot.empty())
    refuse_input(node, "'v2v' expects the robot whose states it receives: \"ROBOT/v2v\", or \"*/v2v\" for all others");
  const std::size_t before = node.inputs.size();
  for (const std::uint32_t mover : movers_of(node, parts)) {
    if (group.type->id == kV2vInput && mover == node.spec.mover) continue;  // no robot receives itself
    const auto own = std::ranges::equal_range(group.rows, mover, {}, &SensorSpec::mover);
    if (*parts.number >= own.size()) continue;
    const WiredInput input{port, mover, group.type->id, *parts.number, place};
    if (parts.robot != "*" &&
        std::ranges::any_of(node.inputs, [&](const WiredInput& other) { return is_same(input, other); }))
      refuse_input(node, fmt::format("'{}' is listed twice", text));
    node.inputs.push_back(input);
  }
  if (node.inputs.size() > before) return;
  if (group.type->id == kV2vInput)
    refuse_input(node, fmt::format("'{}': a robot receives no states of its own; expected another robot", text));
  refuse_input(node, fmt::format("there is no sensor '{}': sensors of one type are numbered per robot, from 0", text));
}

void Wiring::add_inputs(DerivedNode& node) {
  node_of_[{node.type->id, node.spec.mover, node.spec.sensor}] = static_cast<std::size_t>(&node - nodes_.data());
  const world::Setting* const setting = find(*node.settings, "inputs");
  if (setting == nullptr || !setting->numbers.empty() || setting->text.empty())
    refuse_input(node, "expected inputs [\"type\" ...]: the sensors from which it is computed");
  std::string_view rest = setting->text;
  for (std::uint32_t place = 0; !rest.empty(); ++place) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    add_input(node, rest.substr(0, end), place);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  std::ranges::stable_sort(node.inputs, {}, &WiredInput::mover);  // robots that join come last
  const auto& ports = node.type->derived->ports;
  for (std::uint32_t k = 0; k < ports.size(); ++k) {
    const auto count = std::ranges::count(node.inputs, k, &WiredInput::port);
    if (count < ports[k].least || count > ports[k].most)
      refuse_input(node, fmt::format("it has {} inputs '{}'; expected {} to {}", count, ports[k].name, ports[k].least,
                                     ports[k].most));
  }
}

std::uint32_t Wiring::level_of(std::size_t row, std::vector<std::size_t>& path) {
  DerivedNode& node = nodes_[row];
  path.push_back(row);
  if (visits_[row] == Visit::under_way) {
    std::string circle;
    for (auto it = std::ranges::find(path, row); it != path.end(); ++it)
      circle = derived_name(world_, nodes_[*it]) + (circle.empty() ? "" : " -> ") + circle;
    refuse_input(node, "it is an input of itself: " + circle);
  }
  if (path.size() > kMostLevels)
    refuse_input(node, fmt::format("more than {} derived sensors depend on each other in a row", kMostLevels));
  if (visits_[row] == Visit::open) {
    visits_[row] = Visit::under_way;
    for (const WiredInput& input : node.inputs)
      if (const auto below = node_of_.find({input.type, input.mover, input.sensor}); below != node_of_.end())
        node.level = std::max(node.level, 1 + level_of(below->second, path));
    visits_[row] = Visit::done;
  }
  if (node.level >= kMostLevels)
    refuse_input(node, fmt::format("more than {} derived sensors depend on each other in a row", kMostLevels));
  path.pop_back();
  return node.level;
}

void Wiring::number_levels() {
  visits_.assign(nodes_.size(), Visit::open);
  std::vector<std::size_t> path;
  for (std::size_t row = 0; row < nodes_.size(); ++row) level_of(row, path);
}

}  // namespace

InputText read_input(std::string_view text) {
  InputText input;
  if (const std::size_t equal = text.find('='); equal != std::string_view::npos) {
    input.port = text.substr(0, equal);
    text.remove_prefix(equal + 1);
  }
  if (const std::size_t slash = text.rfind('/'); slash != std::string_view::npos) {
    input.robot = text.substr(0, slash);
    text.remove_prefix(slash + 1);
  }
  const std::size_t colon = std::min(text.find(':'), text.size());
  input.type = text.substr(0, colon);
  if (colon == text.size()) return input;
  const char* const end = text.data() + text.size();
  std::uint32_t number = 0;
  const auto [last, error] = std::from_chars(text.data() + colon + 1, end, number);
  input.number = error == std::errc() && last == end ? std::optional(number) : std::nullopt;
  return input;
}

bool is_called(const SensorType& type, std::string_view word) {
  return word == type.name || word == type.word.type || word == type.other_word.type;
}

std::vector<std::uint32_t> movers_named(const world::World& world, std::uint32_t own, std::string_view robot,
                                        std::string& why) {
  if (robot.empty()) return {own};
  std::vector<std::uint32_t> found;
  std::vector<std::string_view> names;
  const auto [first, end] = world::CopyIndex(world).rows_with(own, static_cast<std::uint32_t>(world.movers.size()));
  for (std::uint32_t m = first; m < end; ++m) {
    if (robot == "*" || world.movers[m].name == robot) found.push_back(m);
    names.push_back(world.movers[m].name);
  }
  if (found.empty()) why = fmt::format("no robot is called '{}'{}", robot, base::suggest(robot, names));
  return found;
}

std::vector<DerivedNode> wire(const world::World& world, std::span<const WiredGroup> groups) {
  return Wiring(world, groups).nodes();
}

const SensorType& input_type(std::uint8_t id) {
  const auto received = std::ranges::find(kReceivedTypes, id, &SensorType::id);
  return received != std::end(kReceivedTypes) ? *received : *find_sensor_type(id);
}

std::vector<DerivedNode> wire(const world::World& world, const SensorSet& sensor_set) {
  std::vector<WiredGroup> groups;
  for (const SensorSet::Group& group : sensor_set.groups()) groups.push_back({group.type, group.rows});
  std::vector<SensorSpec> robots(world.movers.size());
  for (std::uint32_t m = 0; m < robots.size(); ++m) robots[m].mover = m;
  for (const SensorType& type : kReceivedTypes) groups.push_back({&type, robots});
  return wire(world, groups);
}

std::string derived_name(const world::World& world, const DerivedNode& node) {
  return fmt::format("{} '{}' of '{}'", node.type->name, node.spec.name, world.movers[node.spec.mover].name);
}

}  // namespace sf::sensors
