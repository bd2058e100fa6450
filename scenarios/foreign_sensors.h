#pragma once
// The sensors of recordings of other programs: which columns of their source they read, and the world that has them.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "record/run_info.h"
#include "scenarios/derive_file.h"
#include "sensors/sensor_type.h"

namespace sf::scenarios {

/// One sensor and the columns from which its readings are filled.
struct ForeignSensor {
  ForeignInput input;
  std::string source;  ///< for messages: "topic /imu (sensor_msgs/msg/Imu)", "odometry.csv"
  const sensors::SensorType* type = nullptr;
  std::vector<std::size_t> from;        ///< per column of the type: column of the source; kNotMeasured: 0
  double yaw = 0.0;                     ///< [rad] added to that of its pose
  bool states_noise = false;            ///< the file states the noise of this receiver
  std::uint32_t mover = 0, number = 0;  ///< in the world
};

inline constexpr std::size_t kNotMeasured = SIZE_MAX;

/// Option of the run: nanoseconds since 1970, or of the recording's own clock.
inline constexpr const char* kTimeZero = "time_zero_ns";

/// Finds the sensor type, which is a new one for a word that no type has, and its columns in the source.
/// @param file for messages @param available columns of the source
/// @throws base::InputError for a column that does not exist, or has another unit
ForeignSensor bind_sensor(const std::string& file, const ForeignInput& input, const std::string& source,
                          const std::vector<std::string>& available);

/// Adds the sensor types of a recording that was made by `read_foreign`, so that its world can be read. Ids that other
/// types have are left out.
void add_foreign_types(const record::RunInfo& info);

/// Returns a world that contains only the robots of the file, with their sensors; sets `mover` and `number`.
world::World foreign_world(const DeriveFile& file, std::span<ForeignSensor> sensors);

}  // namespace sf::scenarios
