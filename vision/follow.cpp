#include "vision/follow.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace sf::vision {

namespace {

using world::TomlNode;
using world::TomlReader;

constexpr std::array<std::string_view, 6> kFollowKeys{"tags", "margin", "speed", "search", "start", "stop"};
constexpr double kMaxId = 65535;
constexpr double kMaxRectangle = 1e4;  // [m]
constexpr double kMaxEventTime = 1e9;  // [s]

/// Parses "[x y width height]", with or without commas. @return the position after it; null for another form
const char* read_rectangle(const char* at, FollowEvent& event) {
  std::array<double, 4> box{};
  int length = 0;
  std::string text(at);
  std::replace(text.begin(), text.end(), ',', ' ');
  if (std::sscanf(text.c_str(), " [ %lf %lf %lf %lf ]%n", &box[0], &box[1], &box[2], &box[3], &length) != 4 ||
      length == 0)
    return nullptr;
  const auto is_valid = [](double n) { return std::abs(n) <= kMaxRectangle; };
  if (!std::all_of(box.begin(), box.end(), is_valid) || box[2] <= 0.0 || box[3] <= 0.0) return nullptr;
  event.low = {box[0], box[1]};
  event.high = event.low + glm::dvec2{box[2], box[3]};
  return at + length;
}

/// @return false for another form
bool parse_event(const std::string& text, FollowEvent& event) {
  int length = 0;
  std::array<char, 8> verb{};
  long id = 0;
  if (std::sscanf(text.c_str(), " at %lf s %n", &event.time, &length) == 1 && length > 0) {
    event.kind = FollowEvent::Kind::time;
    return text.c_str()[length] == 0 && event.time >= 0.0 && event.time <= kMaxEventTime;
  }
  if (std::sscanf(text.c_str(), " tag %5ld %7[a-z]%n", &id, verb.data(), &length) != 2) return false;
  const std::string_view word(verb.data());
  if (word != "enters" && word != "leaves") return false;
  event.kind = word == "enters" ? FollowEvent::Kind::enters : FollowEvent::Kind::leaves;
  if (id < 0 || id > static_cast<long>(kMaxId)) return false;
  event.tag = static_cast<std::uint32_t>(id);
  const char* end = read_rectangle(text.c_str() + length, event);
  while (end != nullptr && *end == ' ') ++end;
  return end != nullptr && *end == 0;
}

FollowEvent read_event(const TomlReader& reader, const TomlNode& table, std::string_view key) {
  FollowEvent event;
  event.text = reader.text(table, key, "");
  const TomlNode* node = world::find(table, key);
  if (node == nullptr) return event;
  event.line = node->line;
  if (!parse_event(event.text, event))
    reader.fail(*node, fmt::format("'{}' is '{}'; expected \"tag 3 enters [x y width height]\" or \"tag 3 leaves [x y "
                                   "width height]\" in metres, width and height above 0, or \"at 5 s\"",
                                   key, event.text));
  return event;
}

}  // namespace

std::set<std::uint32_t> read_tags(const std::string& text) {
  std::set<std::uint32_t> tags;
  std::uint32_t id = 0;
  int digits = 0;
  for (const char c : text + ",") {
    if (c == ',' && digits > 0) {
      tags.insert(id);
      id = 0, digits = 0;
    } else if (c >= '0' && c <= '9' && ++digits <= 5) {
      id = 10 * id + static_cast<std::uint32_t>(c - '0');
    } else {
      return {};
    }
    if (id > static_cast<std::uint32_t>(kMaxId)) return {};
  }
  return tags.size() <= FollowSettings::kMaxTags ? tags : std::set<std::uint32_t>();
}

FollowSettings read_follow(const TomlReader& reader, const TomlNode& table) {
  reader.require_known(table, kFollowKeys);
  FollowSettings settings;
  if (const TomlNode* tags = world::find(table, "tags")) {
    if (tags->kind != TomlNode::Kind::list || tags->items.empty() || tags->items.size() > FollowSettings::kMaxTags)
      reader.fail(*tags,
                  fmt::format("'tags' expects a list of 1 to {} ids, such as tags = [7, 9]", FollowSettings::kMaxTags));
    for (const TomlNode& item : tags->items) {
      const double id = reader.number(item, "tags", 0.0, kMaxId);
      if (id != std::floor(id)) reader.fail(item, "'tags' expects whole numbers from 0 to 65535");
      settings.tags.insert(static_cast<std::uint32_t>(id));
    }
  }
  settings.margin = reader.number(table, "margin", settings.margin, 0.0, 10.0, "metres");
  settings.speed = reader.number(table, "speed", settings.speed, 0.01, 5.0, "m/s");
  settings.search = reader.number(table, "search", settings.search, 0.1, 60.0, "seconds");
  settings.start = read_event(reader, table, "start");
  settings.stop = read_event(reader, table, "stop");
  using Kind = FollowEvent::Kind;
  if (settings.start.kind == Kind::time && settings.stop.kind == Kind::time &&
      settings.stop.time <= settings.start.time)
    reader.fail(*world::find(table, "stop"), "'stop' is not later than 'start'; expected a later time");
  return settings;
}

}  // namespace sf::vision
