#pragma once
// A real iRobot Create, driven by its Open Interface.

#include <optional>
#include <string>
#include <vector>

#include "robots/open_interface.h"
#include "server/real_robot.h"

namespace sf::server {

class CreateDrive final : public RealRobot {
 public:
  /// @param X_WM start pose @param track [m] > 0
  /// @throws base::InputError if the line cannot be opened
  CreateDrive(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM, double track);
  ~CreateDrive() override { stop(); }

  void drive(const base::Twist& twist, std::int64_t now) override;
  bool set_outputs(std::uint8_t bits) override;
  /// Stops the wheels and the stream, clears outputs that were set, and enters passive mode.
  void stop() override;
  std::vector<RobotFact> facts() const override;
  RealRobotCounts counts() const override { return counts_with(stream_); }

 private:
  void start(std::int64_t now) override;
  void take(std::span<const std::uint8_t> bytes, std::int64_t now) override;
  std::string fault() const override;
  void take_frame(const robots::CreateFrame& frame, std::int64_t now);
  void add_motion(const robots::CreateFrame& frame);

  double track_;
  robots::CreateStream stream_;
  robots::CreateFrame frame_;            ///< most recent
  std::optional<std::uint8_t> outputs_;  ///< of the cargo bay; nullopt: never set
  bool counting_ = false;                ///< `frame_` is of this start, so the wheels are counted from it
  bool lifted_ = false;                  ///< lifted since it was last in safe mode
};

}  // namespace sf::server
