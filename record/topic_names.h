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
  plain,  ///< of the only robot: /scan, frames base_link, /tf; other movers as in `robot`
  sensor  ///< /ROBOT/SENSOR/scan, frames ROBOT in `world`; odometry is the truth
};

/// Contents of the topic `odom`, and of the transform from the frame `odom` to the robot.
enum class OdometrySource : std::uint8_t {
  encoders,  ///< wheel encoders; of robots without them as `exact`
  exact,     ///< without errors, from the start pose on
  truth      ///< the pose in `world`, as in all recordings without readings
};

/// Which names topics and frames have, and which transforms nodes elsewhere publish.
struct Naming {
  TopicStyle style = TopicStyle::robot;
  OdometrySource odometry = OdometrySource::encoders;
  bool localizer = false;  ///< elsewhere: no transform map -> odom
  bool mapper = false;     ///< elsewhere: no transform map -> odom, no /map, and no frame `world` below `map`
  bool filter = false;     ///< elsewhere: no transform odom -> base_link

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

/// Adds options to the run (`RunInfo::options`), as far as they differ from the default.
void put_naming(const Naming& naming, RunInfo& info);
/// As the run's options have it. Unknown words count as the default.
Naming naming_of(const RunInfo& info);

/// Gives every mover its topics' prefix and its frames, and every sensor and its standard topics theirs. Names consist
/// of [A-Za-z0-9_], without a digit or '_' in front, a '_' at the end, or two in a row; equal ones are numbered. Names
/// of a mover do not depend on later ones.
/// @return a line for each name that another one has taken; of sensors only where readings are published
std::vector<std::string> name_frames(RunInfo& info);

}  // namespace sf::record
