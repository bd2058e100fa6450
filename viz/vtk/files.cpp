#include <vtkImageData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkXMLPolyDataWriter.h>

#include "viz/vtk/convert.h"
#include "viz/vtk/plugin.h"

namespace sf::viz {
namespace {

template <class Writer>
bool write_data(vtkDataObject* data, const std::string& path) {
  vtkObject::GlobalWarningDisplayOff();  // the caller reports errors
  vtkNew<Writer> writer;
  writer->SetInputData(data);
  writer->SetFileName(path.c_str());
  writer->SetDataModeToAppended();
  return writer->Write() == 1 && writer->GetErrorCode() == 0;
}

}  // namespace

bool poly_data_file(const PolyData& data, const std::string& path) {
  return write_data<vtkXMLPolyDataWriter>(vtkSmartPointer<vtkPolyData>::Take(new_poly_data(data)), path);
}

bool grid_file(const GridData& grid, const std::string& path) {
  return write_data<vtkXMLImageDataWriter>(vtkSmartPointer<vtkImageData>::Take(new_image(grid)), path);
}

}  // namespace sf::viz

extern "C" {
extern const sf::viz::VtkPlugin sensorfarm_vtk;
const sf::viz::VtkPlugin sensorfarm_vtk{sf::viz::poly_data_file, sf::viz::grid_file, sf::viz::show_scene};
}
