#include "record/foreign_messages.h"

#include <array>
#include <cmath>
#include <limits>

#include "base/elementary.h"
#include "record/cdr.h"
#include "record/ros_messages.h"
#include "record/schemas.h"

namespace sf::record {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

constexpr std::string_view kImuColumns[] = {"rate_rad_s", "forward_m_s2", "left_m_s2", "up_m_s2"};
constexpr std::string_view kOdometryColumns[] = {
    "x_m",   "y_m",         "yaw_rad",      "valid",       "xx_m2",    "xy_m2",     "x_yaw_m_rad",
    "yy_m2", "y_yaw_m_rad", "yaw_yaw_rad2", "forward_m_s", "left_m_s", "turn_rad_s"};
constexpr std::string_view kFixColumns[] = {"latitude_deg", "longitude_deg", "variance_m2"};
constexpr std::string_view kScanColumns[] = {"range_m"};

template <std::size_t kCount>
std::array<double, kCount> get_numbers(CdrReader& cdr) {
  std::array<double, kCount> numbers;
  for (double& number : numbers) number = cdr.get<double>();
  return numbers;
}

void get_imu(CdrReader& cdr, ForeignMessage& into) {
  get_numbers<4 + 9>(cdr);  // orientation
  const auto turn = get_numbers<3>(cdr);
  get_numbers<9>(cdr);
  const auto acceleration = get_numbers<3>(cdr);
  get_numbers<9>(cdr);
  into.values = {turn[2], acceleration[0], acceleration[1], acceleration[2]};
}

void get_odometry(CdrReader& cdr, ForeignMessage& into) {
  cdr.get_string();  // child frame
  const auto [x, y, z, qx, qy, qz, qw] = get_numbers<7>(cdr);
  const auto P = get_numbers<36>(cdr);
  const auto twist = get_numbers<6>(cdr);
  get_numbers<36>(cdr);
  const double yaw = base::atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz));
  into.values = {x, y, yaw, 1.0};
  const bool stated = P[0] > 0.0 && P[7] > 0.0 && P[35] > 0.0;  // all zeros: unknown
  for (const std::size_t at : {0, 1, 5, 7, 11, 35}) into.values.push_back(stated ? P[at] : kUnknown);
  for (const std::size_t axis : {0, 1, 5}) into.values.push_back(twist[axis]);
}

void get_fix(CdrReader& cdr, ForeignMessage& into) {
  const auto status = cdr.get<std::int8_t>();
  cdr.get<std::uint16_t>();
  const auto [latitude, longitude, altitude] = get_numbers<3>(cdr);
  const auto P = get_numbers<9>(cdr);
  const bool stated = cdr.get<std::uint8_t>() != 0 && P[0] + P[4] > 0.0;
  const bool fix = status >= 0 && std::abs(latitude) <= 90.0 && std::abs(longitude) <= 360.0;
  into.values = {fix ? latitude : kUnknown, fix ? longitude : kUnknown, stated ? P[0] + P[4] : kUnknown};
}

void get_scan(CdrReader& cdr, ForeignMessage& into) {
  into.angle_min = cdr.get<float>();
  into.angle_max = cdr.get<float>();
  for (int skipped = 0; skipped < 3; ++skipped) cdr.get<float>();  // angle_increment, time_increment, scan_time
  into.range_min = cdr.get<float>();
  into.range_max = cdr.get<float>();
  into.values.resize(cdr.get_count(sizeof(float)));
  for (double& range : into.values) range = cdr.get<float>();
  for (std::size_t left = cdr.get_count(sizeof(float)); left > 0; --left) cdr.get<float>();  // intensities
}

struct ForeignType {
  std::string_view name;
  std::span<const std::string_view> columns;
  void (*get)(CdrReader& cdr, ForeignMessage& into);
};
constexpr ForeignType kForeignTypes[] = {{kImu, kImuColumns, get_imu},
                                         {kOdometry, kOdometryColumns, get_odometry},
                                         {kNavSatFix, kFixColumns, get_fix},
                                         {kLaserScan, kScanColumns, get_scan}};

const ForeignType* find_foreign(std::string_view name) {
  for (const ForeignType& type : kForeignTypes)
    if (type.name == name) return &type;
  return nullptr;
}

}  // namespace

std::span<const std::string_view> foreign_columns(std::string_view type) {
  const ForeignType* const found = find_foreign(type);
  return found == nullptr ? std::span<const std::string_view>() : found->columns;
}

bool decode_foreign(std::string_view type, std::span<const std::uint8_t> message, ForeignMessage& into) {
  const ForeignType* const found = find_foreign(type);
  if (found == nullptr) return false;
  CdrReader cdr(message);
  get_header(cdr, into.time);
  found->get(cdr, into);
  return cdr.good();
}

}  // namespace sf::record
