// Files for ParaView, read with VTK's own readers.

#include "viz/vtk_files.h"

#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLPolyDataReader.h>

#include <cmath>
#include <set>

#include "sensors/laser.h"
#include "tests/refusal.h"
#include "tests/viz/png.h"
#include "tests/viz/scenes.h"
#include "viz/world_geometry.h"
#include "world/stage/build_world.h"

namespace sf::viz {
namespace {

vtkNew<vtkXMLPolyDataReader> read_poly_data(const std::string& path) {
  vtkNew<vtkXMLPolyDataReader> reader;
  EXPECT_TRUE(reader->CanReadFile(path.c_str())) << path;
  reader->SetFileName(path.c_str());
  reader->Update();
  return reader;
}

double number(vtkFieldData* data, const char* name, vtkIdType row, int part = 0) {
  vtkDataArray* array = data->GetArray(name);
  return array == nullptr ? NAN : array->GetComponent(row, part);
}

TEST(VtkFiles, WallsAreUprightRectangles) {
  world::World world;
  const std::uint32_t block = scenes::add_model(world, "block", 0xFF102030u);
  scenes::add_box(world, 1.0, 2.0, 3.0, 4.0, block);
  world.walls[1].seen_by_laser = false;
  world.walls[2].stops_robots = false;
  world.walls[3].z_min = 0.25;
  for (world::Segment& wall : world.walls) wall.solid_left = false;
  write_poly_data(walls_geometry(world), scenes::own_file("walls.vtp"));
  const auto reader = read_poly_data(scenes::own_file("walls.vtp"));
  vtkPolyData* walls = reader->GetOutput();
  ASSERT_EQ(walls->GetNumberOfPolys(), 4);
  ASSERT_EQ(walls->GetNumberOfPoints(), 16);
  for (vtkIdType k = 0; k < 4; ++k) {
    const world::Segment& wall = world.walls[static_cast<std::size_t>(k)];
    double p[3];
    walls->GetPoint(4 * k, p);
    EXPECT_EQ(glm::dvec3(p[0], p[1], p[2]), glm::dvec3(wall.a.x, wall.a.y, wall.z_min));
    walls->GetPoint(4 * k + 2, p);
    EXPECT_EQ(glm::dvec3(p[0], p[1], p[2]), glm::dvec3(wall.b.x, wall.b.y, wall.z_max));
    EXPECT_EQ(number(walls->GetCellData(), "rgb", k, 1), 0x20);
    EXPECT_EQ(number(walls->GetCellData(), "laser", k), k == 1 ? 0.0 : 1.0);
    EXPECT_EQ(number(walls->GetCellData(), "robots", k), k == 2 ? 0.0 : 1.0);
    EXPECT_EQ(number(walls->GetCellData(), "height", k), k == 3 ? 0.75 : 1.0);
    EXPECT_EQ(number(walls->GetCellData(), "model", k), block);
  }
  auto* names = vtkStringArray::SafeDownCast(walls->GetCellData()->GetAbstractArray("name"));
  ASSERT_NE(names, nullptr);
  EXPECT_EQ(names->GetValue(3), "block");
}

/// A robot that left and returned has two lines; every sample keeps its numbers to the bit.
TEST(VtkFiles, TrajectoriesKeepTimeAndSpeed) {
  world::World world;
  world.movers.push_back(scenes::make_robot(world, 1, {}, 0xFF0000FFu, 5.0));
  std::vector<std::vector<MotionSample>> motions(1);
  for (int i = 0; i < 5; ++i)
    motions[0].push_back({0.1 * i, {0.3 * i, -0.7 * i, 0.0, 0.01 * i}, 1.0 / 3.0 + i, i == 4});
  motions[0][2].X_WM.x = motions[0][2].X_WM.y = NAN;
  ASSERT_TRUE(base::is_absent(motions[0][2].X_WM));
  write_poly_data(trajectories_geometry(world, motions), scenes::own_file("t.vtp"));
  const auto reader = read_poly_data(scenes::own_file("t.vtp"));
  vtkPolyData* data = reader->GetOutput();
  EXPECT_EQ(data->GetNumberOfLines(), 2);
  ASSERT_EQ(data->GetNumberOfPoints(), 4);
  int row = 0;
  for (const int i : {0, 1, 3, 4}) {
    const MotionSample& s = motions[0][static_cast<std::size_t>(i)];
    EXPECT_EQ(data->GetPoint(row)[0], s.X_WM.x);
    EXPECT_EQ(number(data->GetPointData(), "time", row), s.time);
    EXPECT_EQ(number(data->GetPointData(), "speed", row), s.speed);
    EXPECT_EQ(number(data->GetPointData(), "yaw", row), s.X_WM.yaw);
    EXPECT_EQ(number(data->GetPointData(), "contact", row), s.contact ? 1.0 : 0.0);
    ++row;
  }
}

/// Three beams of a laser at the origin of a robot turned by 90 degrees: the middle one looks along +y.
TEST(VtkFiles, ScanDotsAreAtBeamEnds) {
  world::World world;
  world.movers.push_back(scenes::make_robot(world, 1, {}, 0xFF0000FFu, 5.0));
  sensors::LaserSettings laser = sensors::lasers_of(world.movers[0])[0];
  laser.samples = 3;
  world.movers[0].sensors = {sensors::laser_sensor(laser)};
  const double ranges[] = {1.0, 2.0, 5.0};
  const std::uint32_t hits[] = {0, 7, base::kNoHit};
  const base::QualityFlag quality[] = {base::QualityFlag::none, base::QualityFlag::grazing, base::QualityFlag::none};
  base::ReadingBlock scan;
  scan.X_WM = {1.0, 1.0, 0.2, M_PI / 2};
  scan.values = ranges;
  scan.hits = hits;
  scan.quality = quality;
  scan.bound = 0.25;
  scan.time = 1'500'000'000;
  ScanGeometry dots(false), beams(true);
  const sensors::SensorSpec spec = sensors::laser_type.parse(world).rows.at(0);
  const base::RigidTransform X_MS = mount_of(laser);
  dots.add(spec, X_MS, scan);
  beams.add(spec, X_MS, scan);
  write_poly_data(dots.data(), scenes::own_file("dots.vtp"));
  write_poly_data(beams.data(), scenes::own_file("beams.vtp"));
  const auto reader = read_poly_data(scenes::own_file("dots.vtp"));
  vtkPolyData* data = reader->GetOutput();
  EXPECT_EQ(data->GetNumberOfVerts(), 3);
  ASSERT_EQ(data->GetNumberOfPoints(), 3);
  EXPECT_NEAR(data->GetPoint(1)[0], 1.0, 1e-12);
  EXPECT_NEAR(data->GetPoint(1)[1], 3.0 + laser.X_MS.x, 1e-12);
  EXPECT_EQ(data->GetPoint(1)[2], 0.2 + laser.X_MS.z);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(number(data->GetPointData(), "range", i), ranges[i]);
  EXPECT_EQ(number(data->GetPointData(), "hit", 1), 7.0);
  EXPECT_EQ(number(data->GetPointData(), "hit", 2), -1.0) << "no echo";
  EXPECT_EQ(number(data->GetPointData(), "bound", 0), 0.25);
  EXPECT_EQ(number(data->GetPointData(), "bound", 1), HUGE_VAL) << "grazing: its bound does not hold";
  EXPECT_EQ(number(data->GetPointData(), "time", 2), 1.5);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(number(data->GetPointData(), "bearing", i), (i - 1) * 0.5 * laser.fov) << i;
  const auto other = read_poly_data(scenes::own_file("beams.vtp"));
  EXPECT_EQ(other->GetOutput()->GetNumberOfLines(), 3);
  EXPECT_EQ(other->GetOutput()->GetNumberOfPoints(), 6);
  // Nose down by 30 degrees, the middle beam of 2 m ends 1 m below the sensor.
  scan.tilt.pitch = M_PI / 6;
  ScanGeometry tilted(true);
  tilted.add(spec, X_MS, scan);
  const glm::dvec3 way = tilted.data().points[3] - tilted.data().points[2];
  EXPECT_LT(glm::length(way - glm::dvec3(0.0, 2.0 * std::cos(M_PI / 6), -1.0)), 1e-12);
}

/// A light of three lamps that faces along y, and one of a single lamp.
TEST(VtkFiles, LightsShowTheirStates) {
  const world::World world =
      world::build_world("lights.world",
                         "light( name \"a\" pose [2 3 0 90] size [0.2 0.1 1] lamps 3 phases 1 phase[0] [\"red\" 1] )\n"
                         "light( name \"b\" pose [5 3 0 0] size [0.2 0.1 1] lamps 1 phases 1 phase[0] [\"red\" 1] )\n");
  using enum world::LightState;
  const PolyData data = lights_geometry(world, std::vector{red, flashing_yellow});
  ASSERT_EQ(data.polygons.size(), 4u) << "an indicator and a lamp each";
  const auto corner = [&](std::size_t polygon, std::size_t i) { return data.points[data.polygons[polygon][i]]; };
  EXPECT_NEAR(corner(0, 2).z, 1.001, 1e-9) << "above its head";
  EXPECT_NEAR(corner(0, 2).x, 2.0 - 0.05, 1e-9);
  EXPECT_NEAR(corner(0, 2).y, 3.0 + 0.1, 1e-9);
  EXPECT_NEAR(corner(1, 0).y, 3.0 + 0.101, 1e-9) << "in front of its head";
  EXPECT_NEAR(corner(1, 0).z, 0.6 + 0.4 * 2.0 / 3.0, 1e-9) << "the upper third";
  EXPECT_NEAR(corner(1, 2).z, 1.0, 1e-9);
  EXPECT_NEAR(corner(2, 2).x, 5.0 + 0.05, 1e-9) << "half as large while it flashes";
  EXPECT_NEAR(corner(3, 0).z, 0.85, 1e-9) << "the only lamp";
  const std::vector<double>& rgb = data.cell_data[1].values;
  EXPECT_GT(rgb[0], 2.0 * rgb[1]) << "red";
  EXPECT_GT(rgb[7], 2.0 * rgb[8]) << "yellow";
  EXPECT_EQ(data.names[3], "b");
  const PolyData green_one = lights_geometry(world, std::vector{green});
  EXPECT_NEAR(green_one.points[green_one.polygons[1][0]].z, 0.6, 1e-9);
  EXPECT_EQ(green_one.polygons.size(), 2u);
}

/// Area [m^2] of the flat polygons of `data` at a height.
double area_at(const PolyData& data, double z) {
  double area = 0.0;
  for (const auto& polygon : data.polygons) {
    const auto at = [&](std::size_t k) { return data.points[static_cast<std::size_t>(polygon[k % polygon.size()])]; };
    double twice = 0.0;
    for (std::size_t k = 0; k < polygon.size(); ++k) twice += base::cross(glm::dvec2(at(k)), glm::dvec2(at(k + 1)));
    bool flat = true;
    for (std::size_t k = 0; k < polygon.size(); ++k) flat = flat && std::abs(at(k).z - z) < 1e-12;
    area += flat ? 0.5 * std::abs(twice) : 0.0;
  }
  return area;
}

/// A box 2 by 2 m with a courtyard of 1 m: the top leaves the court open; its bottom is on the floor. Raised, it has
/// a bottom.
TEST(VtkFiles, BoxesHaveATop) {
  for (const double z : {0.0, 0.5}) {
    world::World world;
    const std::uint32_t block = scenes::add_model(world, "block", 0xFF102030u);
    scenes::add_box(world, 1.0, 2.0, 3.0, 4.0, block);
    const glm::dvec2 court[] = {{1.5, 2.5}, {1.5, 3.5}, {2.5, 3.5}, {2.5, 2.5}};  // clockwise
    for (int i = 0; i < 4; ++i) {
      world.walls.push_back(world.walls[0]);
      world.walls.back().a = court[i], world.walls.back().b = court[(i + 1) % 4];
    }
    for (world::Segment& wall : world.walls) wall.z_min = z;
    const PolyData walls = walls_geometry(world);
    EXPECT_NEAR(area_at(walls, 1.0), 3.0, 1e-12);
    EXPECT_NEAR(area_at(walls, z), z > 0.0 ? 3.0 : 0.0, 1e-12);
    EXPECT_EQ(walls.names.size(), walls.polygons.size());
    EXPECT_EQ(walls.cell_data[1].values.back(), 1.0 - z) << "height";
  }
}

/// Bodies roll and pitch about their origins.
TEST(VtkFiles, BodiesTiltWithTheirRobots) {
  world::World world;
  world.movers.push_back(scenes::make_robot(world, 1, {}, 0xFF0000FFu, 5.0));
  const base::TiltedPose level{{5.0, 6.0, 0.25, 0.4}, {}}, tilted{level.X, {0.35, -0.5}};
  const PolyData a = bodies_geometry(world, {&level, 1}), b = bodies_geometry(world, {&tilted, 1});
  const auto X_WM = base::transform_of(level.X), Y_WM = base::transform_of(tilted.X, tilted.tilt);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    const glm::dvec3 p_M = transpose(X_WM.R) * (a.points[i] - X_WM.p);
    EXPECT_LT(glm::length(b.points[i] - base::transform(Y_WM, p_M)), 1e-12);
  }
}

TEST(VtkFiles, AbsentRobotsHaveNoBody) {
  world::World world;
  for (std::uint32_t id : {1u, 2u}) world.movers.push_back(scenes::make_robot(world, id, {}, 0xFF0000FFu, 5.0));
  const base::TiltedPose gone{base::kAbsent, {}};
  EXPECT_TRUE(bodies_geometry(world, std::vector{gone, gone}).polygons.empty());
  const PolyData one = bodies_geometry(world, std::vector<base::TiltedPose>{gone, {{5.0, 6.0, 0.0, 0.0}, {}}});
  EXPECT_GT(one.polygons.size(), 16u) << "16 sides, the top and the bottom";
  for (const glm::dvec3& p : one.points) EXPECT_NEAR(std::hypot(p.x - 5.0, p.y - 6.0), 0.165, 1e-9);
  for (const double robot : one.cell_data[0].values) EXPECT_EQ(robot, 1.0);
}

/// A model with a mesh is drawn as its triangles, unless these are too many or its mover has taken on another shape.
TEST(VtkFiles, MeshesAreDrawnInPlaceOfOutlines) {
  world::World world;
  const std::uint32_t rock = scenes::add_model(world, "rock", 0xFF00FF00u);
  world.walls.push_back({{0.0, 0.0}, {1.0, 0.0}, 0.0, 1.0, rock, true, true, false});
  world.movers.push_back(scenes::make_robot(world, 1, {}, 0xFF0000FFu, 5.0));
  world.models[world.movers[0].model].mover = 0;
  world.meshes.push_back({"t.obj", {{0, 0, 0}, {1, 0, 0}, {0, 0, 2}}, {0, 1, 2}});
  world.mesh_models = {{0, rock, {3.0, 4.0, 0.5, 0.0}}, {0, world.movers[0].model, {}}};
  const PolyData walls = walls_geometry(world);
  ASSERT_EQ(walls.polygons.size(), 1u);
  EXPECT_EQ(walls.points[2], glm::dvec3(3.0, 4.0, 2.5));
  EXPECT_EQ(walls.names[0], "rock");
  EXPECT_EQ(walls.cell_data[1].values, std::vector{2.0}) << "height";
  EXPECT_EQ(walls.cell_data[3].values, std::vector{0.0}) << "robots drive through";
  const std::vector<base::TiltedPose> poses{{{5.0, 6.0, 0.25, M_PI / 2}, {}}};
  const PolyData body = bodies_geometry(world, poses);
  ASSERT_EQ(body.polygons.size(), 1u);
  EXPECT_LT(glm::length(body.points[1] - glm::dvec3(5.0, 7.0, 0.25)), 1e-12);
  world.changed_shapes[0].shape = 0;
  EXPECT_GT(bodies_geometry(world, poses).polygons.size(), 16u) << "16 sides, the top and the bottom";
  world.meshes[0].corners.resize(3 * kMostDrawnTriangles);
  EXPECT_EQ(walls_geometry(world).polygons[0].size(), 4u) << "its wall";
}

/// Terrain is drawn in place, in coarser cells where it has too many.
TEST(VtkFiles, TerrainIsDrawn) {
  world::World world;
  world.terrain.push_back({"", {10.0, 20.0, 1.0, 0.0}, {2.0, 1.0}, 3, 2, {0, 1, 2, 3, 4, 5}});
  const PolyData small = walls_geometry(world);
  ASSERT_EQ(small.polygons.size(), 4u);
  EXPECT_EQ(small.points[0], glm::dvec3(8.0, 19.5, 1.0)) << "the corner; the pose is that of the middle";
  EXPECT_EQ(small.points[5], glm::dvec3(12.0, 20.5, 6.0));
  EXPECT_EQ(small.names[3], "terrain");
  world.terrain[0].columns = world.terrain[0].rows = 1'501;  // 4.5 million triangles
  world.terrain[0].heights.assign(1'501 * 1'501, 0.0f);
  const PolyData large = walls_geometry(world);
  EXPECT_LE(large.polygons.size(), kMostTerrainTriangles);
  EXPECT_GT(large.polygons.size(), kMostTerrainTriangles / 2);
  EXPECT_EQ(large.points.back(), glm::dvec3(1510.0, 770.0, 1.0)) << "the last point stays";
}

/// Models with closed outlines have a lid at their height; an open bar has none.
TEST(VtkFiles, OnlyClosedOutlinesHaveALid) {
  world::World world;
  world.movers.push_back(scenes::make_robot(world, 1, {}, 0xFF0000FFu, 5.0));
  const std::uint32_t bar = scenes::add_model(world, "bar", 0xFF00FF00u);
  const glm::dvec2 p[] = {{0.2, -0.1}, {0.3, -0.1}, {0.3, 0.1}, {0.2, 0.1}};
  for (int i = 0; i < 3; ++i) world.movers[0].body.push_back({p[i], p[i + 1], 0.0, 0.5, bar, true, true, true});
  for (std::size_t i = 16; i < 19; ++i) world.movers[0].body[i].solid_left = false;
  const std::uint32_t tower = scenes::add_model(world, "tower", 0xFFFF0000u);
  for (int i = 0; i < 4; ++i)
    world.movers[0].body.push_back({0.1 * p[i], 0.1 * p[(i + 1) % 4], 0.1, 0.4, tower, true, true, true});
  const PolyData bodies = bodies_geometry(world, std::vector<base::TiltedPose>{{{5.0, 6.0, 0.25, 0.0}, {}}});
  const double round = area_at(bodies, 0.25 + 0.1), square = 0.01 * 0.1 * 0.2;
  EXPECT_NEAR(round, 8.0 * 0.165 * 0.165 * std::sin(M_PI / 8), square + 1e-3) << "top; the tower's bottom is as high";
  EXPECT_NEAR(area_at(bodies, 0.25 + 0.4), square, 1e-12) << "the tower";
  EXPECT_EQ(area_at(bodies, 0.25 + 0.5), 0.0) << "the open bar";
}

TEST(VtkFiles, RoadsAreLinesOnTheGround) {
  world::World world;
  world.lane_markings.push_back({{{0, 0}, {1, 0}, {1, 1}}, 0.05, 0xFFFFFF00u});
  world.lane_markings.push_back({{{0, 0}}, 0.05, 0xFFFFFF00u});  // a single point is not a line
  write_poly_data(roads_geometry(world), scenes::own_file("roads.vtp"));
  const auto reader = read_poly_data(scenes::own_file("roads.vtp"));
  ASSERT_EQ(reader->GetOutput()->GetNumberOfLines(), 1);
  EXPECT_EQ(number(reader->GetOutput()->GetCellData(), "width", 0), 0.05);
  EXPECT_EQ(number(reader->GetOutput()->GetCellData(), "rgb", 0, 2), 0.0);
}

TEST(VtkFiles, GridsHaveTheirPositionAndValues) {
  const GridData grid{-1.0, 2.0, 0.1, 0.5, 0.25, 3, 2, {{"magnitude", 1, {1, 2, 3, 4, 5, 6.5}}}};
  write_grid(grid, scenes::own_file("g.vti"));
  vtkNew<vtkXMLImageDataReader> reader;
  reader->SetFileName(scenes::own_file("g.vti").c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  ASSERT_EQ(image->GetNumberOfCells(), 6);
  double box[6];
  image->GetBounds(box);
  const double expected[] = {-1.0, 0.5, 2.0, 2.5, 0.1, 0.1};
  for (int i = 0; i < 6; ++i) EXPECT_DOUBLE_EQ(box[i], expected[i]) << i;
  EXPECT_EQ(number(image->GetCellData(), "magnitude", 5), 6.5);
  EXPECT_EQ(number(image->GetCellData(), "magnitude", 3), 4.0) << "the first cell of the second row";
}

TEST(VtkFiles, UnwritableFilesAreReported) {
  expect_in("/nowhere/x.vtp", refusal_of([] { write_poly_data({}, "/nowhere/x.vtp"); }));
  expect_in("/nowhere/x.vti", refusal_of([] { write_grid({}, "/nowhere/x.vti"); }));
  expect_in("/nowhere/x.pvd", refusal_of([] { write_file_series({}, "/nowhere/x.pvd"); }));
}

}  // namespace
}  // namespace sf::viz
