#include "viz/vtk/convert.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>

namespace sf::viz {
namespace {

void add_arrays(vtkFieldData* to, const std::vector<DataArray>& arrays) {
  for (const DataArray& array : arrays) {
    vtkNew<vtkDoubleArray> values;
    values->SetName(array.name.c_str());
    values->SetNumberOfComponents(array.width);
    values->SetNumberOfTuples(static_cast<vtkIdType>(array.values.size()) / array.width);
    std::copy(array.values.begin(), array.values.end(), values->GetPointer(0));
    to->AddArray(values);
  }
}

vtkNew<vtkCellArray> cells_of(const std::vector<std::vector<std::int64_t>>& rows) {
  vtkNew<vtkCellArray> cells;
  for (const auto& row : rows) {
    cells->InsertNextCell(static_cast<int>(row.size()));
    for (const std::int64_t point : row) cells->InsertCellPoint(point);
  }
  return cells;
}

}  // namespace

vtkPolyData* new_poly_data(const PolyData& data) {
  vtkPolyData* const out = vtkPolyData::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const glm::dvec3& p : data.points) points->InsertNextPoint(p.x, p.y, p.z);
  out->SetPoints(points);
  out->SetVerts(cells_of(data.dots));
  out->SetLines(cells_of(data.lines));
  out->SetPolys(cells_of(data.polygons));
  add_arrays(out->GetPointData(), data.point_data);
  add_arrays(out->GetCellData(), data.cell_data);
  if (data.names.empty()) return out;
  vtkNew<vtkStringArray> names;
  names->SetName("name");
  for (const std::string& name : data.names) names->InsertNextValue(name);
  out->GetCellData()->AddArray(names);
  return out;
}

vtkImageData* new_image(const GridData& grid) {
  vtkImageData* const out = vtkImageData::New();
  out->SetOrigin(grid.x, grid.y, grid.z);
  out->SetSpacing(grid.cell_x, grid.cell_y, 1.0);
  out->SetDimensions(grid.columns + 1, grid.rows + 1, 1);  // corners of cells
  add_arrays(out->GetCellData(), grid.cell_data);
  return out;
}

}  // namespace sf::viz
