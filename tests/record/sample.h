#pragma once
// A small synthetic run: two robots, three lasers, three sensors of two other types, with numbers that are not round.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "record/recorder.h"

namespace sf::record::test {

/// One row of a number, a count and a vector.
inline SensorTypeInfo edge_type() {
  return {.id = 2, .name = "edge", .columns = {{"distance_m", 1}, {"points", 1, true}, {"normal_W", 3}}};
}

/// Elements of a number, a vector and a count.
inline SensorTypeInfo array_type() {
  return {
      .id = 3, .name = "array", .list = "elements", .columns = {{"field_T", 1}, {"vector_T", 3}, {"hits", 1, true}}};
}

inline SensorTypeInfo scan_type() {
  return {.id = 1, .name = "laser", .list = "beams", .columns = {{"range_m"}}, .is_scan = true};
}

inline RunInfo sample_info(bool readings) {
  RunInfo info;
  info.world = "a world";
  info.world_hash = 0xFEDCBA9876543210u;
  info.seed = 42;
  info.interval = 0.1;
  info.record_readings = readings;
  info.odometry_rate = 5.0;
  info.sensor_types = {scan_type(), edge_type(), array_type()};
  info.movers = {
      {.name = "roomba:1",
       .id = 7,
       .sensors =
           {{.type = 1, .name = "front", .X_MS = {0.1, 0.0, 0.2, 0.3}, .fov = 3.0, .samples = 4, .range_max = 8.0},
            {.type = 1, .name = "front", .rate = 5.0, .samples = 1, .range_min = 0.5, .range_max = 80.0},
            {.type = 3, .name = "front", .X_MS = {0.5, 0.0, 0.1, 0.0}},
            {.type = 2, .name = "3rd edge", .rate = 4.0},
            {.type = 3, .name = "rear"}}},
      {.name = "roomba.1", .id = 9, .sensors = {{.type = 1, .fov = 1.0, .samples = 2, .range_max = 4.0}}}};
  info.options = {{"noise", "off"}, {"", "empty key"}};
  info.snapshot = {1, 2, 3, 0, 255};
  return info;
}

/// Owns the data of a tick record.
struct SampleTick {
  std::vector<base::Report> reports;
  std::vector<base::Twist> commands;
  std::vector<std::uint8_t> contacts;
  std::vector<std::vector<double>> ranges;
  std::vector<base::ReadingBlock> readings;
  base::TickRecord record;

  explicit SampleTick(std::uint64_t tick, std::uint32_t movers = 2) {
    const double t = 0.1 * static_cast<double>(tick + 1);
    const auto time = static_cast<std::int64_t>(tick) * 100'000'000;
    for (std::uint32_t m = 0; m < movers; ++m) {
      reports.push_back({m, time, {t / 3.0 + m, -t / 7.0, 0.01 * m, t}, {0.3 + t / 11.0, 0.0, t / 13.0}});
      commands.push_back({0.5, t / 17.0, -t / 19.0});
      contacts.push_back(static_cast<std::uint8_t>((tick + m) % 2));
    }
    ranges = {{t / 3.0, 8.0, 0.0, 2.5},
              {t + 0.5},
              {1.0 / 3.0, 4.0},
              {t, 1.0, 2.0, 3.0, 4.0, -t, -1.0, -2.0, -3.0, 5.0},  // two elements
              {t / 7.0, 61.0, 0.1, 0.2, 0.3},
              {1.0 / t, 1.0, 2.0, 3.0, 0.0}};
    readings = {{.mover = 0, .sensor = 0, .type = 1, .sequence = 5, .time = time / 2, .values = ranges[0]},
                {.mover = 0, .sensor = 1, .type = 1, .sequence = 6, .time = time, .values = ranges[1]},
                {.mover = 1, .sensor = 0, .type = 1, .sequence = 7, .time = time, .values = ranges[2]},
                {.mover = 0, .sensor = 0, .type = 3, .sequence = 8, .time = time / 2, .values = ranges[3]},
                {.mover = 0, .sensor = 0, .type = 2, .sequence = 9, .time = time, .values = ranges[4]},
                {.mover = 0, .sensor = 1, .type = 3, .sequence = 10, .time = time, .values = ranges[5]}};
    record = {tick, time, reports, commands, contacts, readings};
  }
  SampleTick(const SampleTick&) = delete;
  SampleTick& operator=(const SampleTick&) = delete;
};

/// Returns an empty directory for one test, below the build directory.
inline std::string fresh_directory(const std::string& name) {
  const std::string directory = std::string(SF_BINARY_DIR) + "/recordings/" + name;
  std::filesystem::remove_all(directory);
  return directory;
}

inline base::Bytes bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace sf::record::test
