// Files of triangles (`mesh "FILE"`): every format, and models that have one.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <glm/geometric.hpp>

#include "tests/folder.h"
#include "tests/refusal.h"
#include "tests/world/read_world.h"
#include "world/append_robot.h"
#include "world/meshes/mesh_file.h"

namespace sf::world {
namespace {

/// A tetrahedron.
constexpr std::array<glm::dvec3, 4> kVertices{glm::dvec3{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
constexpr std::array<std::array<std::uint32_t, 3>, 4> kFaces{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};

template <class... Values>
std::string raw(const Values&... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return bytes;
}
template <class Value>
std::string swapped(Value value) {
  const std::string bytes = raw(value);
  return {bytes.rbegin(), bytes.rend()};
}

const std::string kObj =
    "o t\nv 0 0 0\nv 1 0 0 1.0\nv 0 2 0\nv +0 0 3e0\nvn 0 0 1\nf 1 3 2\nf 1//1 2//1 4//1\nf 2/1 3/2 4/3\nf -2 -4 -1\n";

std::string text_stl() {
  std::string text = "solid t\n";
  for (const auto& face : kFaces) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const std::uint32_t v : face)
      text += fmt::format("   vertex {} {} {}\n", kVertices[v].x, kVertices[v].y, kVertices[v].z);
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid t\n";
}

std::string binary_stl(std::uint32_t count = 4, const std::string& title = "solid, but binary") {
  std::string bytes = title + std::string(80 - title.size(), ' ') + raw(count);
  for (const auto& face : kFaces) {
    bytes += raw(0.0f, 0.0f, 1.0f);
    for (const std::uint32_t v : face)
      for (int axis = 0; axis < 3; ++axis) bytes += raw(static_cast<float>(kVertices[v][axis]));
    bytes += raw(std::uint16_t{0});
  }
  return bytes;
}

std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment by hand\nelement vertex 4\nproperty double x\nproperty uchar red\nproperty double y\nproperty "
         "double z\nelement edge 1\nproperty list ushort float weights\nelement face 4\nproperty list uchar int "
         "vertex_indices\nend_header\n";
}
std::string text_ply() {
  std::string text = ply_header("ascii");
  for (const glm::dvec3& p : kVertices) text += fmt::format("{} 255 {} {}\n", p.x, p.y, p.z);
  text += "2 0.5 0.25\n";
  for (const auto& face : kFaces) text += fmt::format("3 {} {} {}\n", face[0], face[1], face[2]);
  return text;
}
std::string binary_ply(bool big) {
  std::string bytes = ply_header(big ? "binary_big_endian" : "binary_little_endian");
  const auto put = [&](auto value) { bytes += big ? swapped(value) : raw(value); };
  for (const glm::dvec3& p : kVertices) put(p.x), put(std::uint8_t{255}), put(p.y), put(p.z);
  put(std::uint16_t{2}), put(0.5f), put(0.25f);
  for (const auto& face : kFaces) {
    put(std::uint8_t{3});
    for (const std::uint32_t v : face) put(static_cast<std::int32_t>(v));
  }
  return bytes;
}

/// A binary glTF file whose y axis is up. @param change edits its text
std::string glb(const std::function<void(std::string&)>& change = {}) {
  std::string data;
  for (const glm::dvec3& p : kVertices)
    data += raw(static_cast<float>(p.x), static_cast<float>(p.z), static_cast<float>(-p.y));
  for (const auto& face : kFaces)
    for (const std::uint32_t v : face) data += raw(static_cast<std::uint16_t>(v));
  std::string text =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"translation":[0,0,1]},)"
      R"({"mesh":0,"translation":[0,0,-1]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
      R"({"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":48},)"
      R"({"buffer":0,"byteOffset":48,"byteLength":24}],"buffers":[{"byteLength":72}]})";
  if (change) change(text);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto size = [](const std::string& part) { return static_cast<std::uint32_t>(part.size()); };
  const std::string chunks = raw(size(text)) + "JSON" + text + raw(size(data)) + std::string("BIN\0", 4) + data;
  return "glTF" + raw(std::uint32_t{2}, static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
}

class Meshes : public FolderTest {
 protected:
  std::string file(const std::string& name, const std::string& bytes) {
    write(name, bytes);
    return path(name);
  }
  std::string refusal(const std::string& name, const std::string& bytes) {
    return refusal_from(name, [&] { read_triangles(file(name, bytes)); });
  }
};

TEST_F(Meshes, EveryFormatGivesTheSameTriangles) {
  const std::pair<std::string, std::string> files[] = {{"t.obj", kObj},
                                                       {"text.stl", text_stl()},
                                                       {"binary.STL", binary_stl()},
                                                       {"plain.stl", binary_stl(4, "made by x")},
                                                       {"text.ply", text_ply()},
                                                       {"little.ply", binary_ply(false)},
                                                       {"big.ply", binary_ply(true)},
                                                       {"t.glb", glb()}};
  for (const auto& [name, bytes] : files) {
    SCOPED_TRACE(name);
    const Triangles found = read_triangles(file(name, bytes));
    ASSERT_EQ(found.corners.size(), 12u);
    for (std::size_t i = 0; i < 12; ++i)
      EXPECT_EQ(found.vertices[found.corners[i]], kVertices[kFaces[i / 3][i % 3]]) << i;
  }
}

/// Of OBJ: the colour of `Kd` and its luminance, or the default where a texture or nothing states one.
TEST_F(Meshes, MaterialsOfObj) {
  write("two parts.mtl",
        "newmtl dark red\nKd 0.5 0 0\nnewmtl grey\nKd 0.25\nnewmtl textured\nmap_Kd a.png\nKd 1 1 1\n"
        "newmtl bright\nKd 2 0 -1\nnewmtl odd\nKd spectral a.rfl\n");
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nmtllib two parts.mtl\nvt 0 0\n";
  const Triangles found = read_triangles(file(
      "a.obj", corners +
                   "f 1 2 3\nusemtl dark red\nf 1 2 3 4\nusemtl grey\nf 1 2 3\nusemtl textured\nf 1/1 2/1 3/1\n"
                   "usemtl dark red\nf 1 2 3\nusemtl bright\nf 1 2 3\nusemtl odd\nf 1 2 3\nusemtl none\nf 1 2 3\n"));
  EXPECT_EQ(found.material_of, (std::vector<std::uint32_t>{kNoMaterial, 0, 0, 1, 2, 0, 3, 4, kNoMaterial}));
  ASSERT_EQ(found.materials.size(), 5u);
  EXPECT_EQ(found.materials[0].color, glm::dvec3(0.5, 0, 0));
  EXPECT_DOUBLE_EQ(found.materials[0].reflectance, 0.5 * 0.2126);
  EXPECT_DOUBLE_EQ(found.materials[1].reflectance, 0.25) << "one number: grey";
  EXPECT_EQ(found.materials[2].reflectance, kDefaultReflectance);
  EXPECT_EQ(found.materials[3].color, glm::dvec3(1, 0, 0)) << "clamped";
  EXPECT_EQ(found.materials[4].color, glm::dvec3(0.5)) << "a spectrum is no colour";
  ASSERT_EQ(found.notes.size(), 2u);
  expect_in("the colour of material 'bright' is not within 0 to 1", found.notes[0]);
  expect_in("material 'none' is in none of its files of materials", found.notes[1]);

  const Triangles without = read_triangles(file("a.obj", corners.substr(0, 32) + "mtllib none.mtl\nf 1 2 3\n"));
  EXPECT_TRUE(without.materials.empty() && without.material_of.empty());
  expect_in("none.mtl: no such file", without.notes.at(0));
}

/// Of glTF: the base colour and its luminance, or `extras.reflectance`; the default for textures.
TEST_F(Meshes, MaterialsOfGltf) {
  const auto with = [](const std::string& material) {
    return glb([&](std::string& text) {
      text.replace(text.find("\"indices\":1"), 11, "\"indices\":1,\"material\":1");
      text.insert(1, "\"materials\":[{},{\"name\":\"m\"" + material + "}],\"textures\":[{}],");
    });
  };
  const auto material = [&](const std::string& text) {
    const Triangles found = read_triangles(file("a.glb", with(text)));
    EXPECT_EQ(found.material_of, std::vector<std::uint32_t>(4, 1)) << text;
    return found.materials.at(1);
  };
  const std::string green = ",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0,0.5,0,1]";
  EXPECT_EQ(material(green + "}").color, glm::dvec3(0, 0.5, 0));
  EXPECT_DOUBLE_EQ(material(green + "}").reflectance, 0.5 * 0.7152);
  EXPECT_DOUBLE_EQ(material("").reflectance, 1.0) << "white by the standard";
  EXPECT_EQ(material(green + ",\"baseColorTexture\":{\"index\":0}}").reflectance, kDefaultReflectance);
  EXPECT_EQ(material(green + "},\"extras\":{\"reflectance\":80}").reflectance, 80.0) << "a retroreflector";
  EXPECT_TRUE(read_triangles(file("a.glb", glb())).material_of.empty());
  EXPECT_EQ(refusal("a.glb", with(",\"extras\":{\"reflectance\":101}")),
            "a.glb: material '2' has the reflectance 101; expected 0 to 100");
  EXPECT_EQ(refusal("a.glb", with(",\"extras\":{\"reflectance\":\"x\"}")),
            "a.glb: has the material 'm' whose 'reflectance' is no number");
}

TEST_F(Meshes, FacesBecomeTriangles) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.4 0.2 0\n";
  EXPECT_EQ(read_triangles(file("a.obj", square + "f 1 2 3 4\n")).corners,
            (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
  // Comments, and corners on an edge to the precision of the text.
  EXPECT_EQ(
      read_triangles(file("a.obj", "v 0 0 0\nv 0.333333 0.249999 0\nv 4 3 0\nv 0 3 0\nf 1 2 3 4 # x\n")).corners.size(),
      6u);
  EXPECT_EQ(refusal("a.obj", "v 0 3 0\nv 2 -3 0\nv -3 1 0\nv 3 1 0\nv -2 -3 0\nf 1 2 3 4 5\n").substr(0, 34),
            "a.obj:6: a face with 5 corners is ")
      << "a star";
  // A line may continue, and end with CRLF.
  EXPECT_EQ(read_triangles(file("a.obj", square + "f 1 2 \\\n 3\r\n")).corners, (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(refusal("a.obj", square + "f 1 5 2 3 4\n"),
            "a.obj:6: a face with 5 corners is not convex; expected convex faces: divide it into triangles where the "
            "file is made");
}

TEST_F(Meshes, RefusalsNameThePlace) {
  struct {
    std::string name, bytes, expected;
  } const cases[] = {
      {"a.blend", "x", "a.blend: is no mesh by its name; expected .stl, .obj, .ply, .glb, .gltf, .dae, .fbx or .urdf"},
      {"a.obj", "v 0 0\n", "a.obj:1: expected: v X Y Z"},
      {"a.obj", "v 0 0 nan\n", "a.obj:1: the coordinate nan is not a number within 1e+07 of 0"},
      {"a.obj", "v 0 0 2e7\n", "a.obj:1: the coordinate 2e+07 is not a number within 1e+07 of 0"},
      {"a.obj", "v 0 0 0\nf 1 2 3\n", "a.obj:2: a face refers to vertex 2 of 1 so far"},
      {"a.obj", "v 0 0 0\nf 0 1 1\n", "a.obj:2: '0' is no corner of a face; expected the number of a vertex"},
      {"a.obj", "v 0 0 0\nf 1 1\n", "a.obj:2: a face has fewer than three corners"},
      {"a.obj", "# nothing\n", "a.obj: has no triangles"},
      {"a.stl", "solid\nvertex 1 2\n", "a.stl:3: expected: vertex X Y Z"},
      {"a.stl", "solid\nvertex 1 2 3\nendfacet\n", "a.stl:3: a facet has 1 vertices; expected three"},
      {"a.stl", "binary", "a.stl: is too short for an STL file"},
      {"a.stl", binary_stl(5, "b"), "a.stl: ends after 284 bytes; expected 334 for its 5 triangles, 50 bytes each"},
      {"a.stl", binary_stl(20'000'000, "b"), "a.stl: has 20000000 triangles; expected at most 16000000"},
      {"a.ply", "plyx\n", "a.ply:1: expected 'ply' in the first line"},
      {"a.ply", "ply\nformat ascii 1.0\n", "a.ply: ends within its header; expected 'end_header'"},
      {"a.ply", "ply\nformat text 1.0\n", "a.ply:2: unknown format 'text'; expected ascii, binary_little_endian"},
      {"a.ply", "ply\nelement face 9000\n", "a.ply:2: 9000 rows do not fit into the 0 bytes of the file"},
      {"a.ply", "ply\nelement face 1\nproperty list half int v\nend_header\n", "a.ply:3: expected: property TYPE NAME"},
      {"a.ply", "ply\nelement vertex 1\nproperty int x\nend_header\n1\n", "a.ply: its vertices have no x, y and z"},
      {"a.ply", text_ply().substr(0, text_ply().size() - 5), "a.ply: face 4: expected a number"},
      {"a.ply", binary_ply(true).substr(0, binary_ply(true).size() - 1), "a.ply: face 4: the file ends here"},
      {"a.glb", "glTF", "a.glb: is no readable glTF 2.0 file"},
      {"a.gltf", "{}", "a.gltf: is no readable glTF 2.0 file"},
  };
  for (const auto& [name, bytes, expected] : cases) expect_in(expected, refusal(name, bytes));
}

/// COLLADA, read by Assimp, keeps its axes, and its unit becomes metres.
TEST_F(Meshes, Collada) {
  const char* const dae =
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 100 0 0 0 200 0 0 0 300</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 1 2 3 2 0 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  const Triangles found = read_triangles(file("t.dae", dae));
  ASSERT_EQ(found.corners.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_LT(glm::length(found.vertices[found.corners[i]] - kVertices[kFaces[i / 3][i % 3]]), 1e-6) << i;
  expect_in("a.dae: is no readable mesh: ", refusal("a.dae", "<COLLADA/>"));
  expect_in("a.fbx: is no readable mesh: ", refusal("a.fbx", "x"));
}

TEST_F(Meshes, TextOfStlMayBeWrittenInManyWays) {
  std::string capital = text_stl();
  for (char& c : capital) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (const std::string& bytes :
       {capital, "\n " + text_stl(), "\xEF\xBB\xBF" + text_stl(), "solid vertex endfacet 1" + text_stl().substr(7)})
    EXPECT_EQ(read_triangles(file("a.stl", bytes)).corners.size(), 12u) << bytes.substr(0, 20);
  expect_in("a.stl: ends within a solid; expected 'endsolid'",
            refusal("a.stl", text_stl().substr(0, text_stl().find("endsolid"))));
  expect_in("a.stl: ends after 284 bytes", refusal("a.stl", binary_stl(5)));
}

/// Parsers recurse into nested text, which would overflow the stack.
TEST_F(Meshes, DeepTextIsRefused) {
  expect_in("nests brackets more than 1000 deep", refusal("a.gltf", "{\"extras\":" + std::string(30'000, '[')));
  std::string elements;
  for (int i = 0; i < 50'000; ++i) elements += "<a>";
  expect_in("nests elements more than 1000 deep", refusal("a.urdf", elements));
  expect_in("nests elements more than 1000 deep", refusal("a.dae", "<COLLADA>" + elements));
}

/// Notes name each part that the parser skipped, and each link whose mesh cannot be read.
TEST_F(Meshes, UrdfSaysWhatIsLeftOut) {
  const std::string link =
      "<link name='NAME'><visual><geometry><mesh filename='none.stl'/></geometry></visual>"
      "<collision><geometry><box size='1 1 1'/></geometry></collision></link>";
  const auto named = [&](const std::string& name) { return std::string(link).replace(link.find("NAME"), 4, name); };
  const std::string joint = "<joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>";
  const Triangles two =
      read_triangles(file("r.urdf", "<robot name='r'>" + named("a") + named("b") + joint + "</robot>"));
  EXPECT_EQ(two.corners.size(), 72u);
  EXPECT_EQ(two.notes.size(), 2u);
  const Triangles capsule = read_triangles(file(
      "r.urdf", "<robot name='r'>" + named("a") +
                    "<link name='b'><visual><geometry><capsule/></geometry></visual></link>" + joint + "</robot>"));
  EXPECT_EQ(capsule.corners.size(), 36u);
  expect_in("parts are left out: ", capsule.notes.at(0));
  expect_in("r.urdf: has no shape that can be read: link 'a' is left out: 'package://p/x.stl' is in no known folder",
            refusal("r.urdf",
                    "<robot name='r'><link name='a'><visual><geometry><mesh "
                    "filename='package://p/x.stl'/></geometry></visual></link></robot>"));
}

TEST_F(Meshes, RowsOfGltfAreChecked) {
  const auto with = [&](const std::string& from, const std::string& to) {
    return refusal("a.glb", glb([&](std::string& text) { text.replace(text.find(from), from.size(), to); }));
  };
  EXPECT_EQ(with("\"count\":4", "\"count\":7"),
            "a.glb: has an accessor of 7 elements beyond the 72 bytes of its buffer");
  EXPECT_EQ(with("\"count\":4", "\"count\":3"), "a.glb: has a triangle with vertex 3 of 3");
  EXPECT_EQ(with("\"children\":[1]", "\"children\":[0]"),
            "a.glb: has nodes within nodes without end, or more than 1000000");
  EXPECT_EQ(with("\"mesh\":0", "\"mesh\":5"), "a.glb: refers to mesh 5, which does not exist");
  EXPECT_EQ(with("\"VEC3\"", "\"VEC2\""), "a.glb: has positions that are no vectors of three floats");
  EXPECT_EQ(
      with("\"scene\":0", R"("extensionsRequired":["KHR_draco_mesh_compression"],"scene":0)"),
      "a.glb: requires KHR_draco_mesh_compression, which is not read; expected a file without it: export it again");
}

constexpr const char* kUrdf = R"(<?xml version="1.0"?><robot name="r">
<material name="red"><color rgba="1 0 0 1"/></material>
<link name="base"><visual><geometry><box size="1 2 3"/></geometry><origin xyz="0 0 1"/><material name="red"/></visual>
  <visual><geometry><mesh filename="package://mine/meshes/t.obj" scale="2 2 2"/></geometry></visual></link>
<link name="wheel"><visual><geometry><cylinder radius="0.5" length="0.2"/></geometry></visual></link>
<joint name="axle" type="continuous"><parent link="base"/><child link="wheel"/><origin xyz="10 0 0" rpy="1.5707963267948966 0 0"/></joint>
<link name="eye"><visual><geometry><mesh filename="eye.dae"/></geometry></visual>
  <collision><geometry><sphere radius="0.25"/></geometry></collision></link>
<joint name="neck" type="fixed"><parent link="wheel"/><child link="eye"/><origin xyz="0 0 1"/></joint>
<link name="lost"><visual><geometry><mesh filename="package://other/x.stl"/></geometry></visual></link>
<joint name="string" type="fixed"><parent link="base"/><child link="lost"/></joint>
<gazebo reference="eye"><sensor type="ray"/></gazebo></robot>)";

/// All links at their joints' 0, meshes from the package's folder, the collision's shape where a mesh cannot be read.
TEST_F(Meshes, RobotsFromUrdf) {
  std::filesystem::create_directories(folder_ / "mine" / "meshes");
  std::filesystem::create_directories(folder_ / "mine" / "urdf");
  write("mine/meshes/t.obj", kObj);
  const Triangles robot = read_triangles(file("mine/urdf/r.urdf", kUrdf));
  const MeshBox box = box_of(robot.vertices);
  EXPECT_LT(glm::length(box.low - glm::dvec3(-0.5, -1.25, -0.5)), 1e-12)
      << "the eye is 1 m from the wheel's middle, to its side";
  EXPECT_NEAR(box.high.x, 10.5, 1e-12);
  EXPECT_EQ(box.high.y, 4.0) << "the mesh, twice its size";
  EXPECT_EQ(box.high.z, 6.0);
  ASSERT_EQ(robot.materials.size(), 1u);
  EXPECT_EQ(robot.materials[0].color, glm::dvec3(1.0, 0.0, 0.0));
  EXPECT_EQ(robot.material_of.front(), 0u) << "the box";
  EXPECT_EQ(robot.material_of.back(), kNoMaterial);
  ASSERT_EQ(robot.notes.size(), 4u);
  expect_in("link 'eye' has its shape for collisions: ", robot.notes[0]);  // there is no eye.dae
  EXPECT_EQ(robot.notes[1], "link 'lost' is left out: 'package://other/x.stl' is in no known folder");
  EXPECT_EQ(robot.notes[2], "movable joints (1) stay at 0");
  EXPECT_EQ(robot.notes[3], "its sensors are left out; give them to the model, such as lidar( )");
  expect_in("a.urdf: is no readable URDF", refusal("a.urdf", "<robot name='x'/>"));
  expect_in("a.urdf: is no readable URDF", refusal("a.urdf", "no xml"));
  expect_in("has no triangles", refusal("a.urdf", "<robot name='x'><link name='l'/></robot>"));
}

// --- Models

/// Writes the tetrahedron and reads a world.
class MeshModels : public Meshes {
 protected:
  World world(const std::string& text) {
    write("t.obj", kObj);
    return load_world(file("w.world", text), kWithLasers);
  }
};

TEST_F(MeshModels, AreInMetresOrFitASize) {
  const World plain = world("model( mesh \"t.obj\" pose [10 0 1 0] )\n");
  ASSERT_EQ(plain.meshes.size(), 1u);
  EXPECT_EQ(plain.meshes[0].vertices, (std::vector<glm::dvec3>{{0, 0, 0}, {0, 2, 0}, {1, 0, 0}, {0, 0, 3}}));
  EXPECT_EQ(plain.mesh_models[0].X_BF.x, 10.0);
  EXPECT_EQ(plain.models[0].size, glm::dvec2(1.0, 2.0));
  const World fitted = world("model( mesh \"t.obj\" size [4 4 6] )\n");
  EXPECT_EQ(fitted.meshes[0].vertices[3], glm::dvec3(-2, -2, 6));
  const World scaled = world("model( mesh \"t.obj\" mesh_scale 0.5 mesh_rotation [0 0 90] )\n");
  EXPECT_LT(glm::length(scaled.meshes[0].vertices[2] - glm::dvec3(0, 0.5, 0)), 1e-15);
}

/// Materials stay with their triangles as flat ones are left out, and in snapshots, which check them.
TEST_F(MeshModels, HaveTheirMaterials) {
  write("m.mtl", "newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 0 1\n");
  write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 1\nusemtl a\nf 1 2 2\nusemtl b\nf 1 2 3\n");
  World mine = world("model( mesh \"m.obj\" ) model( mesh \"t.obj\" pose [5 0 0 0] )\n");
  ASSERT_EQ(mine.mesh_materials.size(), 1u) << "the other mesh has none";
  EXPECT_EQ(mine.mesh_materials[0].triangles, std::vector<std::uint32_t>{1});
  const World again = from_snapshot(snapshot(mine));
  EXPECT_EQ(again.hash, mine.hash);
  EXPECT_EQ(again.mesh_materials.at(0).materials.at(1).color, glm::dvec3(0, 0, 1));
  const auto broken = [&](auto change) {
    World world = mine;
    change(world.mesh_materials[0]);
    update_extent_and_hash(world);
    return sf::refusal_of([&] { from_snapshot(snapshot(world)); });
  };
  expect_in("a row breaks the rules of its table", broken([](MeshMaterials& m) { m.triangles[0] = 2; }));
  expect_in("a row breaks the rules of its table", broken([](MeshMaterials& m) { m.triangles.push_back(0); }));
  expect_in("a row breaks the rules of its table", broken([](MeshMaterials& m) { m.materials[0].color.y = 1.5; }));
  expect_in("a row breaks the rules of its table", broken([](MeshMaterials& m) { m.materials[0].reflectance = 101; }));
  expect_in("refers to a row that does not exist", broken([](MeshMaterials& m) { m.mesh = 2; }));
}

TEST_F(MeshModels, HaveTheirConvexOutlineForPlanarSensors) {
  const World seen = world("model( mesh \"t.obj\" pose [10 0 1 0] )\n");
  ASSERT_EQ(seen.walls.size(), 3u) << "the corner on the base's edge is none of the outline";
  for (const Segment& side : seen.walls) {
    EXPECT_TRUE(side.solid_left);
    EXPECT_EQ(side.z_min, 1.0);
    EXPECT_EQ(side.z_max, 4.0);
  }
  EXPECT_EQ(world("model( mesh \"t.obj\" noblocks 1 )\n").walls.size(), 0u);
  EXPECT_EQ(world("model( mesh \"t.obj\" boundary 1 )\n").walls.size(), 8u) << "an outline of one's own";
  const World unseen = world("model( mesh \"t.obj\" ranger_return -1 )\n");
  EXPECT_EQ(unseen.mesh_models.size(), 0u);
  EXPECT_EQ(unseen.walls.size(), 3u);
}

TEST_F(MeshModels, ShareWhatIsEqual) {
  const World many = world(
      "define t model( mesh \"t.obj\" size [1 1 1] )\nt( pose [1 0 0 0] ) t( pose [2 0 0 9] ) t( size [1 1 2] )\n");
  EXPECT_EQ(many.meshes.size(), 2u);
  EXPECT_EQ(many.mesh_models.size(), 3u);
}

/// An upright plane is a thin wall; points that no triangle uses do not count.
TEST_F(MeshModels, PlanesAndStrayPoints) {
  write("p.obj", "v 0 -1 0\nv 0 1 0\nv 0 1 1\nv 0 -1 1\nv 100 100 100\nf 1 2 3 4\n");
  const World world = load_world(file("w.world", "model( mesh \"p.obj\" )\n"), kWithLasers);
  ASSERT_EQ(world.walls.size(), 1u);
  EXPECT_FALSE(world.walls[0].solid_left);
  EXPECT_EQ(glm::length(world.walls[0].b - world.walls[0].a), 2.0);
  EXPECT_EQ(world.walls[0].z_max, 1.0);
}

TEST_F(MeshModels, OutlinesOfRoundMeshesHaveFewCorners) {
  std::string round;
  for (int i = 0; i < 1000; ++i)
    for (const int z : {0, 1})
      round += fmt::format("v {} {} {}\n", std::cos(i * 2e-3 * M_PI), std::sin(i * 2e-3 * M_PI), z);
  for (int i = 1; i < 1999; ++i) round += fmt::format("f {} {} {}\n", i, i + 1, i + 2);
  write("r.obj", round);
  const World world = load_world(file("w.world", "model( mesh \"r.obj\" )\n"), kWithLasers);
  EXPECT_LT(world.walls.size(), 100u);
  EXPECT_GT(world.walls.size(), 30u);
  for (const Segment& side : world.walls)
    EXPECT_GT(glm::length(0.5 * (side.a + side.b)), 1.0 - 2e-3) << "0.1 % of the size of 2 m";
}

TEST_F(MeshModels, FlatTrianglesAreLeftOutWithAWarning) {
  write("f.obj", kObj + "f 1 1 2\n");
  const World world = load_world(file("w.world", "model( mesh \"f.obj\" )\n"), kWithLasers);
  EXPECT_EQ(world.meshes[0].corners.size(), 12u);
  expect_in("are left out, since their area is 0; the first is number 5", world.warnings.at(0).message);
  write("f.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_EQ(refusal_from("w.world", [&] { load_world(path("w.world"), kWithLasers); }),
            "w.world:1: all triangles of this mesh have an area of 0");
}

TEST_F(MeshModels, RefuseWhatCannotBe) {
  const std::pair<std::string, std::string> cases[] = {
      {"mesh \"t.obj\" size [1 1 1] mesh_scale 2",
       "w.world:1: 'size' fits the mesh into a box; expected it or 'mesh_scale', not both"},
      {"mesh \"t.obj\" mesh_scale 0", "w.world:1: 'mesh_scale' expects a number above 0"},
      {"mesh \"t.obj\" outlines \"x.csv\"", "w.world:1: a model has a mesh or a file of 'outlines', not both"},
      {"mesh \"t.obj\" random_size [1 1 1]",
       "w.world:1: a mesh has one size; expected 'random_size' in a model without 'mesh'"},
      {"mesh \"t.obj\" mesh_scale 1e7",
       "w.world:1: this mesh reaches 2e+07 m from its origin; expected at most 1e+07 m: give 'size' or 'mesh_scale'"},
      {"mesh \"none.obj\"", "none.obj"},
  };
  for (const auto& [keys, expected] : cases)
    expect_in(expected, sf::refusal_of([&] { world("model( " + keys + " )\n"); }));
  expect_in("'mesh_scale' has no effect without", world("model( mesh_scale 2 )\n").warnings.at(0).message);
}

TEST_F(MeshModels, SnapshotsContainThem) {
  const World before = world("model( mesh \"t.obj\" )\nposition( name \"r\" mesh \"t.obj\" )\n");
  const World after = from_snapshot(snapshot(before));
  ASSERT_EQ(after.mesh_models.size(), 2u);
  EXPECT_EQ(after.meshes[0].vertices, before.meshes[0].vertices);
  World broken = before;
  broken.meshes[0].corners[5] = 4;
  update_extent_and_hash(broken);
  EXPECT_NE(broken.hash, before.hash);
  expect_in("breaks the rules", sf::refusal_of([&] { from_snapshot(snapshot(broken)); }));
  broken = before;
  broken.mesh_models[0].mesh = 7;
  update_extent_and_hash(broken);
  expect_in("does not exist", sf::refusal_of([&] { from_snapshot(snapshot(broken)); }));
}

TEST_F(MeshModels, CopiesOfARobotHaveItsMeshes) {
  World own = world(
      "model( name \"rock\" mesh \"t.obj\" pose [50 0 0 0] )\nposition( name \"r1\" mesh \"t.obj\" model( name \"arm\" "
      "mesh \"t.obj\" ) )\n");
  clone_robots(own, 3, 1);
  EXPECT_EQ(own.meshes.size(), 1u);
  ASSERT_EQ(own.mesh_models.size(), 7u);
  for (const MeshModel& row : own.mesh_models) {
    const Model& model = own.models[row.model];
    EXPECT_EQ(model.mover == kNone, model.name == "rock");
  }
  World other = world("model( )\n");
  write("t.obj", kObj);
  append_robot_of(other, file("robots.world", "define scout position( mesh \"t.obj\" )\n"), "scout", kWithLasers);
  ASSERT_EQ(other.mesh_models.size(), 1u);
  EXPECT_EQ(other.models[other.mesh_models[0].model].mover, 0u);
}

}  // namespace
}  // namespace sf::world
