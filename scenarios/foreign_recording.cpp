#include "scenarios/foreign_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "base/elementary.h"
#include "base/error.h"
#include "base/number_text.h"
#include "base/time.h"
#include "record/foreign_messages.h"
#include "record/mcap_reader.h"
#include "record/recording_files.h"
#include "record/schemas.h"
#include "world/table_record.h"

namespace sf::scenarios {

namespace {

namespace fs = std::filesystem;

constexpr double kMostStates = 5e6;
constexpr std::int64_t kMostApart = 10 * base::kSecond;            ///< between the stamp of a message and its logging
constexpr std::int64_t kMostTime = 4'000'000'000 * base::kSecond;  ///< differences of such times fit into 64 bits
constexpr std::size_t kMostNames = 40;                             ///< of topics, in messages

/// A plane that touches WGS84; see the header.
class LocalPlane {
 public:
  explicit LocalPlane(const std::optional<std::pair<double, double>>& origin) {
    if (origin) touch(origin->first, origin->second);
  }
  /// The first position is the origin if none was given. @return x east, y north [m]
  std::pair<double, double> place(double latitude, double longitude) {
    if (!is_set_) touch(latitude, longitude);
    const auto [x, y, z] = earth(latitude, longitude);
    const double east = x - origin_[0], up = y - origin_[1], north = z - origin_[2];
    const double towards = cos_lon_ * east + sin_lon_ * up;
    return {-sin_lon_ * east + cos_lon_ * up, -sin_lat_ * towards + cos_lat_ * north};
  }

 private:
  static std::array<double, 3> earth(double latitude, double longitude) {
    constexpr double a = 6378137.0, f = 1.0 / 298.257223563, e2 = f * (2.0 - f);
    const double lat = latitude * M_PI / 180.0, lon = longitude * M_PI / 180.0;
    const double n = a / std::sqrt(1.0 - e2 * base::sin(lat) * base::sin(lat));
    return {n * base::cos(lat) * base::cos(lon), n * base::cos(lat) * base::sin(lon), n * (1.0 - e2) * base::sin(lat)};
  }
  void touch(double latitude, double longitude) {
    is_set_ = true;
    origin_ = earth(latitude, longitude);
    sin_lat_ = base::sin(latitude * M_PI / 180.0), cos_lat_ = base::cos(latitude * M_PI / 180.0);
    sin_lon_ = base::sin(longitude * M_PI / 180.0), cos_lon_ = base::cos(longitude * M_PI / 180.0);
  }
  bool is_set_ = false;
  std::array<double, 3> origin_{};
  double sin_lat_ = 0.0, cos_lat_ = 1.0, sin_lon_ = 0.0, cos_lon_ = 1.0;
};

struct Bag {
  explicit Bag(const std::string& path) : name(path), file(path), contents(record::read_mcap(file.bytes(), path)) {}
  std::string name;
  record::MappedFile file;
  record::McapContents contents;

  std::string_view type_of(const record::McapChannel& channel) const {
    const auto schema = contents.schemas.find(channel.schema);
    const bool ros2 = channel.encoding == "cdr" && schema != contents.schemas.end();
    return ros2 ? std::string_view(schema->second.name) : std::string_view();
  }
};

std::vector<std::unique_ptr<Bag>> open_bags(const std::string& place) {
  std::vector<std::string> paths;
  if (fs::is_directory(place)) {
    for (const auto& entry : fs::directory_iterator(place))
      if (entry.path().extension() == ".mcap") paths.push_back(entry.path().string());
    std::ranges::sort(paths);
    if (paths.empty()) throw base::InputError(place, 0, "has no MCAP file (.mcap), from which topics could be read");
  } else {
    paths.push_back(place);
  }
  std::vector<std::unique_ptr<Bag>> bags;
  for (const std::string& path : paths) bags.push_back(std::make_unique<Bag>(path));
  return bags;
}

class ForeignReader {
 public:
  ForeignReader(const std::string& place, const DeriveFile& file) : place_(place), file_(file), plane_(file.origin) {
    const bool any_topic = std::ranges::any_of(file.inputs, [](const ForeignInput& i) { return !i.topic.empty(); });
    if (any_topic) bags_ = open_bags(place);
    for (const ForeignInput& input : file.inputs) input.topic.empty() ? bind_table(input) : bind_topic(input);
  }
  DerivedSource read();

 private:
  [[noreturn]] void fail(const ForeignInput& input, const std::string& why) const {
    throw base::InputError(file_.file, input.sensor.line, why);
  }
  void bind_topic(ForeignInput input);
  double configure(ForeignInput& input, std::string_view type);
  double configure_scan(ForeignInput& input);
  void bind_table(const ForeignInput& input);
  std::string table_of(const ForeignInput& input) const;
  std::string topics() const;
  template <class Visit>
  bool for_messages(const std::string& topic, const Visit& visit) const;
  void read_topic(const ForeignSensor& sensor);
  void convert_fix(const ForeignSensor& sensor, record::ForeignMessage& message);
  void read_table(const ForeignSensor& sensor);
  void add(const ForeignSensor& sensor, std::int64_t stamp, std::int64_t log, const std::vector<double>& values);
  void number_readings();
  void add_states(std::int64_t end);

  const std::string& place_;
  const DeriveFile& file_;
  LocalPlane plane_;
  std::vector<std::unique_ptr<Bag>> bags_;
  std::vector<ForeignSensor> sensors_;
  std::vector<double> values_;
  DerivedSource source_;
};

std::string ForeignReader::topics() const {
  std::set<std::string> names;
  for (const auto& bag : bags_)
    for (const auto& [id, channel] : bag->contents.channels)
      names.insert(fmt::format("{} ({})", channel.topic,
                               bag->type_of(channel).empty() ? std::string_view("not ROS 2") : bag->type_of(channel)));
  std::vector<std::string> shown(names.begin(), names.end());
  const std::size_t more = shown.size() - std::min(shown.size(), kMostNames);
  shown.resize(shown.size() - more);
  return fmt::format("{}{}", fmt::join(shown, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

/// Calls `visit(bag, type, message)` for each message of a topic, in order of the files, until it returns false.
/// @return whether there is such a topic
template <class Visit>
bool ForeignReader::for_messages(const std::string& topic, const Visit& visit) const {
  bool found = false;
  for (const auto& bag : bags_) {
    std::map<std::uint16_t, std::string_view> channels;
    for (const auto& [id, channel] : bag->contents.channels)
      if (channel.topic == topic) channels[id] = bag->type_of(channel);
    found = found || !channels.empty();
    for (const record::McapMessage& message : bag->contents.messages)
      if (const auto channel = channels.find(message.channel); channel != channels.end())
        if (!visit(*bag, channel->second, message)) return true;
  }
  return found;
}

void ForeignReader::bind_topic(ForeignInput input) {
  std::string_view type;
  bool any = false;
  const bool found = for_messages(input.topic, [&](const Bag&, std::string_view its, const record::McapMessage&) {
    type = its;
    any = true;
    return false;
  });
  if (!found) fail(input, fmt::format("{} has no topic '{}'; it has {}", place_, input.topic, topics()));
  if (!any) {
    const auto damaged = std::ranges::find_if(bags_, [](const auto& bag) { return !bag->contents.damage.empty(); });
    fail(input, fmt::format("topic '{}' of {} has no readable messages{}", input.topic, place_,
                            damaged == bags_.end() ? "" : "; " + (*damaged)->contents.damage.front()));
  }
  if (record::foreign_columns(type).empty())
    fail(input, fmt::format("topic '{}' has messages of type {}; expected {}, {}, {} or {}", input.topic,
                            type.empty() ? std::string_view("that are not ROS 2's") : type, record::kImu,
                            record::kOdometry, record::kNavSatFix, record::kLaserScan));
  const bool states_noise = !input.sensor.value("noise").empty();
  const double yaw = configure(input, type);
  std::vector<std::string> available;
  for (const std::string_view name : record::foreign_columns(type)) available.emplace_back(name);
  if (type == record::kNavSatFix) available = {"x_m", "y_m", "hdop"};
  ForeignSensor sensor = bind_sensor(file_.file, input, fmt::format("topic {} ({})", input.topic, type), available);
  if (sensor.type->is_scan != (type == record::kLaserScan))
    fail(input, fmt::format("topic '{}' has messages of type {}, which cannot be read as {}", input.topic, type,
                            sensor.type->name));
  sensor.yaw = yaw;
  sensor.states_noise = states_noise;
  sensors_.push_back(std::move(sensor));
}

/// Fills in what a message type states. @return the yaw of the sensor in its frame [rad]
double ForeignReader::configure(ForeignInput& input, std::string_view type) {
  std::string& word = input.sensor.word;
  if (word.empty())
    word = type == record::kImu         ? "gyro"
           : type == record::kNavSatFix ? "gps"
           : type == record::kLaserScan ? "laser"
                                        : "odometry";
  if (word == "gps" && input.sensor.value("noise").empty()) input.sensor.properties.emplace_back("noise", "1");
  return word == "laser" && type == record::kLaserScan ? configure_scan(input) : 0.0;
}

double ForeignReader::configure_scan(ForeignInput& input) {
  record::ForeignMessage first;
  bool good = false;
  for_messages(input.topic, [&](const Bag&, std::string_view type, const record::McapMessage& message) {
    good = record::decode_foreign(type, message.data, first);
    return false;
  });
  const double fov = first.angle_max - first.angle_min;
  if (!good || first.values.empty() || !(fov > 0.0 && fov <= 2.0 * M_PI + 1e-3) ||
      !(first.range_max > 0.0 && std::isfinite(first.range_max)))
    fail(input,
         fmt::format("the first message of topic '{}' is not a scan with beams, counter-clockwise", input.topic));
  const auto state = [&](const char* key, const std::string& value) {
    if (input.sensor.value(key).empty()) input.sensor.properties.emplace_back(key, value);
  };
  state("samples", std::to_string(first.values.size()));
  state("fov", fmt::format("{}", std::min(360.0, fov * 180.0 / M_PI)));
  state("range_max", fmt::format("{}", first.range_max));
  return 0.5 * (first.angle_max + first.angle_min);
}

std::string ForeignReader::table_of(const ForeignInput& input) const {
  if (!input.table.empty()) {
    const fs::path folder = fs::is_directory(place_) ? fs::path(place_) : fs::path(place_).parent_path();
    return (folder / input.table).string();
  }
  if (fs::is_regular_file(place_)) return place_;
  fail(input, fmt::format("expected topic = \"/NAME\" or file = \"NAME.csv\": what to read of the folder {}", place_));
}

void ForeignReader::bind_table(const ForeignInput& input) {
  const std::string path = table_of(input);
  world::TableRecord table(path);
  if (!table.next()) throw base::InputError(path, 0, "is empty: expected a line with the names of its columns");
  table.split(',', false);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < table.size(); ++i) names.emplace_back(table.field(i));
  if (std::ranges::find(names, input.time) == names.end())
    fail(input, fmt::format("{} has no column '{}': expected time = \"NAME\", the column with the time; it has {}",
                            path, input.time, fmt::join(names, ", ")));
  sensors_.push_back(bind_sensor(file_.file, input, path, names));
  if (sensors_.back().type->is_scan) fail(input, "scans are read from messages, not from tables");
}

void ForeignReader::add(const ForeignSensor& sensor, std::int64_t stamp, std::int64_t log,
                        const std::vector<double>& values) {
  if (file_.clock == ForeignClock::both && std::abs(stamp - log) > kMostApart)
    fail(sensor.input,
         fmt::format("a message of {} is stamped {:.3f} s, but was logged at {:.3f} s: the two are of "
                     "different clocks; write clock = \"stamp\" or clock = \"log\" at the top of the file",
                     sensor.source, 1e-9 * static_cast<double>(stamp), 1e-9 * static_cast<double>(log)));
  record::ReadingSample& reading = source_.recording.readings.emplace_back();
  reading.mover = sensor.mover;
  reading.type = sensor.type->id;
  reading.sensor = sensor.number;
  reading.time = file_.clock == ForeignClock::log ? log : stamp;
  reading.delivered = file_.clock == ForeignClock::stamp ? stamp : std::max(log, reading.time);
  reading.width = sensors::element_width(*sensor.type);
  reading.values = values;
}

void ForeignReader::convert_fix(const ForeignSensor& sensor, record::ForeignMessage& message) {
  const double latitude = message.values[0], longitude = message.values[1], variance = message.values[2];
  const double noise = std::strtod(sensor.input.sensor.value("noise").c_str(), nullptr);
  if (std::isnan(variance) && !sensor.states_noise && std::isfinite(latitude))
    fail(sensor.input,
         fmt::format(
             "a fix of {} states no covariance: add noise = 2 or the like, the standard deviation of a range [m]",
             sensor.source));
  // The variances of both axes together are (noise hdop)^2.
  const double hdop = std::isnan(variance) ? 1.0 : std::sqrt(variance) / std::max(noise, 1e-9);
  if (!std::isfinite(latitude)) {
    message.values = {latitude, latitude, latitude};
    return;
  }
  const auto [x, y] = plane_.place(latitude, longitude);
  message.values = {x, y, hdop};
}

void ForeignReader::read_topic(const ForeignSensor& sensor) {
  record::ForeignMessage message;
  std::size_t beams = 0;
  std::string bound;  ///< type of the first message
  for_messages(sensor.input.topic, [&](const Bag& bag, std::string_view type, const record::McapMessage& raw) {
    const auto refuse = [&](const std::string& why) {
      throw base::InputError(bag.name, 0,
                             fmt::format("a message of {}, logged at {} ns, {}", sensor.source, raw.log_time, why));
    };
    if (bound.empty()) bound = type;
    if (type != bound) refuse("has another type than the first");
    if (raw.log_time > static_cast<std::uint64_t>(kMostTime) || !record::decode_foreign(type, raw.data, message))
      refuse("is malformed");
    if (type == record::kNavSatFix) convert_fix(sensor, message);
    values_.clear();
    if (sensor.type->is_scan) {
      if (beams == 0) beams = message.values.size();
      if (beams != message.values.size()) refuse("has another number of beams than the first");
      for (const double range : message.values)
        values_.push_back(std::isnan(range) || range == HUGE_VAL ? message.range_max : range);
    } else {
      for (const std::size_t from : sensor.from)
        values_.push_back(from == kNotMeasured ? 0.0 : message.values.at(from));
    }
    add(sensor, message.time, static_cast<std::int64_t>(raw.log_time), values_);
    return true;
  });
}

/// Returns a time [ns]. @param text a number in `unit` [s], of up to 19 digits
std::optional<std::int64_t> read_time(std::string_view text, long double unit) {
  const std::optional<long double> number = base::number_of<long double>(text);
  const long double value = number.value_or(NAN) * (1e9L * unit);
  if (!(std::abs(value) <= kMostTime)) return std::nullopt;
  return static_cast<std::int64_t>(std::llround(value));
}

std::optional<double> read_number(std::string_view text) {
  return text.empty() ? std::optional(std::nan("")) : base::number_of<double>(text);  // empty: unknown
}

void ForeignReader::read_table(const ForeignSensor& sensor) {
  const std::string& time_name = sensor.input.time;
  const long double unit = time_name.ends_with("_ns")   ? 1e-9L
                           : time_name.ends_with("_us") ? 1e-6L
                           : time_name.ends_with("_ms") ? 1e-3L
                                                        : 1.0L;
  world::TableRecord table(sensor.source);
  table.next();
  table.split(',', false);
  std::size_t time_column = 0;
  while (table.field(time_column) != time_name) ++time_column;
  const std::size_t columns = table.size();
  while (table.next()) {
    table.split(',', false);
    if (table.size() != columns)
      throw base::InputError(sensor.source, table.first_line(),
                             fmt::format("has {} fields; expected {}, as in the line with the names of the columns",
                                         table.size(), columns));
    const auto refuse = [&](std::string_view name, std::string_view got) {
      throw base::InputError(sensor.source, table.first_line(),
                             fmt::format("'{}' expects a number; got '{:.40}'", name, got));
    };
    const auto time = read_time(table.field(time_column), unit);
    if (!time) refuse(time_name, table.field(time_column));
    values_.clear();
    for (std::size_t k = 0; k < sensor.from.size(); ++k) {
      const std::size_t from = sensor.from[k];
      const auto value = from == kNotMeasured ? std::optional(0.0) : read_number(table.field(from));
      if (!value) refuse(sensor.type->columns[k].name, table.field(from));
      values_.push_back(*value);
    }
    add(sensor, *time, *time, values_);
  }
}

/// Sorts readings by delivery, numbers those of each sensor, and subtracts the time of the first measurement.
void ForeignReader::number_readings() {
  auto& readings = source_.recording.readings;
  std::ranges::stable_sort(readings, {}, &record::ReadingSample::delivered);
  const std::int64_t zero = std::ranges::min_element(readings, {}, &record::ReadingSample::time)->time;
  std::map<std::tuple<std::uint32_t, std::uint8_t, std::uint32_t>, std::uint32_t> counts;
  for (record::ReadingSample& reading : readings) {
    reading.sequence = counts[{reading.mover, reading.type, reading.sensor}]++;
    reading.time -= zero;
    reading.delivered -= zero;
  }
  source_.recording.info.options.emplace_back(kTimeZero, std::to_string(zero));
}

/// Ticks of the world's interval until the last delivery; poses are unknown.
void ForeignReader::add_states(std::int64_t end) {
  record::Recording& recording = source_.recording;
  const std::int64_t interval = base::nanoseconds(source_.world.interval);
  const double ticks = std::ceil(static_cast<double>(end) / static_cast<double>(interval)) + 1.0;
  recording.states.resize(source_.world.movers.size());
  if (ticks * static_cast<double>(recording.states.size()) > kMostStates)
    throw base::InputError(place_, 0,
                           fmt::format("spans {:.0f} s with {} robots: expected at most 5e5 s times robots",
                                       1e-9 * static_cast<double>(end), recording.states.size()));
  recording.ticks = static_cast<std::uint64_t>(ticks);
  for (std::uint64_t tick = 0; tick < recording.ticks; ++tick)
    for (auto& states : recording.states)
      states.push_back({tick, static_cast<std::int64_t>(tick) * interval, false, base::kAbsent, {}, {}});
  recording.end_time = recording.states[0].back().time;
}

DerivedSource ForeignReader::read() {
  source_.foreign = true;
  source_.world = foreign_world(file_, sensors_);
  for (const ForeignSensor& sensor : sensors_) sensor.input.topic.empty() ? read_table(sensor) : read_topic(sensor);
  record::Recording& recording = source_.recording;
  recording.file = place_;
  recording.info.world = fs::path(place_).stem().string();
  recording.info.interval = source_.world.interval;
  recording.info.estimated = true;
  for (const auto& bag : bags_)
    for (const std::string& damage : bag->contents.damage) recording.damage.push_back(bag->name + ": " + damage);
  if (recording.readings.empty()) throw base::InputError(place_, 0, "has no rows: nothing can be derived");
  number_readings();
  add_states(recording.readings.back().delivered);
  return std::move(source_);
}

}  // namespace

DerivedSource read_foreign(const std::string& recording, const DeriveFile& file) {
  std::error_code ignored;
  if (!fs::exists(recording, ignored))
    throw base::InputError(recording, 0,
                           "no such recording: expected an MCAP or CSV file, or a folder with such files");
  return ForeignReader(recording, file).read();
}

}  // namespace sf::scenarios
