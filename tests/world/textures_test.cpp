// Textures of mesh files: where they are, how they are placed, and which are left out.

#include "world/meshes/textures.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/files.h"
#include "tests/folder.h"
#include "tests/refusal.h"
#include "tests/world/read_world.h"
#include "tests/world/textured_square.h"
#include "world/append_robot.h"
#include "world/meshes/mesh_file.h"

namespace sf::world {
namespace {

constexpr std::string_view kCameraKeys[] = {"rgb"};
constexpr SensorKeyword kCameraWords[] = {{"camera", kCameraKeys}};
const LoadOptions kWithCameras{.sensors = kCameraWords};
const std::string kPng = png_of({0xFF0000, 0x00FF00, 0x0000FF, 0x102030}, 2);
const std::vector<std::uint8_t> kTexels{255, 0, 0, 0, 255, 0, 0, 0, 255, 16, 32, 48};

class Textures : public FolderTest {
 protected:
  World world(const std::string& mesh, const std::string& camera = "camera( rgb 1 )") {
    write("w.world", fmt::format("model( mesh \"{}\" pose [5 0 0 0] )\nposition( name \"r\" {} )\n", mesh, camera));
    return load_world(path("w.world"), kWithCameras);
  }
  World square(const TexturedSquare& square) {
    write("a.glb", glb_of(square));
    return world("a.glb");
  }
  Triangles triangles(const std::string& name, const std::string& bytes) { return read_triangles(write(name, bytes)); }
  /// The only warning, and no texture.
  std::string left_out(const World& world) {
    EXPECT_TRUE(world.textures.empty() && world.mesh_textures.empty());
    return world.warnings.size() == 1 ? world.warnings[0].message : warnings_of(world);
  }
};

/// In a buffer, a URI or a file of its own, as PNG or JPEG.
TEST_F(Textures, OfGltf) {
  write("a picture.png", kPng);
  const std::string uri = R"({"uri":"data:image/png;base64,)" + [] {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text, bytes = kPng + std::string((3 - kPng.size() % 3) % 3, '\0');
    for (std::size_t i = 0; i < bytes.size(); i += 3)
      for (int k = 3; k >= 0; --k)
        text += kDigits[(static_cast<std::uint8_t>(bytes[i]) << 16 | static_cast<std::uint8_t>(bytes[i + 1]) << 8 |
                         static_cast<std::uint8_t>(bytes[i + 2])) >>
                            (6 * k) &
                        63];
    return text;
  }() + "\"}";
  for (const TexturedSquare& form :
       {TexturedSquare{.picture = kPng}, {.picture = kPng, .image = uri}, {.image = R"({"uri":"a%20picture.png"})"}}) {
    const World found = square(form);
    ASSERT_EQ(found.textures.size(), 1u) << form.image.substr(0, 40) << warnings_of(found);
    EXPECT_EQ(found.textures[0].width, 2u);
    EXPECT_EQ(found.textures[0].rgb, kTexels);
    ASSERT_EQ(found.mesh_textures.size(), 1u);
    EXPECT_EQ(found.mesh_textures[0].materials.at(0).texture, 0u);
    EXPECT_EQ(found.mesh_textures[0].corners, (std::vector<glm::vec2>{{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}));
    EXPECT_TRUE(found.warnings.empty()) << warnings_of(found);
  }
  const World jpeg = square({.picture = base::read_text(SF_SOURCE_DIR "/tests/fuzz/picture/grey.jpg")});
  EXPECT_EQ(jpeg.textures.at(0).width, 16u);
}

/// Ways to continue beyond the picture, and the example of KHR_texture_transform: the lower left quadrant, turned.
TEST_F(Textures, ArePlacedByTheirSamplersAndTransforms) {
  const Triangles found = triangles(
      "a.glb", glb_of({.picture = kPng,
                       .info = R"(,"extensions":{"KHR_texture_transform":{"offset":[0,1],"rotation":1.57079632679,)"
                               R"("scale":[0.5,0.5]}})",
                       .sampler = R"({"wrapS":33071,"wrapT":33648})"}));
  EXPECT_EQ(found.texture_of.at(0).u, TextureWrap::clamp);
  EXPECT_EQ(found.texture_of.at(0).v, TextureWrap::mirror);
  const glm::vec2 expected[] = {{0, 1}, {0, 0.5}, {0.5, 0.5}};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(glm::distance(found.coordinates.at(i), expected[i]), 1e-6f) << i;
  const Triangles other = triangles("a.glb", glb_of({.picture = kPng, .info = R"(,"texCoord":1)"}));
  EXPECT_EQ(other.coordinates, std::vector<glm::vec2>(6)) << "a set that the vertices lack";
  expect_in("faces of textured materials lack texture coordinates", other.notes.at(0));
}

/// `vt` points up; options of `map_Kd`; names with blanks, relative to the MTL file.
TEST_F(Textures, OfObj) {
  std::filesystem::create_directories(folder_ / "parts" / "my maps");
  write("parts/my maps/a b.png", kPng);
  write("parts/m.mtl",
        "newmtl a\nmap_Kd my maps\\a b.png\nnewmtl b\nKd 0.5 0 0\n"
        "map_Kd -blendu on -s 2 3 1 -o 0.25 0.5 -clamp on -mm 0 1 my maps/a b.png\nnewmtl c\nmap_Kd\n");
  const std::string text =
      "mtllib parts/m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 1\nvt 0 0\nvt 1 0 0\nvt 0 1\nvt 0.5\nusemtl a\nf 1/1 2/2 3/-2\n"
      "usemtl b\nf 1/1/1 2/2/1 3/3/1\nusemtl c\nf 1 2 3\n";
  const Triangles found = triangles("a.obj", text);
  EXPECT_EQ(found.coordinates,
            (std::vector<glm::vec2>{{0, 1}, {1, 1}, {0, 0}, {0.25, 0.5}, {2.25, 0.5}, {0.25, -2.5}, {}, {}, {}}));
  EXPECT_TRUE(found.notes.empty()) << found.notes[0];
  ASSERT_EQ(found.materials.size(), 3u);
  EXPECT_EQ(found.materials[0].color, glm::dvec3(1.0)) << "without 'Kd', the texture's own";
  EXPECT_EQ(found.materials[1].color, glm::dvec3(0.5, 0, 0));
  EXPECT_EQ(found.textures.size(), 1u) << "both are one file";
  EXPECT_EQ(found.texture_of[0].u, TextureWrap::repeat);
  EXPECT_EQ(found.texture_of[1].v, TextureWrap::clamp);
  EXPECT_EQ(found.texture_of[2].texture, kNoTexture);
  EXPECT_EQ(world("a.obj").textures.at(0).rgb, kTexels);
}

/// Through Assimp: a texture in place of the diffuse colour, with v upward in the file; and a colour.
TEST_F(Textures, OfCollada) {
  write("a b.png", kPng);
  const auto source = [](const char* id, const char* numbers, int count, const char* names) {
    std::string params;
    for (const char* name = names; *name != '\0'; ++name)
      params += fmt::format("<param name=\"{}\" type=\"float\"/>", *name);
    const std::size_t stride = std::string_view(names).size();
    return fmt::format(
        R"(<source id="{0}"><float_array id="{0}a" count="{1}">{2}</float_array><technique_common>)"
        R"(<accessor source="#{0}a" count="{3}" stride="{4}">{5}</accessor></technique_common></source>)",
        id, static_cast<std::size_t>(count) * stride, numbers, count, stride, params);
  };
  const auto triangle = [](const char* material) {
    return fmt::format(R"(<triangles count="1" material="{}"><input semantic="VERTEX" source="#v" offset="0"/>)"
                       R"(<input semantic="TEXCOORD" source="#t" offset="1" set="0"/><p>0 0 1 1 2 2</p></triangles>)",
                       material);
  };
  const std::string dae =
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">)"
      R"(<asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset><library_images><image id="i"><init_from>a%20b.png)"
      R"(</init_from></image></library_images><library_effects><effect id="e"><profile_COMMON><newparam sid="s">)"
      R"(<surface type="2D"><init_from>i</init_from></surface></newparam><newparam sid="m"><sampler2D><source>s)"
      R"(</source></sampler2D></newparam><technique sid="x"><lambert><diffuse><texture texture="m" texcoord="c"/>)"
      R"(</diffuse></lambert></technique></profile_COMMON></effect><effect id="f"><profile_COMMON><technique sid="x">)"
      R"(<lambert><diffuse><color>0.5 0.25 0 1</color></diffuse></lambert></technique></profile_COMMON></effect>)"
      R"(</library_effects><library_materials><material id="p"><instance_effect url="#e"/></material>)"
      R"(<material id="q"><instance_effect url="#f"/></material></library_materials><library_geometries>)"
      R"(<geometry id="g"><mesh>)" +
      source("w", "0 0 0 1 0 0 0 1 1", 3, "XYZ") + source("t", "0 0 1 0 0 1", 3, "ST") +
      R"(<vertices id="v"><input semantic="POSITION" source="#w"/></vertices>)" + triangle("P") + triangle("Q") +
      R"(</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="z"><node id="n">)"
      R"(<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="P" target="#p">)"
      R"(<bind_vertex_input semantic="c" input_semantic="TEXCOORD" input_set="0"/></instance_material>)"
      R"(<instance_material symbol="Q" target="#q"/></technique_common></bind_material></instance_geometry></node>)"
      R"(</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#z"/></scene></COLLADA>)";
  const Triangles found = triangles("a.dae", dae);
  ASSERT_EQ(found.material_of.size(), 2u);
  const Material &picture = found.materials[found.material_of[0]], &plain = found.materials[found.material_of[1]];
  EXPECT_EQ(picture.color, glm::dvec3(1.0));
  EXPECT_EQ(picture.reflectance, kDefaultReflectance);
  EXPECT_EQ(plain.color, glm::dvec3(0.5, 0.25, 0.0));
  EXPECT_DOUBLE_EQ(plain.reflectance, luminance(plain.color));
  EXPECT_EQ(found.texture_of[found.material_of[1]].texture, kNoTexture);
  ASSERT_EQ(found.coordinates.size(), 6u);
  EXPECT_EQ((std::vector<glm::vec2>(found.coordinates.begin(), found.coordinates.begin() + 3)),
            (std::vector<glm::vec2>{{0, 1}, {1, 1}, {0, 0}}));
  EXPECT_EQ(world("a.dae").textures.at(0).rgb, kTexels);
}

TEST_F(Textures, CoordinatesThatAreNone) {
  write("m.mtl", "newmtl a\nmap_Kd a.png\n");
  const std::string head = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 1\nvt nan 0\nvt 0 1e7\nvt 1 1\nusemtl a\n";
  for (const char* const face : {"f 1/1 2/3 3/3\n", "f 1/2 2/3 3/3\n", "f 1/3 2/3 3/4\n", "f 1/3 2/3 3\n"}) {
    const Triangles found = triangles("a.obj", head + face);
    EXPECT_EQ(found.coordinates, std::vector<glm::vec2>(3)) << face;
    EXPECT_EQ(found.notes.size(), 1u) << face;
  }
}

/// Textures are loaded only for colour cameras: at once, or when the first robot with such a camera joins.
TEST_F(Textures, AreReadForCamerasWithColours) {
  write("a.glb", glb_of({.picture = kPng}));
  World plain = world("a.glb", "camera( rgb 0 )");
  EXPECT_TRUE(plain.textures.empty() && plain.mesh_textures.empty() && plain.warnings.empty());
  const World seen = world("a.glb");
  EXPECT_NE(plain.hash, seen.hash);
  TexturedSquare other{.picture = png_of({0xFF0000, 0x00FF00, 0x0000FF, 0x102031}, 2)};
  EXPECT_NE(seen.hash, square(other).hash) << "of one texel";
  write("a.glb", glb_of({.picture = kPng}));
  append_robot_of(plain, write("other.world", "position( name \"s\" mesh \"a.glb\" camera( rgb 1 ) )\n"), "s",
                  kWithCameras);
  EXPECT_EQ(plain.textures.size(), 1u);
  ASSERT_EQ(plain.mesh_textures.size(), 1u) << "that of the model, which the robot shares";
  EXPECT_EQ(plain.mesh_textures[0].corners, seen.mesh_textures[0].corners);
}

TEST_F(Textures, ThatCannotBeReadAreLeftOut) {
  expect_in("a texture is left out: ", left_out(square({.image = R"({"uri":"none.png"})"})));
  expect_in("none.png: no such file", left_out(square({.image = R"({"uri":"none.png"})"})));
  expect_in("a.glb, image 0: corrupt PNG", left_out(square({.picture = kPng.substr(0, kPng.size() - 20)})));
  expect_in("a.glb, image 0: is not a picture in PNG", left_out(square({.picture = "x"})));
  const auto sized = [&](std::uint8_t high) {  // in the header, whose checksum is then wrong
    std::string png = kPng;
    png[18] = static_cast<char>(high);
    return png;
  };
  const std::string huge = "P6 8193 1 255 ", large = "P6 8192 8192 255 ";
  expect_in("a picture of 8193 x 1 pixels; expected 1 to 8192", left_out(square({.picture = huge})));
  expect_in("fewer pixels than the header states", left_out(square({.picture = large})));
  expect_in("corrupt PNG", left_out(square({.picture = sized(0x10)})));
  expect_in("it has no image in PNG or JPEG", [&] {
    std::string bytes = glb_of({.picture = kPng});
    bytes.replace(bytes.find("\"source\":0"), 10, "\"extras\":0");
    write("a.glb", bytes);
    return left_out(world("a.glb"));
  }());
  expect_in("has image 0 beyond the", refusal_from("a.glb", [&] {
              std::string bytes = glb_of({.picture = kPng});
              bytes.replace(bytes.find("\"byteOffset\":92"), 15, "\"byteOffset\":93");
              triangles("a.glb", bytes);
            }));
}

/// Textures of a world together have a bound, which their headers tell before memory is taken.
TEST_F(Textures, HaveABoundTogether) {
  World world = square({.picture = kPng});
  world.mesh_textures.clear();
  Texture& large = world.textures[0];
  large.file = "large", large.rgb.resize(3 * (kMostTexels - 3));
  std::map<std::string, Triangles> files;
  EXPECT_FALSE(read_textures(world, files));
  expect_in("is one texture too many: those of a world have at most 67108864 pixels in all",
            world.warnings.back().message);
}

/// Transparent texels are opaque, with a warning if the file says that they are not.
TEST_F(Textures, AreOpaque) {
  const std::string clear = base::read_text(SF_SOURCE_DIR "/tests/fuzz/picture/rgba.png");
  EXPECT_TRUE(square({.picture = clear}).warnings.empty());
  const World masked = square({.picture = clear, .material = R"(,"alphaMode":"MASK")"});
  expect_in("transparent parts of the texture", masked.warnings.at(0).message);
  EXPECT_EQ(masked.textures.size(), 1u);
  EXPECT_TRUE(square({.picture = kPng, .material = R"(,"alphaMode":"BLEND")"}).warnings.empty());
}

TEST_F(Textures, AreInSnapshotsWhichCheckThem) {
  const World mine = square({.picture = kPng, .sampler = R"({"wrapS":33648})"});
  const World again = from_snapshot(snapshot(mine));
  EXPECT_EQ(again.hash, mine.hash);
  EXPECT_EQ(again.textures.at(0).rgb, kTexels);
  EXPECT_EQ(again.mesh_textures.at(0).materials[0].u, TextureWrap::mirror);
  EXPECT_EQ(again.mesh_textures[0].corners, mine.mesh_textures[0].corners);
  const auto broken = [&](auto change) {
    World world = mine;
    change(world.textures[0], world.mesh_textures[0]);
    update_extent_and_hash(world);
    return sf::refusal_of([&] { from_snapshot(snapshot(world)); });
  };
  const char* const kRule = "a row breaks the rules of its table";
  expect_in(kRule, broken([](Texture& t, auto&) { t.rgb.pop_back(); }));
  expect_in(kRule, broken([](Texture& t, auto&) { t.width = 0, t.rgb.clear(); }));
  expect_in(kRule, broken([](auto&, MeshTextures& m) { m.corners.pop_back(); }));
  expect_in(kRule, broken([](auto&, MeshTextures& m) { m.corners[0].x = NAN; }));
  expect_in(kRule, broken([](auto&, MeshTextures& m) { m.materials.emplace_back(); }));
  expect_in("does not exist", broken([](auto&, MeshTextures& m) { m.mesh = 1; }));
  expect_in("does not exist", broken([](auto&, MeshTextures& m) { m.materials[0].texture = 1; }));
}

}  // namespace
}  // namespace sf::world
