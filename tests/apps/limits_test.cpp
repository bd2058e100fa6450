// The table "Limits of ranges" of docs/sensors.md, row by row, in every output of the program.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "farm/farm.h"
#include "record/cdr.h"
#include "record/mcap_reader.h"
#include "record/recording.h"
#include "record/recording_files.h"
#include "record/ros_messages.h"
#include "record/schemas.h"
#include "sensors/sensor_set.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/device.h"

namespace sf {
namespace {

constexpr double kMin = 0.5, kMax = 4.0, kInRange = 2.0;

/// A row of the table.
struct LimitRow {
  std::string name, surface, flag, model, api, table, ros;
};

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream text(line.substr(1));
  for (std::string cell; std::getline(text, cell, '|');) {
    std::erase(cell, '`');
    const std::size_t first = cell.find_first_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(' ') - first + 1));
  }
  return cells;
}

std::vector<LimitRow> limit_rows() {
  std::vector<LimitRow> rows;
  std::stringstream page(read_file(SF_SOURCE_DIR "/docs/sensors.md"));
  bool here = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) here = line == "## Limits of ranges";
    if (!here || !line.starts_with("|")) continue;
    const std::vector<std::string> c = cells_of(line);
    if (c.size() == 7) rows.push_back({c[0], c[1], c[2], c[3], c[4], c[5], c[6]});
  }
  if (rows.size() > 2) rows.erase(rows.begin(), rows.begin() + 2);  // the heading and the line below it
  return rows;
}

/// [m] Returns the value named in a cell of the table.
double value_of(const std::string& cell) {
  const std::map<std::string, double> values{
      {"range_min", kMin}, {"range_max", kMax}, {"d", kInRange}, {"inf", HUGE_VAL}, {"-inf", -HUGE_VAL}};
  const auto found = values.find(cell);
  EXPECT_NE(found, values.end()) << cell;
  return found == values.end() ? NAN : found->second;
}

/// [m] Returns the distance of a row's surface; NaN if there is none.
double surface_of(const LimitRow& row) {
  if (row.surface == "less than range_min") return 0.25;
  if (row.surface == "more than range_max") return 6.0;
  return row.surface == "nowhere" ? NAN : value_of(row.surface);
}

/// One robot per row with a laser of one beam, a sonar and an infrared sensor, 100 m apart.
std::string world_of(const std::vector<LimitRow>& rows) {
  std::ostringstream text;
  text << "interval_sim 100\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = 128.0 * static_cast<double>(i), d = surface_of(rows[i]);
    if (!std::isnan(d))
      text << "model( name \"w" << i << "\" pose [" << d + 0.5 << " " << y << " 0 0] size [1 4 1] )\n";
    text << "position( name \"r" << i << "\" pose [0 " << y << " 0 0] size [0.1 0.1 0.1]\n"
         << "  laser( name \"laser\" samples 1 fov 180 range_min 0.5 range_max 4 )\n"
         << "  sonar( name \"sonar\" fov 0 range [0.5 4] ) infrared( name \"infrared\" fov 0 range [0.5 4] ) )\n";
  }
  return text.str();
}

class Limits : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(rows.size(), 6u) << "the table has changed its form"; }
  Outcome run(Words words) const {
    words.insert(words.begin() + 1, world);
    const Outcome outcome = run_successfully(words);
    return outcome;
  }
  /// Records one tick of all robots, which do not move.
  record::Recording recorded(const Words& more = {}) const {
    const Words words = with({"run", "--controller", "avoid", "--set", "speed=0", "--set", "slow_speed=0", "--duration",
                              "0.1", "--record", folder.path("r"), "--record-readings"},
                             more);
    run(words);
    return record::open_recording(folder.path("r"));
  }

  const std::vector<LimitRow> rows = limit_rows();
  const Folder folder;
  const std::string world = folder.write("limits.world", world_of(rows));
};

TEST_F(Limits, InJson) {
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const auto& [type, list] : {std::pair("laser", "beams"), {"sonar", "transducers"}, {"infrared", "elements"}}) {
      const Json json(run({"sense", "--json", "--robot", "r" + std::to_string(i), "--type", type}).out);
      const std::string element = "/" + std::string(list) + "/0/", what = rows[i].name + ", " + type;
      EXPECT_EQ(json.number(element + "range_m"), value_of(rows[i].api)) << what;
      const bool flagged = json.has(element + "unsure");
      EXPECT_EQ(flagged ? json.text(element + "unsure") : "none", rows[i].flag) << what;
      if (type != std::string("laser")) continue;
      EXPECT_EQ(json.number(element + "bearing_rad"), 0.0);
      EXPECT_EQ(json.is_null(element + "hit"), rows[i].model == "none") << what;
    }
}

/// Returns the number in the second column of a scan, or in the first column of other readings.
double number_of(const std::string& csv, bool is_scan) {
  const std::string row = csv.substr(csv.find('\n') + 1);
  return std::stod(is_scan ? row.substr(row.find(',') + 1) : row);
}

TEST_F(Limits, InCsv) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Words sense{"sense", "--robot", "r" + std::to_string(i), "--type"};
    const auto read = [&](const std::string& type, const Words& more) {
      Words words = sense;
      words.push_back(type);
      words.insert(words.end(), more.begin(), more.end());
      return number_of(run(words).out, type == "laser");
    };
    EXPECT_EQ(read("laser", {}), value_of(rows[i].table)) << rows[i].name;
    if (rows[i].flag == "none" && rows[i].model != "none") continue;
    EXPECT_EQ(read("sonar", {}), value_of(rows[i].table)) << rows[i].name;
    EXPECT_EQ(read("laser", {"--too-near", "min"}), value_of(rows[i].api)) << rows[i].name;
    const bool none = rows[i].ros == "inf";
    EXPECT_EQ(read("laser", {"--no-return", "inf"}), none ? HUGE_VAL : value_of(rows[i].table)) << rows[i].name;
  }
}

/// Ranges of LaserScan and Range messages by topic, and angles of scans.
struct RosRanges {
  explicit RosRanges(const std::string& path) {
    const record::MappedFile file(path);
    const record::McapContents contents = record::read_mcap(file.bytes(), path);
    for (const record::McapMessage& message : contents.messages) {
      const record::McapChannel& channel = contents.channels.at(message.channel);
      const std::string& type = contents.schemas.at(channel.schema).name;
      if (type == record::kLaserScan) add_scan(channel.topic, message.data);
      if (type == record::kRange) add_range(channel.topic, message.data);
    }
  }
  void add_scan(const std::string& topic, std::span<const std::uint8_t> message) {
    record::CdrReader cdr(message);
    std::int64_t time = 0;
    record::get_header(cdr, time);
    for (int angle = 0; angle < 3; ++angle) EXPECT_EQ(cdr.get<float>(), 0.0F) << "the bearing of one beam";
    add(topic, record::decode_scan(message)->range_min, record::decode_scan(message)->range_max,
        record::decode_scan(message)->ranges.at(0));
  }
  void add_range(const std::string& topic, std::span<const std::uint8_t> message) {
    record::CdrReader cdr(message);
    std::int64_t time = 0;
    record::get_header(cdr, time);
    cdr.get<std::uint8_t>();
    cdr.get<float>();
    const float least = cdr.get<float>(), most = cdr.get<float>();
    add(topic, least, most, cdr.get<float>());
  }
  void add(const std::string& topic, double least, double most, float range) {
    EXPECT_EQ(least, kMin) << topic;
    EXPECT_EQ(most, kMax) << topic;
    by_topic[topic].push_back(range);
  }
  std::map<std::string, std::vector<float>> by_topic;
};

TEST_F(Limits, InRosMessages) {
  recorded();
  const RosRanges messages(folder.path("r/run.mcap"));
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const std::string topic : {"/scan", "/sonar/range", "/infrared/range"}) {
      const auto found = messages.by_topic.find("/r" + std::to_string(i) + topic);
      ASSERT_NE(found, messages.by_topic.end()) << topic;
      for (const float range : found->second) EXPECT_EQ(range, value_of(rows[i].ros)) << rows[i].name << topic;
    }
}

/// Recordings read back as in the tables, and verify.
TEST_F(Limits, InRecordings) {
  for (const Words& options : {Words{}, {"--too-near", "min"}, {"--no-return", "inf"}}) {
    const record::Recording run = recorded(options);
    const bool min = !options.empty() && options[1] == "min", inf = !options.empty() && options[1] == "inf";
    EXPECT_FALSE(run.readings.empty());
    for (const record::ReadingSample& reading : run.readings) {
      const LimitRow& row = rows[reading.mover];
      const bool none = inf && reading.type == 1 && row.ros == "inf";
      EXPECT_EQ(reading.values[0], none ? HUGE_VAL : value_of(min ? row.api : row.table)) << row.name;
    }
    EXPECT_EQ(run_program({"verify", folder.path("r"), "--all"}).code, 0);
    ASSERT_EQ(run_program({"export", folder.path("r"), "-o", folder.path("csv")}).code, 0);
    const std::string csv = read_file(folder.path("csv/laser.csv"));
    EXPECT_EQ(csv.find("-inf") != std::string::npos, !min) << csv;
  }
}

/// In process, and in packets as a robot receives them.
TEST_F(Limits, InReadingsAndPackets) {
  const world::World loaded = world::load_world(world, {.sensors = sensors::world_file_words()});
  farm::Farm farm(loaded, device(), {});
  for (const sensors::SensorSet::Group& group : farm.sensor_set().groups())
    for (const sensors::SensorSpec& spec : group.rows) {
      const LimitRow& row = rows[spec.mover];
      const base::ReadingBlock reading = farm.sense(spec.mover, group.type->id, 0, loaded.movers[spec.mover].X_WM);
      EXPECT_EQ(reading.values[0], value_of(row.api)) << row.name;
      EXPECT_EQ(!reading.quality.empty() && reading.quality[0] == base::QualityFlag::too_near, row.flag == "too near");
      if (group.type->is_scan) {
        EXPECT_EQ(reading.hits[0] == base::kNoHit, row.model == "none") << row.name;
      }

      base::Bytes payload;
      const auto wire = sensors::WireFormat::farm;
      const std::uint8_t type = group.type->encode(spec, reading, wire, 0, payload);
      ASSERT_EQ(group.type->decode(spec, payload, type, wire).fault, sensors::PayloadError::none);
      std::vector<double> received(reading.values.size());
      group.type->read(spec, payload, type, wire, received);
      EXPECT_EQ(received[0], value_of(row.api)) << row.name;
    }
}

}  // namespace
}  // namespace sf
