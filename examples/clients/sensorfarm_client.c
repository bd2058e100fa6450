// A robot's side of the sensor farm in C11 and POSIX. docs/packets.md specifies every byte.
//
// As a program: robot 7 reports its pose (x, y [m], yaw [degrees]; or x, y, z, roll, pitch, yaw) ten times a second and
// prints its readings.
//
//   cc -std=c11 -O2 -o sensorfarm_client sensorfarm_client.c -lm
//   ./sensorfarm_client --robot 7 --farm 127.0.0.1:9000 --pose 1.5,-2.25,30 --sensor laser --sensor gps.0
//
// --key FILE (64 hexadecimal digits, the key in the farm's table of peers) signs sent packets, and drops packets that
// the farm did not sign.
//
// As a library: with -DSENSORFARM_CLIENT_NO_MAIN. Parts of large scans and maps are delivered one by one, each with its
// place in the whole. Each client is single-threaded.

#define _POSIX_C_SOURCE 200809L
#include <arpa/inet.h>
#include <math.h>
#include <netdb.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum {
  SF_LASER = 1,
  SF_LANE_EDGE = 2,
  SF_MAGNETOMETER = 3,
  SF_GPS = 10,
  SF_OCCUPANCY = 12,
  SF_IMU = 46,
  SF_LASER_EXTENDED = 65,
  SF_LIDAR = 44,
  SF_LIDAR_EXTENDED = 108,
  SF_CAMERA = 45,
  SF_CAMERA_EXTENDED = 109
};
enum {
  SF_HEADER = 64,
  SF_V2V_BYTES = 132,
  SF_TILT_BYTES = 16,  // after a V2V or STATE of a robot that is not level
  SF_TAG_BYTES = 168,
  SF_MAX_VALUES = 465,
  SF_MAX_SENSORS = 32,
  SF_SIGNATURE = 24
};
enum {
  SF_V2V = 128,
  SF_TAG,
  SF_SUBSCRIBE,
  SF_START,
  SF_LEAVE,
  SF_CHALLENGE,
  SF_V2I = 137,
  SF_OBJECT,
  SF_REFUSAL,
  SF_NEIGHBOURS,
  SF_DRIVE = 143,
  SF_LANE,
  SF_TEAM_MAP,
  SF_OWN_READINGS,
  SF_DROPPED
};
enum { SF_OWN_LASER = 1, SF_OWN_SONAR = 4, SF_OWN_INFRARED, SF_OWN_BUMPER, SF_OWN_PART = 310 };
enum { SF_DARK, SF_RED, SF_YELLOW, SF_GREEN, SF_FLASHING_RED, SF_FLASHING_YELLOW, SF_STOP_LINE = 255 };
enum { SF_COMMAND = 134, SF_STEP, SF_FETCH, SF_STATE = 141, SF_VALUES };  // lockstep
enum { SF_MAX_COMMANDS = 38, SF_MAX_PART = 148, SF_MAX_DATAGRAM = 1400 };
#define SF_NONE 0xFFFFFFFFu  // V2V: no leader, no checkpoint

// Name, base of the ports, names of the integers, and columns of a row: name, number of values, unit on the wire.
typedef struct {
  uint8_t type;
  const char* name;
  uint16_t port;
  const char* words[6];
  struct {
    const char* name;
    unsigned width;
    double unit;
  } columns[21];  // a unit of 0: f32
} sf_type;
static const sf_type sf_types[] = {
    {1, "laser", 10000, {0}, {{"range_m", 1, 1e-3}}},
    {2,
     "laneedge",
     20000,
     {0},
     {{"distance_m", 1, 1e-3}, {"points", 1, 1}, {"residual_m", 1, 1e-6}, {"sigma_m", 1, 1e-6}}},
    {3, "magnetometer", 30000, {0}, {{"field_T", 1, 1e-8}, {"vector_T", 3, 1e-8}}},
    {4, "sonar", 36000, {0}, {{"range_m", 1, 1e-3}}},
    {5, "infrared", 38000, {0}, {{"range_m", 1, 1e-6}, {"value", 1, 1}}},
    {6, "bumper", 40000, {0}, {{"pressed", 1, 1}}},
    {7, "cliff", 42000, {0}, {{"cliff", 1, 1}}},
    {8,
     "encoder",
     44000,
     {0},
     {{"left_m", 1, 1e-5}, {"right_m", 1, 1e-5}, {"left_counts", 1, 1}, {"right_counts", 1, 1}}},
    {9, "gyro", 46000, {0}, {{"rate_rad_s", 1, 1e-6}}},
    {10,
     "gps",
     48000,
     {0},
     {{"x_m", 1, 5e-3},
      {"y_m", 1, 5e-3},
      {"hdop", 1, 1e-3},
      {"satellites", 1, 1},
      {"altitude_m", 1, 5e-3},
      {"vdop", 1, 1e-3}}},
    {11, "irreceiver", 50000, {0}, {{"virtual_wall", 1, 1}, {"ir_byte", 1, 1}}},
    {12, "occupancy", 52000, {"part", "parts", "word_columns", "word_rows", "flags"}, {{"word", 1, 1}}},
    {27,
     "fiducial",
     62000,
     {0},
     {{"id", 1, 1},
      {"fiducial_type", 1, 1},
      {"range_m", 1, 1e-3},
      {"bearing_rad", 1, 1e-6},
      {"orientation_rad", 1, 1e-6}}},
    {28, "lightsensor", 54000, {0}, {{"illuminance_lx", 1, 1e-3}, {"value", 1, 1}}},
    {29,
     "battery",
     56000,
     {0},
     {{"voltage_V", 1, 1e-3}, {"current_A", 1, 1e-3}, {"charge_Ah", 1, 1e-6}, {"docked", 1, 1}}},
    {30, "analog", 58000, {0}, {{"voltage_V", 1, 1e-4}, {"value", 1, 1}}},
    {31, "ptz", 60000, {0}, {{"pan_rad", 1, 1e-6}, {"tilt_rad", 1, 1e-6}, {"fov_rad", 1, 1e-6}}},
    {32,
     "localization",
     64000,
     {0},
     {{"x_m", 1, 5e-3},
      {"y_m", 1, 5e-3},
      {"yaw_rad", 1, 1e-6},
      {"valid", 1, 1},
      {"xx_m2", 1, 0},
      {"xy_m2", 1, 0},
      {"x_yaw_m_rad", 1, 0},
      {"yy_m2", 1, 0},
      {"y_yaw_m_rad", 1, 0},
      {"yaw_yaw_rad2", 1, 0}}},
    {33,
     "sideslip",
     34000,
     {0},
     {{"sideslip_rad", 1, 1e-6},
      {"front_force_n", 1, 1e-2},
      {"rear_force_n", 1, 1e-2},
      {"valid", 1, 1},
      {"sideslip_sideslip_rad2", 1, 0},
      {"sideslip_front_rad_n", 1, 0},
      {"sideslip_rear_rad_n", 1, 0},
      {"front_front_n2", 1, 0},
      {"front_rear_n2", 1, 0},
      {"rear_rear_n2", 1, 0}}},
    {34, "model", 6000, {0}, {{"value", 1, 0}, {"valid", 1, 1}, {"variance", 1, 0}}},
    {35,
     "monitor",
     4000,
     {0},
     {{"x_m", 1, 5e-3},
      {"y_m", 1, 5e-3},
      {"yaw_rad", 1, 1e-6},
      {"valid", 1, 1},
      {"xx_m2", 1, 0},
      {"xy_m2", 1, 0},
      {"x_yaw_m_rad", 1, 0},
      {"yy_m2", 1, 0},
      {"y_yaw_m_rad", 1, 0},
      {"yaw_yaw_rad2", 1, 0},
      {"forward_m_s", 1, 0},
      {"turn_rad_s", 1, 0},
      {"encoder_state", 1, 1},
      {"gyro_state", 1, 1},
      {"gps_state", 1, 1},
      {"encoder_residual", 1, 0},
      {"gyro_residual", 1, 0},
      {"gps_residual", 1, 0}}},
    {41,
     "location",
     24000,
     {0},
     {{"x_m", 1, 5e-3},
      {"y_m", 1, 5e-3},
      {"valid", 1, 1},
      {"xx_m2", 1, 0},
      {"xy_m2", 1, 0},
      {"yy_m2", 1, 0},
      {"source", 1, 1},
      {"age_s", 1, 0}}},
    {42, "thermometer", 22000, {0}, {{"temperature_C", 1, 1e-3}}},
    {43,
     "aggregate",
     18000,
     {0},
     {{"value", 1, 0}, {"valid", 1, 1}, {"variance", 1, 0}, {"source", 1, 1}, {"age_s", 1, 0}}},
    {47,
     "compass",
     16000,
     {0},
     {{"field_T", 1, 0}, {"field_x_T", 1, 0}, {"field_y_T", 1, 0}, {"field_z_T", 1, 0}, {"heading_rad", 1, 1e-6}}},
    {48, "altimeter", 32000, {0}, {{"height_m", 1, 1e-3}}},
    {49, "inclinometer", 13000, {0}, {{"roll_rad", 1, 1e-6}, {"pitch_rad", 1, 1e-6}, {"saturated", 1, 1}}},
    {50,
     "radar",
     17000,
     {0},
     {{"range_m", 1, 1e-3}, {"bearing_rad", 1, 1e-6}, {"closing_m_s", 1, 1e-4}, {"elevation_rad", 1, 1e-6}}},
    {46,
     "imu",
     12000,
     {0},
     {{"rate_x_rad_s", 1, 0},
      {"rate_y_rad_s", 1, 0},
      {"rate_z_rad_s", 1, 0},
      {"force_x_m_s2", 1, 0},
      {"force_y_m_s2", 1, 0},
      {"force_z_m_s2", 1, 0},
      {"saturated", 1, 1},
      {"orientation_w", 1, 0},
      {"orientation_x", 1, 0},
      {"orientation_y", 1, 0},
      {"orientation_z", 1, 0}}},
    {44, "lidar", 14000, {0}, {{"range_m", 1, 1e-3}}},
    {45, "camera", 15000, {0}, {{"depth_m", 1, 1e-3}}},
    {36, "loop", 8000, {0}, {{"count", 1, 1}, {"occupancy", 1, 1e-6}, {"speed_m_s", 1, 1e-4}, {"vehicles", 1, 1}}},
    {37,
     "link-speed",
     2000,
     {0},
     {{"speed_m_s", 1, 0},
      {"travel_time_s", 1, 0},
      {"valid", 1, 1},
      {"speed_speed_m2_s2", 1, 0},
      {"speed_time_m", 1, 0},
      {"time_time_s2", 1, 0},
      {"age_s", 1, 0}}},
    {38,
     "features",
     26000,
     {0},
     {{"x_m", 1, 0.001},
      {"y_m", 1, 0.001},
      {"direction_rad", 1, 1e-6},
      {"valid", 1, 1},
      {"xx_m2", 1, 0},
      {"xy_m2", 1, 0},
      {"x_direction_m_rad", 1, 0},
      {"yy_m2", 1, 0},
      {"y_direction_m_rad", 1, 0},
      {"direction_direction_rad2", 1, 0},
      {"kind", 1, 1},
      {"half_length_m", 1, 0.001},
      {"id", 1, 1},
      {"age_s", 1, 1e-6}}},
    {39, "tracks", 28000, {0}, {{"x_m", 1, 0.005},     {"y_m", 1, 0.005},     {"vx_m_s", 1, 0},
                                {"vy_m_s", 1, 0},      {"valid", 1, 1},       {"xx_m2", 1, 0},
                                {"xy_m2", 1, 0},       {"x_vx_m2_s", 1, 0},   {"x_vy_m2_s", 1, 0},
                                {"yy_m2", 1, 0},       {"y_vx_m2_s", 1, 0},   {"y_vy_m2_s", 1, 0},
                                {"vx_vx_m2_s2", 1, 0}, {"vx_vy_m2_s2", 1, 0}, {"vy_vy_m2_s2", 1, 0},
                                {"identity", 1, 1},    {"kind", 1, 1},        {"tag", 1, 1},
                                {"ahead_m", 1, 0},     {"contact_s", 1, 0}}},
    {65, "laser", 0, {"total", "first", "part", "parts"}, {{"range_m", 1, 1e-4}}},
    {108, "lidar", 0, {"total", "first", "part", "parts"}, {{"range_m", 1, 1e-4}, {"intensity", 1, 1e-3}, {"incidence_rad", 1, 1e-4},
      {"second_range_m", 1, 1e-4}, {"second_intensity", 1, 1e-3}}},
    {109, "camera", 0, {"total", "first", "part", "parts"}, {{"depth_m", 1, 1e-4}}},
    {128, "V2V", 0, {"follows", "checkpoint", "docking"}, {{"pose", 4, 1}, {"velocity", 3, 1}}},
    {129, "TAG", 0, {0}, {{"position", 3, 1}, {"orientation", 4, 1}, {"linear", 3, 1}, {"angular", 3, 1}}},
    {130, "SUBSCRIBE", 0, {"types"}, {{0}}},
    {131, "START", 0, {0}, {{0}}},
    {132, "LEAVE", 0, {0}, {{0}}},
    {133, "CHALLENGE", 0, {"challenge"}, {{0}}},
    {134, "COMMAND", 0, {0}, {{"robots", 1, 1}, {"twists", 3, 1}}},
    {135, "STEP", 0, {"ticks", "commands"}, {{0}}},
    {136, "FETCH", 0, {"first", "count"}, {{0}}},
    // Rows of eight numbers: approaches, followed by the stop lines of SF_STOP_LINE.
    {137, "V2I", 0, {0}, {{"group", 1, 1}, {"state", 1, 1}, {"next", 1, 1}, {"left_s", 1, 1e-3}, {"light", 4, 1}}},
    {138, "OBJECT", 0, {"present"}, {{0}}},
    {139, "REFUSAL", 0, {"reason"}, {{0}}},
    {140, "NEIGHBOURS", 0, {0}, {{0}}},
    {141, "STATE", 0, {"index", "datagrams", "contact", "flags"}, {{"pose", 4, 1}, {"velocity", 3, 1}}},
    {142, "VALUES", 0, {"index", "datagrams", "values_type", "total", "first"}, {{"value", 1, 1}}},
    {143, "DRIVE", 0, {0}, {{"velocity", 3, 1}}},
    {144, "LANE", 0, {"segment", "lane", "use"}, {{0}}},
    {145, "TEAM_MAP", 0, {"word_columns", "word_rows", "piece", "flags"}, {{0}}},
    {146, "OWN_READINGS", 0, {"readings_type", "total", "first", "fov_urad"}, {{"value", 1, 1}}},
    {147, "DROPPED", 0, {"readings_type", "processor", "network"}, {{0}}},
    {255, "", 0, {0}, {{"stop_group", 1, 1}, {"stop_point", 3, 1}, {"stop_line", 4, 1}}}};

typedef struct {
  uint8_t type;
  uint16_t robot, sensor;
  uint32_t sequence;
  int64_t time_ns;  // of the measurement
  uint32_t session, token;
  unsigned mode, unsure;         // readings, VALUES: accuracy mode; 1: no bound holds for every element
  double bound;                  // of the error, in the unit of the first column; NAN: not stated
  uint32_t age_us;               // of the robot's state used for the reading, of an estimate sent; 0: not stated
  unsigned stale;                // 1: that state is too old to act on
  unsigned fused;                // readings: 1: includes one of the robot's own sensor
  unsigned no_state;             // 1: no state has arrived yet; the robot is at its place in the world file
  float covariance[6];           // of that state, x, y [m], yaw [rad]: xx, xy, x yaw, yy, y yaw, yaw yaw; 0: unknown
  uint32_t words[5];             // the integers named in sf_types
  double corner[3];              // OCCUPANCY, TEAM_MAP: left, top, cell [m]
  unsigned count;                // number of values. NEIGHBOURS: number of V2V packets
  unsigned width;                // values per row, of the first columns; 0: of all
  unsigned approaches;           // V2I: number of rows of eight values that are approaches; the others are stop lines
  double values[SF_MAX_VALUES];  // SI, row by row as in sf_types; NAN: no number; INFINITY: no return
  const uint8_t* image;          // CAMERA_EXTENDED: part of a file, in place of values, from byte words[1] on; as `states`
  unsigned image_bytes;          // 0: the values are depths
  unsigned image_form;           // 1: a PNG file, 2: JPEG
  const uint8_t* states;         // NEIGHBOURS: V2V packets one after another; valid as long as the datagram
  const uint8_t* rows[3];        // TEAM_MAP: acknowledgements (4 u32 each), claim (2 u16 each), bytes; as `states`
  unsigned lengths[3];           // TEAM_MAP: number of integers in each of them
  unsigned changes;              // OBJECT: sum of 2: shape, 4: colour (words[1], 0xAARRGGBB), 8: size (values, m)
  char shape[65];                // OBJECT: name of a shape, or "original"
  uint64_t tick;                 // lockstep
  double tilt[2];                // V2V, STATE: roll, pitch [rad] (positive: left side higher, front lower)
  double sensor_pose[4], error;  // VALUES: x, y, z [m], yaw [rad] in the world frame; error bound, INFINITY: not stated
} sf_packet;

static uint64_t get(const uint8_t* bytes, unsigned size) {
  uint64_t value = 0;
  for (unsigned i = 0; i < size; ++i) value |= (uint64_t)bytes[i] << 8 * i;
  return value;
}
static void put(uint8_t* bytes, unsigned size, uint64_t value) {
  for (unsigned i = 0; i < size; ++i) bytes[i] = (uint8_t)(value >> 8 * i);
}
static double get_f64(const uint8_t* bytes) {
  const uint64_t word = get(bytes, 8);
  double value;
  memcpy(&value, &word, 8);
  return value;
}
static void put_f64(uint8_t* bytes, double value) {
  uint64_t word;
  memcpy(&word, &value, 8);
  put(bytes, 8, word);
}

static const sf_type* sf_find_type(uint8_t type) {
  for (size_t i = 0; i < sizeof sf_types / sizeof *sf_types; ++i)
    if (sf_types[i].type == type) return &sf_types[i];
  return NULL;
}
static unsigned sf_row_width(const sf_type* type) {
  unsigned width = 0;
  for (unsigned c = 0; type->columns[c].name; ++c) width += type->columns[c].width;
  return width;
}

static const char* check_size(size_t size, size_t expected) {
  return size < expected ? "too short" : size > expected ? "too long" : NULL;
}
static const char* check_numbers(const double* values, unsigned count, double limit) {
  bool within = true;
  for (unsigned i = 0; i < count; ++i) {
    if (!isfinite(values[i])) return "not finite";
    within = within && fabs(values[i]) <= limit;
  }
  return within ? NULL : "out of range";
}
static const char* in_range(bool fine) { return fine ? NULL : "out of range"; }

// A part of a lidar's scan with `more` numbers per beam in addition to its range.
static const char* decode_echoes(sf_packet* p, const uint8_t* b, size_t size, unsigned more) {
  const sf_type* const type = sf_find_type(SF_LIDAR_EXTENDED);
  if (more > 4 || more == 3) return "out of range";
  unsigned beam = 0;
  for (unsigned c = 0; c <= more; ++c) beam += c % 3 == 0 ? 4 : 2;
  const unsigned most = 1240 / beam;
  uint32_t* const w = p->words;  // total, first, part, parts
  w[0] = (uint32_t)get(b, 4), w[1] = (uint32_t)get(b + 4, 4), w[2] = (uint32_t)get(b + 8, 2), w[3] = (uint32_t)get(b + 10, 2);
  const unsigned count = (unsigned)get(b + 12, 2);
  const char* const sized = check_size(size, 16 + (size_t)beam * count);
  if (sized) return sized;
  if (w[0] < 1 || w[0] > 1000000 || w[3] != (w[0] + most - 1) / most || w[2] >= w[3] || w[1] != most * w[2] ||
      count != (w[0] - w[1] < most ? w[0] - w[1] : most))
    return "out of range";
  p->width = more + 1;
  p->count = count * p->width;
  b += 16;
  for (unsigned i = 0; i < p->count; ++i) {
    const unsigned column = i % p->width, bytes = column % 3 == 0 ? 4 : 2;
    const uint32_t units = (uint32_t)get(b, bytes);
    p->values[i] = bytes == 4 && units == UINT32_MAX ? INFINITY : units * type->columns[column].unit;
    b += bytes;
  }
  return NULL;
}

// A part of the PNG or JPEG file with a camera's colours.
static const char* decode_image(sf_packet* p, const uint8_t* b, size_t size) {
  uint32_t* const w = p->words;  // total, first, part, parts
  w[0] = (uint32_t)get(b, 4), w[1] = (uint32_t)get(b + 4, 4), w[2] = (uint32_t)get(b + 8, 2), w[3] = (uint32_t)get(b + 10, 2);
  p->image = b + 16;
  p->image_bytes = (unsigned)get(b + 12, 2);
  p->image_form = (unsigned)get(b + 14, 2);
  if (p->image_form > 2) return "out of range";
  const char* const sized = check_size(size, 16 + (size_t)p->image_bytes);
  if (sized) return sized;
  return in_range(w[0] >= 1 && w[0] <= 4000000 && w[3] == (w[0] + 1239) / 1240 && w[2] < w[3] && w[1] == 1240 * w[2] &&
                  p->image_bytes == (w[0] - w[1] < 1240 ? w[0] - w[1] : 1240));
}

static const char* decode_laser(sf_packet* p, const uint8_t* b, size_t size) {
  const bool extended = p->type >= 64;
  const unsigned head = extended ? 16 : 2, word = extended ? 4 : 2;
  if (size < head) return "too short";
  p->width = 1;
  if (p->type == SF_CAMERA_EXTENDED && get(b + 14, 2) != 0) return decode_image(p, b, size);
  if (p->type == SF_LIDAR_EXTENDED && get(b + 14, 2) != 0) return decode_echoes(p, b, size, (unsigned)get(b + 14, 2));
  p->count = (unsigned)get(b + (extended ? 12 : 0), 2);
  const char* const sized = check_size(size, head + (size_t)word * p->count);
  if (sized) return sized;
  uint32_t* const w = p->words;  // total, first, part, parts
  for (unsigned i = 0; extended && i < 4; ++i) w[i] = (uint32_t)get(b + (i < 2 ? 4 * i : 4 + 2 * i), i < 2 ? 4 : 2);
  if (extended && (w[0] < 1 || w[0] > 1000000 || w[3] != (w[0] + 309) / 310 || w[2] >= w[3] || w[1] != 310 * w[2] ||
                   p->count != (w[0] - w[1] < 310 ? w[0] - w[1] : 310)))
    return "out of range";
  if (p->count < 1 || p->count > SF_MAX_VALUES) return "out of range";
  for (unsigned i = 0; i < p->count; ++i) {
    const uint32_t units = (uint32_t)get(b + head + word * i, word);
    p->values[i] = extended && units == UINT32_MAX ? INFINITY : units / (extended ? 1e4 : 1e3);
  }
  return NULL;
}

static const char* decode_lane_edge(sf_packet* p, const uint8_t* b, size_t size) {
  if (size != 12) return check_size(size, 12);
  const uint64_t distance = get(b, 2), residual = get(b + 4, 4), sigma = get(b + 8, 4);
  p->count = 4;
  p->values[0] = distance == 65535 ? NAN : (double)distance / 1e3;
  p->values[1] = (double)get(b + 2, 2);
  p->values[2] = residual == UINT32_MAX ? NAN : (double)residual / 1e6;
  p->values[3] = sigma == UINT32_MAX ? NAN : (double)sigma / 1e6;
  return NULL;
}

static const char* decode_rows(sf_packet* p, const sf_type* type, const uint8_t* b, size_t size) {
  if (size < 4) return "too short";
  const unsigned rows = (unsigned)get(b, 2);
  unsigned width = sf_row_width(type);
  if (p->type == SF_GPS && size == 4 + (size_t)16 * rows) p->width = width = 4;  // without an altitude
  if (p->type == SF_IMU && size == 4 + (size_t)28 * rows) p->width = width = 7;  // without an orientation
  const char* const sized = check_size(size, 4 + (size_t)4 * rows * width);
  if (sized) return sized;
  if (rows < 1 || rows * width > 313 || (p->type == SF_MAGNETOMETER && rows > 16)) return "out of range";
  for (unsigned r = 0; r < rows; ++r)
    for (unsigned c = 0, first = 0; type->columns[c].name && first < width; first += type->columns[c++].width)
      for (unsigned k = 0; k < type->columns[c].width; ++k, ++p->count) {
        const uint32_t bits = (uint32_t)get(b + 4 + 4 * p->count, 4);
        const int32_t word = (int32_t)bits;
        float real;
        memcpy(&real, &bits, 4);
        const bool missing = word == INT32_MIN && p->type != SF_MAGNETOMETER;
        p->values[p->count] = type->columns[c].unit == 0 ? real : missing ? NAN : word * type->columns[c].unit;
      }
  return NULL;
}

static const char* decode_occupancy(sf_packet* p, const uint8_t* b, size_t size) {
  if (size < 36) return "too short";
  uint32_t* const w = p->words;  // part, parts, word columns, word rows, flags
  for (unsigned i = 0; i < 3; ++i) p->corner[i] = get_f64(b + 8 * i);
  for (unsigned i = 0; i < 5; ++i) w[i] = (uint32_t)get(b + 24 + 2 * i, 2);
  p->count = (unsigned)get(b + 34, 2);
  const char* const sized = check_size(size, 36 + (size_t)4 * p->count);
  if (sized) return sized;
  const uint32_t all = w[2] * w[3], left = all > 305 * w[0] ? all - 305 * w[0] : 0;
  const bool placed =
      fabs(p->corner[0]) <= 1e7 && fabs(p->corner[1]) <= 1e7 && p->corner[2] >= 1e-4 && p->corner[2] <= 1e3;
  const bool shaped = w[2] >= 1 && w[2] <= 4096 && w[3] >= 1 && w[3] <= 4096 && all <= 1u << 20 && w[4] <= 1;
  if (!placed || !shaped || w[1] != (all + 304) / 305 || w[0] >= w[1] || p->count != (left < 305 ? left : 305))
    return "out of range";
  for (unsigned i = 0; i < p->count; ++i) {
    const uint32_t word = (uint32_t)get(b + 36 + 4 * i, 4);
    if (word & word >> 1 & 0x55555555u) return "out of range";
    p->values[i] = word;
  }
  return NULL;
}

const char* sf_decode(const uint8_t* bytes, size_t size, sf_packet* packet);

static const char* decode_neighbours(sf_packet* p, const uint8_t* b, size_t size) {
  if (size > 9 * SF_V2V_BYTES) return "too long";
  if (size == 0 || size % SF_V2V_BYTES != 0) return "too short";
  p->states = b;
  for (p->count = 0; p->count < size / SF_V2V_BYTES; ++p->count) {
    static _Thread_local sf_packet state;
    const char* const status = sf_decode(b + SF_V2V_BYTES * p->count, SF_V2V_BYTES, &state);
    if (status || state.type != SF_V2V) return status ? status : "wrong direction";
  }
  return NULL;
}

static double get_f32(const uint8_t* bytes) {
  const uint32_t word = (uint32_t)get(bytes, 4);
  float value;
  memcpy(&value, &word, 4);
  return value;
}

// The eight numbers of a row: group, then state, next and time left, or way-point; then place.
static const char* decode_v2i_row(const uint8_t* b, bool approach, double* v) {
  const uint64_t left = get(b + 4, 4);
  v[0] = b[0];
  v[1] = approach ? b[1] : (double)get(b + 2, 2);
  v[2] = !approach ? (double)get(b + 4, 2) : b[2] == 255 ? NAN : b[2];
  v[3] = !approach ? (double)get(b + 6, 2) : left == UINT32_MAX ? NAN : (double)left / 1e3;
  for (unsigned i = 0; i < 2; ++i) v[4 + i] = get_f64(b + 8 + 8 * i), v[6 + i] = get_f32(b + 24 + 4 * i);
  if (check_numbers(v + 4, 4, HUGE_VAL)) return "not finite";
  const bool placed = fabs(v[4]) <= 1e7 && fabs(v[5]) <= 1e7 && b[0] >= 1 && b[0] <= 254;
  return in_range(placed && (approach ? b[1] < 6 && (b[2] < 6 || b[2] == 255) && fabs(v[6]) <= 1e7 && fabs(v[7]) <= 1e6
                                      : fabs(v[6]) <= 1e6 && v[7] >= 0 && v[7] <= 1e7));
}

static const unsigned team_map_widths[3] = {4, 2, 1};  // bytes of the integers in sf_packet.rows

static const char* decode_team_map(sf_packet* p, const uint8_t* b, size_t size) {
  if (size < 44) return "too short";
  for (unsigned i = 0; i < 3; ++i) p->corner[i] = get_f64(b + 8 * i), p->words[i] = (uint32_t)get(b + 24 + 4 * i, 4);
  const uint32_t flags = p->words[3] = (uint32_t)get(b + 42, 2), *const w = p->words;
  p->lengths[0] = 4 * (unsigned)get(b + 38, 2), p->lengths[1] = 2 * (unsigned)get(b + 40, 2);
  p->lengths[2] = (unsigned)get(b + 36, 2);
  size_t at = 44;
  for (unsigned i = 0; i < 3; at += (size_t)team_map_widths[i] * p->lengths[i], ++i) p->rows[i] = b + at;
  const char* const sized = check_size(size, at);
  if (sized) return sized;
  if (check_numbers(p->corner, 3, HUGE_VAL)) return "not finite";
  uint64_t end = 0;
  for (unsigned i = 0; i < p->lengths[1]; ++i) end += get(p->rows[1] + 2 * i, 2);
  bool good = fabs(p->corner[0]) <= 1e7 && fabs(p->corner[1]) <= 1e7 && p->corner[2] >= 1e-4 && p->corner[2] <= 1e3 &&
              w[0] >= 1 && w[0] <= 4096 && w[1] >= 1 && w[1] <= 4096 && w[0] * w[1] <= 1u << 20 && flags < 8 &&
              p->lengths[0] <= 4 * 12 && end <= UINT64_C(16) * w[0] * w[1] &&
              ((flags & 2) || (p->lengths[1] == 0 && !(flags & 4))) &&
              (p->lengths[2] > 0 || (w[2] == 0 && !(flags & 1)));
  for (unsigned i = 0; good && i < p->lengths[0]; i += 4) good = get(p->rows[0] + 4 * i, 4) <= 65535;
  return in_range(good);
}

static const char* decode_own_readings(sf_packet* p, const uint8_t* b, size_t size) {
  if (size < 16) return "too short";
  uint32_t* const w = p->words;  // type, total, first, field of view
  w[0] = (uint32_t)get(b, 2);
  for (unsigned i = 1; i < 4; ++i) w[i] = (uint32_t)get(b + 4 * i, 4);
  const bool bumper = w[0] == SF_OWN_BUMPER;
  const uint32_t count = (uint32_t)get(b + 2, 2);
  const char* const sized = check_size(size, 16 + (size_t)4 * (bumper ? 1 : count));
  if (sized) return sized;
  const uint32_t most = w[0] == SF_OWN_LASER                              ? 1000000
                        : w[0] == SF_OWN_SONAR || w[0] == SF_OWN_INFRARED ? 64
                        : bumper                                          ? 32
                                                                          : 0;
  const bool good = w[1] >= 1 && w[1] <= most && w[2] < w[1] && w[2] % SF_OWN_PART == 0 &&
                    count == (w[1] - w[2] < SF_OWN_PART ? w[1] - w[2] : SF_OWN_PART) &&
                    w[3] <= (w[0] == SF_OWN_LASER ? 6283186 : 0) && (!bumper || get(b + 16, 4) >> count == 0);
  if (!good) return "out of range";
  for (p->count = 0; p->count < count; ++p->count) {
    const uint64_t word = get(b + 16 + (bumper ? 0 : 4 * p->count), 4);
    p->values[p->count] = bumper                ? (double)(word >> p->count & 1)
                          : word == SF_NONE     ? NAN
                          : word == SF_NONE - 1 ? INFINITY
                                                : (double)word / 1e4;
  }
  return NULL;
}

static const char* decode_v2i(sf_packet* p, const uint8_t* b, size_t size) {
  if (size < 8) return "too short";
  p->approaches = (unsigned)get(b, 2);
  const unsigned rows = p->approaches + (unsigned)get(b + 2, 2);
  const char* status = check_size(size, 8 + (size_t)32 * rows);
  if (status) return status;
  status = in_range(p->approaches > 0);
  for (unsigned i = 0; i < rows; ++i, p->count += 8) {
    const char* const row = decode_v2i_row(b + 8 + 32 * i, i < p->approaches, p->values + p->count);
    if (row && (!status || strcmp(row, "not finite") == 0)) status = row;
  }
  return status;
}

// An OBJECT that changes a shape, colour or size.
enum { SF_SHAPED_OBJECT = 96 };
static const char* decode_shaped(sf_packet* p, const uint8_t* b) {
  static const char* const plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.";
  const uint32_t flags = (uint32_t)get(b, 4);
  p->words[0] = flags & 1;
  p->words[1] = (uint32_t)get(b + 4, 4);
  p->changes = flags & ~1u;
  memcpy(p->shape, b + 32, 64);
  p->shape[64] = 0;
  const size_t length = strlen(p->shape);
  bool good = flags > 1 && flags < 16 && p->robot > 0 && length == strspn(p->shape, plain) &&
              (length > 0) == ((flags & 2) != 0) && ((flags & 4) || p->words[1] == 0);
  for (size_t i = length; i < 64; ++i) good = good && b[32 + i] == 0;
  for (p->count = 0; p->count < 3; ++p->count) {
    const double v = p->values[p->count] = get_f64(b + 8 + 8 * p->count);
    good = good && ((flags & 8) ? v > 0 && v <= 1000 : get(b + 8 + 8 * p->count, 8) == 0);
  }
  return check_numbers(p->values, 3, HUGE_VAL) ? "not finite" : in_range(good);
}

// Reads the tilt after the first `shorter` bytes of a payload, and takes it off its size; level robots send none.
static void decode_tilt(sf_packet* p, const uint8_t* b, size_t shorter, size_t* size) {
  if (*size != shorter + SF_TILT_BYTES) return;
  for (unsigned i = 0; i < 2; ++i) p->tilt[i] = get_f64(b + shorter + 8 * i);
  *size = shorter;
}

static const char* decode_state(sf_packet* p, const sf_type* type, const uint8_t* b, size_t size) {
  unsigned words = 0;
  while (type->words[words]) ++words;
  if (p->type == SF_OBJECT && size == SF_SHAPED_OBJECT) return decode_shaped(p, b);
  p->count = sf_row_width(type);
  if (p->type == SF_V2V) decode_tilt(p, b, 8 * p->count + 4 * words, &size);
  if (size != 8 * p->count + 4 * words) return check_size(size, 8 * p->count + 4 * words);
  for (unsigned i = 0; i < p->count; ++i) p->values[i] = get_f64(b + 8 * i);
  for (unsigned i = 0; i < words; ++i) p->words[i] = (uint32_t)get(b + 8 * p->count + 4 * i, 4);
  const double* const v = p->values;
  if (check_numbers(v, p->count, HUGE_VAL) || check_numbers(p->tilt, 2, HUGE_VAL)) return "not finite";
  if (p->type == SF_V2V)
    return in_range(!check_numbers(v, 3, 1e7) && fabs(v[3]) <= 1e6 && !check_numbers(v + 4, 3, 1e3) &&
                    fabs(p->tilt[0]) <= acos(-1.0) && fabs(p->tilt[1]) <= acos(0.0) && p->words[2] <= 1 &&
                    (p->words[0] <= 65535 || p->words[0] == SF_NONE));
  if (p->type == SF_TAG)
    return in_range(!check_numbers(v, 3, 1e7) && !check_numbers(v + 7, 6, 1e3) && p->robot > 0 &&
                    fabs(hypot(hypot(v[3], v[4]), hypot(v[5], v[6])) - 1.0) <= 1e-3);
  if (p->type == SF_DRIVE) return in_range(!check_numbers(v, 3, 1e3));
  if (p->type == SF_OBJECT) return in_range(p->words[0] <= 1 && p->robot > 0);
  if (p->type == SF_LANE) return in_range(p->words[2] < 16 && p->words[2] % 8 <= 4);
  if (p->type == SF_REFUSAL) return in_range(p->words[0] >= 1 && p->words[0] <= 4);
  if (p->type == SF_DROPPED) return in_range(p->words[0] >= 1 && p->words[0] <= 63);
  return NULL;
}

static bool is_lockstep(uint8_t type) {
  return (type >= SF_COMMAND && type <= SF_FETCH) || type == SF_STATE || type == SF_VALUES;
}

// Rows of robot, forward, left, turn.
static const char* decode_command(sf_packet* p, const uint8_t* b, size_t size) {
  const size_t count = size < 16 ? 0 : get(b + 8, 4);
  if (size < 16 || size != 16 + 32 * count) return size < 16 ? "too short" : check_size(size, 16 + 32 * count);
  if (count < 1 || count > SF_MAX_COMMANDS) return "out of range";
  bool within = true;
  for (const uint8_t* row = b + 16; p->count < 4 * count; row += 32, p->count += 4) {
    double* const v = p->values + p->count;
    v[0] = (double)get(row + 24, 4);
    for (unsigned i = 0; i < 3; ++i) v[1 + i] = get_f64(row + 8 * i);
    if (check_numbers(v + 1, 3, HUGE_VAL)) return "not finite";
    within = within && v[0] <= 65535 && !check_numbers(v + 1, 3, 1e3);
  }
  return in_range(within);
}

static const char* decode_values(sf_packet* p, const uint8_t* b, size_t size) {
  if (size < 72) return "too short";
  uint32_t* const w = p->words;  // index, datagrams, type, total, first
  w[0] = (uint32_t)get(b + 8, 4), w[1] = (uint32_t)get(b + 12, 4), w[2] = (uint32_t)get(b + 16, 2);
  w[3] = (uint32_t)get(b + 20, 4), w[4] = (uint32_t)get(b + 24, 4);
  p->count = (unsigned)get(b + 18, 2);
  if (size != 72 + 8 * (size_t)p->count) return check_size(size, 72 + 8 * (size_t)p->count);
  for (unsigned i = 0; i < 4; ++i) p->sensor_pose[i] = get_f64(b + 32 + 8 * i);
  p->error = get_f64(b + 64);
  if (check_numbers(p->sensor_pose, 4, HUGE_VAL) || isnan(p->error)) return "not finite";
  if (w[3] < 1 || w[3] > 1u << 24 || w[4] >= w[3] || w[4] % SF_MAX_PART != 0 ||
      p->count != (w[3] - w[4] < SF_MAX_PART ? w[3] - w[4] : SF_MAX_PART) || w[2] < 1 || w[2] > 63 || w[0] >= w[1] ||
      !(p->error >= 0))
    return "out of range";
  for (unsigned i = 0; i < p->count; ++i) p->values[i] = get_f64(b + 72 + 8 * i);
  return NULL;
}

static const char* decode_lockstep(sf_packet* p, const uint8_t* b, size_t size) {
  if (size >= 8) p->tick = get(b, 8);
  if (p->type == SF_COMMAND) return decode_command(p, b, size);
  if (p->type == SF_VALUES) return decode_values(p, b, size);
  const size_t expected = p->type == SF_STATE ? 80 : 16;
  if (p->type == SF_STATE) decode_tilt(p, b, expected, &size);
  if (size != expected) return check_size(size, expected);
  for (unsigned i = 0; i < 2; ++i) p->words[i] = (uint32_t)get(b + 8 + 4 * i, 4);
  if (p->type == SF_STEP) return in_range(p->words[0] >= 1 && p->words[0] <= 1000 && p->words[1] <= 65536);
  if (p->type == SF_FETCH) return in_range(p->words[1] >= 1 && p->words[1] <= 64);
  for (; p->count < 7; ++p->count) p->values[p->count] = get_f64(b + 16 + 8 * p->count);
  for (unsigned i = 2; i < 4; ++i) p->words[i] = (uint32_t)get(b + 64 + 4 * i, 4);
  if (check_numbers(p->values, 7, HUGE_VAL) || check_numbers(p->tilt, 2, HUGE_VAL)) return "not finite";
  return in_range(p->words[0] < p->words[1] && p->words[2] <= 1 && p->words[3] <= 1);
}

static bool has_accuracy(const sf_packet* p) { return p->type < 128 || p->type == SF_VALUES; }

static void decode_accuracy(sf_packet* p, const uint8_t* b) {
  const unsigned accuracy = (unsigned)get(b + 10, 2);
  p->mode = accuracy & 15;
  p->unsure = accuracy >> 4 & 1;
  p->bound = accuracy < 32 ? NAN : exp2(((double)(accuracy >> 5) - 1024) / 16);
}

static void decode_state_quality(sf_packet* p, const uint8_t* b) {
  p->age_us = (uint32_t)get(b + 32, 4);
  if (p->age_us == 0) return;
  p->stale = b[62] & 1;
  p->no_state = b[62] >> 1 & 1;
  bool known = true;
  for (unsigned i = 0; i < 6; ++i) {
    const uint32_t word = (uint32_t)get(b + 36 + 4 * i, 4);
    memcpy(&p->covariance[i], &word, 4);
    known = known && isfinite(p->covariance[i]) && ((i != 0 && i != 3 && i != 5) || p->covariance[i] >= 0);
  }
  if (!known) memset(p->covariance, 0, sizeof p->covariance);
}

// Decodes any bytes. Returns NULL, or the reason why they are dropped.
const char* sf_decode(const uint8_t* bytes, size_t size, sf_packet* packet) {
  memset(packet, 0, sizeof *packet);
  if (size < SF_HEADER) return "too short";
  if (memcmp(bytes, "SFPK", 4) != 0) return "bad magic";
  if (bytes[4] != 2) return "unknown version";
  packet->type = bytes[5];
  packet->robot = (uint16_t)get(bytes + 6, 2);
  packet->sensor = (uint16_t)get(bytes + 8, 2);
  packet->sequence = (uint32_t)get(bytes + 12, 4);
  packet->time_ns = (int64_t)get(bytes + 16, 8);
  packet->session = (uint32_t)get(bytes + 24, 4);
  packet->token = (uint32_t)get(bytes + 28, 4);
  const size_t trailer = get(bytes + 60, 2);
  if (size < SF_HEADER + trailer) return "too short";
  const sf_type* const type = sf_find_type(packet->type);
  if (!type || packet->type == SF_STOP_LINE) return "unknown type";
  const uint8_t* const b = bytes + SF_HEADER;
  size -= SF_HEADER + trailer;
  if (size > 1256) return "too long";
  packet->fused = packet->type < 128 ? bytes[62] >> 2 & 1 : 0;
  if (has_accuracy(packet)) decode_accuracy(packet, bytes);
  if (packet->type < 128 || packet->type == SF_V2V || packet->type == SF_TAG) decode_state_quality(packet, bytes);
  const uint8_t laser = packet->type;  // or a lidar or camera
  const char* const status =
      laser == SF_LASER || laser == SF_LASER_EXTENDED || laser == SF_LIDAR || laser == SF_LIDAR_EXTENDED ||
              laser == SF_CAMERA || laser == SF_CAMERA_EXTENDED
          ? decode_laser(packet, b, size)
      : packet->type == SF_LANE_EDGE    ? decode_lane_edge(packet, b, size)
      : packet->type == SF_OCCUPANCY    ? decode_occupancy(packet, b, size)
      : packet->type == SF_NEIGHBOURS   ? decode_neighbours(packet, b, size)
      : packet->type == SF_V2I          ? decode_v2i(packet, b, size)
      : packet->type == SF_TEAM_MAP     ? decode_team_map(packet, b, size)
      : packet->type == SF_OWN_READINGS ? decode_own_readings(packet, b, size)
      : is_lockstep(packet->type)       ? decode_lockstep(packet, b, size)
      : packet->type >= 128             ? decode_state(packet, type, b, size)
                                        : decode_rows(packet, type, b, size);
  if (status) return status;
  return in_range(packet->time_ns >= 0 && packet->time_ns <= INT64_C(1) << 62 && trailer <= 80);
}

// Encodes a V2V, TAG, SUBSCRIBE, START, LEAVE, OBJECT or LANE from type, robot, sequence, time_ns, session, token,
// words, values, the tilt in V2V and, of an estimate in V2V or TAG, age_us, stale and covariance. Returns its size, at
// most SF_TAG_BYTES; 0 for numbers that the farm would drop.
size_t sf_encode(const sf_packet* packet, uint8_t* bytes) {
  const sf_type* const type = sf_find_type(packet->type);
  if (!type || packet->type < SF_V2V ||
      (packet->type > SF_LEAVE && packet->type != SF_OBJECT && packet->type != SF_LANE))
    return 0;
  memset(bytes, 0, SF_TAG_BYTES);
  memcpy(bytes, "SFPK\2", 5);
  bytes[5] = packet->type;
  put(bytes + 6, 2, packet->robot);
  put(bytes + 12, 4, packet->sequence);
  put(bytes + 16, 8, (uint64_t)packet->time_ns);
  put(bytes + 24, 4, packet->session);
  put(bytes + 28, 4, packet->token);
  put(bytes + 32, 4, packet->age_us);
  for (unsigned i = 0; i < 6 && packet->age_us > 0; ++i) {
    uint32_t word;
    memcpy(&word, &packet->covariance[i], 4);
    put(bytes + 36 + 4 * i, 4, word);
  }
  if (packet->age_us > 0) put(bytes + 62, 2, packet->stale);
  size_t size = SF_HEADER;
  for (unsigned i = 0; i < sf_row_width(type); ++i, size += 8) put_f64(bytes + size, packet->values[i]);
  for (unsigned i = 0; type->words[i]; ++i, size += 4) put(bytes + size, 4, packet->words[i]);
  const bool tilted = packet->type == SF_V2V && (packet->tilt[0] != 0 || packet->tilt[1] != 0);
  for (unsigned i = 0; i < 2 && tilted; ++i, size += 8) put_f64(bytes + size, packet->tilt[i]);
  if (packet->type == SF_OBJECT && packet->changes) {
    put(bytes + SF_HEADER, 4, (packet->words[0] & 1) | packet->changes);
    put(bytes + size, 4, packet->changes & 4 ? packet->words[1] : 0);
    for (unsigned i = 0; i < 3 && (packet->changes & 8); ++i) put_f64(bytes + size + 4 + 8 * i, packet->values[i]);
    if (packet->changes & 2) memcpy(bytes + SF_HEADER + 32, packet->shape, strnlen(packet->shape, 64));
    size = SF_HEADER + SF_SHAPED_OBJECT;
  }
  static _Thread_local sf_packet back;
  return sf_decode(bytes, size, &back) == NULL ? size : 0;
}

// Prints the first columns, of `width` values per row; 0: all.
static void print_columns(FILE* out, const sf_type* type, const double* values, unsigned count, unsigned width,
                          const char* before, const char* after) {
  if (width == 0) width = sf_row_width(type);
  for (unsigned c = 0, first = 0; type->columns[c].name && first < width; first += type->columns[c++].width) {
    fprintf(out, "%s%s =", before, type->columns[c].name);
    for (unsigned row = 0; row < count; row += width)
      for (unsigned k = 0; k < type->columns[c].width; ++k)
        fprintf(out, isnan(values[row + first + k]) ? " none" : " %.10g", values[row + first + k]);
    if (count == 0) fputc(' ', out);
    fputs(after, out);
  }
}

// Encodes a COMMAND, STEP or FETCH in the same way, of at most SF_MAX_DATAGRAM bytes. COMMAND: values are rows of
// robot, forward, left [m/s], turn [rad/s], `count` numbers in all.
size_t sf_encode_lockstep(const sf_packet* packet, uint8_t* bytes) {
  const sf_packet head = {.type = SF_LEAVE,
                          .robot = packet->robot,
                          .sequence = packet->sequence,
                          .time_ns = packet->time_ns,
                          .session = packet->session,
                          .token = packet->token};
  const bool command = packet->type == SF_COMMAND;
  if (packet->type < SF_COMMAND || packet->type > SF_FETCH || packet->count > 4 * SF_MAX_COMMANDS ||
      sf_encode(&head, bytes) == 0)
    return 0;
  bytes[5] = packet->type;
  put(bytes + SF_HEADER, 8, packet->tick);
  put(bytes + SF_HEADER + 8, 4, command ? packet->count / 4 : packet->words[0]);
  put(bytes + SF_HEADER + 12, 4, command ? 0 : packet->words[1]);
  uint8_t* row = bytes + SF_HEADER + 16;
  for (unsigned i = 0; command && i + 3 < packet->count; i += 4, row += 32) {
    for (unsigned k = 0; k < 3; ++k) put_f64(row + 8 * k, packet->values[i + 1 + k]);
    put(row + 24, 8, (uint64_t)packet->values[i]);
  }
  static _Thread_local sf_packet back;
  return sf_decode(bytes, (size_t)(row - bytes), &back) == NULL ? (size_t)(row - bytes) : 0;
}

// Encodes an OWN_READINGS in the same way, of at most SF_MAX_DATAGRAM bytes: words are type, total, first and field of
// view [urad], `count` values are ranges [m], INFINITY without an echo, NAN if not measured; of bumpers 0 or 1.
size_t sf_encode_own_readings(const sf_packet* packet, uint8_t* bytes) {
  const sf_packet head = {.type = SF_LEAVE,
                          .robot = packet->robot,
                          .sequence = packet->sequence,
                          .time_ns = packet->time_ns,
                          .session = packet->session,
                          .token = packet->token};
  if (packet->type != SF_OWN_READINGS || packet->count > SF_OWN_PART || sf_encode(&head, bytes) == 0) return 0;
  bytes[5] = packet->type;
  put(bytes + 8, 2, packet->sensor);
  put(bytes + SF_HEADER, 2, packet->words[0]);
  put(bytes + SF_HEADER + 2, 2, packet->count);
  for (unsigned i = 1; i < 4; ++i) put(bytes + SF_HEADER + 4 * i, 4, packet->words[i]);
  size_t size = SF_HEADER + 16;
  uint64_t pressed = 0;
  for (unsigned i = 0; i < packet->count; ++i) {
    const double v = packet->values[i], units = floor(v * 1e4 + 0.5);
    if (packet->words[0] == SF_OWN_BUMPER)
      pressed |= (uint64_t)(v != 0) << i;
    else
      put(bytes + size, 4, isnan(v) ? SF_NONE : units < SF_NONE - 1 ? (uint64_t)units : SF_NONE - 1), size += 4;
  }
  if (packet->words[0] == SF_OWN_BUMPER) put(bytes + size, 4, pressed), size += 4;
  static _Thread_local sf_packet back;
  return sf_decode(bytes, size, &back) == NULL ? size : 0;
}

// Prints the names and values of a packet after its header, each as `before`, "range_m = 1 0.25 8" and `after`.
void sf_print_body(FILE* out, const sf_packet* p, const char* before, const char* after) {
  static const char* const corner[] = {"left_m", "top_m", "cell_m"};
  const sf_type* const type = sf_find_type(p->type);
  for (unsigned i = 0; (p->type == SF_OCCUPANCY || p->type == SF_TEAM_MAP) && i < 3; ++i)
    fprintf(out, "%s%s = %.10g%s", before, corner[i], p->corner[i], after);
  if (is_lockstep(p->type)) fprintf(out, "%stick = %llu%s", before, (unsigned long long)p->tick, after);
  for (unsigned i = 0; type->words[i]; ++i) {
    char number[12] = "none";
    if (p->type != SF_V2V || p->words[i] != SF_NONE) snprintf(number, sizeof number, "%lu", (unsigned long)p->words[i]);
    fprintf(out, "%s%s = %s%s", before, type->words[i], number, after);
  }
  if (p->type == SF_OBJECT && p->changes) {
    fprintf(out, "%sshape = %s%s", before, p->changes & 2 ? p->shape : "none", after);
    fprintf(out, "%scolor = ", before);
    fprintf(out, p->changes & 4 ? "%lu" : "none", (unsigned long)p->words[1]);
    fprintf(out, "%s%ssize_m =", after, before);
    for (unsigned i = 0; i < 3; ++i) fprintf(out, p->changes & 8 ? " %.10g" : " none", p->values[i]);
    fputs(after, out);
  }
  if (p->type == SF_VALUES) {
    fprintf(out, "%ssensor_pose =", before);
    for (unsigned i = 0; i < 4; ++i) fprintf(out, " %.10g", p->sensor_pose[i]);
    fprintf(out, "%s%serror = ", after, before);
    fprintf(out, isinf(p->error) ? "none" : "%.10g", p->error);
    fputs(after, out);
  }
  static const char* const lists[] = {"acks", "claim", "data"};
  for (unsigned i = 0; p->type == SF_TEAM_MAP && i < 3; ++i) {
    fprintf(out, p->lengths[i] > 0 ? "%s%s =" : "%s%s = ", before, lists[i]);
    for (unsigned k = 0; k < p->lengths[i]; ++k)
      fprintf(out, " %lu", (unsigned long)get(p->rows[i] + team_map_widths[i] * k, team_map_widths[i]));
    fputs(after, out);
  }
  if (p->image_bytes > 0) {
    fprintf(out, "%sform = %u%s%simage =", before, p->image_form, after, before);
    for (unsigned i = 0; i < p->image_bytes; ++i) fprintf(out, " %u", p->image[i]);
    fputs(after, out);
    return;
  }
  const unsigned approaches = p->type == SF_V2I ? 8 * p->approaches : p->count;
  print_columns(out, type, p->values, approaches, p->width, before, after);
  if (p->tilt[0] != 0 || p->tilt[1] != 0) fprintf(out, "%stilt = %.10g %.10g%s", before, p->tilt[0], p->tilt[1], after);
  if (p->type == SF_V2I)
    print_columns(out, sf_find_type(SF_STOP_LINE), p->values + approaches, p->count - approaches, 0, before,
                  after);
}

// Prints "; error up to " with three digits, never less than the bound.
static void print_bound(FILE* out, double bound) {
  char text[32];
  snprintf(text, sizeof text, "%.3g", bound);
  if (strtod(text, NULL) < bound) snprintf(text, sizeof text, "%.3g", bound + 0.5 * pow(10, floor(log10(bound)) - 2));
  fprintf(out, "; error up to %s", text);
}

// Prints one line about a packet; NEIGHBOURS: one for each state.
void sf_print(FILE* out, const sf_packet* p) {
  for (unsigned i = 0; p->type == SF_NEIGHBOURS && i < p->count; ++i) {
    static _Thread_local sf_packet state;
    if (sf_decode(p->states + SF_V2V_BYTES * i, SF_V2V_BYTES, &state) == NULL) sf_print(out, &state);
  }
  if (p->type == SF_NEIGHBOURS) return;
  const char* const whose = p->type == SF_V2I ? "intersection" : p->type == SF_OBJECT ? "tag" : "robot";
  fprintf(out, "%s %u of %s %u at %.3f s", sf_find_type(p->type)->name, p->sensor, whose, p->robot,
          (double)p->time_ns * 1e-9);
  sf_print_body(out, p, "; ", "");
  if (has_accuracy(p)) fprintf(out, "; mode %u%s", p->mode, p->unsure ? ", not for every element" : "");
  if (has_accuracy(p) && !isnan(p->bound)) print_bound(out, p->bound);
  if (p->fused) fprintf(out, "; fused");
  if (p->no_state)
    fprintf(out, "; no state of the robot has arrived yet");
  else if (p->age_us > 0)
    fprintf(out, "; state %.1f ms old%s", p->age_us * 1e-3, p->stale ? ", stale" : "");
  if (p->covariance[0] + p->covariance[3] + p->covariance[5] > 0)
    fprintf(out, ", sigma %.3g m, %.3g m, %.3g rad", sqrt(p->covariance[0]), sqrt(p->covariance[3]),
            sqrt(p->covariance[5]));
  fputc('\n', out);
}

// Signatures: HMAC-SHA-256 (RFC 2104, FIPS 180-4). A packet's trailer is a counter and the first half of its HMAC.

typedef struct {
  uint32_t words[8];
  uint64_t size;  // number of bytes so far
  uint8_t block[64];
} sf_sha256;

static uint32_t rotate_right(uint32_t word, unsigned bits) { return word >> bits | word << (32 - bits); }
static uint32_t get_big_endian(const uint8_t* b) {
  return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static void sha256_block(sf_sha256* s) {
  static const uint32_t constants[64] = {
      0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
      0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
      0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
      0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
      0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
      0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
      0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
      0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};
  uint32_t w[64], v[8];
  for (unsigned i = 0; i < 16; ++i) w[i] = get_big_endian(s->block + 4 * i);
  for (unsigned i = 16; i < 64; ++i) {
    const uint32_t a = w[i - 15], b = w[i - 2];
    w[i] = w[i - 16] + (rotate_right(a, 7) ^ rotate_right(a, 18) ^ a >> 3) + w[i - 7] +
           (rotate_right(b, 17) ^ rotate_right(b, 19) ^ b >> 10);
  }
  memcpy(v, s->words, sizeof v);
  for (unsigned i = 0; i < 64; ++i) {
    const uint32_t a = v[0], e = v[4];
    const uint32_t t1 = v[7] + (rotate_right(e, 6) ^ rotate_right(e, 11) ^ rotate_right(e, 25)) +
                        ((e & v[5]) ^ (~e & v[6])) + constants[i] + w[i];
    const uint32_t t2 =
        (rotate_right(a, 2) ^ rotate_right(a, 13) ^ rotate_right(a, 22)) + ((a & v[1]) ^ (a & v[2]) ^ (v[1] & v[2]));
    memmove(v + 1, v, 7 * sizeof *v);
    v[4] += t1;
    v[0] = t1 + t2;
  }
  for (unsigned i = 0; i < 8; ++i) s->words[i] += v[i];
}

static void sha256_begin(sf_sha256* s) {
  *s = (sf_sha256){
      .words = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19}};
}
static void sha256_add(sf_sha256* s, const uint8_t* bytes, size_t size) {
  for (size_t i = 0; i < size; ++i) {
    s->block[s->size++ % 64] = bytes[i];
    if (s->size % 64 == 0) sha256_block(s);
  }
}
static void sha256_end(sf_sha256* s, uint8_t hash[32]) {
  const uint64_t bits = 8 * s->size;
  const uint8_t one = 0x80, zero = 0;
  sha256_add(s, &one, 1);
  while (s->size % 64 != 56) sha256_add(s, &zero, 1);
  for (unsigned i = 0; i < 8; ++i) sha256_add(s, &(uint8_t){(uint8_t)(bits >> (56 - 8 * i))}, 1);
  for (unsigned i = 0; i < 32; ++i) hash[i] = (uint8_t)(s->words[i / 4] >> (24 - 8 * (i % 4)));
}

// key: at most 64 bytes; longer keys are hashed first.
void sf_hmac_sha256(const uint8_t* key, size_t key_size, const uint8_t* bytes, size_t size, uint8_t code[32]) {
  uint8_t padded[64] = {0}, inner[32];
  sf_sha256 s;
  if (key_size > 64) {
    sha256_begin(&s);
    sha256_add(&s, key, key_size);
    sha256_end(&s, padded);
  } else if (key_size > 0) {
    memcpy(padded, key, key_size);
  }
  for (unsigned i = 0; i < 64; ++i) padded[i] ^= 0x36;
  sha256_begin(&s);
  sha256_add(&s, padded, 64);
  sha256_add(&s, bytes, size);
  sha256_end(&s, inner);
  for (unsigned i = 0; i < 64; ++i) padded[i] ^= 0x36 ^ 0x5c;
  sha256_begin(&s);
  sha256_add(&s, padded, 64);
  sha256_add(&s, inner, 32);
  sha256_end(&s, code);
}

// Appends a trailer to a packet without one, in a buffer with room for SF_SIGNATURE more bytes. Returns the new size.
size_t sf_sign(uint8_t* bytes, size_t size, const uint8_t key[32], uint64_t counter) {
  uint8_t code[32];
  put(bytes + 60, 2, SF_SIGNATURE);
  put(bytes + size, 8, counter);
  sf_hmac_sha256(key, 32, bytes, size + 8, code);
  memcpy(bytes + size + 8, code, 16);
  return size + SF_SIGNATURE;
}

// Counters of received signatures: each is accepted once, in any order within the newest 64.
typedef struct {
  uint64_t newest, seen;  // bit k of seen: newest - k was received
} sf_window;

// Checks a packet that sf_decode has accepted. Returns NULL, or the reason why it is dropped.
const char* sf_check_signature(sf_window* window, const uint8_t* bytes, size_t size, const uint8_t key[32]) {
  uint8_t code[32], differs = 0;
  if (size < SF_HEADER + SF_SIGNATURE || get(bytes + 60, 2) != SF_SIGNATURE) return "not signed";
  sf_hmac_sha256(key, 32, bytes, size - 16, code);
  for (unsigned i = 0; i < 16; ++i) differs |= code[i] ^ bytes[size - 16 + i];
  if (differs) return "wrong signature";
  const uint64_t counter = get(bytes + size - SF_SIGNATURE, 8);
  if (counter > window->newest) {
    const uint64_t ahead = counter - window->newest;
    window->seen = ahead < 64 ? window->seen << ahead : 0;
    window->newest = counter;
  }
  const uint64_t behind = window->newest - counter;
  if (behind >= 64 || window->seen >> behind & 1) return "replayed";
  window->seen |= UINT64_C(1) << behind;
  return NULL;
}

// A robot that communicates with the farm. Its first socket sends; the address and port of this socket bind the robot's
// id.
typedef struct {
  uint16_t robot;
  struct sockaddr_in farm;
  uint32_t session, token, farm_session, types, states, requests;
  bool all;             // requests all types, and no states of others
  double next_request;  // [s] on the monotonic clock
  double tilt[2];       // roll, pitch [rad] in the states that it sends
  unsigned sockets;
  struct pollfd polled[1 + SF_MAX_SENSORS];
  sf_window windows[1 + SF_MAX_SENSORS];  // of the farm's signatures, by socket
  uint8_t key[32];                        // the farm's key for this robot (docs/packets.md, Signatures)
  bool has_key;                           // false: nothing is signed
  uint64_t counter;                       // of the next signature
  struct {
    uint64_t stream;
    uint32_t sequence;
    double when;
  } newest[64];  // when 0: not in use
  struct {
    const char* status;
    unsigned long packets;
  } counts[16];  // accepted packets, and dropped ones by reason
} sf_client;

static double now_s(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void count_status(sf_client* c, const char* status) {
  unsigned i = 0;
  while (i < 15 && c->counts[i].status && strcmp(c->counts[i].status, status) != 0) ++i;
  c->counts[i].status = status;
  ++c->counts[i].packets;
}

// Binds a port, 0: any. Uses loopback only for a farm on this machine. Returns false and sets errno on failure.
static bool open_port(sf_client* c, uint16_t port) {
  if (c->sockets > SF_MAX_SENSORS) return false;
  const bool local = ntohl(c->farm.sin_addr.s_addr) >> 24 == 127;
  struct sockaddr_in own = {.sin_family = AF_INET, .sin_port = htons(port)};
  own.sin_addr.s_addr = htonl(local ? INADDR_LOOPBACK : INADDR_ANY);
  const int opened = socket(AF_INET, SOCK_DGRAM, 0);
  c->polled[c->sockets++] = (struct pollfd){.fd = opened, .events = POLLIN};
  return opened >= 0 && bind(opened, (const struct sockaddr*)&own, sizeof own) == 0;
}

// Opens the socket that sends. @param neighbours also request the states of other robots
bool sf_open(sf_client* c, uint16_t robot, const char* host, const char* port, bool neighbours) {
  memset(c, 0, sizeof *c);
  struct addrinfo wanted = {.ai_family = AF_INET, .ai_socktype = SOCK_DGRAM}, *found = NULL;
  FILE* const random = fopen("/dev/urandom", "rb");
  const bool drawn = random && fread(&c->session, sizeof c->session, 1, random) == 1;
  if (random) fclose(random);
  if (!drawn || getaddrinfo(host, port, &wanted, &found) != 0) return false;
  memcpy(&c->farm, found->ai_addr, sizeof c->farm);
  freeaddrinfo(found);
  c->robot = robot;
  c->session |= 1;  // 0 would mean that there is none
  c->types = neighbours;
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  c->counter = (uint64_t)now.tv_sec * 1000000 + (uint64_t)now.tv_nsec / 1000;
  return open_port(c, 0);
}

// Signs sent packets, and drops packets that the farm did not sign. file: 64 hexadecimal digits. Returns false for any
// other content.
bool sf_read_key(sf_client* c, const char* file) {
  char digits[66] = "";
  FILE* const opened = fopen(file, "r");
  const bool read = opened && fscanf(opened, " %65[0-9a-fA-F]", digits) == 1;
  if (opened) fclose(opened);
  for (unsigned i = 0; i < 32 && read && strlen(digits) == 64; ++i) {
    unsigned byte;
    c->has_key = sscanf(digits + 2 * i, "%2x", &byte) == 1;
    c->key[i] = (uint8_t)byte;
  }
  return c->has_key;
}

// Listens for one sensor, numbered from 0 among the sensors of its type. @param port 0: the farm's default
bool sf_add_sensor(sf_client* c, const sf_type* type, unsigned number, unsigned port) {
  if (port == 0) port = type->port + 8u * c->robot + number;
  if (type->type > 31)
    c->all = true;  // its bit would need a SUBSCRIBE of 72 bytes
  else
    c->types |= 1u << type->type;
  return port <= 65535 && open_port(c, (uint16_t)port);
}

static void send_packet(sf_client* c, sf_packet* p) {
  uint8_t bytes[SF_TAG_BYTES + SF_SIGNATURE];
  p->robot = c->robot;
  p->time_ns = (int64_t)(now_s() * 1e9);
  p->session = c->session;
  p->token = c->token;
  size_t size = sf_encode(p, bytes);
  if (size > 0 && c->has_key) size = sf_sign(bytes, size, c->key, c->counter++);
  const struct sockaddr* const farm = (const struct sockaddr*)&c->farm;
  if (size == 0 || sendto(c->polled[0].fd, bytes, size, 0, farm, sizeof c->farm) < 0) count_status(c, "not sent");
}

// Sends V2V, and SUBSCRIBE twice a second. state: x, y, z [m], yaw [rad] in the world frame, forward, left [m/s], turn
// [rad/s].
void sf_send_state(sf_client* c, const double state[7], uint32_t follows, uint32_t checkpoint, bool docking) {
  if (now_s() >= c->next_request) {
    send_packet(c, &(sf_packet){.type = SF_SUBSCRIBE, .sequence = c->requests++, .words = {c->all ? 0 : c->types}});
    c->next_request = now_s() + 0.5;
  }
  sf_packet packet = {.type = SF_V2V, .sequence = c->states++, .words = {follows, checkpoint, docking}};
  memcpy(packet.values, state, 7 * sizeof *state);
  memcpy(packet.tilt, c->tilt, sizeof packet.tilt);
  send_packet(c, &packet);
}

void sf_leave(sf_client* c) {
  send_packet(c, &(sf_packet){.type = SF_LEAVE});
  for (unsigned i = 0; i < c->sockets; ++i) close(c->polled[i].fd);
}

// Compares sequences, which the parts of one reading share; after two seconds of silence any packet is new.
static bool is_newer(sf_client* c, const sf_packet* p) {
  const uint64_t stream = (uint64_t)p->type << 32 | (uint32_t)p->robot << 16 | p->sensor;
  unsigned at = 0, oldest = 0;
  for (at = 0; at < 64 && (c->newest[at].stream != stream || c->newest[at].when == 0); ++at)
    if (c->newest[at].when < c->newest[oldest].when) oldest = at;
  const uint32_t ahead = at < 64 ? p->sequence - c->newest[at].sequence : 1;
  const bool repeated =
      ahead == 0 && (p->type == SF_LASER_EXTENDED || p->type == SF_LIDAR_EXTENDED ||
                     p->type == SF_CAMERA_EXTENDED || p->type == SF_OCCUPANCY);
  if (at < 64 && now_s() - c->newest[at].when <= 2.0 && !repeated && (ahead == 0 || ahead >= 1u << 31)) return false;
  at = at < 64 ? at : oldest;
  c->newest[at].stream = stream;
  c->newest[at].sequence = p->sequence;
  c->newest[at].when = now_s();
  return true;
}

// The reason why the farm drops packets of this client. Anyone may have sent it, so it is only counted.
static const char* refusal_text(const sf_packet* p) {
  static const char* const kReasons[] = {"refused: not signed", "refused: wrong signature", "refused: clock behind",
                                         "refused: wrong address"};
  return kReasons[p->words[0] - 1];
}

static const char* accept_packet(sf_client* c, const uint8_t* bytes, size_t size, const struct sockaddr_in* from,
                                 sf_window* window, sf_packet* p) {
  if (from->sin_addr.s_addr != c->farm.sin_addr.s_addr || from->sin_port != c->farm.sin_port) return "wrong source";
  const char* const status = sf_decode(bytes, size, p);
  if (status) return status;
  if (p->token == c->session && p->type == SF_REFUSAL) return refusal_text(p);
  if (p->token != c->session || (p->type != SF_CHALLENGE && p->session != c->farm_session)) return "wrong source";
  const char* const forged = c->has_key ? sf_check_signature(window, bytes, size, c->key) : NULL;
  if (forged) return forged;
  if (p->type >= SF_V2V && p->type != SF_START && p->type != SF_CHALLENGE && p->type != SF_NEIGHBOURS &&
      p->type != SF_V2I && p->type != SF_DROPPED)
    return "wrong direction";
  if (p->robot != c->robot && p->type != SF_V2I && (p->type != SF_START || p->robot != 65535)) return "unknown robot";
  if (p->type == SF_CHALLENGE) {
    if (p->session != c->farm_session) memset(c->newest, 0, sizeof c->newest);  // another farm
    c->token = p->words[0];
    c->farm_session = p->session;
    c->next_request = 0;
    return NULL;
  }
  return p->type == SF_START || is_newer(c, p) ? NULL : "stale";
}

// Waits at most `timeout` [s], then passes accepted readings, NEIGHBOURS, V2I, DROPPED and START to `handle`, at most
// 64 from each port.
void sf_receive(sf_client* c, double timeout, void (*handle)(const sf_packet*, void*), void* context) {
  if (poll(c->polled, c->sockets, timeout > 0 ? (int)ceil(1e3 * timeout) : 0) <= 0) return;
  for (unsigned i = 0; i < c->sockets; ++i)
    for (unsigned n = 0; n < 64 && c->polled[i].revents & POLLIN; ++n) {
      static _Thread_local sf_packet packet;
      uint8_t bytes[2048];
      struct sockaddr_in from = {0};
      socklen_t length = sizeof from;
      const ssize_t size =
          recvfrom(c->polled[i].fd, bytes, sizeof bytes, MSG_DONTWAIT, (struct sockaddr*)&from, &length);
      if (size < 0) break;
      const char* const status = accept_packet(c, bytes, (size_t)size, &from, &c->windows[i], &packet);
      count_status(c, status ? status : "accepted");
      if (!status && packet.type != SF_CHALLENGE) handle(&packet, context);
    }
}

#ifndef SENSORFARM_CLIENT_NO_MAIN

static volatile sig_atomic_t stopped;
static void stop(int number) { stopped = number; }

static int fail(const char* text, const char* about) {
  fprintf(stderr, "sensorfarm_client: %s%s\n", text, about);
  return 2;
}

static void print_packet(const sf_packet* packet, void* out) {
  sf_print(out, packet);
  fflush(out);
}

// TYPE[.NUMBER][=PORT]
static bool add_sensor(sf_client* c, const char* word) {
  char name[16] = "";
  unsigned number = 0, port = 0;
  int length = 0, more = 0;
  if (strchr(word, '-') != NULL) return false;  // rejects numbers with a sign
  sscanf(word, "%15[a-z]%n.%5u%n", name, &length, &number, &more);
  word += more > length ? more : length;
  length = 0;
  if (*word == '=') sscanf(word, "=%6u%n", &port, &length);
  for (size_t i = 0; word[length] == 0 && i < sizeof sf_types / sizeof *sf_types; ++i)
    if (sf_types[i].port != 0 && strcmp(sf_types[i].name, name) == 0)
      return sf_add_sensor(c, &sf_types[i], number, port);
  return false;
}

int main(int argc, char** argv) {
  static sf_client c;
  const char *const names[] = {"--robot", "--farm", "--pose", "--rate", "--key"}, *sensors[SF_MAX_SENSORS] = {"laser"};
  const char* values[] = {"", "127.0.0.1:9000", "0,0,0", "10", ""};
  unsigned count = 0, robot = 0;
  bool neighbours = false;
  for (int i = 1; i < argc; ++i) {
    unsigned k = 0;
    while (k < 5 && strcmp(argv[i], names[k]) != 0) ++k;
    const bool is_sensor = strcmp(argv[i], "--sensor") == 0 && count < SF_MAX_SENSORS;
    if (strcmp(argv[i], "--neighbours") == 0)
      neighbours = true;
    else if (i + 1 == argc || (k == 5 && !is_sensor))
      return fail(
          "--robot N [--farm HOST:PORT] [--pose X,Y,DEGREES] [--rate HZ] [--neighbours] [--key FILE] "
          "[--sensor TYPE[.NUMBER][=PORT]]...; not ",
          argv[i]);
    else
      *(is_sensor ? &sensors[count++] : &values[k]) = argv[i + 1], ++i;
  }
  char host[256], port[6], rest;
  double state[7] = {0}, pose[6] = {0}, rate;
  if (sscanf(values[0], "%6u%c", &robot, &rest) != 1 || robot > 65535)
    return fail("--robot takes an id from 0 to 65535, not ", values[0]);
  if (sscanf(values[1], "%255[^:]:%5[0-9]%c", host, port, &rest) != 2)
    return fail("--farm takes HOST:PORT, not ", values[1]);
  const bool planar = sscanf(values[2], "%lf,%lf,%lf%c", pose, pose + 1, pose + 2, &rest) == 3;
  const bool whole = !planar && sscanf(values[2], "%lf,%lf,%lf,%lf,%lf,%lf%c", pose, pose + 1, pose + 2, pose + 3,
                                       pose + 4, pose + 5, &rest) == 6;
  const double yaw = pose[planar ? 2 : 5];
  if ((!planar && !whole) || check_numbers(pose, planar ? 2 : 3, 1e7) || !(fabs(yaw) <= 1e6) ||
      (whole && !(fabs(pose[3]) <= 180 && fabs(pose[4]) <= 90)))
    return fail("--pose takes X,Y,DEGREES or X,Y,Z,ROLL,PITCH,YAW, not ", values[2]);
  if (sscanf(values[3], "%lf%c", &rate, &rest) != 1 || !(rate >= 1 && rate <= 1000))
    return fail("--rate takes 1 to 1000 states per second, not ", values[3]);
  const double degree = acos(-1.0) / 180;
  memcpy(state, pose, (planar ? 2 : 3) * sizeof *pose);
  state[3] = yaw * degree;
  if (!sf_open(&c, (uint16_t)robot, host, port, neighbours)) return fail("no such host: ", host);
  if (values[4][0] && !sf_read_key(&c, values[4]))
    return fail("--key takes a file of 64 hexadecimal digits, not ", values[4]);
  for (unsigned i = 0; i < 2 && whole; ++i) c.tilt[i] = pose[3 + i] * degree;
  for (unsigned i = 0; i == 0 || i < count; ++i)
    if (!add_sensor(&c, sensors[i])) return fail("no such sensor, or its port is taken: ", sensors[i]);

  const struct sigaction action = {.sa_handler = stop};
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  signal(SIGPIPE, SIG_IGN);
  for (double due = now_s(); !stopped && !ferror(stdout);) {
    if (now_s() >= due) {
      sf_send_state(&c, state, SF_NONE, SF_NONE, false);
      due = fmax(due + 1 / rate, now_s());
    }
    sf_receive(&c, due - now_s(), print_packet, stdout);
  }
  sf_leave(&c);
  for (unsigned i = 0; i < 16 && c.counts[i].status; ++i)
    fprintf(stderr, "%s%s %lu", i ? ", " : "", c.counts[i].status, c.counts[i].packets);
  fputs(c.counts[0].status ? "\n" : "nothing received\n", stderr);
  return 0;
}

#endif
