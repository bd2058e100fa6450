#pragma once
// DDS, the network of ROS 2, as far as a bridge needs it: bytes go out on writers and come in on readers. Cyclone DDS
// is in a plug-in (dds/, `sensorfarm_dds.so`) that is loaded with the first participant. Fast DDS, with which services
// also answer clients of rmw_fastrtps, is in a process (fast_services.h).

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

/// Of a participant, writer or reader, unique in its domain.
using DdsGuid = std::array<std::uint8_t, 16>;

inline constexpr std::size_t kDdsMaxReceived = 1 << 20;  ///< [byte] longer messages come as empty ones

/// Whether a client with this writer puts the header of rmw_cyclonedds before its requests, and reads it before
/// replies. All others are expected to do as DDS-RPC says, and as rmw_fastrtps does: the participant of Fast DDS takes
/// these alone, and that of Cyclone DDS the former alone, so that each request is executed once. A GUID begins with the
/// number of the implementation (RTPS 2.2, 8.2.4.2).
inline bool has_request_header(const DdsGuid& writer) {
  return writer[0] == 0x01 && writer[1] == 0x10;  // Eclipse Cyclone DDS
}

/// A writer or a reader. Both are reliable; a reader matches writers of any kind.
struct DdsEndpoint {
  std::string topic;      ///< name in DDS, e.g. "rt/robot/odom"
  std::string type;       ///< name in DDS, e.g. "nav_msgs::msg::dds_::Odometry_"
  std::string user_data;  ///< pairs "key=value;", as nodes of ROS 2 write them
  int depth = 10;         ///< messages kept for slow readers, > 0
  bool latched = false;   ///< of writers: late readers are given the last `depth` messages
  bool best_effort = false;
  bool requests = false;  ///< of readers: of a service's requests; see `has_request_header`
};

/// Of a message.
struct DdsSender {
  DdsSender(std::uint64_t of_writer = 0) : writer(of_writer) {}
  std::uint64_t writer = 0;  ///< as in `can_answer`
  bool fast = false;         ///< it came by the participant of Fast DDS
  bool operator==(const DdsSender&) const = default;
};

struct DdsMessage {
  std::size_t reader = 0;
  DdsSender sender;
  base::Bytes bytes;  ///< with encapsulation; empty where longer than kDdsMaxReceived
};

/// Adding is for one thread, before the first write. All other functions are for any thread, one at a time per writer.
class DdsParticipant {
 public:
  virtual ~DdsParticipant() = default;  ///< after it, nothing is received
  virtual DdsGuid guid() const = 0;
  /// @param guid out: of the writer @return its number: 0, 1, ... @throws std::runtime_error
  virtual std::size_t add_writer(const DdsEndpoint& endpoint, DdsGuid& guid) = 0;
  /// @param guid out: of the reader @return its number: 0, 1, ... @throws std::runtime_error
  virtual std::size_t add_reader(const DdsEndpoint& endpoint, DdsGuid& guid) = 0;
  /// @param message with encapsulation
  /// @return false: its readers are behind, and the message is dropped; it waits for them for some ms at most
  virtual bool write(std::size_t writer, const base::Bytes& message) = 0;
  /// Of readers that are known at present; never waits.
  virtual std::size_t count_readers(std::size_t writer) const = 0;
  /// Whether the sender's participant reads what `writer` writes, or is gone.
  /// @param sender `DdsSender::writer` of a message of `reader`
  virtual bool can_answer(std::size_t writer, std::size_t reader, std::uint64_t sender) const = 0;
};

struct DdsOptions {
  std::uint32_t domain = 0;  ///< [0, kDdsMaxDomain]
  std::string user_data;     ///< of the participant
  bool loopback = false;     ///< on this machine only; false: on the default interface, or as CYCLONEDDS_URI says
  std::set<std::string> addresses;  ///< IPv4, of the interfaces of Fast DDS without `loopback`; not empty
  /// Takes what came. Called on threads of the library; returns soon.
  std::function<void(DdsMessage&&)> receive;
  /// Takes a line of the library's log, such as one per malformed datagram. Called on threads of the library.
  std::function<void(std::string_view)> log;
};
inline constexpr std::uint32_t kDdsMaxDomain = 232;  ///< ports of higher ones do not exist

struct DdsLibrary {
  /// @throws std::runtime_error saying why
  std::unique_ptr<DdsParticipant> (*open)(const DdsOptions& options);
};

/// The name of the plug-in's only symbol: `extern "C" const DdsLibrary sensorfarm_dds`.
inline constexpr const char* kDdsSymbol = "sensorfarm_dds";

/// Loads the plug-in, once. @throws base::InputError naming the file when it cannot be loaded
const DdsLibrary& dds_library();

}  // namespace sf::bridges
