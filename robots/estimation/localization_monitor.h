#pragma once
// Localizes a robot as Localization does, and monitors its encoders, gyro and satellite receiver: detects that one is
// faulty, isolates it, continues without it from before the fault, and hands back.
//
//   LocalizationMonitor monitor(options, {});
//   monitor.add_encoder(time, left, right);    // and so on, as for Localization
//   monitor.update(now);                       // once per step
//   monitor.predict(now), monitor.state(MonitoredInput::gyro)
//
// Method: a bank of filters over one motion model (a generalized observer scheme). The main filter uses all inputs. For
// each input there are two copies of the main filter that have not used this input for up to 10 s and for 10 to 20 s.
// Four residuals relate the inputs, each normalised by its covariance:
//
//   turn      encoder - gyro       yaw rates of both
//   wheels    encoder - satellites positions against the copy without the gyro
//   course    gyro - satellites    positions against the copy without the encoder
//   reckoned  all                  positions against the copy without satellites, dead reckoning
//
// A large residual is a fault of one of its inputs. The faulty input is the one without which the others agree: an
// encoder if `course` is small, a gyro if `wheels` is, a receiver if `turn` is. Where `turn` is large, the faulty yaw
// rate is the one that changes more from reading to reading, else the one by which dead reckoning leaves the positions.
// Faults of one input at a time are isolated.
//
// Reference: P. M. Frank, Fault diagnosis in dynamic systems using analytical and knowledge-based redundancy,
// Automatica 26, 1990. We deviate in the copies: a filter that never used an input would not know the constants that
// this input shows.

#include <array>
#include <cstdint>
#include <optional>

#include "robots/estimation/localization.h"

namespace sf::estimation {

enum class MonitoredInput : std::uint8_t { encoder, gyro, gps };
inline constexpr std::array kEachMonitoredInput{MonitoredInput::encoder, MonitoredInput::gyro, MonitoredInput::gps};
inline constexpr std::size_t kMonitoredInputs = kEachMonitoredInput.size();

enum class InputState : std::uint8_t {
  good,
  faulty,    ///< not used
  absent,    ///< no reading for 3.5 of its periods, late readings, or none with a fix; or the robot does not have it
  suspected  ///< used; a residual is too large, and this input is one of those that may be the cause
};

/// Residuals between inputs, in the order of MonitorThresholds.
enum MonitorRelation : std::uint8_t { kTurnRelation, kWheelsRelation, kCourseRelation, kReckonedRelation, kRelations };

/// Limits of the statistics of residuals: 1 is their mean without faults if the model is exact.
struct MonitorThresholds {
  std::array<double, kRelations> fast;  ///< mean of the squares of the last two to five residuals, for sudden faults
  std::array<double, kRelations> slow;  ///< squared mean residual of 2 to 10 s, for slow faults
  double roughness;  ///< mean difference between the squared changes of both yaw rates, normalised; below, neither
                     ///< counts as rougher
};
/// Returns the thresholds that docs/derived.md derives from runs without faults.
MonitorThresholds default_thresholds();

struct MonitorOptions {
  MonitorThresholds thresholds = default_thresholds();
  std::array<double, kMonitoredInputs> period{0.1, 0.1, 1.0};  ///< [s] > 0 between readings
  std::array<double, kMonitoredInputs> latency{};              ///< [s] >= 0
  double lower = 0.5;  ///< share of the thresholds below which an input is handed back
  double hold = 10.0;  ///< [s] time below before it is; doubles with each fault of the same input, up to 64 times
};

/// Not thread-safe.
class LocalizationMonitor {
 public:
  LocalizationMonitor(const LocalizationOptions& options, const MonitorOptions& monitor, bool has_gyro, bool has_gps);

  // As for Localization, in order of arrival.
  void add_encoder(std::int64_t time, double left, double right);
  void add_gyro(std::int64_t time, double rate);
  void add_gps(std::int64_t time, double x, double y, double hdop);
  void add_pose(std::int64_t time, const base::Pose& X_WM, const std::array<double, 6>& covariance);

  /// Decides on faults by the readings that arrived by `now` [ns]. Not decreasing.
  void update(std::int64_t now);

  /// Returns the estimate from the inputs that are not faulty.
  Prediction predict(std::int64_t time) const { return main_.predict(time); }
  InputState state(MonitoredInput input) const;
  /// Returns the largest statistic of the residuals that test this input, as a share of its threshold: 1 is an alarm.
  double residual(MonitoredInput input) const;

  struct Statistic {
    double fast = 0.0, slow = 0.0;  ///< as in MonitorThresholds
    std::array<double, 2> mean{};
  };
  /// For the choice of thresholds:
  const Statistic& statistic(MonitorRelation relation) const { return statistics_[relation]; }
  double roughness() const { return roughness_; }  ///< > 0: the gyro changes more

 private:
  struct Input {
    bool wired = false;
    bool faulty = false;
    bool arrived = false;            ///< the newest reading came after the last update
    bool delayed = false;            ///< it came later than its latency
    std::int64_t newest = -1;        ///< [ns] of measurement; -1: none
    bool fixed = true;               ///< the newest reading has a value
    std::array<double, 2> values{};  ///< the newest
    std::int64_t changed = 0;        ///< [ns] when its values last changed
    int repeats = 0;                 ///< identical successive readings before the newest
    std::int64_t wrong = 0;          ///< [ns] last time at which a faulty input was inconsistent
    int faults = 0;                  ///< how often it was faulty
  };
  Input& at(MonitoredInput input) { return inputs_[static_cast<std::size_t>(input)]; }
  const Input& at(MonitoredInput input) const { return inputs_[static_cast<std::size_t>(input)]; }

  template <class Add>
  void feed(MonitoredInput input, const Add& add);
  void note(MonitoredInput input, std::int64_t time, std::array<double, 2> values, bool fixed);
  Localization& older_without(MonitoredInput input) { return copies_[static_cast<std::size_t>(input)][0]; }
  void compare_with_gps(std::int64_t time, glm::dvec2 p, double hdop);
  void compare_turns();
  void compare_roughness(double rate, double turn, double variance);
  void compare_speed(std::int64_t time, double seconds, std::array<double, 2> rolled);
  void compare_position(MonitorRelation relation, const Localization& filter, std::int64_t time, glm::dvec2 p,
                        double variance);
  double ratio(MonitorRelation relation) const;
  bool is_sudden() const;
  void refresh(std::int64_t now);
  void make_copies(std::int64_t now);
  void pause_absent_encoder(std::int64_t now);
  std::optional<MonitoredInput> isolated(std::int64_t now) const;
  void exclude(MonitoredInput input, std::int64_t now);
  void hand_back(MonitoredInput input, std::int64_t now);
  bool is_consistent(MonitoredInput input) const;
  bool is_late(MonitoredInput input) const;

  LocalizationOptions options_;
  MonitorOptions monitor_;
  Localization main_;
  std::array<std::array<Localization, 2>, kMonitoredInputs> copies_;  ///< without that input: the older, the newer
  std::array<Calibration, 2> calibrations_;  ///< those of the main filter when the copies were made
  std::int64_t copied_ = -1;                 ///< [ns] when the newer copies were made; -1: never
  std::array<Input, kMonitoredInputs> inputs_;
  std::array<Statistic, kRelations> statistics_;
  /// Two poses by the wheels' distance, one with each yaw rate: satellites show which is wrong.
  struct Reckoning {
    Reckoning() = default;
    explicit Reckoning(const Prediction& start) : by_encoder(start.estimate.X_WM), by_gyro(start.estimate.X_WM) {}
    base::Pose by_encoder, by_gyro;
    double evidence = 0.0;  ///< sum of differences of squared distances, normalised; > 0: the encoder's is wrong
  };
  std::array<Reckoning, 2> reckonings_;  ///< as old as the copies
  struct Rolled {
    std::int64_t time = -1;            ///< [ns] of an encoder reading; -1: compared
    double seconds = 0.0;              ///< [s] since the one before
    std::array<double, 2> distance{};  ///< [m] counted since then
  };
  Rolled rolled_;                                  ///< not yet compared with the gyro
  double mean_roughness_ = 0.0, roughness_ = 0.0;  ///< now; its largest magnitude, with decay
  double turn_ = 0.0;                              ///< [rad/s] yaw rate of the last encoder interval
  double compared_rate_ = 0.0;                     ///< [rad/s] the gyro's at that time
  std::optional<std::int64_t> suspected_;          ///< [ns] since when a residual is too large
  bool sudden_ = false;                            ///< a fault that had begun just before, else possibly long before
  bool paused_ = false;                            ///< the main filter does without an absent encoder
  std::int64_t now_ = 0;                           ///< [ns] of the last update
};

}  // namespace sf::estimation
