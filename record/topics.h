#pragma once
// Ticks as ROS messages: the topics of a run, and the messages of each tick. Recordings and bridges share them.
//
//   TickMessages messages(info);
//   for (const Topic& topic : messages.topics()) advertise(topic);
//   messages.begin(emit);
//   while (running) messages.encode(tick, emit);

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/tick_record.h"
#include "record/odometry.h"
#include "record/ros_messages.h"
#include "record/run_info.h"
#include "record/topic_names.h"

namespace sf::record {

/// Valid as long as its TickMessages.
struct Topic {
  std::string name;         ///< "/robot/scan"
  std::string_view type;    ///< "sensor_msgs/msg/LaserScan"
  std::string_view schema;  ///< its definition as `ros2msg`
  bool latched = false;     ///< the message of `begin` is valid for the whole run
};

/// A message. Its bytes are valid during the call.
struct TopicMessage {
  std::uint32_t topic = 0;              ///< row of `TickMessages::topics`
  std::uint32_t sequence = 0;           ///< counted per reading for readings, per tick otherwise
  std::int64_t log_time = 0;            ///< [ns] time of the tick
  std::int64_t time = 0;                ///< [ns] time of the measurement
  std::span<const std::uint8_t> bytes;  ///< CDR
};

/// Single-threaded. Allocates nothing after warm-up.
class TickMessages {
 public:
  using Emit = std::function<void(const TopicMessage&)>;

  /// @param info its frames and topics have names (`name_frames`); outlives the object
  explicit TickMessages(const RunInfo& info);

  const std::vector<Topic>& topics() const { return topics_; }

  /// Returns a flag per topic, for `encode`: set for readings and /clock.
  std::vector<bool> readings_and_clock() const;

  /// Adds the topic of objects that change their shapes, at the end.
  /// @return whether it is new
  bool add_shapes();
  bool has_shapes() const { return shapes_ != 0; }
  /// Adds the topic of tilts, at the end.
  /// @return whether it is new
  bool add_tilts();
  bool has_tilts() const { return tilts_ != 0; }
  /// The same for the speeds of wheels.
  bool add_wheels();
  bool has_wheels() const { return wheels_ != 0; }

  /// Emits the latched topics. The next tick is the first of a run: its time may be earlier than that of the last one.
  void begin(const Emit& emit);
  /// Continues from `before`, which had fewer movers: sends the latched topics, except map and walls.
  /// @param time [ns] of the last tick
  void go_on(const TickMessages& before, std::int64_t time, const Emit& emit);
  /// Emits the messages of a tick. @pre every report's mover is a row of `info.movers`, its quality exists if
  /// `info.estimated`, every reading's sensor is one of its sensors; time is non-decreasing and not negative
  /// @param wanted flag per topic, false if it has no subscribers; empty: all topics are encoded
  void encode(const base::TickRecord& record, const Emit& emit, const std::vector<bool>& wanted = {});

 private:
  struct SensorTopics {
    const SensorTypeInfo* type = nullptr;  ///< row of `RunInfo::sensor_types`
    const SensorInfo* sensor = nullptr;
    std::uint32_t topic = 0;
    Scan header;                 ///< for every type only `frame`; for scans all fields except time and ranges
    std::uint32_t standard = 0;  ///< first row of its standard topics
  };
  struct MoverTopics {
    std::uint32_t odometry = 0, truth = 0, command = 0, quality = 0;
    std::string footprint;  ///< frame
    Odometer odometer;
    std::vector<SensorTopics> sensors;
  };
  /// A tree of frames, with the movers [first, end): all movers, or one.
  struct Tree {
    std::size_t first = 0, end = 0;
    std::uint32_t transforms = 0, fixed = 0, map = 0, bodies = 0;
  };
  /// New odometry of this tick.
  struct Odometry {
    std::uint32_t mover = 0;
    OdometryState state;
  };
  struct Output;

  std::uint32_t add(std::string name, std::string_view type, bool latched = false);
  std::uint32_t add(std::string name, const SensorTypeInfo& type);
  void add_tree(const std::string& prefix, std::size_t first, std::size_t end);
  void add_mover(const MoverInfo& mover);
  bool has_truth() const;
  bool places_odometry(const MoverInfo& mover) const;
  void add_readings(std::size_t row);
  void send_tree(const Tree& tree, const Output& out);
  void add_fixed(const MoverInfo& mover, const MoverTopics& topics);
  void find_odometry(const base::TickRecord& record);
  void send_transforms(const Output& out);
  void add_transforms(const Odometry& odometry);
  void send_odometry(const Output& out);
  void send_truth(const Output& out);
  void send_qualities(const Output& out) const;
  void send_reading(const base::ReadingBlock& reading, const Output& out);

  const RunInfo& info_;
  const Naming naming_;
  const OdometrySource odometry_;
  const std::string_view root_;                              ///< frame of all trees
  std::map<std::string, std::string, std::less<>> schemas_;  ///< schemas by type
  std::vector<Topic> topics_;
  std::vector<Tree> trees_;
  std::vector<MoverTopics> movers_;
  std::vector<Odometry> news_;
  std::size_t first_reading_ = 0;   ///< row of the first topic of readings; all later topics are readings too
  std::int64_t next_odometry_ = 0;  ///< [ns]
  std::uint32_t ticks_ = 0, odometries_ = 0;
  std::uint32_t shapes_ = 0;    ///< row of /shapes; 0: there is none
  std::uint32_t tilts_ = 0;     ///< row of /tilts; 0: there is none
  std::uint32_t wheels_ = 0;    ///< row of /wheels; 0: there is none
  std::uint32_t faults_ = 0;    ///< row of /faults; 0: the run has no faults
  bool marks_too_near_ = true;  ///< ranges of surfaces that are too near are -infinity
  std::vector<double> marked_;  ///< values of one reading
  base::Bytes message_;
  std::vector<Transform> transforms_;
};

}  // namespace sf::record
