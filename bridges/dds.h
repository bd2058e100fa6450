#pragma once
// DDS, the network of ROS 2, reduced to the needs of a bridge: writers send bytes and readers receive them. Cyclone DDS
// is in a plug-in (dds/, `sensorfarm_dds.so`) that is loaded with the first participant. Fast DDS, by which services
// also answer clients of rmw_fastrtps, runs in a separate process (fast_services.h).

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <string_view>

#include "base/bytes.h"

namespace sf::bridges {

/// GUID of a participant, writer or reader, unique in its domain.
using DdsGuid = std::array<std::uint8_t, 16>;

inline constexpr std::size_t kDdsMaxReceived = 1 << 20;  ///< [byte] longer messages are received as empty ones

/// Returns whether a client with this writer prefixes requests with the header of rmw_cyclonedds and expects it in
/// replies. All others are expected to follow DDS-RPC, as rmw_fastrtps does. The participant of Fast DDS accepts only
/// the latter, and that of Cyclone DDS only the former, so each request is executed once. A GUID begins with the vendor
/// id of the implementation (RTPS 2.2, 8.2.4.2).
inline bool has_request_header(const DdsGuid& writer) {
  return writer[0] == 0x01 && writer[1] == 0x10;  // Eclipse Cyclone DDS
}

/// A writer or a reader. Both are reliable. A reader also matches best-effort writers.
struct DdsEndpoint {
  std::string topic;      ///< name in DDS, e.g. "rt/robot/odom"
  std::string type;       ///< name in DDS, e.g. "nav_msgs::msg::dds_::Odometry_"
  std::string user_data;  ///< pairs "key=value;" in the format of ROS 2 nodes
  int depth = 10;         ///< messages kept for slow readers, > 0
  bool latched = false;   ///< writers: late readers receive the last `depth` messages
  bool best_effort = false;
  bool requests = false;  ///< readers: for requests to a service; see `has_request_header`
};

/// The sender of a message.
struct DdsSender {
  DdsSender(std::uint64_t of_writer = 0) : writer(of_writer) {}
  std::uint64_t writer = 0;  ///< as in `can_answer`
  bool fast = false;         ///< whether the participant of Fast DDS received it
  bool operator==(const DdsSender&) const = default;
};

struct DdsMessage {
  std::size_t reader = 0;
  DdsSender sender;
  base::Bytes bytes;  ///< with encapsulation; empty if longer than kDdsMaxReceived
};

/// Adding is single-threaded and precedes the first write. All other functions are thread-safe, with one caller at a
/// time per writer.
class DdsParticipant {
 public:
  virtual ~DdsParticipant() = default;  ///< nothing is received afterwards
  virtual DdsGuid guid() const = 0;
  /// @param guid out: of the writer
  /// @return its number: 0, 1, ...
  /// @throws std::runtime_error
  virtual std::size_t add_writer(const DdsEndpoint& endpoint, DdsGuid& guid) = 0;
  /// @param guid out: of the reader
  /// @return its number: 0, 1, ...
  /// @throws std::runtime_error
  virtual std::size_t add_reader(const DdsEndpoint& endpoint, DdsGuid& guid) = 0;
  /// Writes a message. Waits a few ms at most for slow readers.
  /// @param message with encapsulation
  /// @return false: its readers are behind, and the message was dropped
  virtual bool write(std::size_t writer, const base::Bytes& message) = 0;
  /// Returns the number of readers currently known. Never blocks.
  virtual std::size_t count_readers(std::size_t writer) const = 0;
  /// Returns whether the sender's participant reads from `writer`, or has left.
  /// @param sender `DdsSender::writer` of a message of `reader`
  virtual bool can_answer(std::size_t writer, std::size_t reader, std::uint64_t sender) const = 0;
};

struct DdsOptions {
  std::uint32_t domain = 0;  ///< [0, kDdsMaxDomain]
  std::string user_data;     ///< of the participant
  bool loopback = false;     ///< uses only this machine; false: the default interface, or the one set by CYCLONEDDS_URI
  std::set<std::string> addresses;  ///< IPv4 addresses of the interfaces for Fast DDS without `loopback`; not empty
  /// Called with each received message on threads of the library. Must return quickly.
  std::function<void(DdsMessage&&)> receive;
  /// Called with each line of the library's log, for example one per malformed datagram, on threads of the library.
  std::function<void(std::string_view)> log;
};
inline constexpr std::uint32_t kDdsMaxDomain = 232;  ///< higher domains have no valid ports

struct DdsLibrary {
  /// @throws std::runtime_error with the reason
  std::unique_ptr<DdsParticipant> (*open)(const DdsOptions& options);
};

/// The name of the plug-in's only symbol: `extern "C" const DdsLibrary sensorfarm_dds`.
inline constexpr const char* kDdsSymbol = "sensorfarm_dds";

/// Loads the plug-in once.
/// @throws base::InputError with the file name if it cannot be loaded
const DdsLibrary& dds_library();

}  // namespace sf::bridges
