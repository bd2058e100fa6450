// The plug-in for VTK's files.

#include "viz/vtk_files.h"

#include <vtkXMLImageDataWriter.h>
#include <vtkXMLPolyDataWriter.h>

#include "viz/vtk_convert.h"

namespace sf::viz {
namespace {

template <class Writer, class Data>
bool write_data(Data* data, const std::string& path) {
  vtkNew<Writer> writer;
  writer->SetInputData(data);
  writer->SetFileName(path.c_str());
  writer->SetDataModeToAppended();
  return writer->Write() == 1 && writer->GetErrorCode() == 0;
}

bool poly_data_file(const PolyData& data, const std::string& path) {
  vtkObject::GlobalWarningDisplayOff();  // the caller reports
  return write_data<vtkXMLPolyDataWriter>(poly_data_of(data).Get(), path);
}

bool grid_file(const GridData& grid, const std::string& path) {
  vtkObject::GlobalWarningDisplayOff();
  return write_data<vtkXMLImageDataWriter>(image_of(grid).Get(), path);
}

}  // namespace
}  // namespace sf::viz

extern "C" {
extern const sf::viz::VtkFiles sensorfarm_vtk_files;
const sf::viz::VtkFiles sensorfarm_vtk_files{sf::viz::poly_data_file, sf::viz::grid_file};
}
