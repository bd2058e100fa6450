#pragma once
// A real Khepera II, driven by its serial protocol. One request is under way at a time.

#include <optional>
#include <string>
#include <vector>

#include "robots/khepera_protocol.h"
#include "server/real_robot.h"

namespace sf::server {

class KheperaDrive final : public RealRobot {
 public:
  /// @param X_WM start pose @param track [m] > 0
  /// @throws base::InputError if the line cannot be opened
  KheperaDrive(const RealRobotType& type, const RealRobotOptions& options, const base::Pose& X_WM, double track);
  ~KheperaDrive() override { stop(); }

  void drive(const base::Twist& twist, std::int64_t now) override;
  /// Stops the wheels. Repeats the command until the robot confirms it.
  void stop() override;
  std::vector<RobotFact> facts() const override;
  RealRobotCounts counts() const override;

 private:
  /// Position counters of the wheels [pulses].
  struct Pulses {
    std::int64_t left = 0, right = 0;
  };

  void start(std::int64_t now) override;
  void take(std::span<const std::uint8_t> bytes, std::int64_t now) override;
  void run(std::int64_t now) override;
  std::string fault() const override;
  void take_line(std::string_view line, std::int64_t now);
  bool accept(const robots::KheperaAnswer& answer, std::int64_t now);
  void take_pulses(const Pulses& pulses, std::int64_t now);
  bool possible(const Pulses& before, const Pulses& after, std::int64_t now) const;
  void clear_line(std::int64_t now);
  void ask(std::int64_t now);
  void ask(char letter, std::initializer_list<int> numbers, std::int64_t now);

  double track_;
  robots::KheperaLines lines_;
  bool stopped_ = false;    ///< the robot confirmed that it stopped, and received no request since
  char pending_ = 0;        ///< letter of the request under way; 0: none; '\n': the line is being cleared
  std::int64_t asked_ = 0;  ///< [ns] of the request under way
  bool counting_ = false;   ///< the counters were set to 0, so the robot answers
  bool drive_due_ = false;  ///< the wheels' speeds are to be sent
  std::size_t round_ = 0;   ///< next of the repeated requests
  robots::KheperaWheels wheels_;
  int fastest_ = 0;                  ///< [pulses per 10 ms] of the last two commands
  int fastest_before_ = 0;           ///< [pulses per 10 ms]
  Pulses pulses_;                    ///< most recent
  std::int64_t counted_ = 0;         ///< [ns] of `pulses_`
  std::optional<Pulses> suspect_;    ///< counters after an impossible motion: of a restarted robot, or damaged
  std::vector<std::int64_t> light_;  ///< ambient light, most recent
};

}  // namespace sf::server
