#pragma once
// Reads tables of outlines from text in tests.

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "world/outlines.h"
#include "world/stage/properties.h"

namespace sf::world {

inline const std::string kSquare = "POLYGON ((0 0,12 0,12 8,0 8,0 0))";

struct TableRead {
  std::vector<Segment> walls;
  std::string warnings;  ///< "2: ...", one per line

  double area() const {
    double area = 0.0;
    for (const Segment& wall : walls) area += 0.5 * base::cross(wall.a, wall.b);
    return area;
  }
  std::string heights() const {  ///< of consecutive walls
    std::string text;
    for (std::size_t i = 0; i < walls.size(); ++i)
      if (i == 0 || walls[i].z_max != walls[i - 1].z_max) text += fmt::format("{} ", walls[i].z_max);
    return text;
  }
};

inline TableRead read_table_file(const std::string& file) {
  OutlineFile outlines;
  outlines.file = file;
  outlines.surface.z_max = 3.0;
  TableRead read;
  std::vector<Warning> warnings;
  read_outlines(
      outlines, [&](std::span<const Segment> more) { read.walls.insert(read.walls.end(), more.begin(), more.end()); },
      &warnings);
  for (const Warning& w : warnings) read.warnings += fmt::format("{}: {}\n", w.line, w.message);
  return read;
}

inline TableRead read_table(const std::string& text) {
  const std::string file = (std::filesystem::temp_directory_path() / "table.csv").string();
  std::ofstream(file, std::ios::binary) << text;
  return read_table_file(file);
}

}  // namespace sf::world
