#include "world/foreign_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "base/error.h"

namespace sf::world {

namespace {

struct Kind {
  std::string_view mark;  ///< the root element of an XML file, or the first bytes of any other
  std::string_view program;
  std::string_view how;
};

constexpr std::string_view kModels =
    "write its solids as model( size [x y z] pose [x y z yaw] ), or their outlines as well-known text for `outlines`";
constexpr std::string_view kGazebo =
    "save an occupancy map of it (such as by its plug-in libgazebo_2Dmap_plugin.so, or by map_saver after a drive) and "
    "load the map's .yaml, or write each box as model( size [x y z] pose [x y z yaw] )";

// World files that are XML.
constexpr auto kElements = std::to_array<Kind>({
    {"sdf", "Gazebo (SDFormat)", kGazebo},
    {"gazebo", "Gazebo (SDFormat)", kGazebo},
    {"gazebo:world", "Gazebo", kGazebo},
    {"mvsim_world", "MVSim",
     "load the map that its <element class=\"occupancy_grid\"> names (a ROS .yaml; a picture goes into `bitmap`), and "
     "write the <shape> of each <block> as block( points ... ) of a model"},
    {"argos-configuration", "ARGoS",
     "write each <box size=\"x,y,z\"> of its <arena> as model( size [x y z] pose [x y z yaw] )"},
    {"mujoco", "MuJoCo (MJCF)",
     "write each geom of type box, whose size is half of its sides, as model( size [x y z] pose [x y z yaw] )"},
    {"robot", "URDF, which describes one robot",
     "write its collision shapes as block( ... ) of a position( ), with laser( ) or ranger( ) for its sensors"},
    {"launch", "ROS (a launch file)", "load the world or the map's .yaml that it names"},
    {"osm", "OpenStreetMap",
     "export its buildings as a table with well-known text (ogr2ogr -f CSV -lco GEOMETRY=AS_WKT -t_srs EPSG:...) and "
     "name it by `outlines`"},
    {"OpenDRIVE", "OpenDRIVE", "write its road as path( ... ), or its network as an RNDF for road( rndf \"FILE\" )"},
    {"COLLADA", "COLLADA", kModels},
    {"svg", "a drawing program (SVG)", "export it as PNG and name it by `bitmap`"},
});

// Other files, by their first bytes.
constexpr auto kBeginnings = std::to_array<Kind>({
    {"#VRML_SIM", "Webots",
     "write each Box of its Solids as model( size [x y z] pose [x y z yaw] ), or save a map by "
     "map_saver after a drive and load its .yaml"},
    {"#VRML ", "VRML", kModels},
    {"#X3D ", "X3D", kModels},
    {"#usda ", "Universal Scene Description", kModels},
    {"PXR-USDC", "Universal Scene Description", kModels},
    {"glTF", "glTF", kModels},
});

constexpr auto kPictures = std::to_array<std::string_view>(
    {"\x89PNG", "\xFF\xD8\xFF", "GIF8", "P1\n", "P2\n", "P3\n", "P4\n", "P5\n", "P6\n", "P5 ", "P6 "});
constexpr auto kGeometry = std::to_array<std::string_view>(
    {"POLYGON", "MULTIPOLYGON", "LINESTRING", "MULTILINESTRING", "GEOMETRYCOLLECTION", "SRID=", "WKT,", "\"WKT\","});

void skip_blanks(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

// Behind declarations and comments; empty for a text that is not XML.
std::string_view root_element(std::string_view text) {
  for (skip_blanks(text); text.starts_with("<?") || text.starts_with("<!"); skip_blanks(text)) {
    const std::string_view end = text.starts_with("<!--") ? "-->" : text.starts_with("<?") ? "?>" : ">";
    const std::size_t at = text.find(end);
    if (at == std::string_view::npos) return {};
    text.remove_prefix(at + end.size());
  }
  if (!text.starts_with('<')) return {};
  text.remove_prefix(1);
  return text.substr(0, text.find_first_of(" \t\r\n/>"));
}

void refuse_xml(const std::string& file, std::string_view text) {
  const std::string_view root = root_element(text);
  if (root.empty()) return;
  for (const Kind& kind : kElements)
    if (root == kind.mark) refuse_world_of(file, 0, kind.program, kind.how);
  throw base::InputError(
      file, 0,
      fmt::format(
          "is XML with the root <{}>, of no known simulator; expected a Stage world or the .yaml of a ROS map: {}",
          root.substr(0, 40), kModels));
}

template <class Marks>
bool begins_with(std::string_view text, const Marks& marks) {
  return std::any_of(marks.begin(), marks.end(), [&](std::string_view mark) { return text.starts_with(mark); });
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
  if (begins_with(text, kPictures))
    throw base::InputError(file, 0,
                           "is a picture; expected a world: name it by model( bitmap \"FILE\" size [x y z] ), or as "
                           "`image` in the .yaml of a ROS map");
  for (const Kind& kind : kBeginnings)
    if (text.starts_with(kind.mark)) refuse_world_of(file, 1, kind.program, kind.how);
  skip_blanks(text);
  if (begins_with(text, kGeometry) || text.starts_with('{'))
    throw base::InputError(file, 0,
                           "seems to be a file of outlines (well-known text, CSV or GeoJSON); expected a world: name "
                           "it by model( outlines \"FILE\" size [0 0 HEIGHT] )");
  refuse_xml(file, text);
}

}  // namespace sf::world
