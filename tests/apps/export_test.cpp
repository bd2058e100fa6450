// `export`, `plot` and `view --3d` of a recorded run.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <sstream>

#include "base/files.h"
#include "record/reading_messages.h"
#include "record/recording.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/instrumented.h"
#include "tests/refusal.h"
#include "tests/viz/png.h"
#include "viz/theme.h"

namespace sf {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// Fields of a CSV file without quotes; row 0 is the heading.
Rows rows_of(const std::string& path) {
  Rows rows;
  std::stringstream file(read_file(path));
  for (std::string line; std::getline(file, line);) {
    rows.emplace_back();
    std::stringstream fields(line + ",");
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  return rows;
}

/// Equal to the last bit, as written in the shortest form.
bool same(const std::string& field, double value) {
  return std::isnan(value) ? field.empty() : !field.empty() && std::strtod(field.c_str(), nullptr) == value;
}

/// Two robots among walls, one with a sonar, encoders and GPS, and a traffic light.
constexpr const char* kRecordedWorld = R"(
define block model( size [1 1 1] obstacle_return 1 )
model( name "room" size [8 8 1] boundary 1 obstacle_return 1 )
block( pose [2 2 0 0] )
position( name "one" pose [-2 -2 0 30] laser( samples 31 fov 180 range_max 3 rate 5 ) sonar( scount 2 spose[0] [0.1 0 0] spose[1] [0 0.1 90] ) encoder( ) gps( ) )
position( name "two" pose [1 -2 0 90] )
light( name "lamp" pose [0 3 0 0] phases 2 phase[0] ["green" 2] phase[1] ["red" 2] )
)";

class Recorded : public testing::Test {
 protected:
  void SetUp() override {
    run_successfully({"run", folder_.write("w.world", kRecordedWorld), "--duration", "3", "--record", folder_.path("r"),
                      "--record-readings"});
  }
  Words recorded(const std::string& command, const Words& more) const {
    return with({command, folder_.path("r")}, more);
  }
  record::Recording recording() const { return record::open_recording(folder_.path("r")); }

  Folder folder_;
};

/// Numbers after a header that ends with `end`.
template <class Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// A cloud in the sensor's frame and one in the world have the same echoes.
TEST(ExportClouds, BothFormatsHaveTheEchoes) {
  const Folder folder;
  run_successfully(
      {"run", our_world("lidar.world"), "--duration", "0.3", "--record", folder.path("r"), "--record-readings"});
  for (const char* format : {"pcd", "ply"})
    run_successfully({"export", folder.path("r"), "--clouds", format, "--robots", "rover2", "-o", folder.path(format)});
  const Rows table = rows_of(folder.path("pcd/clouds/clouds.csv"));
  ASSERT_GE(table.size(), 3u);
  EXPECT_EQ(table[1][0], "rover2_lidar_000000.pcd");
  EXPECT_EQ(table[2][1], "0.1");
  const std::string pcd = read_file(folder.path("pcd/clouds/" + table[2][0]));
  const std::string ply = read_file(folder.path("ply/clouds/rover2_lidar_000001.ply"));
  expect_in("\nWIDTH 900\nHEIGHT 16\n", pcd);
  const std::size_t first = pcd.find("DATA binary\n") + 12, points = ply.find("end_header\n") + 11;
  ASSERT_EQ(pcd.size(), first + 14u * 16 * 900);
  double pose[7];
  for (std::size_t k = 0; k < 7; ++k) pose[k] = std::stod(table[2][4 + k]);
  const glm::dmat3 R = glm::mat3_cast(glm::dquat(pose[3], pose[4], pose[5], pose[6]));
  std::size_t echoes = 0;
  for (std::size_t i = 0; i < 16 * 900; ++i) {
    const std::size_t at = first + 14 * i;
    EXPECT_EQ(number_at<std::uint16_t>(pcd, at + 12), i / 900);
    const glm::dvec3 p_S{number_at<float>(pcd, at), number_at<float>(pcd, at + 4), number_at<float>(pcd, at + 8)};
    if (std::isnan(p_S.x)) continue;
    const std::size_t to = points + 26 * echoes++;
    const glm::dvec3 p{number_at<double>(ply, to), number_at<double>(ply, to + 8), number_at<double>(ply, to + 16)};
    ASSERT_LT(glm::length(R * p_S + glm::dvec3(pose[0], pose[1], pose[2]) - p), 1e-5) << i;
  }
  EXPECT_GT(echoes, 5000u);
  EXPECT_EQ(ply.size(), points + 26 * echoes);
  expect_in(fmt::format("element vertex {}\n", echoes), ply);
}

/// Recordings contain the tables of directions: neither another table in its place nor its absence changes the points.
TEST(ExportClouds, HaveTheRecordedTableOfDirections) {
  const Folder folder;
  folder.write("t.csv", "azimuth_deg,elevation_deg\n0,0\n20,5\n");
  const std::string world = "model( pose [5 0 0 0] size [1 9 9] ) position( lidar( directions \"t.csv\" ) )";
  run_successfully(
      {"run", folder.write("w.world", world), "--duration", "0.2", "--record", folder.path("r"), "--record-readings"});
  const auto clouds = [&](const std::string& name) {
    run_successfully({"export", folder.path("r"), "--clouds", "pcd", "-o", folder.path(name)});
    std::string text;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path(name)))
      if (entry.is_regular_file()) text += base::read_text(entry.path().string());
    return text;
  };
  const std::string before = clouds("before");
  EXPECT_GT(before.size(), 50u);
  folder.write("t.csv", "azimuth_deg,elevation_deg\n0,0\n10,5\n");
  EXPECT_EQ(clouds("changed"), before);
  std::filesystem::remove(folder.path("t.csv"));
  EXPECT_EQ(clouds("without"), before);
}

TEST(ExportClouds, SayWhenThereAreNone) {
  const Folder folder;
  run_successfully(
      {"run", our_world("cave.world"), "--robots", "1", "--duration", "0.2", "--record", folder.path("r")});
  const Outcome none = run_successfully({"export", folder.path("r"), "--clouds", "ply", "-o", folder.path("c")});
  expect_in("no clouds: the run was recorded without --record-readings, or these robots have no lidars", none.err);
  expect_in("--vtk", run_program({"export", folder.path("r"), "--clouds", "ply", "--vtk", "-o", folder.path("c")}).err);
}

TEST_F(Recorded, TrajectoriesAreExportedToTheBit) {
  run_successfully(recorded("export", {"-o", folder_.path("csv")}));
  const Rows rows = rows_of(folder_.path("csv/trajectories.csv"));
  const record::Recording expected = recording();
  ASSERT_EQ(rows.size(), 1 + expected.states[0].size() + expected.states[1].size());
  EXPECT_EQ(rows[0][2], "x_m");
  std::size_t row = 1;
  for (std::size_t m = 0; m < 2; ++m)
    for (const record::StateSample& s : expected.states[m]) {
      const std::vector<std::string>& fields = rows[row++];
      ASSERT_EQ(fields.size(), 13u);
      EXPECT_EQ(fields[1], expected.info.movers[m].name);
      EXPECT_TRUE(same(fields[0], 1e-9 * static_cast<double>(s.time)));
      EXPECT_TRUE(same(fields[2], s.X_WM.x) && same(fields[3], s.X_WM.y) && same(fields[5], s.X_WM.yaw));
      EXPECT_TRUE(same(fields[6], s.velocity.forward) && same(fields[11], s.command.turn)) << row;
    }
}

TEST_F(Recorded, ReadingsAreExportedToTheBit) {
  ASSERT_EQ(run_program(recorded("export", {"-o", folder_.path("csv")})).code, 0);
  const record::Recording expected = recording();
  std::size_t checked = 0;
  for (const record::SensorTypeInfo& type : expected.info.sensor_types) {
    const Rows rows = rows_of(folder_.path("csv/" + type.name + ".csv"));
    const std::size_t width = record::element_width(type), before = type.is_scan ? 7 : 6;
    std::size_t row = 1;
    for (const record::ReadingSample& reading : expected.readings) {
      if (reading.type != type.id) continue;
      for (std::size_t i = 0; i < reading.values.size(); ++i) {
        ASSERT_LT(row + i / width, rows.size()) << type.name;
        const std::vector<std::string>& fields = rows[row + i / width];
        ASSERT_EQ(fields.size(), before + width);
        EXPECT_TRUE(same(fields[before + i % width], reading.values[i])) << type.name << " " << row;
        ++checked;
      }
      row += reading.values.size() / width;
    }
    EXPECT_EQ(row, rows.size()) << type.name;
  }
  EXPECT_GT(checked, 15u * 31u + 30u * 4u) << "scans at 5 Hz, encoders at 10 Hz";
}

/// A robot that an event tilts has its angles in the table, and its clouds in the orientation that `sense` prints.
TEST(ExportTilts, AsColumnsAndInClouds) {
  const Folder folder;
  folder.write(
      "w.world",
      "model( name \"room\" size [8 8 2] boundary 1 )\n"
      "position( name \"one\" size [0.3 0.3 0.2] pose [-2 -2 0 30] lidar( channels 4 columns 20 range [0 20] ) )\n");
  const std::string scenario = folder.write("t.toml",
                                            "world = \"w.world\"\nduration = 0.3\n[default]\ncontroller = \"none\"\n"
                                            "[[event]]\nat = 0.1\nobject = \"one\"\npose = [1, 0, 0.5, 10, -20, 40]\n");
  run_successfully({"run", scenario, "--record", folder.path("r"), "--record-readings"});
  run_successfully({"verify", folder.path("r")});
  run_successfully({"export", folder.path("r"), "-o", folder.path("x")});
  run_successfully({"export", folder.path("r"), "--clouds", "pcd", "-o", folder.path("x")});
  const Rows rows = rows_of(folder.path("x/trajectories.csv"));
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0][13] + " " + rows[0].back(), "roll_rad pitch_rad");
  EXPECT_TRUE(same(rows[1][13], 0.0) && same(rows[1][14], 0.0));
  EXPECT_NEAR(std::stod(rows[3][13]), M_PI / 18.0, 1e-15);
  EXPECT_NEAR(std::stod(rows[3][14]), -M_PI / 9.0, 1e-15);
  const Json sensed(
      run_successfully({"sense", folder.path("w.world"), "--type", "lidar", "--pose", "1,0,0.5,10,-20,40", "--json"})
          .out);
  const Rows clouds = rows_of(folder.path("x/clouds/clouds.csv"));
  ASSERT_EQ(clouds.size(), 4u);
  for (const auto& [first, key, count] : {std::tuple{4u, "/sensor_position/", 3u}, {7u, "/sensor_orientation/", 4u}})
    for (unsigned k = 0; k < count; ++k)
      EXPECT_NEAR(std::stod(clouds[3][first + k]), sensed.number(key + std::to_string(k)), 1e-12) << key << k;
}

TEST_F(Recorded, APartIsExported) {
  ASSERT_EQ(
      run_program(recorded("export", {"-o", folder_.path("csv"), "--robots", "one", "--from", "1", "--to", "2"})).code,
      0);
  const Rows rows = rows_of(folder_.path("csv/trajectories.csv"));
  ASSERT_EQ(rows.size(), 1u + 11u) << "from tick to tick, both among them";
  EXPECT_EQ(rows[1][0], "1");
  EXPECT_EQ(rows.back()[0], "2");
  for (std::size_t i = 1; i < rows.size(); ++i) EXPECT_EQ(rows[i][1], "one");
  for (const std::vector<std::string>& row : rows_of(folder_.path("csv/encoder.csv")))
    EXPECT_TRUE(row[0] == "time_s" || (std::stod(row[0]) >= 1.0 && std::stod(row[0]) <= 2.0)) << row[0];
}

TEST_F(Recorded, LightsAreExported) {
  ASSERT_EQ(run_program(recorded("export", {"-o", folder_.path("csv")})).code, 0);
  const Rows rows = rows_of(folder_.path("csv/lights.csv"));
  ASSERT_EQ(rows.size(), 31u);
  EXPECT_EQ(rows[1][1], "lamp");
  EXPECT_TRUE(rows[1][2] == "red" || rows[1][2] == "green") << rows[1][2];
  const record::Recording expected = recording();
  ASSERT_EQ(expected.lights.size(), 30u);
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_TRUE(same(rows[i + 1][0], 1e-9 * static_cast<double>(expected.lights[i].time))) << i;
    EXPECT_TRUE(same(rows[i + 1][3], expected.lights[i].lights[0].left)) << i;
  }
}

TEST_F(Recorded, EverySensorTypeAndTheLightsArePlotted) {
  run_successfully(recorded("plot", {"-o", folder_.path("p"), "--csv"}));
  for (const char* name : {"sonar", "encoder", "gps", "lights"})
    EXPECT_GT(count_lines(read_file(folder_.path(std::string("p/") + name + ".csv"))), 2u) << name;
  scenes::expect_painted(folder_.path("p/lights.png"), {{viz::theme::kLightGreen, 30}, {viz::theme::kLightRed, 30}});
  for (const char* name : {"sonar", "gps"})
    scenes::expect_painted(folder_.path(std::string("p/") + name + ".png"), {{viz::theme::kFrame, 500}});
  scenes::expect_painted(folder_.path("p/encoder.png"), {{viz::theme::kBlue, 500}});
  EXPECT_TRUE(std::filesystem::exists(folder_.path("p/trajectories.csv")));
  const Rows curve = rows_of(folder_.path("p/encoder.csv"));
  EXPECT_EQ(curve[0], (std::vector<std::string>{"panel", "curve", "time_s", "value"}));
  EXPECT_EQ(curve[1][0], "left [m]");
  EXPECT_EQ(curve[1][1], "one");
}

TEST_F(Recorded, PlotsAreSvgOrPdfOnDemand) {
  ASSERT_EQ(
      run_program(recorded("plot", {"-o", folder_.path("p"), "--format", "svg", "--size", "85", "--robots", "one"}))
          .code,
      0);
  const std::string svg = read_file(folder_.path("p/trajectories.svg"));
  EXPECT_NE(svg.find(">one</text>"), std::string::npos);
  EXPECT_EQ(svg.find(">two</text>"), std::string::npos) << "not selected";
  EXPECT_FALSE(std::filesystem::exists(folder_.path("p/trajectories.png")));
  ASSERT_EQ(run_program(recorded("plot", {"-o", folder_.path("p"), "--format", "pdf", "--no-title"})).code, 0);
  for (const char* name : {"trajectories", "occupancy", "gps", "lights"})
    EXPECT_TRUE(read_file(folder_.path(std::string("p/") + name + ".pdf")).starts_with("%PDF-")) << name;
  ASSERT_EQ(run_program(recorded("plot", {"-o", folder_.path("n"), "--format", "svg", "--no-title"})).code, 0);
  EXPECT_EQ(read_file(folder_.path("n/trajectories.svg")).find(">Trajectories<"), std::string::npos);
}

TEST_F(Recorded, APlotStatesTheDurationOfItsPart) {
  for (const auto& [from, to, message] : {std::tuple{"0", "10", "2 robots, 2.9 s, "}, {"1", "2", "2 robots, 1 s, "}}) {
    ASSERT_EQ(
        run_program(recorded("plot", {"-o", folder_.path("p"), "--format", "svg", "--from", from, "--to", to})).code,
        0);
    EXPECT_NE(read_file(folder_.path("p/trajectories.svg")).find(message), std::string::npos) << message;
  }
}

TEST_F(Recorded, WithoutALaserThereIsNoMap) {
  const Outcome outcome = run_successfully(recorded("plot", {"-o", folder_.path("p"), "--robots", "two"}));
  expect_in("no occupancy.png: none of these robots has a laser", outcome.err);
  EXPECT_FALSE(std::filesystem::exists(folder_.path("p/occupancy.png")));
}

TEST_F(Recorded, MissingPartsAreRejected) {
  const std::string out = folder_.path("x");
  expect_refused(recorded("plot", {"-o", out, "--robots", "one,three"}), "has no robot 'three'; it has one, two");
  expect_refused(recorded("export", {"-o", out, "--from", "5"}), "has no tick from 5 s on; it covers 0 to 2.9 s");
  expect_refused(recorded("export", {"-o", out, "--from", "2", "--to", "1"}),
                 "has no tick from 2 s to 1 s");  // reversed
  expect_refused(recorded("export", {}), "--out");
  expect_refused(recorded("export", {"-o", out, "--every", "0"}), "--every");
  expect_refused(recorded("plot", {"-o", out, "--format", "eps"}), "expected png, svg or pdf");
  expect_refused({"export", folder_.path("none"), "-o", out}, "no such recording");
  EXPECT_FALSE(std::filesystem::exists(out));
  expect_refused(recorded("export", {"-o", "/proc/none"}), "/proc/none");
}

TEST_F(Recorded, ParaViewGetsSeries) {
  run_successfully(recorded("export", {"--vtk", "-o", folder_.path("v"), "--every", "1"}));
  for (const char* name : {"walls.vtp", "trajectories.vtp", "occupancy.vti"})
    EXPECT_TRUE(read_file(folder_.path(std::string("v/") + name)).starts_with("<?xml")) << name;
  EXPECT_FALSE(std::filesystem::exists(folder_.path("v/field.vti"))) << "no magnets";
  for (const std::string name : {"robots", "scans"}) {
    const std::string series = read_file(folder_.path("v/" + name + ".pvd"));
    for (const char* time : {"0", "1", "2"}) expect_in("timestep=\"" + std::string(time) + "\"", series);
    expect_in("file=\"" + name + "/" + name + "_000002.vtp\"", series);
    EXPECT_TRUE(std::filesystem::exists(folder_.path("v/" + name + "/" + name + "_000002.vtp")));
    EXPECT_FALSE(std::filesystem::exists(folder_.path("v/" + name + "/" + name + "_000003.vtp")));
  }
  const Outcome shorter = run_successfully(recorded("export", {"--vtk", "-o", folder_.path("v"), "--every", "2"}));
  expect_in("removed 3 files of an earlier call (robots_NNNNNN.vtp)", shorter.err);
  for (const std::string name : {"robots", "scans"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_.path("v/" + name + "/" + name + "_000001.vtp")));
    EXPECT_FALSE(std::filesystem::exists(folder_.path("v/" + name + "/" + name + "_000002.vtp")))
        << "of the longer one";
  }
}

/// Returns an attribute in the head of a VTK file, of an array or of the whole: `key="VALUE"` after `after`.
std::string vtk_head(const std::string& file, const std::string& after, const std::string& key) {
  const std::string text = read_file(file);
  const std::size_t at = text.find(key + "=\"", text.find(after)) + key.size() + 2;
  return text.substr(at, text.find('"', at) - at);
}

std::string from_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char letter : text) {
    if (letter == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(letters.find(letter));
    if ((count += 6) >= 8) bytes.push_back(static_cast<char>(bits >> (count -= 8)));
  }
  return bytes;
}

/// Returns the numbers of the first array of a VTK image: zlib blocks after the list of their sizes, both in base64.
std::vector<double> vtk_numbers(const std::string& file) {
  const std::string text = read_file(file);
  const std::size_t begin = text.find('_', text.find("<AppendedData")) + 1;
  const auto words = [&](std::size_t count) {
    std::vector<std::uint32_t> all(count);
    std::memcpy(all.data(), from_base64(text.substr(begin, (4 * count + 2) / 3 * 4)).data(), 4 * count);
    return all;
  };
  const std::size_t blocks = words(3)[0];
  const std::vector<std::uint32_t> sizes = words(3 + blocks);
  std::size_t all = 0;
  for (std::size_t i = 3; i < sizes.size(); ++i) all += sizes[i];
  const std::string packed = from_base64(text.substr(begin + (4 * sizes.size() + 2) / 3 * 4, (all + 2) / 3 * 4));
  std::string bytes;
  for (std::size_t i = 0, at = 0; i < blocks; at += sizes[3 + i++]) {
    std::string block(sizes[1], '\0');
    uLongf size = block.size();
    EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(block.data()), &size,
                         reinterpret_cast<const Bytef*>(packed.data() + at), sizes[3 + i]),
              Z_OK);
    bytes += block.substr(0, size);
  }
  std::vector<double> numbers(bytes.size() / sizeof(double));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(double));
  return numbers;
}

/// Returns the centres of the cells of a VTK image, in the order of their numbers: row by row from the lower left.
std::vector<glm::dvec2> vtk_middles(const std::string& file) {
  double left = 0.0, bottom = 0.0, cell = 0.0;
  EXPECT_EQ(std::sscanf(vtk_head(file, "<ImageData", "Origin").c_str(), "%lf %lf", &left, &bottom), 2);
  EXPECT_EQ(std::sscanf(vtk_head(file, "<ImageData", "Spacing").c_str(), "%lf", &cell), 1);
  int columns = 0, rows = 0;
  EXPECT_EQ(std::sscanf(vtk_head(file, "<ImageData", "WholeExtent").c_str(), "0 %d 0 %d", &columns, &rows), 2);
  std::vector<glm::dvec2> middles;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      middles.emplace_back(left + (column + 0.5) * cell, bottom + (row + 0.5) * cell);
  return middles;
}

/// The known cells are within the 3 m range of the robot in the lower left quarter; the occupied ones belong to the
/// wall below it.
TEST_F(Recorded, ParaViewsMapBeginsAtTheLowerLeft) {
  ASSERT_EQ(run_program(recorded("export", {"--vtk", "-o", folder_.path("v")})).code, 0);
  const std::vector<double> cells = vtk_numbers(folder_.path("v/occupancy.vti"));
  const std::vector<glm::dvec2> middles = vtk_middles(folder_.path("v/occupancy.vti"));
  ASSERT_EQ(cells.size(), middles.size());
  const auto poses = recording().states[0];
  int occupied = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] == 0.0) continue;
    const glm::dvec2& p = middles[i];
    double nearest = INFINITY;
    for (const record::StateSample& s : poses) nearest = std::min(nearest, std::hypot(s.X_WM.x - p.x, s.X_WM.y - p.y));
    ASSERT_LT(nearest, 3.05) << p.x << " " << p.y;
    if (cells[i] != 1.0) continue;
    EXPECT_LT(p.y, -3.95) << p.x;
    ++occupied;
  }
  EXPECT_GT(occupied, 0);
}

TEST_F(Recorded, ParaViewGetsTheRequestedPart) {
  const std::string out = folder_.path("v"), ways = out + "/trajectories.vtp", map = out + "/occupancy.vti";
  run_successfully(
      recorded("export", {"--vtk", "-o", out, "--robots", "one", "--from", "1", "--to", "2", "--every", "0.5"}));
  EXPECT_EQ(vtk_head(ways, "<Piece", "NumberOfLines"), "1");
  EXPECT_EQ(vtk_head(ways, "<Piece", "NumberOfPoints"), "11") << "from tick to tick, both among them";
  EXPECT_EQ(vtk_head(ways, "\"time\"", "RangeMin"), "1");
  EXPECT_EQ(vtk_head(ways, "\"time\"", "RangeMax"), "2");
  EXPECT_EQ(vtk_head(ways, "\"robot\"", "RangeMax"), "0") << "the first";
  const auto states = recording().states[0];
  double fastest = 0.0;
  for (std::size_t tick = 10; tick <= 20; ++tick) {
    fastest = std::max(fastest, std::hypot(states[tick].velocity.forward, states[tick].velocity.left));
    ASSERT_FALSE(states[tick].contact);
  }
  EXPECT_NEAR(std::stod(vtk_head(ways, "\"speed\"", "RangeMax")), fastest, 1e-9);
  EXPECT_EQ(vtk_head(ways, "\"contact\"", "RangeMax"), "0");
  for (const char* series : {"/robots.pvd", "/scans.pvd"})
    for (const char* time : {"1", "1.5", "2"})
      expect_in("timestep=\"" + std::string(time) + "\"", read_file(out + series));
  EXPECT_EQ(vtk_head(out + "/scans/scans_000000.vtp", "\"robot\"", "RangeMax"), "0") << "two has no laser";
  EXPECT_FALSE(std::filesystem::exists(out + "/roads.vtp")) << "no roads";

  // The room from -4 to 4 m, in cells of 3 cm that begin at its upper left corner.
  double left = 0.0, bottom = 0.0;
  ASSERT_EQ(std::sscanf(vtk_head(map, "<ImageData", "Origin").c_str(), "%lf %lf", &left, &bottom), 2);
  EXPECT_EQ(left, -4.0);
  int columns = 0, rows = 0;
  ASSERT_EQ(std::sscanf(vtk_head(map, "<ImageData", "WholeExtent").c_str(), "0 %d 0 %d", &columns, &rows), 2);
  EXPECT_NEAR(bottom + 0.03 * rows, 4.0, 1e-9);
  EXPECT_EQ(vtk_head(map, "\"state\"", "RangeMax"), "2") << "free cells";
  EXPECT_EQ(run_program(recorded("export", {"--vtk", "-o", folder_.path("w"), "--robots", "two"})).code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_.path("w/scans.pvd"))) << "none of these has a laser";
}

/// At each time the newest scan of every chosen lidar: those of --clouds ply, point by point.
TEST(ExportClouds, ParaViewGetsTheNewestScans) {
  const Folder folder;
  run_successfully(
      {"run", our_world("lidar.world"), "--duration", "0.6", "--record", folder.path("r"), "--record-readings"});
  const Words part{"--robots", "rover2", "-o", folder.path("v")};
  run_successfully(with({"export", folder.path("r"), "--vtk", "--every", "0.2"}, part));
  run_successfully(with({"export", folder.path("r"), "--clouds", "ply"}, part));
  expect_in("file=\"clouds/clouds_000002.vtp\"", read_file(folder.path("v/clouds.pvd")));
  const std::string vtp = folder.path("v/clouds/clouds_000002.vtp");
  std::string newest;
  for (const auto& row : rows_of(folder.path("v/clouds/clouds.csv")))
    if (row[2] == "rover2" && std::stod(row[1]) <= 0.4 + 1e-9) newest = row[0];
  expect_in("element vertex " + vtk_head(vtp, "<Piece", "NumberOfPoints") + "\n",
            read_file(folder.path("v/clouds/" + newest)));
  EXPECT_EQ(vtk_head(vtp, "\"ring\"", "RangeMax"), "15");
  EXPECT_EQ(vtk_head(vtp, "\"time\"", "RangeMin"), vtk_head(vtp, "\"time\"", "RangeMax"));

  run_successfully({"run", our_world("lidar.world"), "--duration", "0.2", "--record", folder.path("without")});
  const Outcome none = run_successfully({"export", folder.path("without"), "--vtk", "-o", folder.path("w")});
  expect_in("no clouds of lidars: the run was recorded without --record-readings", none.err);
}

/// Scans of a tilted robot, and of a rolling laser on the way, are replayed as they were recorded, from the middle of a
/// run, too.
TEST(Export, ReplayedScansAreTheRecordedOnes) {
  const Folder folder;
  folder.write(
      "w.world",
      "interval_sim 100\ndefine rover position( size [0.6 0.4 0.3] velocity_bounds [-5 5 -5 5 0 0 -200 200] )\n"
      "model( size [0.2 30 3] pose [9 0 0 0] )\nmodel( size [0.2 30 3] pose [-9 0 0 0] )\n"
      "rover( name \"r1\" laser( samples 31 fov 360 range_max 12 ) )\n"
      "rover( name \"r2\" pose [0 5 0 60] laser( samples 31 fov 300 range_max 12 latency 0.15 rolling 1 ) )\n");
  const std::string scenario =
      folder.write("s.toml",
                   "world = \"w.world\"\nduration = 1\n[default]\ncontroller = \"wander\"\n[[robot]]\nname = \"r1\"\n"
                   "controller = \"none\"\npose = [0, 0, 1.5, 20, -30, 63]\n");
  run_successfully({"run", scenario, "--record", folder.path("r"), "--record-readings"});
  run_successfully({"export", folder.path("r"), "-o", folder.path("c")});
  const Rows table = rows_of(folder.path("c/laser.csv"));
  for (const std::string robot : {"r1", "r2"}) {
    const std::string out = folder.path(robot);
    run_successfully(
        {"export", folder.path("r"), "--vtk", "--robots", robot, "--from", "0.5", "--every", "0.1", "-o", out});
    for (int tick = 0; tick < 3; ++tick) {  // later ones were not delivered
      const std::string scan = fmt::format("{}/scans/scans_{:06}.vtp", out, tick);
      double low = INFINITY, high = 0.0;
      for (const auto& row : table) {
        if (row[2] != robot || std::abs(std::stod(row[0]) - 0.1 * (tick + 5)) > 1e-6) continue;
        low = std::min(low, std::stod(row[7])), high = std::max(high, std::stod(row[7]));
      }
      EXPECT_NEAR(std::stod(vtk_head(scan, "\"range\"", "RangeMin")), low, 1e-5) << robot << tick;
      EXPECT_NEAR(std::stod(vtk_head(scan, "\"range\"", "RangeMax")), high, 1e-5) << robot << tick;
      EXPECT_NEAR(std::stod(vtk_head(scan, "\"time\"", "RangeMin")), 0.1 * (tick + 5), 1e-9);
    }
  }
}

/// Tags are not robots. A field needs no laser, and is at the requested height.
TEST(Export, TagsHaveNoTrajectoriesAndMagnetsHaveAField) {
  const Folder folder;
  const std::string world = folder.write(
      "w.world",
      "position( name \"one\" size [0.3 0.3 0.1] )\nmodel( name \"tag1\" pose [1 0 0 0] size [0.3 0.3 0.5] )\n"
      "model( pose [0 1 -0.1 0] size [0.025 0.025 0.1] magnetic_moment 10000 magnetometer_return 1 )\n");
  ASSERT_EQ(run_program({"run", world, "--duration", "1", "--record", folder.path("r")}).code, 0);
  const Outcome vtk =
      run_successfully({"export", folder.path("r"), "--vtk", "-o", folder.path("v"), "--height", "0.25"});
  EXPECT_EQ(vtk_head(folder.path("v/trajectories.vtp"), "<Piece", "NumberOfLines"), "1");
  EXPECT_FALSE(std::filesystem::exists(folder.path("v/occupancy.vti")));
  const std::string origin = vtk_head(folder.path("v/field.vti"), "<ImageData", "Origin");
  EXPECT_EQ(origin.substr(origin.rfind(' ')), " 0.25");
  const std::vector<double> magnitudes = vtk_numbers(folder.path("v/field.vti"));
  const std::vector<glm::dvec2> middles = vtk_middles(folder.path("v/field.vti"));
  ASSERT_EQ(magnitudes.size(), middles.size());
  const auto most = std::max_element(magnitudes.begin(), magnitudes.end()) - magnitudes.begin();
  EXPECT_LT(length(middles[static_cast<std::size_t>(most)] - glm::dvec2{0.0, 1.0}), 0.02) << "above the magnet";
  EXPECT_EQ(vtk.err.find("no readings"), std::string::npos) << vtk.err;

  const Outcome csv = run_successfully({"export", folder.path("r"), "-o", folder.path("c")});
  expect_in("no readings: the run was recorded without --record-readings", csv.err);
  EXPECT_FALSE(std::filesystem::exists(folder.path("c/lights.csv"))) << "no lights";
}

/// Cells are a 400th of the longer side but at least 1 mm, and cover the world.
TEST(Export, CellsOfAFieldAreAtLeastAMillimetre) {
  const Folder folder;
  for (const auto& [size, cell] : {std::pair{"0.1", 1e-3}, {"0.4", 1e-3}, {"0.8", 2e-3}, {"0.6", 1.5e-3}}) {
    const std::string world = folder.write(
        "w.world",
        fmt::format("position( name \"one\" size [0.01 0.01 0.1] )\n"
                    "model( name \"floor\" size [{0} {0} 0.01] boundary 1 )\n"
                    "model( pose [0 0 -0.1 0] size [0.01 0.01 0.1] magnetic_moment 10 magnetometer_return 1 )\n",
                    size));
    ASSERT_EQ(run_program({"run", world, "--duration", "0.2", "--record", folder.path(size)}).code, 0);
    const std::string out = folder.path(std::string("v") + size);
    ASSERT_EQ(run_program({"export", folder.path(size), "--vtk", "-o", out, "--height", "0.1"}).code, 0);
    const std::vector<glm::dvec2> middles = vtk_middles(out + "/field.vti");
    ASSERT_GT(middles.size(), 1u);
    EXPECT_NEAR(middles[1].x - middles[0].x, cell, 1e-9) << size;
    const double half = 0.5 * std::atof(size);
    EXPECT_GE(middles.back().x, half - 1e-9) << size;
    EXPECT_LT(middles.back().x, half + 2.0 * cell) << size;
  }
}

/// An X server without a screen, on a separate display.
class VirtualDisplay {
 public:
  VirtualDisplay() : server_({"-displayfd", "2", "-screen", "0", "1300x900x24"}, {}, "", "", "Xvfb") {
    if (server_.prints("\n")) name_ = ":" + std::to_string(std::atoi(server_.err().c_str()));
  }
  Environment environment() const { return {{"DISPLAY", name_}}; }

 private:
  Program server_;
  std::string name_;
};

TEST_F(Recorded, WithoutADisplayTheWindowFails) {
  expect_refused(recorded("view", {"--3d"}), "no display");
  const Outcome outcome = run_program(recorded("view", {"--3d"}), {{"DISPLAY", ":64999"}});
  EXPECT_EQ(outcome.code, 2) << "a display that is not there";
  expect_refused(recorded("view", {"--from", "1"}), "--3d");
}

TEST_F(Recorded, TheWindowShowsTheRun) {
  if (!succeeds("command -v Xvfb")) GTEST_SKIP() << "no Xvfb on this machine (Debian: xvfb)";
  if (instrumented()) GTEST_SKIP() << "the driver's own leaks would be reported";
  const VirtualDisplay display;
  const auto shown_at = [&](const std::string& time) {
    run_successfully(recorded("view", {"--3d", "--screenshot", folder_.path("s.png"), "--time", time}),
                     display.environment());
    return scenes::read_png(folder_.path("s.png"));
  };
  const scenes::Picture begin = shown_at("0"), end = shown_at("2.9");
  EXPECT_EQ(begin.width, 1280);
  int changed = 0, red = 0;
  for (int y = 0; y < begin.height; ++y)
    for (int x = 0; x < begin.width; ++x) {
      changed += begin.at(x, y) != end.at(x, y);
      const std::uint32_t c = begin.at(x, y);
      red += (c >> 16 & 0xFF) > 90 && (c >> 8 & 0xFF) < 60 && (c & 0xFF) < 60;
    }
  EXPECT_GT(changed, 500) << "robots, beams and the slider have moved";
  EXPECT_LT(changed, begin.width * begin.height / 2) << "walls stand still";
  EXPECT_GT(red, 500) << "Stage's default colour, of walls and bodies";
}

/// Opens the window and closes it from the terminal, as a user would.
TEST_F(Recorded, TheWindowClosesOnDemand) {
  if (!succeeds("command -v Xvfb")) GTEST_SKIP() << "no Xvfb on this machine (Debian: xvfb)";
  if (instrumented()) GTEST_SKIP() << "the driver's own leaks would be reported";
  const VirtualDisplay display;
  Program window(recorded("view", {"--3d"}), display.environment());
  ASSERT_TRUE(window.prints("the slider chooses the time")) << window.err();
  EXPECT_EQ(window.stop(SIGTERM).code, 0) << window.err();
}

}  // namespace
}  // namespace sf
