#pragma once
// A participant of Fast DDS, another DDS implementation than the farm's, on the loopback interface. Types are those of
// ROS 2, written by hand; messages are decoded by fastcdr.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/bytes.h"

namespace sf::ros2 {

/// A reader or writer of another participant.
struct Endpoint {
  std::string topic, type, user_data;
  bool writes = false;
  bool reliable = false, latched = false;
};

class FastPeer {
 public:
  explicit FastPeer(std::uint32_t domain);
  ~FastPeer();

  /// @return the reader's number
  std::size_t subscribe(const std::string& topic, const std::string& type, bool latched = false, bool reliable = true);
  /// @return the writer's number
  std::size_t advertise(const std::string& topic, const std::string& type, bool reliable = true);
  void send(std::size_t writer, const base::Bytes& message);
  /// Sends a request in the way of rmw_fastrtps clients, naming the reader of its reply.
  /// @return its sequence number
  std::int64_t call(std::size_t writer, std::size_t reader, const base::Bytes& message);
  /// Returns the replies that name this reader, in the form expected by these clients: sequence number and message.
  std::vector<std::pair<std::int64_t, base::Bytes>> replies(std::size_t reader) const;
  /// Returns the number of matching remote endpoints.
  int count_matched_reader(std::size_t reader) const;
  int count_matched_writer(std::size_t writer) const;

  bool matched_reader(std::size_t reader) const;
  bool matched_writer(std::size_t writer) const;
  std::vector<base::Bytes> messages(std::size_t reader) const;  ///< all received messages
  std::vector<Endpoint> endpoints() const;                      ///< known endpoints of other participants
  std::vector<std::string> participants() const;                ///< user data of other participants

  /// Waits until `condition` holds, checking it after every event.
  /// @return false: it did not within a minute
  bool wait(const std::function<bool()>& condition) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct LaserScan {
  std::int64_t time = 0;  ///< [ns]
  std::string frame;
  float angle_min = 0, angle_max = 0, angle_increment = 0, time_increment = 0, scan_time = 0, range_min = 0,
        range_max = 0;
  std::vector<float> ranges, intensities;
};

struct Transform {
  std::int64_t time = 0;
  std::string frame, child;
  double position[3] = {}, rotation[4] = {};
};

struct Odometry {
  Transform pose;
  double pose_covariance[36] = {};
  double velocity[6] = {};
  double velocity_covariance[36] = {};
};

/// The first fields of most messages.
struct Header {
  std::int64_t time = 0;
  std::string frame;
};

// Return nullopt if fastcdr finds that the bytes end too early or that bytes are left.
std::optional<LaserScan> decode_scan(const base::Bytes& message);
std::optional<Odometry> decode_odometry(const base::Bytes& message);
std::optional<std::vector<Transform>> decode_transforms(const base::Bytes& message);
std::optional<Header> decode_header(const base::Bytes& message);  ///< ignores everything after it
std::optional<std::int64_t> decode_clock(const base::Bytes& message);

/// A node of ros_discovery_info, with the number of its readers and writers.
struct Node {
  std::string space, name;
  std::size_t readers = 0, writers = 0;
};
std::optional<std::vector<Node>> decode_nodes(const base::Bytes& message);

base::Bytes encode_twist(double forward, double left, double turn);
base::Bytes encode_twist_stamped(double forward, double left, double turn);

/// Returns a request of an rmw_fastrtps client: only its fields.
base::Bytes encode_fields(const std::vector<std::uint8_t>& fields);
/// Returns a request of an rmw_cyclonedds client: its number and the request's number before the request itself.
base::Bytes encode_request(std::uint64_t client, std::int64_t sequence, const std::vector<std::uint8_t>& fields);
/// Returns a SetEntityState of version 2.1 that sets the pose, in the same form.
base::Bytes encode_set_pose(std::uint64_t client, std::int64_t sequence, const std::string& entity, double x, double y,
                            double yaw);

struct Reply {
  std::uint64_t client = 0;
  std::int64_t sequence = 0;
  std::uint8_t code = 0;
  std::string message;
};
/// Decodes a reply that consists of a byte and a text: simulation_interfaces/Result, or success and message of
/// std_srvs.
std::optional<Reply> decode_reply(const base::Bytes& message);
/// Decodes the same without the numbers of rmw_cyclonedds.
std::optional<Reply> decode_fields_of_reply(const base::Bytes& message);

}  // namespace sf::ros2
