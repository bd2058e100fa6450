#pragma once
// Requests and commands of Player's clients to devices.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "bridges/player/devices.h"
#include "bridges/player/exchange.h"

namespace sf::bridges::player {

/// The answer to a request.
struct Answer {
  enum class Kind { granted, refused, malformed } kind = Kind::refused;
  base::Bytes payload;  ///< if granted
};

/// Returns whether the process of a mover follows the commands that a service forwards. Called on the server's thread.
using Follows = std::function<bool(std::uint32_t mover)>;

/// Not thread-safe.
class Requester {
 public:
  /// @param follows of a service that forwards commands; empty: the run moves robots, or commands are ignored
  Requester(const Scene& scene, const Devices& devices, Exchange& exchange, const Follows& follows);

  Answer request(std::uint32_t device, std::uint32_t subtype, std::span<const std::uint8_t> payload);
  /// Returns false if the command is malformed. Ignores commands that a device does not support or that are not finite.
  bool command(std::uint32_t device, std::uint32_t subtype, std::span<const std::uint8_t> payload);
  /// Returns false after a client has turned the device off, until a client turns it on.
  bool is_on(std::uint32_t device) const { return on_[device] != 0; }

 private:
  Answer to_sensor(std::uint32_t device, std::uint32_t subtype, std::span<const std::uint8_t> payload);
  Answer to_position(const Device& device, std::uint32_t subtype, std::span<const std::uint8_t> payload);
  Answer to_simulation(std::uint32_t subtype, std::span<const std::uint8_t> payload);
  Answer to_map(std::uint32_t subtype, std::span<const std::uint8_t> payload);
  bool moves(std::uint32_t mover) const;
  std::optional<base::Pose> pose_of(const std::string& name);
  std::optional<std::uint32_t> find_mover(const std::string& name) const;
  bool drive(const Device& device, std::uint32_t subtype, XdrReader& xdr);
  void drive(std::uint32_t mover, position2d::Command command, const std::array<double, 6>& numbers);

  const Scene scene_;
  const Devices& devices_;
  Exchange& exchange_;
  Follows follows_;
  std::vector<char> on_;  ///< per device
};

}  // namespace sf::bridges::player
