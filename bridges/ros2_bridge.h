#pragma once
// A run as a node of ROS 2, `/sensorfarm`, without a ROS installation: its topics are those of recordings, its commands
// are geometry_msgs/Twist and TwistStamped on the topics cmd_vel, its services those of `RosServices`.

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
#include "record/tick_messages.h"

namespace sf::bridges {

struct Ros2Options {
  std::uint32_t domain = 0;  ///< ROS_DOMAIN_ID of the nodes, [0, kDdsMaxDomain]
  bool loopback = false;     ///< nodes of this machine only
};

/// @param domain digits; empty: ROS_DOMAIN_ID of the environment, or 0. Of the environment, too, as nodes of ROS 2 read
/// it, ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST or ROS_LOCALHOST_ONLY=1: `loopback`.
/// @throws base::InputError where it is no domain
Ros2Options ros2_options(std::string domain);

/// Messages of others, until the run asks for them.
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

/// Lines of the DDS library on standard error, as few as of all that strangers can cause.
class DdsLog {
 public:
  /// @param descriptor 2: standard error
  explicit DdsLog(int descriptor = 2) : log_(descriptor) {}
  /// From any thread.
  void write(std::string_view line);

 private:
  std::mutex mutex_;
  netio::RateLimitedLog log_;
};

class Ros2Bridge : public Bridge {
 public:
  static constexpr std::size_t kNone = ~std::size_t{0};
  static constexpr std::size_t kMaxRequests = 32;  ///< of services, taken per tick; further ones wait

  /// @param open_fast where it throws, services do not answer clients of rmw_fastrtps
  /// @throws base::InputError where DDS cannot be used
  Ros2Bridge(const Ros2Options& options, const Scene& scene, const DdsLibrary& library = dds_library(),
             OpenFastServices open_fast = open_fast_services);

  void publish(const base::TickRecord& tick, const RunState& state) override;
  void publish(const RunState& state) override;
  void take(Requests& requests) override;
  bool keeps_on() const override { return true; }
  /// Adds readers and writers of topics that are new. Those of movers that left stay, and are silent.
  void show_scene(bool is_new) override;
  std::string describe() const override;

  struct Counts {
    DdsOutbox::Counts sent;
    std::uint64_t malformed = 0;  ///< messages that could not be read
    std::uint64_t left_out = 0;   ///< messages that came faster than ticks
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
  /// @return false: it cannot be read
  bool take_command(const DdsMessage& message, Requests& requests) const;
  void send_answers();

  const Ros2Options options_;
  const Scene scene_;
  RosServices services_;
  std::optional<record::TickMessages> messages_;
  DdsInbox commands_, requests_;           // outlive the participant, which fills them
  std::deque<DdsMessage> come_, pending_;  ///< taken from these
  std::uint64_t malformed_ = 0;
  std::vector<std::size_t> writer_of_;  ///< by row of `messages_.topics()`; kNone: it has none
  std::vector<bool> wanted_;            ///< by row of `messages_.topics()`: it has readers
  /// Of commands to a mover; those of services come first.
  struct Reader {
    std::uint32_t mover = 0;  ///< row; world::kNone: it is of another world
    bool stamped = false;
  };
  std::vector<Reader> reader_of_;                       ///< by reader
  std::map<std::string, std::size_t> writer_of_topic_;  ///< of all topics that ever were
  std::map<std::string, std::size_t> commands_of_;      ///< first reader of the topic's commands
  std::vector<std::size_t> reply_writers_;              ///< by service; those of Fast DDS are in order of services
  std::vector<std::size_t> action_writers_;             ///< by topic of actions
  std::size_t discovery_ = kNone;                       ///< writer
  std::vector<DdsGuid> readers_, writers_;              ///< all of them
  std::uint32_t runs_ = 0;
  std::int64_t time_ = 0;  ///< [ns] of the last tick
  DdsBatch batch_;
  DdsLog log_;
  std::string why_no_fast_;  ///< empty: clients of rmw_fastrtps are answered
  std::unique_ptr<DdsParticipant> participant_;
  std::unique_ptr<FastServices> fast_;  ///< null: they are not
  std::optional<DdsOutbox> outbox_;
};

}  // namespace sf::bridges
