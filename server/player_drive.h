#pragma once
// A robot behind a Player server, driven as a client of its devices with index 0 (docs/robots.md).

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "netio/player/protocol.h"
#include "netio/player/xdr.h"
#include "server/real_robot.h"

namespace sf::server {

class PlayerDrive final : public RealRobot {
 public:
  /// Maximum accepted payload of a message [byte].
  static constexpr std::size_t kMostPayload = 1u << 20;

  /// @param X_WM start pose
  /// @throws base::InputError if the server does not accept the connection
  PlayerDrive(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM, double track);
  ~PlayerDrive() override { stop(); }

  void drive(const base::Twist& twist, std::int64_t now) override;
  /// Stops the robot, whose driver also stops it when the connection ends.
  void stop() override;
  std::vector<RobotFact> facts() const override;

 private:
  /// Data of `power`, as far as it is valid.
  struct Power {
    std::uint32_t valid = 0;
    float volts = 0.0f, percent = 0.0f, joules = 0.0f, watts = 0.0f;
    std::int32_t charging = 0;
  };

  void start(std::int64_t now) override;
  void take(std::span<const std::uint8_t> bytes, std::int64_t now) override;
  std::string silence(bool connected) const override;

  void give_up(std::string trouble);
  bool greet();
  void send(netio::player::MessageType type, const netio::player::Address& to, std::uint32_t subtype,
            const base::Bytes& payload);
  // Return whether the payload is well-formed.
  bool take_message(const netio::player::Header& header, netio::player::XdrReader xdr, std::int64_t now);
  bool take_answer(const netio::player::Header& header, netio::player::XdrReader& xdr);
  bool take_list(netio::player::XdrReader& xdr);
  bool take_opened(netio::player::XdrReader& xdr);
  bool take_geometry(netio::player::XdrReader& xdr);
  bool take_data(netio::player::Interface interf, netio::player::XdrReader& xdr, std::int64_t now);
  bool take_state(netio::player::XdrReader& xdr, std::int64_t now);
  bool take_sonar(netio::player::XdrReader& xdr, std::int64_t now);
  bool take_infrared(netio::player::XdrReader& xdr, std::int64_t now);
  bool take_bumpers(netio::player::XdrReader& xdr, std::int64_t now);
  bool take_power(netio::player::XdrReader& xdr, std::int64_t now);

  base::Bytes in_;                  ///< received, incomplete message
  bool greeted_ = false;            ///< the banner arrived
  bool opened_ = false;             ///< position2d is open
  std::string trouble_;             ///< why the last connection is of no use; empty: it is
  std::optional<base::Pose> X_OM_;  ///< by the server's odometry, as last reported in this connection
  bool stalled_ = false, bumped_ = false;
  std::optional<Power> power_;
  std::array<double, 2> size_{};  ///< [m] length and width; 0: unknown
};

}  // namespace sf::server
