#include "world/foreign_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>

#include "base/error.h"

namespace sf::world {

namespace {

struct ForeignKind {
  std::string_view mark;  ///< root element of an XML file, or first bytes of any other file
  std::string_view program;
  std::string_view how;
};

constexpr std::string_view kModels =
    "write its solids as model( size [x y z] pose [x y z yaw] ), or their outlines as well-known text for `outlines`";
constexpr std::string_view kMeshes = "name it in a model of a world file: model( mesh \"FILE\" size [x y z] )";
constexpr std::string_view kClouds =
    "project its points onto a picture, dark where they are, and name that by `bitmap` or in the .yaml of a ROS map";
constexpr std::string_view kGazebo =
    "save an occupancy map of it (such as by its plug-in libgazebo_2Dmap_plugin.so, or by map_saver after a drive) and "
    "load the map's .yaml, or write each box as model( size [x y z] pose [x y z yaw] )";

constexpr std::string_view kMujoco =
    "write each geom of type box, whose size is half of its sides, as model( size [x y z] pose [x y z yaw] )";

// XML world files.
constexpr auto kElements = std::to_array<ForeignKind>({
    {"sdf", "Gazebo (SDFormat)", kGazebo},
    {"gazebo", "Gazebo (SDFormat)", kGazebo},
    {"gazebo:world", "Gazebo", kGazebo},
    {"mvsim_world", "MVSim",
     "load the map that its <element class=\"occupancy_grid\"> names (a ROS .yaml; a picture goes into `bitmap`), and "
     "write the <shape> of each <block> as block( points ... ) of a model"},
    {"argos-configuration", "ARGoS",
     "write each <box size=\"x,y,z\"> of its <arena> as model( size [x y z] pose [x y z yaw] )"},
    {"mujoco", "MuJoCo (MJCF)", kMujoco},
    {"mujocoinclude", "MuJoCo (MJCF)", kMujoco},
    {"robot", "URDF, which describes one robot",
     "name it in a world file: position( mesh \"FILE\" ), with laser( ) or lidar( ) for its sensors"},
    {"launch", "ROS (a launch file)", "load the world or the map's .yaml that it names"},
    {"osm", "OpenStreetMap",
     "export its buildings as a table with well-known text (ogr2ogr -f CSV -lco GEOMETRY=AS_WKT -t_srs EPSG:...) and "
     "name it by `outlines`"},
    {"OpenDRIVE", "OpenDRIVE", "write its road as path( ... ), or its network as an RNDF for road( rndf \"FILE\" )"},
    {"COLLADA", "COLLADA", kMeshes},
    {"svg", "a drawing program (SVG)", "export it as PNG and name it by `bitmap`"},
});

// Other files, by their first bytes.
constexpr auto kBeginnings = std::to_array<ForeignKind>({
    {"#VRML_SIM", "Webots",
     "write each Box of its Solids as model( size [x y z] pose [x y z yaw] ), or save a map by "
     "map_saver after a drive and load its .yaml"},
    {"#VRML ", "VRML", kModels},
    {"#X3D ", "X3D", kModels},
    {"#usda ", "Universal Scene Description", kModels},
    {"PXR-USDC", "Universal Scene Description", kModels},
    {"glTF", "glTF", kMeshes},
    {"ply\n", "PLY", kMeshes},
    {"ply\r", "PLY", kMeshes},
    {"# .PCD ", "point clouds (PCD)", kClouds},
    {"VERSION .7", "point clouds (PCD)", kClouds},
    {"VERSION 0.7", "point clouds (PCD)", kClouds},
});

constexpr auto kPictures = std::to_array<std::string_view>(
    {"\x89PNG", "\xFF\xD8\xFF", "GIF8", "P1\n", "P2\n", "P3\n", "P4\n", "P5\n", "P6\n", "P5 ", "P6 "});
constexpr auto kGeometry = std::to_array<std::string_view>(
    {"POLYGON", "MULTIPOLYGON", "LINESTRING", "MULTILINESTRING", "GEOMETRYCOLLECTION", "SRID=", "WKT,", "\"WKT\","});

bool contains(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

void skip_blanks(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

// Finds the end of a <!DOCTYPE>, whose subset in brackets and quotes may contain '>'.
std::size_t end_of_doctype(std::string_view text) {
  int brackets = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '"' || c == '\'') at = std::min(text.find(c, at + 1), text.size() - 1);
    brackets += c == '[' ? 1 : c == ']' ? -1 : 0;
    if (c == '>' && brackets == 0) return at + 1;
  }
  return std::string_view::npos;
}

// Returns the root element, after declarations and comments; empty if the text is not XML.
std::string_view root_element(std::string_view text) {
  for (skip_blanks(text); text.starts_with("<?") || text.starts_with("<!"); skip_blanks(text)) {
    const std::string_view end = text.starts_with("<!--") ? "-->" : "?>";
    std::size_t at = text.starts_with("<!D") ? end_of_doctype(text) : text.find(end);
    if (at == std::string_view::npos) return {};
    if (!text.starts_with("<!D")) at += end.size();
    text.remove_prefix(at);
  }
  if (!text.starts_with('<')) return {};
  text.remove_prefix(1);
  return text.substr(0, text.find_first_of(" \t\r\n/>"));
}

void refuse_xml(const std::string& file, std::string_view text) {
  const std::string_view root = root_element(text);
  if (root.empty()) return;
  for (const ForeignKind& kind : kElements)
    if (root == kind.mark) refuse_world_of(file, 0, kind.program, kind.how);
  throw base::InputError(file, 0,
                         fmt::format("is XML with the root <{}>, which belongs to no known simulator; expected a Stage "
                                     "world or the .yaml of a ROS map: {}",
                                     root.substr(0, 40), kModels));
}

template <class Marks>
bool begins_with(std::string_view text, const Marks& marks) {
  return std::any_of(marks.begin(), marks.end(), [&](std::string_view mark) { return text.starts_with(mark); });
}

[[noreturn]] void refuse_outlines(const std::string& file) {
  throw base::InputError(file, 0,
                         "seems to be a file of outlines (well-known text, CSV or GeoJSON); expected a world: include "
                         "it with model( outlines \"FILE\" size [0 0 HEIGHT] )");
}

void refuse_yaml(const std::string& file, std::string_view text) {
  if (contains(text, "unity3d.com")) refuse_world_of(file, 0, "Unity", kModels);
  throw base::InputError(file, 0, "is YAML; expected a Stage world, or a ROS map in a file that ends in .yaml");
}

// Rejects JSON texts: geometries, scenes and others.
void refuse_json(const std::string& file, std::string_view text) {
  if (contains(text, "\"coordinates\"") || contains(text, "\"FeatureCollection\"") || contains(text, "\"Topology\""))
    refuse_outlines(file);
  if (contains(text, "\"asset\"") && (contains(text, "\"version\"") || contains(text, "\"meshes\"")))
    refuse_world_of(file, 0, "glTF", kMeshes);
  throw base::InputError(
      file, 0,
      fmt::format("is JSON of no known program; expected a Stage world or the .yaml of a ROS map: {}", kModels));
}

// Wavefront OBJ: starts with one of its words after comments, and has a vertex somewhere.
bool is_obj(std::string_view text) {
  constexpr auto kWords = std::to_array<std::string_view>({"mtllib ", "usemtl ", "o ", "g ", "v ", "vn ", "vt ", "s "});
  for (skip_blanks(text); text.starts_with('#'); skip_blanks(text))
    text.remove_prefix(std::min(text.find('\n'), text.size()));
  if (!begins_with(text, kWords)) return false;
  const std::size_t vertex = text.starts_with("v ") ? 0 : text.find("\nv ");
  if (vertex == std::string_view::npos) return false;
  const std::string_view line = text.substr(vertex + (vertex > 0 ? 1 : 0)).substr(0, 80);
  return std::count(line.begin(), line.begin() + std::min(line.find('\n'), line.size()), ' ') >= 3;
}

// Text, or binary: a header of 80 bytes, the number of triangles, and 50 bytes for each.
bool is_stl(std::string_view text) {
  if (text.starts_with("solid") && (contains(text, "facet normal") || contains(text, "endsolid"))) return true;
  if (text.size() < 84) return false;
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, text.data() + 80, sizeof(triangles));
  return text.size() == 84 + 50 * std::size_t{triangles};
}

// Returns the ASCII characters of a UTF-16 text; empty for any other text.
std::string ascii_of_utf16(std::string_view text) {
  const bool is_little = text.starts_with("\xFF\xFE") || text.starts_with(std::string_view("<\0", 2));
  const bool is_big = text.starts_with("\xFE\xFF") || text.starts_with(std::string_view("\0<", 2));
  std::string ascii;
  for (std::size_t i = is_little ? 0 : 1; (is_little || is_big) && i < text.size(); i += 2) {
    const std::size_t other = is_little ? i + 1 : i - 1;
    if (other < text.size() && text[other] == '\0') ascii += text[i];
  }
  return ascii;
}

}  // namespace

void refuse_world_of(const std::string& file, int line, std::string_view program, std::string_view how) {
  throw base::InputError(file, line,
                         fmt::format("is a file of {}; expected a Stage world or the .yaml of a ROS map. To use its "
                                     "geometry, {} (docs/worlds.md, Worlds of other simulators)",
                                     program, how));
}

void refuse_foreign(const std::string& file, std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (const std::string ascii = ascii_of_utf16(text); !ascii.empty()) {
    refuse_foreign(file, ascii);
    throw base::InputError(file, 0, "is UTF-16 text: save it as UTF-8");
  }
  if (begins_with(text, kPictures))
    throw base::InputError(file, 0,
                           "is a picture; expected a world: include it with model( bitmap \"FILE\" size [x y z] ), or "
                           "as `image` in the .yaml of a ROS map");
  if (is_stl(text)) refuse_world_of(file, 0, "STL", kMeshes);
  skip_blanks(text);
  for (const ForeignKind& kind : kBeginnings)
    if (text.starts_with(kind.mark)) refuse_world_of(file, 1, kind.program, kind.how);
  if (is_obj(text)) refuse_world_of(file, 0, "Wavefront OBJ", kMeshes);
  if (text.starts_with("%YAML") || text.starts_with("---")) refuse_yaml(file, text);
  if (begins_with(text, kGeometry)) refuse_outlines(file);
  if (text.starts_with('{')) refuse_json(file, text);
  refuse_xml(file, text);
}

}  // namespace sf::world
