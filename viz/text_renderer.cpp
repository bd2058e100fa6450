// The module: the one source that knows VTK. Nothing here opens a window or asks for OpenGL.

#include "viz/text_renderer.h"

#include <vtkFreeTypeTools.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>

namespace sf::viz {
namespace {

constexpr int kDotsPerInch = 72;  // so that a point of VTK's font size is a pixel

/// VTK's first row is the lowest one, and its last component the alpha.
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

bool encode_png(const std::uint8_t* rgb, int width, int height, std::vector<std::uint8_t>& out) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(width, height, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  const std::size_t row = 3 * static_cast<std::size_t>(width);
  for (int y = 0; y < height; ++y)
    std::copy_n(rgb + row * static_cast<std::size_t>(y), row,
                static_cast<std::uint8_t*>(image->GetScalarPointer(0, height - 1 - y, 0)));
  // VTK's writer prints its own errors, so it writes to memory and the file is the canvas's.
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->WriteToMemoryOn();
  writer->SetCompressionLevel(6);
  writer->Write();
  vtkUnsignedCharArray* png = writer->GetResult();
  if (png == nullptr || png->GetNumberOfValues() <= 0) return false;
  const unsigned char* first = png->GetPointer(0);
  out.assign(first, first + png->GetNumberOfValues());
  return true;
}

}  // namespace
}  // namespace sf::viz

extern "C" {
extern const sf::viz::TextRenderer sensorfarm_text_renderer;
const sf::viz::TextRenderer sensorfarm_text_renderer{sf::viz::render, sf::viz::encode_png};
}
