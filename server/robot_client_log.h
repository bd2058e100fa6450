#pragma once
// Log of a robot's process: why the robot stops, and when it drives on.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "netio/rate_limited_log.h"
#include "server/map_exchange.h"
#include "server/robot_link.h"

namespace sf::server {

/// Readings of a robot that the farm dropped, because a budget was exhausted, of all sensors.
struct DroppedReadings {
  std::uint64_t processor = 0;  ///< for lack of processor time
  std::uint64_t network = 0;    ///< for lack of bytes
};

/// Not thread-safe. Times [ns] are on the robot's own clock.
class RobotClientLog {
 public:
  /// @param robot name in the world @param descriptor for the lines; -1: none @param reading_timeout [ns] without a
  /// reading after which the robot stops; 0: never
  RobotClientLog(std::string robot, std::uint32_t id, int descriptor, std::int64_t reading_timeout);

  /// Logs changes since the last step: no answer, refused signatures, missing readings.
  /// @param needs_farm whether the robot stops while readings are missing
  void note_link(const RobotLink& link, bool needs_farm, std::int64_t now);
  /// Logs that the controller does not follow DRIVE, at most every ten seconds.
  void note_ignored_drive(const std::string& controller, std::int64_t now);
  /// Logs that the farm changes a lane that the robot's world cannot change, at most every ten seconds.
  void note_unknown_lane(std::uint32_t segment, std::uint32_t lane, std::int64_t now);
  /// Counts the readings that the farm dropped, and logs them, at most every ten seconds for each sensor.
  /// @param sensor of the robot; the counts are those since the farm started, and fall when it starts again
  void note_dropped(std::uint32_t sensor, const netio::Dropped& dropped, std::int64_t now);
  /// Logs that a real robot does not have the digital outputs that its controller sets, once.
  void note_ignored_outputs(std::string_view title, std::int64_t now);
  /// Logs that a real robot's own readings are not sent to the farm, since they have other elements than the virtual
  /// sensor `row`, at most every ten seconds.
  void note_unshared(std::string_view type, std::size_t elements, const sensors::SensorSpec& row, std::int64_t now);
  /// Logs that the controller is to share its map, but there is no V2V without the farm.
  void note_no_team(std::int64_t now);
  /// Logs maps of another area, at most every ten seconds, and measurements that are not used.
  void note_team(const MapExchangeCounts& counts, std::int64_t now);
  /// Logs that the robot's own position was lost or found.
  /// @param cameras it has cameras, and is lost until one sees it; else it is lost once its wheels' errors are too
  /// large
  void note_position(bool lost, bool cameras, std::int64_t now);
  /// Logs why the real robot does not drive, whenever the reason changes. Does not log silence before its first answer
  /// is due.
  /// @param title "Create" @param problem "": none @param answered a frame has arrived
  void note_real(std::string_view title, const std::string& problem, bool answered, std::int64_t now);

  /// Returns whether no complete reading has arrived within the timeout.
  bool readings_timed_out(const RobotLink& link, std::int64_t now) const;
  std::uint64_t stops() const { return stops_; }              ///< number of stops for lack of readings or positions
  std::uint64_t left_out() const { return log_.left_out(); }  ///< number of dropped lines
  const DroppedReadings& dropped() const { return dropped_; }

 private:
  void note_signatures(const RobotLink& link, bool needs_farm, std::int64_t now);

  std::string robot_;
  std::uint32_t id_;
  std::int64_t reading_timeout_;
  netio::RateLimitedLog log_;
  bool problem_logged_ = false;
  std::uint64_t troubles_ = 0;     ///< number of refused packets seen before
  std::int64_t next_trouble_ = 0;  ///< [ns] time before which nothing is logged
  bool stands_ = false;            ///< stopped for lack of readings
  std::optional<bool> lost_;       ///< as of the last step
  std::uint64_t stops_ = 0;
  std::string real_problem_;        ///< last logged
  std::int64_t next_lane_ = 0;      ///< [ns] time before which no unknown lane is logged
  std::int64_t next_unshared_ = 0;  ///< [ns] the same of own readings
  MapExchangeCounts team_;          ///< as last logged
  std::int64_t next_foreign_ = 0;   ///< [ns] time before which no map of another area is logged
  struct DroppedOfSensor {
    netio::Dropped last;    ///< as last received
    std::int64_t next = 0;  ///< [ns] time before which nothing is logged
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, DroppedOfSensor> dropped_of_;  ///< by type and number
  DroppedReadings dropped_;
  bool outputs_ignored_ = false;
  std::int64_t next_drive_ = 0;  ///< [ns] time before which no ignored DRIVE is logged
};

}  // namespace sf::server
