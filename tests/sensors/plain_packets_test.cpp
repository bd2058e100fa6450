// The payload of sensor types with a few plain numbers.

#include "sensors/plain_packets.h"

#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/netio/documented.h"
#include "tests/sensors/chance.h"
#include "tests/units.h"

namespace sf::sensors {
namespace {

constexpr PlainNumber kNumbers[] = {{1e-3}, {1.0, 0.0, 5.0}};
constexpr PlainForm kForm{29, "trial", kNumbers};
constexpr SensorType kTrial = plain<kForm>({});

SensorSpec plain_row(std::uint32_t elements) {
  SensorSpec row;
  row.elements = elements;
  return row;
}

base::Bytes bytes_of(const std::vector<double>& values) {
  base::ReadingBlock block;
  block.values = values;
  base::Bytes out;
  EXPECT_EQ(kTrial.encode(plain_row(static_cast<std::uint32_t>(values.size() / 2)), block, WireFormat::farm, 0, out),
            29);
  return out;
}

std::vector<double> back(const std::vector<double>& values) {
  const base::Bytes bytes = bytes_of(values);
  std::vector<double> read(values.size(), 77.0);
  kTrial.read(plain_row(static_cast<std::uint32_t>(values.size() / 2)), bytes, 29, WireFormat::farm, read);
  return read;
}

TEST(PlainPackets, EncodesEveryByte) {
  EXPECT_EQ(bytes_of({1.0, 2.0, -0.001, kNaN}), (base::Bytes{2,    0,    0,    0,    0xE8, 3, 0, 0,   2, 0, 0, 0,  //
                                                             0xFF, 0xFF, 0xFF, 0xFF, 0,    0, 0, 0x80}));
}

TEST(PlainPackets, RoundsToNearestAndSaturates) {
  EXPECT_DOUBLE_EQ(back({0.00149, 0})[0], 0.001);
  EXPECT_DOUBLE_EQ(back({0.0015, 0})[0], 0.002) << "half away from zero";
  EXPECT_DOUBLE_EQ(back({-0.0015, 0})[0], -0.002);
  EXPECT_DOUBLE_EQ(back({2'147'483.647, 0})[0], 2'147'483.647) << "the largest word";
  EXPECT_DOUBLE_EQ(back({1e300, 0})[0], 2'147'483.647);
  EXPECT_DOUBLE_EQ(back({kInf, 0})[0], 2'147'483.647);
  EXPECT_DOUBLE_EQ(back({-2'147'483.648, 0})[0], -2'147'483.647) << "the word below means NaN";
  EXPECT_DOUBLE_EQ(back({-kInf, 0})[0], -2'147'483.647);
  EXPECT_TRUE(std::isnan(back({kNaN, 0})[0]));
}

TEST(PlainPackets, RejectsImpossibleValues) {
  const base::Bytes good = bytes_of({1, 2, 3, 4});
  const auto fault = [&](base::Bytes bytes, std::uint32_t rows, std::uint8_t type = 29,
                         WireFormat wire = WireFormat::farm) {
    return kTrial.decode(plain_row(rows), bytes, type, wire).fault;
  };
  EXPECT_EQ(fault(good, 2), PayloadError::none);
  EXPECT_EQ(fault(good, 0), PayloadError::none) << "of any number of rows";
  EXPECT_EQ(fault(good, 1), PayloadError::out_of_range) << "of another sensor";
  EXPECT_EQ(fault(good, 2, 28), PayloadError::out_of_range) << "of another type";
  EXPECT_EQ(fault(good, 2, 29 + kExtended), PayloadError::out_of_range) << "there is no second form";
  EXPECT_EQ(fault(good, 2, 29, WireFormat::thesis), PayloadError::out_of_range);
  EXPECT_EQ(fault({0, 0, 0, 0}, 0), PayloadError::out_of_range) << "no rows";
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_EQ(fault({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}, 2), PayloadError::too_short)
        << size;
  base::Bytes longer = good;
  longer.push_back(0);
  EXPECT_EQ(fault(longer, 2), PayloadError::too_long);
  EXPECT_EQ(fault(bytes_of({1, 6}), 1), PayloadError::out_of_range) << "more than its column has";
  EXPECT_EQ(fault(bytes_of({1, -1}), 1), PayloadError::out_of_range) << "less than its column has";
  EXPECT_EQ(fault(bytes_of({1, kNaN}), 1), PayloadError::none) << "NaN is valid";
  EXPECT_EQ(fault(bytes_of({1e9, 0}), 1), PayloadError::none) << "a saturated word stands for any larger value";
}

TEST(PlainPackets, LimitsNumbersToOneDatagram) {
  std::vector<double> most(312, 1.0);
  const base::Bytes bytes = bytes_of(most);
  EXPECT_EQ(bytes.size(), 4 + 4 * 312u);
  EXPECT_LE(bytes.size() + 64 + 80, 1400u);
  EXPECT_EQ(kTrial.decode(plain_row(0), bytes, 29, WireFormat::farm).fault, PayloadError::none);
  base::Bytes more(4 + 4 * 314, 0);
  more[0] = 157;
  EXPECT_EQ(kTrial.decode(plain_row(0), more, 29, WireFormat::farm).fault, PayloadError::out_of_range);
}

TEST(PlainPackets, RejectsTheThesisFormat) {
  EXPECT_EQ(kTrial.wire_problem({}, WireFormat::farm), "");
  const std::string why = kTrial.wire_problem({}, WireFormat::thesis);
  EXPECT_NE(why.find("trial"), std::string::npos);
  EXPECT_NE(why.find("--wire farm"), std::string::npos);
  EXPECT_EQ(kTrial.parts({}, WireFormat::farm), 1u);
}

/// Arbitrary bytes are validated without a crash. Accepted payloads can be read.
TEST(PlainPackets, ValidatesAnyBytes) {
  trial::Chance chance(4);
  std::size_t taken = 0;
  for (int i = 0; i < 20'000; ++i) {
    base::Bytes bytes(chance.below(60));
    for (std::uint8_t& b : bytes)
      b = static_cast<std::uint8_t>(i % 3 == 0 && chance.below(9) > 0 ? 0 : chance.below(256));
    if (bytes.size() > 3 && i % 2 == 0) bytes[0] = static_cast<std::uint8_t>((bytes.size() - 4) / 8), bytes[1] = 0;
    for (const SensorType* type : sensor_types()) {
      const PayloadPart part = type->decode(plain_row(0), bytes, type->id, WireFormat::farm);
      EXPECT_TRUE(part.fault != PayloadError::none || part.elements >= 1u);
    }
    const PayloadPart part = kTrial.decode(plain_row(0), bytes, 29, WireFormat::farm);
    if (part.fault != PayloadError::none) continue;
    ++taken;
    std::vector<double> values(2 * part.elements);
    kTrial.read(plain_row(0), bytes, 29, WireFormat::farm, values);
    for (std::size_t k = 0; k < part.elements; ++k)
      EXPECT_TRUE(std::isnan(values[2 * k + 1]) || (values[2 * k + 1] >= 0.0 && values[2 * k + 1] <= 5.0));
  }
  EXPECT_GT(taken, 50u);
}

/// Payloads of each type as documented and printed.
TEST(PlainPackets, PayloadsMatchTheDocumentation) {
  const struct {
    const char* example;
    std::uint8_t id;
    std::uint32_t rows;
    std::vector<double> values;
  } all[] = {{"sonar", 4, 3, {0.1, 1.25, 4}},
             {"infrared", 5, 2, {0.05, 0, 0.0125, 767}},
             {"bumper", 6, 2, {1, 0}},
             {"cliff", 7, 4, {0, 0, 1, 1}},
             {"encoder", 8, 1, {1.234, -0.5, 1234, -500}},
             {"gyro", 9, 1, {-0.25}},
             {"gps", 10, 1, {kNaN, kNaN, kNaN, 3}},
             {"irreceiver", 11, 1, {1, 252}},
             {"fiducial", 27, 2, {7, 2, 3, 0.5, -0.25, kNaN, kNaN, kNaN, kNaN, kNaN}},
             {"lightsensor", 28, 2, {250.5, 337, 0, 450}},
             {"battery", 29, 1, {14.4, -0.6, 1.35, 0}},
             {"analog", 30, 2, {2.5, 512, 5, 1023}},
             {"ptz", 31, 1, {0.5, -0.1, 0.4}},
             {"localization", 32, 1, {1.5, -0.5, 0.5, 1, 0.0625, 0, -0.0078125, 0.0625, 0.00390625, 0.0009765625}},
             {"sideslip", 33, 1, {-0.05, 4000, 2500, 1, 0.0009765625, 0, 0, 1024, 0, 256}},
             {"model", 34, 1, {0.25, 1, 0.00390625}},
             {"monitor",
              35,
              1,
              {1.5, -0.5, 0.5, 1, 0.0625, 0, -0.0078125, 0.0625, 0.00390625, 0.0009765625, 0.25, -0.125, 0, 1, 0, 0.5,
               2, 0.25}},
             {"location", 41, 1, {1.5, -0.5, 1, 0.0625, -0.0078125, 0.25, -1, 0.125}},
             {"thermometer", 42, 1, {21.5}},
             {"compass", 47, 1, {5e-5, 0.25, -0.5, 0.125, 1.5}},
             {"altimeter", 48, 1, {12.5}},
             {"inclinometer", 49, 1, {0.25, -0.5, 2}},
             {"radar", 50, 2, {12.5, 0.25, 3.5, -0.125, kNaN, kNaN, kNaN, kNaN}},
             {"imu", 46, 1, {0.5, -0.25, 0.125, 1.5, -0.5, 9.75, 36}},
             {"aggregate", 43, 1, {21.5, 1, 0.25, 0, 0.0625}},
             {"loop", 36, 1, {12, 0.25, 0.5, 1}},
             {"link-speed", 37, 2, {0.5, 40, 1, 0.0625, -5, 400, 2.5, kNaN, kNaN, 0, kNaN, kNaN, kNaN, kNaN}},
             {"features",
              38,
              1,
              {1.5, -0.5, 0.5, 1, 0.0625, 0, -0.0078125, 0.0625, 0.00390625, 0.0009765625, 1, 0.75, 0, 0.05}},
             {"tracks", 39, 1, {1.5, -0.5,      0.25,     -0.125, 1,        0.0625, 0, 0.0078125, 0,    0.0625,
                                0,   0.0078125, 0.015625, 0,      0.015625, 7,      2, 3,         1.25, 4}}};
  for (const auto& [example, id, rows, values] : all) {
    const SensorType* type = find_sensor_type(id);
    ASSERT_NE(type, nullptr) << example;
    EXPECT_EQ(type->name, example);
    base::ReadingBlock block;
    block.values = values;
    base::Bytes bytes;
    SensorSpec row = plain_row(rows);
    row.width = static_cast<std::uint32_t>(values.size() / rows);
    EXPECT_EQ(type->encode(row, block, WireFormat::farm, 0, bytes), id);
    const base::Bytes packet = test::documented(example);
    ASSERT_GT(packet.size(), 64u) << example;
    EXPECT_EQ(packet[5], id);
    EXPECT_EQ(base::Bytes(packet.begin() + 64, packet.end()), bytes) << example;
    EXPECT_EQ(type->decode(row, bytes, id, WireFormat::farm).fault, PayloadError::none) << example;
    EXPECT_NE(type->wire_problem(plain_row(rows), WireFormat::thesis), "") << example;
  }
}

/// Sensors may have fewer numbers than their type, as receivers without an altitude: the length says how many.
TEST(PlainPackets, RowsMayEndEarly) {
  const SensorType& gps = *find_sensor_type(10);
  SensorSpec planar = plain_row(1), spatial = plain_row(1);
  planar.width = 4;
  base::ReadingBlock block;
  const std::vector<double> values{1.0, 2.0, 1.5, 8.0, 3.0, 2.5};
  const SensorSpec any{.elements = 0};
  for (const SensorSpec& sensor : {planar, spatial}) {
    const std::size_t width = sensor.width != 0 ? 4 : 6;
    block.values = std::span(values).first(width);
    base::Bytes bytes;
    gps.encode(sensor, block, WireFormat::farm, 0, bytes);
    EXPECT_EQ(bytes.size(), 4 + 4 * width);
    const SensorSpec& other = sensor.width != 0 ? spatial : planar;
    EXPECT_EQ(gps.decode(sensor, bytes, 10, WireFormat::farm).fault, PayloadError::none);
    EXPECT_EQ(gps.decode(any, bytes, 10, WireFormat::farm).fault, PayloadError::none);
    EXPECT_NE(gps.decode(other, bytes, 10, WireFormat::farm).fault, PayloadError::none);
    std::vector<double> read(width);
    gps.read(sensor, bytes, 10, WireFormat::farm, read);
    EXPECT_EQ(read, std::vector<double>(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(width)));
    bytes.resize(bytes.size() - (width == 4 ? 4 : 12));
    EXPECT_EQ(gps.decode(any, bytes, 10, WireFormat::farm).fault, PayloadError::too_short) << "fewer than four";
  }
}

/// Ports, ids and numbers of rows as in the tables of docs/packets.md.
TEST(PacketsPage, SensorTypesMatchTheProgram) {
  std::ifstream file(SF_SOURCE_DIR "/docs/packets.md");
  std::size_t ports = 0, rows = 0;
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> cells;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, '|');)
      cells.push_back(cell.size() > 2 ? cell.substr(1, cell.size() - 2) : "");
    for (const SensorType* type : built_in_sensor_types()) {
      std::string upper(type->name);
      for (char& c : upper) c = static_cast<char>(std::toupper(c));
      if (cells.size() == 5 && cells[1] == type->name) {
        ++ports;
        EXPECT_EQ(cells[2], std::to_string(type->base_port));
        EXPECT_EQ(cells[3], "`--" + std::string(type->name) + "-port`");
        EXPECT_EQ(cells[4], std::to_string(type->base_port + 56));
      }
      if (cells.size() != 5 || cells[2] != upper) continue;
      ++rows;
      EXPECT_EQ(cells[1], std::to_string(type->id)) << upper;
      std::size_t numbers = 1;  // each after a comma or a semicolon, except those in brackets
      for (std::size_t at = 0, open = 0; at < cells[4].size(); ++at) {
        open += cells[4][at] == '(', open -= cells[4][at] == ')';
        numbers += open == 0 && (cells[4][at] == ',' || cells[4][at] == ';');
      }
      EXPECT_EQ(numbers, type->columns.size()) << upper << ": " << cells[4];
    }
  }
  EXPECT_EQ(ports, built_in_sensor_types().size());
  EXPECT_EQ(rows, 29u) << "plain readings";
}

}  // namespace
}  // namespace sf::sensors
