// Values at and beyond the limits of the wire formats.

#include <fmt/format.h>

#include "selftest/fixture.h"
#include "selftest/suite.h"
#include "sensors/gyro.h"
#include "sensors/laneedge_settings.h"
#include "sensors/laser.h"
#include "sensors/magnetometer.h"

namespace sf::selftest {

namespace {

using sensors::SensorSpec;
using sensors::SensorType;
using sensors::WireFormat;

/// Returns the received values after encoding and decoding; empty if nothing is sent.
std::vector<double> decoded(const SensorType& sensor_type, const SensorSpec& row, const std::vector<double>& values,
                            Checks& checks) {
  base::ReadingBlock reading;
  reading.values = values;
  base::Bytes payload;
  const std::uint8_t type = sensor_type.encode(row, reading, WireFormat::farm, 0, payload);
  if (type == 0) return {};
  const sensors::PayloadPart part = sensor_type.decode(row, payload, type, WireFormat::farm);
  checks.holds(part.fault == sensors::PayloadError::none,
               fmt::format("{}: the sent payload is accepted", sensor_type.name));
  std::vector<double> got(values.size());
  if (part.fault == sensors::PayloadError::none) sensor_type.read(row, payload, type, WireFormat::farm, got);
  return got;
}

struct Sent {
  double value, told;
};

/// Checks one number of a reading; the other numbers remain fixed.
void expect(Checks& checks, const SensorType& sensor_type, const SensorSpec& row, std::span<const Sent> sent,
            std::size_t at, std::size_t width) {
  for (const Sent& s : sent) {
    std::vector<double> values(width, 0.0);
    values[at] = s.value;
    const auto got = decoded(sensor_type, row, values, checks);
    const auto what = fmt::format("{} number {}: {:.17g}", sensor_type.name, at, s.value);
    if (got.size() == width)
      checks.same(got[at], s.told, what);
    else
      checks.holds(std::isnan(s.value), what + " was not sent");
  }
}

SensorSpec row_of(std::uint32_t elements, double limit) {
  SensorSpec row;
  row.elements = elements;
  row.limit = limit;
  return row;
}

constexpr Sent kPlainLaser[] = {{-1.0, 0.0},        {-kInfinity, 0.0}, {-0.0, 0.0},         {5e-324, 0.0},
                                {0.000499999, 0.0}, {0.0005, 0.001},   {65.534, 65.534},    {65.5344, 65.534},
                                {65.535, 65.535},   {65.536, 65.535},  {66.0, 65.535},      {131.072, 65.535},
                                {1e9, 65.535},      {kHuge, 65.535},   {kInfinity, 65.535}, {kNan, kNan}};
constexpr Sent kExtendedLaser[] = {{-1.0, 0.0},
                                   {0.00004, 0.0},
                                   {0.00005, 0.0001},
                                   {1e5, 1e5},
                                   {429'496.7294, 429'496.7294},
                                   {429'496.7295, 429'496.7294},
                                   {429'496.7296, 429'496.7294},
                                   {1e6, 429'496.7294},
                                   {kHuge, 429'496.7294},
                                   {kInfinity, kInfinity},
                                   {-kInfinity, 0.0},
                                   {kNan, kNan}};
constexpr Sent kField[] = {{21.47483647, 21.47483647},
                           {21.47483648, 21.47483647},
                           {-21.47483648, -21.47483648},
                           {-21.4748365, -21.47483648},
                           {1e3, 21.47483647},
                           {42.94967296, 21.47483647},
                           {kHuge, 21.47483647},
                           {-kHuge, -21.47483648},
                           {kInfinity, 21.47483647},
                           {-kInfinity, -21.47483648},
                           {4.9e-9, 0.0},
                           {5e-324, 0.0},
                           {kNan, kNan}};
constexpr Sent kDistance[] = {{65.534, 65.534},    {65.535, 65.534}, {65.536, 65.534},  {1e9, 65.534},
                              {kInfinity, 65.534}, {-1.0, 0.0},      {-kInfinity, 0.0}, {kNan, kNan}};
constexpr Sent kPoints[] = {
    {65'534.0, 65'534.0}, {65'535.0, 65'535.0}, {65'536.0, 65'535.0}, {131'072.0, 65'535.0}, {-1.0, 0.0}};
constexpr Sent kSigma[] = {{4294.967294, 4294.967294}, {4294.967295, kNan}, {4294.967296, kNan}, {8589.934592, kNan},
                           {kInfinity, kNan},          {kNan, kNan},        {-1.0, 0.0}};
constexpr Sent kTurnRates[] = {{2147.483647, 2147.483647},   {2147.483648, 2147.483647},
                               {-2147.483647, -2147.483647}, {-2147.483648, -2147.483647},
                               {-2147.483649, -2147.483647}, {4294.967296, 2147.483647},
                               {kInfinity, 2147.483647},     {-kInfinity, -2147.483647},
                               {kHuge, 2147.483647},         {kNan, kNan}};

void lasers(Fixture&, Checks& checks) {
  expect(checks, sensors::laser_type, row_of(1, 65.535), kPlainLaser, 0, 1);
  expect(checks, sensors::laser_type, row_of(1, 1e6), kExtendedLaser, 0, 1);
  for (std::uint32_t word = 0; word <= 0xFFFF; ++word)
    checks.same(decoded(sensors::laser_type, row_of(1, 65.535), {word / 1e3}, checks)[0], word / 1e3,
                "every word of u16", word);
}

void lane_edges(Fixture&, Checks& checks) {
  expect(checks, sensors::laneedge_type, row_of(1, 0.0), kDistance, 0, 4);
  expect(checks, sensors::laneedge_type, row_of(1, 0.0), kPoints, 1, 4);
  for (const std::size_t at : {2, 3}) expect(checks, sensors::laneedge_type, row_of(1, 0.0), kSigma, at, 4);
}

void fields(Fixture&, Checks& checks) {
  for (const std::size_t at : {0, 1, 2, 3}) expect(checks, sensors::magnetometer_type, row_of(1, 0.0), kField, at, 4);
}

/// Numbers of every sensor type from -1e300 to 1e300: order and sign are preserved.
void all_types(Fixture&, Checks& checks) {
  expect(checks, sensors::gyro_type, row_of(1, 0.0), kTurnRates, 0, 1);
  for (const SensorType* sensor_type : sensors::sensor_types()) {
    if (sensor_type->id == sensors::kLaneEdge || sensor_type->name == "occupancy") continue;
    double before = -kInfinity;
    for (const double value : {-kInfinity, -1e300, -1e18, -4294967296.0, -2147483648.0, -1.0, 0.0, 1.0, 65'536.0,
                               2147483647.0, 2147483648.0, 4294967296.0, 1e18, 1e300, kInfinity}) {
      base::ReadingBlock reading;
      const std::vector<double> values(sensors::element_width(*sensor_type), value);
      reading.values = values;
      base::Bytes payload;
      const std::uint8_t type = sensor_type->encode(row_of(1, 0.0), reading, WireFormat::farm, 0, payload);
      std::vector<double> got(values.size());
      sensor_type->read(row_of(1, 0.0), payload, type, WireFormat::farm, got);
      checks.holds(got[0] >= before && (value <= 0.0 ? got[0] <= 0.0 : got[0] >= 0.0),
                   fmt::format("{}: {:g} is decoded as {:g}", sensor_type->name, value, got[0]));
      before = got[0];
    }
  }
}

constexpr Case kWireFormatCases[] = {
    {"wires", "laser-words", "m",
     "u16 millimetres and u32 tenths at and past their ends: saturated, no return flagged, NaN not sent", lasers},
    {"wires", "lane-edge-words", "m", "u16 and u32 of lane edges: saturated below the flag, none flagged", lane_edges},
    {"wires", "field-words", "T", "i32 of 1e-8 T at and past both ends: saturated, NaN not sent", fields},
    {"wires", "all-types", "", "numbers of every sensor type from -infinity to infinity: order and sign preserved",
     all_types},
};

}  // namespace

std::span<const Case> wire_format_cases() { return kWireFormatCases; }

}  // namespace sf::selftest
