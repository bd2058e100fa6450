#pragma once
// Writes geometry and images as VTK XML files (.vtp, .vti), which ParaView opens. VTK is in a plug-in
// (viz/vtk/plugin.h) that is loaded with the first file.

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace sf::viz {

/// Values per point or cell.
struct DataArray {
  std::string name;
  int width = 1;               ///< number of values per point or cell
  std::vector<double> values;  ///< `width` per point or cell
};

/// Points, and dots, lines and polygons that refer to them. Cell arrays contain the values of dots, then of lines, then
/// of polygons.
struct PolyData {
  std::vector<glm::dvec3> points;                   ///< [m] world frame
  std::vector<std::vector<std::int64_t>> dots;      ///< indices into `points`, one each
  std::vector<std::vector<std::int64_t>> lines;     ///< indices into `points`
  std::vector<std::vector<std::int64_t>> polygons;  ///< indices into `points`; planar, the first point is not repeated
  std::vector<DataArray> point_data, cell_data;
  std::vector<std::string> names;  ///< one per cell, written as array `name`; empty: none
};

/// Cells of a grid in the plane z = const, row by row from the lower left (-x, -y).
struct GridData {
  double x = 0.0, y = 0.0, z = 0.0;   ///< [m] lower left corner of the first cell
  double cell_x = 1.0, cell_y = 1.0;  ///< [m] > 0
  int columns = 1, rows = 1;
  std::vector<DataArray> cell_data;
};

/// Writes a `.vtp` or a `.vti` file. @throws base::InputError naming the path if it cannot be written.
void write_poly_data(const PolyData& data, const std::string& path);
void write_grid(const GridData& data, const std::string& path);

/// One file of a time series.
struct SeriesFile {
  double time = 0.0;  ///< [s]
  std::string file;   ///< relative to the folder of the series
};
/// Writes a `.pvd` file. @throws base::InputError naming the path if it cannot be written.
void write_file_series(const std::vector<SeriesFile>& files, const std::string& path);

}  // namespace sf::viz
