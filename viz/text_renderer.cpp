// The plug-in, the only source that includes VTK. Needs neither a display nor OpenGL.

#include "viz/text_renderer.h"

#include <vtkFreeTypeTools.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkStdString.h>
#include <vtkTextProperty.h>

namespace sf::viz {
namespace {

constexpr int kDotsPerInch = 72;  // makes one point of VTK's font size one pixel

/// VTK's first row is the bottom row, and its last component is alpha.
bool render(const TextRun& letters, GlyphBitmap& out) {
  vtkNew<vtkTextProperty> property;
  property->SetFontFamilyToArial();
  if (!letters.font_file.empty()) {
    property->SetFontFamily(VTK_FONT_FILE);
    property->SetFontFile(letters.font_file.c_str());
  }
  property->SetFontSize(letters.size);
  property->SetBold(letters.bold);
  property->SetOrientation(letters.upwards ? 90.0 : 0.0);
  property->SetColor(1.0, 1.0, 1.0);
  vtkFreeTypeTools* fonts = vtkFreeTypeTools::GetInstance();
  fonts->ScaleToPowerTwoOff();
  vtkNew<vtkImageData> image;
  int size[2] = {0, 0};
  if (!fonts->RenderString(property, letters.text, kDotsPerInch, image, size)) return false;
  const int* extent = image->GetExtent();
  const int parts = image->GetNumberOfScalarComponents();
  out.width = extent[1] - extent[0] + 1;
  out.height = extent[3] - extent[2] + 1;
  out.coverage.clear();
  for (int j = extent[3]; j >= extent[2]; --j)
    for (int i = extent[0]; i <= extent[1]; ++i)
      out.coverage.push_back(static_cast<const std::uint8_t*>(image->GetScalarPointer(i, j, 0))[parts - 1]);
  return true;
}

}  // namespace
}  // namespace sf::viz

extern "C" {
extern const sf::viz::TextRenderer sensorfarm_text_renderer;
const sf::viz::TextRenderer sensorfarm_text_renderer{sf::viz::render};
}
