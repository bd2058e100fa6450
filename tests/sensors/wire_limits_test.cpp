// Ranges read from packets stay on their side of the sensor's limits, even if the limits are not whole units of the
// wire.

#include <gtest/gtest.h>

#include <cmath>

#include "sensors/gyro.h"
#include "sensors/infrared.h"
#include "sensors/laneedge.h"
#include "sensors/laser.h"
#include "sensors/laser_packets.h"
#include "sensors/magnetometer.h"
#include "sensors/occupancy.h"
#include "sensors/sonar.h"
#include "tests/sensors/chance.h"

namespace sf::sensors {
namespace {

/// A sensor type and wire form, with the step of its ranges [m].
struct Form {
  const SensorType* type;
  WireFormat wire;
  double step;
  double longest;  ///< [m] range_max
};

std::vector<Form> forms() {
  const SensorType* laser = find_sensor_type(kLaser);
  return {{laser, WireFormat::farm, 1e-3, kPlainRange},
          {laser, WireFormat::thesis, 1e-3, kPlainRange},
          {laser, WireFormat::farm, 1e-4, 4e5},
          {find_sensor_type(kSonar), WireFormat::farm, 1e-3, 1e4},
          {find_sensor_type(kInfrared), WireFormat::farm, 1e-6, 2e3}};
}

/// Returns the range that a receiver reads.
double received(const Form& form, SensorSpec row, double range) {
  const bool extended = form.step < 1e-3 && form.type->id == kLaser;
  row.elements = extended ? kPlainRays + 1 : 1;
  const std::size_t width = element_width(*form.type);
  std::vector<double> values(row.elements * width, 0.0), read(values.size());
  values[0] = range;
  base::ReadingBlock block{.type = form.type->id, .values = values};
  base::Bytes bytes;
  const std::uint8_t packet = form.type->encode(row, block, form.wire, 0, bytes);
  EXPECT_EQ(form.type->decode(row, bytes, packet, form.wire).fault, PayloadError::none) << range;
  form.type->read(row, bytes, packet, form.wire, read);
  if (form.type->wire_error != nullptr && std::isfinite(range)) {
    EXPECT_LE(std::abs(read[0] - range), form.type->wire_error(row, block)) << "the stated error covers it";
  }
  return read[0];
}

void keeps_sides(const Form& form, double least, double most, trial::Chance& chance) {
  SensorSpec row;
  row.range_min = least, row.limit = most;
  const auto read = [&](double range) { return received(form, row, range); };
  EXPECT_EQ(read(most), most) << "no echo, of " << most << " m";
  EXPECT_EQ(read(least), least) << "too near, up to " << least << " m";
  for (int i = 0; i < 20; ++i) {
    const double away = form.step * chance.between(0.0, 3.0);
    for (const double range : {least + away, most - away, chance.between(least, most)}) {
      if (range < least || range > most) continue;
      const double seen = read(range);
      EXPECT_TRUE(seen >= least && seen <= most) << seen << " in [" << least << ", " << most << "]";
      EXPECT_LE(std::abs(seen - range), 1.000001 * form.step + 1e-15 * range) << range;
      const bool clear = range > least + form.step && range < most - form.step;
      EXPECT_TRUE(!clear || (seen > least && seen < most)) << "a surface in range: " << range;
    }
  }
}

TEST(WireLimits, RangesKeepTheirSide) {
  trial::Chance chance(7);
  for (const Form& form : forms())
    for (int i = 0; i < 300; ++i) {
      const double most = std::exp(chance.between(std::log(20.0 * form.step), std::log(form.longest)));
      const double least = i % 3 == 0 ? 0.0 : std::min(chance.between(0.0, 0.5), 0.5) * most;
      keeps_sides(form, least, most, chance);
    }
}

TEST(WireLimits, ReadsTheExpectedRanges) {
  struct Case {
    const char* why;
    double least, most, range, read;
  };
  const SensorType* laser = find_sensor_type(kLaser);
  for (const Case& c :
       {Case{"rounded down, below range_max", 0.0, 3.0004, 3.0004, 3.0004},
        {"the first number of that word", 0.0, 3.0004, 2.9995, 3.0004},
        {"the last of the word before it", 0.0, 3.0004, 2.9994, 2.999},
        {"rounded up, beyond range_max", 0.0, 3.0006, 3.0006, 3.0006},
        {"rounded up, beyond range_min", 0.2036, 3.0, 0.2036, 0.2036},
        {"the last number of that word", 0.2036, 3.0, 0.2044, 0.2036},
        {"the first of the word after it", 0.2036, 3.0, 0.2046, 0.205},
        {"rounded down, below range_min", 0.2034, 3.0, 0.2034, 0.2034},
        {"a range of 0 is valid with range_min 0", 0.0, 3.0, 0.0, 0.0},
        {"limits of one word: too near comes first, since nothing is free then", 3.0, 3.0004, 3.0004, 3.0},
        {"without a minimum there is no echo", 0.0, 0.0004, 0.0004, 0.0004},
        {"no return", 0.0, 3.0004, HUGE_VAL, HUGE_VAL},
        {"the last word is range_max where that is its number", 0.0, 65.535, HUGE_VAL, 65.535}}) {
    SensorSpec row;
    row.range_min = c.least, row.limit = c.most;
    for (const WireFormat wire : {WireFormat::farm, WireFormat::thesis})
      EXPECT_EQ(received({laser, wire, 1e-3, kPlainRange}, row, c.range), c.read) << c.why;
  }
}

/// Returns the number `at` of a reading with one element as a receiver reads it; the others are 0.
double received(std::uint8_t type, std::size_t at, double value) {
  const SensorType* const sensor_type = find_sensor_type(type);
  std::vector<double> values(element_width(*sensor_type)), read(values.size());
  values[at] = value;
  const SensorSpec row;
  base::Bytes bytes;
  const std::uint8_t packet = sensor_type->encode(row, {.type = type, .values = values}, WireFormat::farm, 0, bytes);
  sensor_type->read(row, bytes, packet, WireFormat::farm, read);
  return read[at];
}

/// The last word of each number, the values next to it, and values whose words would wrap.
TEST(WireLimits, WordsSaturateAndDoNotWrap) {
  constexpr double kField = 21.47483647, kTurn = 2147.483647, kInf = HUGE_VAL;
  for (const auto& [value, read] :
       {std::pair{65'534.0, 65'534.0}, {65'536.0, 65'535.0}, {131'072.0, 65'535.0}, {-1.0, 0.0}})
    EXPECT_EQ(received(kLaneEdge, 1, value), read) << value << " points";
  for (const std::size_t at : {2u, 3u}) {
    EXPECT_EQ(received(kLaneEdge, at, 4294.967294), 4294.967294);
    for (const double none : {4294.967295, 4294.967296, 8589.934592, kInf})
      EXPECT_TRUE(std::isnan(received(kLaneEdge, at, none))) << none;
  }
  for (std::size_t at = 0; at < kMagnetometerColumns; ++at)
    for (const auto& [value, read] : {std::pair{kField, kField},
                                      {21.47483648, kField},
                                      {42.94967296, kField},
                                      {-21.47483648, -21.47483648},
                                      {-21.4748365, -21.47483648},
                                      {5e-324, 0.0}})
      EXPECT_EQ(received(kMagnetometer, at, value), read) << value << " T";
  for (const auto& [value, read] : {std::pair{kTurn, kTurn},
                                    {2147.483648, kTurn},
                                    {4294.967296, kTurn},
                                    {-2147.483648, -kTurn},
                                    {-2147.483649, -kTurn}})
    EXPECT_EQ(received(kGyro, 0, value), read) << value << " rad/s";
}

TEST(WireLimits, OrderAndSignArePreserved) {
  for (const SensorType* type : built_in_sensor_types()) {
    if (type->id == kLaneEdge || type->id == kOccupancy) continue;  // values beyond the wire are none; words
    double before = -HUGE_VAL;
    for (const double value : {-HUGE_VAL, -1e300, -4294967296.0, -2147483648.0, -1.0, 0.0, 1.0, 65'536.0, 2147483647.0,
                               2147483648.0, 4294967296.0, 1e300, HUGE_VAL}) {
      const double read = received(type->id, 0, value);
      EXPECT_TRUE(read >= before && (value <= 0.0 ? read <= 0.0 : read >= 0.0)) << type->name << ": " << value;
      before = read;
    }
  }
}

}  // namespace
}  // namespace sf::sensors
