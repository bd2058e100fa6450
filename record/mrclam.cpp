#include "record/mrclam.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/files.h"

namespace sf::record {

namespace {

constexpr double kLongest = 1e14;  // [ns] from the first reading to the last

constexpr int kMostRobots = 32;
constexpr int kMostSubject = 1'000'000;
constexpr std::size_t kMostRows = 20'000'000;  // of one file
constexpr double kLatestSecond = 4e9;          // of a timestamp
constexpr double kMostMagnitude = 1e6;         // of all other numbers
constexpr std::string_view kBlanks = " \t\r";

/// One line with its place, for messages.
class MrclamRow {
 public:
  MrclamRow(const std::string& file, int line, std::string_view text) : file_(file), line_(line) {
    for (std::size_t at = text.find_first_not_of(kBlanks); at != std::string_view::npos;
         at = text.find_first_not_of(kBlanks, at)) {
      const std::size_t end = std::min(text.find_first_of(kBlanks, at), text.size());
      fields_.push_back(text.substr(at, end - at));
      at = end;
    }
  }

  [[noreturn]] void refuse(const std::string& message) const { throw base::InputError(file_, line_, message); }
  void expect(std::size_t count, std::string_view columns) const {
    if (fields_.size() != count) refuse(fmt::format("has {} columns; expected {}: {}", fields_.size(), count, columns));
  }
  /// @param most greatest magnitude
  double number(std::size_t column, double most = kMostMagnitude) const {
    const std::string_view text = fields_[column];
    double value = NAN;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(std::abs(value) <= most))
      refuse(
          fmt::format("column {} is \"{}\"; expected a number of at most {:g}", column + 1, text.substr(0, 40), most));
    return value;
  }
  int whole(std::size_t column) const {
    const double value = number(column, kMostSubject);
    if (value < 0.0 || value != std::floor(value))
      refuse(fmt::format("column {} is {:g}; expected a whole number >= 0", column + 1, value));
    return static_cast<int>(value);
  }
  std::int64_t time() const {
    const double value = number(0, kLatestSecond);
    if (value < 0.0) refuse(fmt::format("the time is {:g} s; expected seconds since 1970", value));
    return std::llround(value * 1e3) * 1'000'000;
  }

 private:
  const std::string& file_;
  int line_;
  std::vector<std::string_view> fields_;
};

template <class Take>
void read_rows(const std::string& file, std::size_t count, std::string_view columns, Take&& take) {
  base::LineFile lines(file);
  std::size_t rows = 0;
  for (std::string_view text; lines.next(text);) {
    const std::size_t first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos || text[first] == '#') continue;
    const MrclamRow row(file, lines.number(), text);
    if (++rows > kMostRows) row.refuse(fmt::format("has more than {} rows; split the data set", kMostRows));
    row.expect(count, columns);
    take(row);
  }
  if (rows == 0) throw base::InputError(file, 0, fmt::format("has no rows; expected {}", columns));
}

template <class Row>
void sort_by_time(std::vector<Row>& rows) {
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.time < b.time; });
}

std::string file_in(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).string();
}

std::map<int, int> read_barcodes(const std::string& folder) {
  std::map<int, int> subjects;
  read_rows(file_in(folder, "Barcodes.dat"), 2, "subject, barcode", [&](const MrclamRow& row) {
    if (!subjects.emplace(row.whole(1), row.whole(0)).second)
      row.refuse(fmt::format("barcode {} belongs to two subjects", row.whole(1)));
  });
  return subjects;
}

std::vector<MrclamLandmark> read_landmarks(const std::string& folder) {
  std::vector<MrclamLandmark> all;
  read_rows(file_in(folder, "Landmark_Groundtruth.dat"), 5, "subject, x, y and their standard deviations [m]",
            [&](const MrclamRow& row) {
              all.push_back({row.whole(0), {row.number(1), row.number(2)}});
              for (std::size_t k = 0; k + 1 < all.size(); ++k)
                if (all[k].subject == all.back().subject)
                  row.refuse(fmt::format("landmark {} has two positions", all[k].subject));
              if (all.size() > 1000) row.refuse("has more than 1000 landmarks");
            });
  std::sort(all.begin(), all.end(), [](auto& a, auto& b) { return a.subject < b.subject; });
  return all;
}

MrclamRobot read_robot(const std::string& folder, int subject, const std::map<int, int>& subjects) {
  MrclamRobot robot{.subject = subject};
  const auto file = [&](std::string_view what) {
    return file_in(folder, fmt::format("Robot{}_{}.dat", subject, what));
  };
  read_rows(file("Odometry"), 3, "time [s], forward [m/s], turn [rad/s]", [&](const MrclamRow& row) {
    robot.odometry.push_back({row.time(), row.number(1), row.number(2)});
  });
  read_rows(file("Measurement"), 4, "time [s], barcode, range [m], bearing [rad]", [&](const MrclamRow& row) {
    const auto known = subjects.find(row.whole(1));
    const MrclamSighting seen{row.time(), known == subjects.end() ? 0 : known->second, row.number(2), row.number(3)};
    if (!(seen.range > 0.0)) row.refuse(fmt::format("the range is {:g} m; expected a positive one", seen.range));
    if (known == subjects.end())
      ++robot.unknown_barcodes;
    else
      robot.sightings.push_back(seen);
  });
  read_rows(file("Groundtruth"), 4, "time [s], x [m], y [m], orientation [rad]", [&](const MrclamRow& row) {
    robot.truth.push_back({row.time(), {row.number(1), row.number(2), 0.0, base::wrap_angle(row.number(3))}});
  });
  sort_by_time(robot.odometry);
  sort_by_time(robot.sightings);
  sort_by_time(robot.truth);
  const auto same = [](const MrclamTruth& a, const MrclamTruth& b) { return a.time == b.time; };
  robot.truth.erase(std::unique(robot.truth.begin(), robot.truth.end(), same), robot.truth.end());
  return robot;
}

/// Drops measurements of subjects without data.
void drop_unknown_subjects(MrclamData& data) {
  const auto known = [&](int subject) {
    const auto is = [&](const auto& each) { return each.subject == subject; };
    return std::any_of(data.landmarks.begin(), data.landmarks.end(), is) ||
           std::any_of(data.robots.begin(), data.robots.end(), is);
  };
  for (MrclamRobot& robot : data.robots)
    robot.unknown_subjects = std::erase_if(robot.sightings, [&](const auto& each) { return !known(each.subject); });
}

}  // namespace

MrclamData read_mrclam(const std::string& folder) {
  if (!std::filesystem::is_directory(folder))
    throw base::InputError(folder, 0, "is not a folder; expected one with the files of an MRCLAM data set");
  const std::map<int, int> subjects = read_barcodes(folder);
  MrclamData data{.landmarks = read_landmarks(folder)};
  for (int k = 1; k <= kMostRobots; ++k)
    if (std::filesystem::exists(file_in(folder, fmt::format("Robot{}_Odometry.dat", k))))
      data.robots.push_back(read_robot(folder, k, subjects));
  if (data.robots.empty())
    throw base::InputError(folder, 0,
                           fmt::format("has no robot; expected Robot<k>_Odometry.dat, k from 1 to {}", kMostRobots));
  drop_unknown_subjects(data);
  std::int64_t first = INT64_MAX, last = INT64_MIN;
  const auto cover = [&](const auto& rows) {
    if (!rows.empty()) first = std::min(first, rows.front().time), last = std::max(last, rows.back().time);
  };
  for (const MrclamRobot& robot : data.robots) cover(robot.odometry), cover(robot.sightings);
  if (first<last&& static_cast<double>(last) - static_cast<double>(first)> kLongest)
    throw base::InputError(folder, 0, "has times more than 100 000 s apart; expected the readings of one experiment");
  return data;
}

}  // namespace sf::record
