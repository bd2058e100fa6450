#pragma once
// The topics of a recording, and their channels in the file.

#include <cstdint>
#include <vector>

#include "record/mcap_writer.h"
#include "record/ros_messages.h"
#include "record/run_info.h"

namespace sf::record {

struct SensorChannel {
  std::uint16_t channel = 0;             ///< 0: readings are not recorded
  const SensorTypeInfo* type = nullptr;  ///< row of `RunInfo::sensor_types`
  Scan header;                           ///< `frame` of every type; of scans, all but time and ranges
};

struct MoverChannels {
  std::uint16_t odometry = 0;  ///< 0: neither odometry nor commands are recorded
  std::uint16_t command = 0;
  std::uint16_t quality = 0;  ///< 0: states are true
  std::vector<SensorChannel> sensors;
};

struct Channels {
  std::uint16_t info = 0, fleet = 0, transforms = 0, statics = 0;
  std::uint16_t lights = 0;  ///< 0: the world has none
  std::vector<MoverChannels> movers;
};

std::size_t count_channels(const RunInfo& info);

/// Adds all schemas and channels. Rule: frames and topics are named. @param info outlives the channels
Channels add_channels(McapWriter& mcap, const RunInfo& info);

}  // namespace sf::record
