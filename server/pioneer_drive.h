#pragma once
// A real Pioneer 3 (AT), driven by ARCOS packets.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "robots/arcos.h"
#include "server/real_robot.h"

namespace sf::server {

class PioneerDrive final : public RealRobot {
 public:
  /// @param X_WM start pose
  /// @throws base::InputError if the line cannot be opened
  PioneerDrive(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM, double track);
  ~PioneerDrive() override { stop(); }

  void drive(const base::Twist& twist, std::int64_t now) override;
  /// Stops the wheels and ends the session.
  void stop() override;
  std::vector<RobotFact> facts() const override;
  RealRobotCounts counts() const override { return counts_with(stream_); }

 private:
  static constexpr std::uint8_t kOpen = 3;  ///< value of `stage_` during a session

  void start(std::int64_t now) override;
  void take(std::span<const std::uint8_t> bytes, std::int64_t now) override;
  void run(std::int64_t now) override;
  std::string fault() const override;
  void synchronize(std::span<const std::uint8_t> payload, std::int64_t now);
  void enable(std::int64_t now);
  void take_sip(const robots::ArcosSip& sip, std::int64_t now);

  robots::ArcosStream stream_;
  robots::ArcosName name_;
  bool powered_ = false;                             ///< the motors were on in this session
  std::int64_t enabled_ = 0;                         ///< [ns] of the last attempt to switch the motors on
  std::uint8_t stage_ = 0;                           ///< awaited synchronization packet, 0 to 2, or kOpen
  std::int64_t sent_ = 0;                            ///< [ns] of the last command
  std::optional<robots::ArcosSip> sip_;              ///< most recent of this session
  std::array<double, robots::kArcosSonars> ranges_;  ///< [m]
};

}  // namespace sf::server
