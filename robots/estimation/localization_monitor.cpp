#include "robots/estimation/localization_monitor.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sf::estimation {

namespace {

constexpr std::int64_t kCopyAge = 10'000'000'000;   // [ns] between copies
constexpr std::int64_t kPatience = 10'000'000'000;  // [ns] for evidence that isolates a fault
constexpr std::int64_t kOnset = 2'000'000'000;      // [ns] before a large residual, a sudden fault has not begun
constexpr double kEvidence = 10.0;                  // squared distances by which one of two headings is worse
constexpr double kLatePeriods = 3.5;                // age of the newest reading of an absent input
constexpr double kLateness = 0.3;                   // [s] beyond the latency; updates may be 0.1 s apart
constexpr int kMostRepeats = 2, kMostEncoderRepeats = 5;

/// The relation between the two other inputs.
constexpr std::array<MonitorRelation, kMonitoredInputs> kRest{kCourseRelation, kWheelsRelation, kTurnRelation};

std::size_t row(MonitoredInput input) { return static_cast<std::size_t>(input); }
/// As for the filters' measurements.
bool is_plausible(double v) { return std::abs(v) <= 1e9; }
double in_seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// A slip that lasts is a fault of the encoder here.
LocalizationOptions without_slips(LocalizationOptions options) {
  options.learn_slip = false;
  return options;
}

}  // namespace

MonitorThresholds default_thresholds() {
  return {.fast = {13.0, 11.0, 8.0, 10.0}, .slow = {49.0, 18.0, 18.0, 32.0}, .roughness = 13.0};
}

LocalizationMonitor::LocalizationMonitor(const LocalizationOptions& options, const MonitorOptions& monitor,
                                         bool has_gyro, bool has_gps)
    : options_(without_slips(options)),
      monitor_(monitor),
      main_(options_),
      copies_{{{main_, main_}, {main_, main_}, {main_, main_}}},
      calibrations_{main_.calibration(), main_.calibration()} {
  at(MonitoredInput::encoder).wired = options.encoder.has_value();
  at(MonitoredInput::gyro).wired = has_gyro;
  at(MonitoredInput::gps).wired = has_gps;
}

/// Passes a reading to the filters that use the input.
template <class Add>
void LocalizationMonitor::feed(MonitoredInput input, const Add& add) {
  if (at(input).faulty) return;
  add(main_);
  // The copies are made again when all inputs are good.
  if (std::ranges::any_of(inputs_, &Input::faulty)) return;
  for (const MonitoredInput without : kEachMonitoredInput)
    if (without != input)
      for (Localization& copy : copies_[row(without)]) add(copy);
}

void LocalizationMonitor::note(MonitoredInput input, std::int64_t time, std::array<double, 2> values, bool fixed) {
  Input& known = at(input);
  if (time <= known.newest) return;
  known.repeats = fixed && known.newest >= 0 && values == known.values ? known.repeats + 1 : 0;
  if (known.repeats == 0) known.changed = time;
  known.newest = time, known.values = values, known.fixed = fixed, known.arrived = true;
}

void LocalizationMonitor::add_pose(std::int64_t time, const base::Pose& X_WM, const std::array<double, 6>& covariance) {
  main_.add_pose(time, X_WM, covariance);
  for (auto& copies : copies_)
    for (Localization& copy : copies) copy.add_pose(time, X_WM, covariance);
}

void LocalizationMonitor::add_encoder(std::int64_t time, double left, double right) {
  const Input before = at(MonitoredInput::encoder);
  feed(MonitoredInput::encoder, [&](Localization& filter) { filter.add_encoder(time, left, right); });
  note(MonitoredInput::encoder, time, {left, right}, is_plausible(left) && is_plausible(right));
  if (before.newest < 0 || time <= before.newest || !before.fixed) return;
  const double seconds = in_seconds(time - before.newest);
  const std::array<double, 2> rolled{left - before.values[0], right - before.values[1]};
  rolled_ = {time, seconds, rolled};
  compare_turns();
  if (before.faulty) compare_speed(time, seconds, rolled);
}

void LocalizationMonitor::add_gyro(std::int64_t time, double rate) {
  feed(MonitoredInput::gyro, [&](Localization& filter) { filter.add_gyro(time, rate); });
  note(MonitoredInput::gyro, time, {rate, 0.0}, is_plausible(rate));
  compare_turns();
}

void LocalizationMonitor::add_gps(std::int64_t time, double x, double y, double hdop) {
  const bool fixed = is_plausible(x) && is_plausible(y) && is_plausible(hdop);
  if (fixed) compare_with_gps(time, {x, y}, hdop);
  feed(MonitoredInput::gps, [&](Localization& filter) { filter.add_gps(time, x, y, hdop); });
  note(MonitoredInput::gps, time, {x, y}, fixed);
}

double LocalizationMonitor::ratio(MonitorRelation relation) const {
  const Statistic& of = statistics_[relation];
  return std::max(of.fast / monitor_.thresholds.fast[relation], of.slow / monitor_.thresholds.slow[relation]);
}

double LocalizationMonitor::residual(MonitoredInput input) const {
  if (input == MonitoredInput::gps) return ratio(kReckonedRelation);
  if (input == MonitoredInput::gyro) return ratio(kTurnRelation);
  return std::max(ratio(kTurnRelation), ratio(kWheelsRelation));
}

bool LocalizationMonitor::is_late(MonitoredInput input) const {
  const Input& of = at(input);
  const double age = in_seconds(now_ - std::max<std::int64_t>(of.newest, 0));
  return of.delayed || age > kLatePeriods * monitor_.period[row(input)] + monitor_.latency[row(input)];
}

InputState LocalizationMonitor::state(MonitoredInput input) const {
  const Input& of = at(input);
  if (!of.wired) return InputState::absent;
  if (of.faulty) return InputState::faulty;
  if (is_late(input) || !of.fixed) return InputState::absent;
  if (!suspected_) return InputState::good;
  // The cause is among the inputs of a residual that is too large.
  const bool turn = ratio(kTurnRelation) > 1.0;
  if (turn) return input == MonitoredInput::gps ? InputState::good : InputState::suspected;
  if (ratio(kReckonedRelation) > 1.0) return InputState::suspected;
  const auto other = ratio(kWheelsRelation) > 1.0 ? MonitoredInput::gyro : MonitoredInput::encoder;
  return input == other ? InputState::good : InputState::suspected;
}

void LocalizationMonitor::update(std::int64_t now) {
  now_ = now;
  for (const MonitoredInput input : kEachMonitoredInput)
    if (std::exchange(at(input).arrived, false))
      at(input).delayed = in_seconds(now - at(input).newest) > monitor_.latency[row(input)] + kLateness;
  for (const MonitoredInput input : kEachMonitoredInput)
    if (at(input).faulty) {
      if (!is_consistent(input)) at(input).wrong = now;
      const double hold = std::ldexp(monitor_.hold, std::min(static_cast<int>(at(input).faults) - 1, 6));
      if (in_seconds(now - at(input).wrong) > hold) hand_back(input, now);
      return;
    }
  pause_absent_encoder(now);
  bool large = false;
  for (int k = 0; k < kRelations; ++k) large = large || ratio(static_cast<MonitorRelation>(k)) > 1.0;
  if (!large) suspected_.reset();
  if (large && !suspected_) suspected_ = now, sudden_ = is_sudden();
  if (const auto input = isolated(now)) return exclude(*input, now);
  refresh(now);
}

/// An encoder that is too late for the filter's window cannot bound the motion.
void LocalizationMonitor::pause_absent_encoder(std::int64_t now) {
  const Input& encoder = at(MonitoredInput::encoder);
  if (!encoder.wired) return;
  const bool absent = now - std::max<std::int64_t>(encoder.newest, 0) > Localization::kWindow;
  if (absent == paused_) return;
  paused_ = absent;
  absent ? main_.pause_encoder() : main_.resume_encoder();
  make_copies(now);
}

std::optional<MonitoredInput> LocalizationMonitor::isolated(std::int64_t now) const {
  using enum MonitoredInput;
  // Noise does not repeat.
  if (options_.gyro.noise > 0.0 && at(gyro).repeats >= kMostRepeats) return gyro;
  if (options_.gps_noise > 0.01 && at(gps).repeats >= kMostRepeats) return gps;
  if (!suspected_) return std::nullopt;
  const bool patient = now - *suspected_ < kPatience;
  if (ratio(kTurnRelation) > 1.0) {
    // Wheels that were at rest before do not begin to count falsely, and those that stop just then are stuck.
    const Input& wheels = at(encoder);
    const std::int64_t rested = *suspected_ - wheels.changed;
    if (wheels.repeats >= kMostEncoderRepeats && rested >= 0) return rested > kOnset ? gyro : encoder;
    if (std::abs(roughness_) > monitor_.thresholds.roughness) return roughness_ > 0.0 ? gyro : encoder;
    const double evidence = reckonings_[0].evidence;
    if (!at(gps).wired || (patient && std::abs(evidence) < kEvidence)) return std::nullopt;
    return evidence > 0.0 ? encoder : gyro;
  }
  if (!std::ranges::all_of(inputs_, &Input::wired)) return std::nullopt;
  // Without the faulty input the others agree, and without any other they do not.
  auto order = kEachMonitoredInput;
  const auto rest = [&](MonitoredInput input) { return ratio(kRest[row(input)]); };
  std::ranges::sort(order, {}, rest);
  if (rest(order[0]) < 0.5 && rest(order[1]) > 1.0) return order[0];
  if (patient) return std::nullopt;
  if (ratio(kReckonedRelation) > 1.0 || ratio(kWheelsRelation) > 1.0) return rest(encoder) < rest(gps) ? encoder : gps;
  return rest(gyro) < rest(gps) ? gyro : gps;
}

bool LocalizationMonitor::is_sudden() const {
  for (std::size_t k = 0; k < kRelations; ++k)
    if (statistics_[k].fast > monitor_.thresholds.fast[k]) return true;
  return false;
}

/// Continues without the input from before the fault.
void LocalizationMonitor::exclude(MonitoredInput input, std::int64_t now) {
  Input& of = at(input);
  const bool sudden = suspected_ ? sudden_ : true;
  const bool recent = sudden && suspected_.value_or(now) - copied_ > kOnset;
  main_ = copies_[row(input)][recent ? 1 : 0];
  of.faulty = true, of.wrong = now;
  ++of.faults;
  paused_ = false;
  suspected_.reset();
  statistics_ = {};
}

bool LocalizationMonitor::is_consistent(MonitoredInput input) const {
  const Input& of = at(input);
  const bool repeats = input != MonitoredInput::encoder && of.repeats >= kMostRepeats;
  if (is_late(input) || !of.fixed || repeats) return false;
  if (input == MonitoredInput::gps) return ratio(kReckonedRelation) < monitor_.lower;
  const bool turns = ratio(kTurnRelation) < monitor_.lower;
  return turns && (input == MonitoredInput::gyro || ratio(kWheelsRelation) < monitor_.lower);
}

void LocalizationMonitor::hand_back(MonitoredInput input, std::int64_t now) {
  at(input).faulty = false;
  if (input == MonitoredInput::encoder) main_.resume_encoder();
  statistics_ = {};
  make_copies(now);
}

void LocalizationMonitor::make_copies(std::int64_t now) {
  for (const MonitoredInput without : kEachMonitoredInput) {
    copies_[row(without)] = {main_, main_};
    if (without == MonitoredInput::encoder)
      for (Localization& copy : copies_[row(without)]) copy.pause_encoder();
  }
  calibrations_.fill(main_.calibration());
  reckonings_.fill(Reckoning(main_.predict(now)));
  copied_ = now;
}

/// Replaces the older copies by the newer ones, and these by the main filter, unless it may contain a fault.
void LocalizationMonitor::refresh(std::int64_t now) {
  if (copied_ < 0) return make_copies(now);
  if (suspected_ || now - copied_ < kCopyAge) return;
  for (const MonitoredInput without : kEachMonitoredInput) {
    auto& [older, newer] = copies_[row(without)];
    older = std::move(newer);
    newer = main_;
    if (without == MonitoredInput::encoder) newer.pause_encoder();
  }
  calibrations_ = {calibrations_[1], main_.calibration()};
  reckonings_ = {reckonings_[1], Reckoning(main_.predict(now))};
  copied_ = now;
}

}  // namespace sf::estimation
