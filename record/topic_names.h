#pragma once
// Names of topics and frames of a run, for recordings and bridges (docs/bridges.md, "Names").

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "record/run_info.h"

namespace sf::record {

enum class TopicStyle : std::uint8_t {
  robot,  ///< /ROBOT/scan, frames ROBOT/base_link, one /tf
  nav2,   ///< /ROBOT/scan, frames base_link, a /ROBOT/tf per robot
  plain,  ///< for the only robot: /scan, frames base_link, /tf; other movers as in `robot`
  sensor  ///< /ROBOT/SENSOR/scan, frames ROBOT in `world`; odometry is the truth
};

/// Contents of the topic `odom`, and of the transform from the frame `odom` to the robot.
enum class OdometrySource : std::uint8_t {
  encoders,  ///< wheel encoders; robots without encoders use `exact`
  exact,     ///< without errors, from the start pose on
  truth      ///< the pose in `world`, as in all recordings without readings
};

/// Names of topics and frames, and the transforms that external nodes publish.
struct Naming {
  TopicStyle style = TopicStyle::robot;
  OdometrySource odometry = OdometrySource::encoders;
  bool localizer = false;  ///< is external: no transform map -> odom
  bool mapper = false;     ///< is external: no transform map -> odom, no /map, and no frame `world` below `map`
  bool filter = false;     ///< is external: no transform odom -> base_link

  friend bool operator==(const Naming&, const Naming&) = default;
};

// Words of the command line and of recordings.
inline constexpr std::array<std::pair<std::string_view, TopicStyle>, 4> kTopicStyles{{{"robot", TopicStyle::robot},
                                                                                      {"nav2", TopicStyle::nav2},
                                                                                      {"plain", TopicStyle::plain},
                                                                                      {"sensor", TopicStyle::sensor}}};
inline constexpr std::array<std::pair<std::string_view, OdometrySource>, 3> kOdometrySources{
    {{"encoders", OdometrySource::encoders}, {"exact", OdometrySource::exact}, {"truth", OdometrySource::truth}}};
inline constexpr std::array<std::pair<std::string_view, bool Naming::*>, 3> kExternalNodes{
    {{"localizer", &Naming::localizer}, {"mapper", &Naming::mapper}, {"filter", &Naming::filter}}};

/// Adds options to the run (`RunInfo::options`) if they differ from the default.
void put_naming(const Naming& naming, RunInfo& info);
/// Returns the naming in the run's options. Unknown words count as the default.
Naming naming_of(const RunInfo& info);

/// Sets the topic prefix and the frames of every mover, and the names of every sensor and its standard topics. Names
/// consist of [A-Za-z0-9_], do not begin with a digit or '_', do not end with '_', and never contain two in a row;
/// duplicates are numbered. The names of a mover do not depend on later ones.
/// @return a line for each name that was already taken; for sensors only if readings are published
std::vector<std::string> name_frames(RunInfo& info);

}  // namespace sf::record
