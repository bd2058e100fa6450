#pragma once
// Presents a run as a ROS 2 node, `/sensorfarm`, without a ROS installation. Its topics are those of recordings, its
// commands are geometry_msgs/Twist and TwistStamped on the cmd_vel topics, and its services are those of `RosServices`.

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridges/bridge.h"
#include "bridges/dds.h"
#include "bridges/dds_outbox.h"
#include "bridges/fast_services.h"
#include "bridges/ros_services.h"
#include "netio/rate_limited_log.h"
#include "record/topics.h"

namespace sf::bridges {

struct Ros2Options {
  std::uint32_t domain = 0;  ///< ROS_DOMAIN_ID of the nodes, [0, kDdsMaxDomain]
  bool loopback = false;     ///< only nodes on this machine
};

/// @param domain digits; empty: ROS_DOMAIN_ID of the environment, or 0. Like ROS 2 nodes, sets `loopback` if the
/// environment has ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST or ROS_LOCALHOST_ONLY=1.
/// @throws base::InputError if it is not a domain
Ros2Options ros2_options(std::string domain);

/// Received messages, until the run collects them.
class DdsInbox {
 public:
  static constexpr std::size_t kMaxMessages = 4096;
  static constexpr std::size_t kMaxBytes = 16 << 20;

  void add(DdsMessage&& message);
  /// Moves all messages to the end of `out`.
  void take(std::deque<DdsMessage>& out);
  std::uint64_t left_out() const;

 private:
  mutable std::mutex mutex_;
  std::deque<DdsMessage> messages_;
  std::size_t bytes_ = 0;
  std::uint64_t left_out_ = 0;
};

/// Writes lines of the DDS library to standard error, rate-limited because external traffic can cause them.
class DdsLog {
 public:
  /// @param descriptor 2: standard error
  explicit DdsLog(int descriptor = 2) : log_(descriptor) {}
  /// Thread-safe.
  void write(std::string_view line);

 private:
  std::mutex mutex_;
  netio::RateLimitedLog log_;
};

class Ros2Bridge : public Bridge {
 public:
  static constexpr std::size_t kNone = ~std::size_t{0};
  static constexpr std::size_t kMaxRequests = 32;  ///< maximum number of service requests handled per tick; others wait

  /// @param open_fast if it throws, services do not answer clients of rmw_fastrtps
  /// @throws base::InputError if DDS is unavailable
  Ros2Bridge(const Ros2Options& options, const Scene& scene, const DdsLibrary& library = dds_library(),
             OpenFastServices open_fast = open_fast_services);

  void publish(const base::TickRecord& tick, const RunState& state) override;
  void publish(const RunState& state) override;
  void take(Requests& requests) override;
  bool keeps_on() const override { return true; }
  /// Adds readers and writers for new topics. Those of movers that have left remain but are silent.
  void show_scene(bool is_new) override;
  std::string describe() const override;

  struct Counts {
    DdsOutbox::Counts sent;
    std::uint64_t malformed = 0;  ///< messages that could not be parsed
    std::uint64_t left_out = 0;   ///< messages dropped because they arrived faster than ticks
  };
  Counts counts() const;

 private:
  void add_topics();
  void add_commands();
  void add_services();
  void add_fast(OpenFastServices open, const std::set<std::string>& addresses);
  void announce();
  std::size_t add_writer(const std::string& topic, std::string_view type, std::string_view definition, int depth,
                         bool latched);
  std::size_t add_reader(const std::string& topic, std::string_view type, std::string_view definition);
  void add(const record::TopicMessage& message);
  /// Returns false if it cannot be parsed.
  bool take_command(const DdsMessage& message, Requests& requests) const;
  void send_answers();

  const Ros2Options options_;
  const Scene scene_;
  RosServices services_;
  std::optional<record::TickMessages> messages_;
  DdsInbox commands_, requests_;           // outlive the participant, which fills them
  std::deque<DdsMessage> come_, pending_;  ///< taken from the inboxes
  std::uint64_t malformed_ = 0;
  std::vector<std::size_t> writer_of_;  ///< by row of `messages_.topics()`; kNone: no writer
  std::vector<bool> wanted_;            ///< by row of `messages_.topics()`: whether it has readers
  /// A reader of commands to a mover; readers of services come first.
  struct Reader {
    std::uint32_t mover = 0;  ///< row; world::kNone: the mover belongs to another world
    bool stamped = false;
  };
  std::vector<Reader> reader_of_;                       ///< by reader
  std::map<std::string, std::size_t> writer_of_topic_;  ///< of every topic since the start
  std::map<std::string, std::size_t> commands_of_;      ///< first reader of the command topic
  std::vector<std::size_t> reply_writers_;              ///< by service; those of Fast DDS are in the order of services
  std::vector<std::size_t> action_writers_;             ///< by action topic
  std::size_t discovery_ = kNone;                       ///< writer
  std::vector<DdsGuid> readers_, writers_;              ///< of all endpoints
  std::uint32_t runs_ = 0;
  std::int64_t time_ = 0;  ///< [ns] of the last tick
  DdsBatch batch_;
  DdsLog log_;
  std::string why_no_fast_;  ///< why clients of rmw_fastrtps get no answers; empty: they do
  std::unique_ptr<DdsParticipant> participant_;
  std::unique_ptr<FastServices> fast_;  ///< null: clients of rmw_fastrtps get no answers
  std::optional<DdsOutbox> outbox_;
};

}  // namespace sf::bridges
