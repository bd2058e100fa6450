#include "bridges/ros_entities.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/elementary.h"
#include "base/tilted_pose.h"
#include "netio/packets.h"
#include "record/ros_messages.h"

namespace sf::bridges {

namespace {

/// Matches a regular expression of characters, '.' and ".*" with any part of `name`; '^' and '$' anchor it. Takes time
/// proportional to the product of both lengths.
bool matches(std::string_view pattern, std::string_view name) {
  const bool from_begin = pattern.starts_with('^'), to_end = pattern.ends_with('$');
  pattern.remove_prefix(from_begin ? 1 : 0);
  pattern.remove_suffix(to_end ? 1 : 0);
  std::vector<bool> reached(name.size() + 1, !from_begin);  // by position: whether the pattern so far can end there
  reached[0] = true;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const bool any = pattern.substr(i, 2) == ".*";
    if (any) {
      for (std::size_t at = 1; at < reached.size(); ++at) reached[at] = reached[at] || reached[at - 1];
      ++i;
      continue;
    }
    for (std::size_t at = name.size(); at > 0; --at)
      reached[at] = reached[at - 1] && (pattern[i] == '.' || pattern[i] == name[at - 1]);
    reached[0] = false;
  }
  return to_end ? reached.back() : std::find(reached.begin(), reached.end(), true) != reached.end();
}

bool is_simple(std::string_view pattern) {
  if (pattern.starts_with('^')) pattern.remove_prefix(1);
  if (pattern.ends_with('$')) pattern.remove_suffix(1);
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (std::string_view("^$[](){}+?|\\").find(pattern[i]) != std::string_view::npos) return false;
    if (pattern[i] == '*' && (i == 0 || pattern[i - 1] != '.')) return false;
  }
  return true;
}

/// Returns yaw and tilt of the quaternion (x, y, z, w); nullopt unless its length is nearly 1.
std::optional<base::TiltedPose> turn_of(double x, double y, double z, double w) {
  const double length = base::hypot(base::hypot(x, y), base::hypot(z, w));
  constexpr double kSmall = 1e-3, kRounding = 1e-6;
  if (!(std::abs(length - 1.0) <= kSmall)) return std::nullopt;
  if (base::hypot(x, y) <= kRounding) return base::TiltedPose{{0.0, 0.0, 0.0, 2.0 * base::atan2(z, w)}};
  return base::tilted_pose_of({base::rotation_of(base::Quaternion{w, x, y, z})});
}

}  // namespace

std::string find_entities(record::CdrReader& cdr, const record::RunInfo& info, const std::vector<base::Report>& movers,
                          std::vector<std::size_t>& rows) {
  constexpr std::size_t kLeastString = 5, kVector = 24;  // [byte]
  const std::string pattern = cdr.get_string();
  const std::uint32_t categories = cdr.get_count(1);
  for (std::uint32_t i = 0; i < categories; ++i) cdr.get<std::uint8_t>();
  const std::uint32_t tags = cdr.get_count(kLeastString);
  for (std::uint32_t i = 0; i < tags; ++i) cdr.get_string();
  cdr.get<std::uint8_t>();  // whether any or all of the tags are required
  const auto bounds = cdr.get<std::uint8_t>();
  for (std::uint32_t left = 3 * cdr.get_count(kVector); left > 0; --left) cdr.get<double>();
  if (!cdr.good()) return {};
  if (categories + tags + bounds > 0) return "entities have no categories, tags or bounds";
  if (pattern.size() > 256 || !is_simple(pattern)) return "a filter consists of up to 256 characters, '.' and \".*\"";
  for (std::size_t row = 0; row < movers.size(); ++row)
    if (!base::is_absent(movers[row].X_WM) && matches(pattern, info.movers[row].frame)) rows.push_back(row);
  return {};
}

void put_entity_state(record::CdrWriter& cdr, std::int64_t time, const base::Report& state) {
  record::put_header(cdr, time, "world");
  const base::Pose& X_WM = state.X_WM;
  record::put_pose(cdr, X_WM, state.tilt);
  const glm::dvec2 v_W = base::rotate(X_WM.yaw, {state.velocity.forward, state.velocity.left});
  for (const double value : {v_W.x, v_W.y, 0.0, 0.0, 0.0, state.velocity.turn}) cdr.put(value);
  for (int i = 0; i < 6; ++i) cdr.put(0.0);  // accelerations are unknown
}

EntityState get_stamped_pose(record::CdrReader& cdr, double z) {
  EntityState state;
  std::int64_t time = 0;
  state.frame = record::get_header(cdr, time);
  const auto x = cdr.get<double>(), y = cdr.get<double>();
  cdr.get<double>();  // height
  const auto a = cdr.get<double>(), b = cdr.get<double>(), c = cdr.get<double>(), d = cdr.get<double>();
  const std::optional<base::TiltedPose> turn = turn_of(a, b, c, d);
  state.valid = std::abs(x) <= netio::kMaxPosition && std::abs(y) <= netio::kMaxPosition && turn;
  if (state.valid) state.X_WM = {x, y, z, turn->X.yaw}, state.tilt = turn->tilt;
  return state;
}

EntityState get_entity_state(record::CdrReader& cdr, double z) {
  EntityState state = get_stamped_pose(cdr, z);
  for (int i = 0; i < 12; ++i) cdr.get<double>();  // velocity and acceleration
  if (cdr.left() == 0) return state;               // version 1.0 always sets the pose
  state.pose = cdr.get<bool>();
  state.twist = cdr.get<bool>();
  state.acceleration = cdr.get<bool>();
  return state;
}

}  // namespace sf::bridges
