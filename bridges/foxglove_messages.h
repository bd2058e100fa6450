#pragma once
// JSON messages of Foxglove's WebSocket protocol: github.com/foxglove/ws-protocol docs/spec.md (foxglove.websocket.v1),
// and foxglove.sdk.v1, which adds playback control.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/pose.h"

namespace sf::bridges {

inline constexpr const char* kWebSocketV1 = "foxglove.websocket.v1";
inline constexpr const char* kSdkV1 = "foxglove.sdk.v1";

struct Parameter {
  std::string name;
  std::variant<std::monostate, bool, double, std::string> value;  ///< monostate: no value, or one of another type
};

struct Channel {
  std::uint32_t id = 0;
  std::string topic;
  std::string type;    ///< for example "nav_msgs/msg/Odometry"
  std::string schema;  ///< ros2msg
};

struct Service {
  std::uint32_t id = 0;
  std::string name;
  std::string type;      ///< for example "std_srvs/srv/Trigger"
  std::string request;   ///< ros2msg fields; may be empty
  std::string response;  ///< ros2msg fields; may be empty
};

struct ServerInfo {
  std::string name;
  std::vector<std::string> capabilities;
  std::string session;  ///< a new id makes clients discard what they received
  std::vector<std::pair<std::string, std::string>> metadata;
  std::optional<std::int64_t> start, end;  ///< [ns] of a recording
};

enum class StatusLevel { info = 0, warning = 1, error = 2 };

std::string server_info_text(const ServerInfo& info);
std::string advertise_text(std::span<const Channel> channels);
std::string advertise_services_text(std::span<const Service> services);
/// @param id of the request that this message answers; empty: none
std::string parameters_text(std::span<const Parameter> parameters, std::string_view id);
std::string status_text(StatusLevel level, std::string_view message);
std::string service_failure_text(std::uint32_t service, std::uint32_t call, std::string_view message);

/// A message from a client. Each operation uses the members in its comment.
struct ClientText {
  enum class Op {
    subscribe,               ///< subscriptions
    unsubscribe,             ///< ids
    advertise,               ///< channels
    unadvertise,             ///< ids
    get_parameters,          ///< names, id
    set_parameters,          ///< parameters, id
    subscribe_parameters,    ///< names
    unsubscribe_parameters,  ///< names
    other                    ///< known but ignored
  };
  struct Subscription {
    std::uint32_t id = 0;
    std::uint32_t channel = 0;
  };
  struct Advertised {
    std::uint32_t id = 0;
    std::string topic;
    std::string encoding;
    std::string type;
  };
  Op op = Op::other;
  std::vector<Subscription> subscriptions;
  std::vector<std::uint32_t> ids;
  std::vector<Advertised> channels;
  std::vector<std::string> names;
  std::vector<Parameter> parameters;
  std::string id;
};

/// @return nullopt if the text is not such a message
std::optional<ClientText> parse_client_text(std::string_view text);

/// Reads a geometry_msgs Twist or TwistStamped in JSON: linear.x, linear.y, angular.z, each 0 if missing.
/// @return nullopt for any other text
std::optional<base::Twist> parse_json_twist(std::string_view text);
/// Reads `data` of a std_srvs SetBool request in JSON.
/// @return nullopt for any other text
std::optional<bool> parse_json_bool(std::string_view text);
/// Returns a response of std_srvs SetBool or Trigger in JSON.
std::string json_response(bool success, std::string_view message);

}  // namespace sf::bridges
