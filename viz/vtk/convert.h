#pragma once
// Converts plain tables to VTK objects, which the caller owns.

#include "viz/vtk_files.h"

class vtkImageData;
class vtkPolyData;

namespace sf::viz {

vtkPolyData* new_poly_data(const PolyData& data);
vtkImageData* new_image(const GridData& grid);

}  // namespace sf::viz
