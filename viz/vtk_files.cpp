#include "viz/vtk_files.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/plugin.h"
#include "viz/png.h"
#include "viz/vtk/plugin.h"

namespace sf::viz {

namespace {

void expect_written(bool written, const std::string& path) {
  if (!written)
    throw base::InputError(path, 0, "cannot be written; name a folder that exists, can be written and has room");
}

}  // namespace

const VtkPlugin& vtk_plugin() {
  static const auto* const loaded = static_cast<const VtkPlugin*>(
      base::load_plugin(kVtkSymbol, "no VTK file can be written and no window opened", "VTK 9.1 (Debian: libvtk9.1)"));
  return *loaded;
}

void write_poly_data(const PolyData& data, const std::string& path) {
  expect_written(vtk_plugin().write_poly_data(data, path), path);
}

void write_grid(const GridData& data, const std::string& path) {
  expect_written(vtk_plugin().write_grid(data, path), path);
}

void write_file_series(const std::vector<SeriesFile>& files, const std::string& path) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
  for (const SeriesFile& file : files)
    text += fmt::format("<DataSet timestep=\"{}\" file=\"{}\"/>\n", file.time, file.file);
  write_picture(path, text + "</Collection>\n</VTKFile>\n");
}

}  // namespace sf::viz
