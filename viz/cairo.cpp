// The drawing plug-in, the only source that includes Cairo and FreeType.

#include <cairo-ft.h>
#include <cairo-pdf.h>
#include <cairo.h>

#include <algorithm>

#include <cmath>
#include <memory>

#include "viz/drawing_backend.h"

namespace sf::viz {
namespace {

constexpr double kPoints = 72.0;  // per inch

using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;
using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;

/// Loads DejaVu from its file, which avoids a search of the system's fonts. Falls back to the system's sans-serif.
cairo_font_face_t* load_face(bool bold) {
  static FT_Library library = nullptr;
  FT_Face face = nullptr;
  const char* file =
      bold ? "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf" : "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
  if ((library != nullptr || FT_Init_FreeType(&library) == 0) && FT_New_Face(library, file, 0, &face) == 0)
    return cairo_ft_font_face_create_for_ft_face(face, 0);
  return cairo_toy_font_face_create("sans-serif", CAIRO_FONT_SLANT_NORMAL,
                                    bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
}

void set_font(cairo_t* to, const Lettering& text) {
  static cairo_font_face_t* const regular = load_face(false);
  static cairo_font_face_t* const heavy = load_face(true);
  cairo_set_font_face(to, text.bold ? heavy : regular);
  cairo_set_font_size(to, text.size);
  // Disable hinting, so that letters have the same shape on every machine, at every resolution and in every file
  // format.
  const std::unique_ptr<cairo_font_options_t, decltype(&cairo_font_options_destroy)> options(
      cairo_font_options_create(), &cairo_font_options_destroy);
  cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_set_font_options(to, options.get());
}

double text_width(const Lettering& text) {
  static const Surface page(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1), &cairo_surface_destroy);
  static const Context to(cairo_create(page.get()), &cairo_destroy);
  set_font(to.get(), text);
  cairo_text_extents_t extents{};
  cairo_text_extents(to.get(), text.text.c_str(), &extents);
  return extents.x_advance;
}

void set_color(cairo_t* to, std::uint32_t color) {
  const auto part = [&](int shift) { return ((color >> shift) & 0xFFu) / 255.0; };
  cairo_set_source_rgba(to, part(16), part(8), part(0), part(24));
}

void add_paths(cairo_t* to, const Paths& paths, bool closed) {
  for (const auto& path : paths) {
    cairo_move_to(to, path.front().x, path.front().y);
    for (const glm::dvec2& p : path) cairo_line_to(to, p.x, p.y);
    if (closed) cairo_close_path(to);
  }
}

/// Paints shapes onto a page. `scale` is the number of page pixels per layout pixel; 0 for vector formats.
struct Painter {
  cairo_t* to;
  double scale;

  void operator()(const Clip& clip) const {
    cairo_reset_clip(to);
    const PixelBox& b = clip.box;
    cairo_rectangle(to, b.x_min, b.y_min, std::max(b.x_max - b.x_min, 0), std::max(b.y_max - b.y_min, 0));
    cairo_clip(to);
  }
  void operator()(const Stroke& stroke) const {
    add_paths(to, stroke.paths, false);
    cairo_set_line_width(to, stroke.width);
    set_color(to, stroke.color);
    cairo_set_dash(to, stroke.dash.data(), static_cast<int>(stroke.dash.size()), 0.0);
    cairo_stroke(to);
    cairo_set_dash(to, nullptr, 0, 0.0);
  }
  void operator()(const Fill& fill) const {
    add_paths(to, fill.paths, true);
    set_color(to, fill.color);
    cairo_fill(to);
  }
  void operator()(const Lettering& text) const {
    set_font(to, text);
    cairo_save(to);
    cairo_translate(to, text.at.x, text.at.y);
    if (text.upwards) cairo_rotate(to, -0.5 * M_PI);
    if (text.halo >> 24) {
      cairo_move_to(to, 0.0, 0.0);
      cairo_text_path(to, text.text.c_str());
      cairo_set_line_width(to, kHaloWidth);
      set_color(to, text.halo);
      cairo_stroke(to);
    }
    cairo_move_to(to, 0.0, 0.0);
    set_color(to, text.color);
    cairo_show_text(to, text.text.c_str());
    cairo_restore(to);
  }
  void operator()(const CellImage& cells) const;
};

/// Cells larger than a pixel keep sharp edges; smaller ones are averaged. Cells that are smaller along only one side
/// are repeated along the other, since filters have no direction.
void Painter::operator()(const CellImage& cells) const {
  glm::dvec2 cell{(cells.to.x - cells.from.x) / cells.columns, (cells.to.y - cells.from.y) / cells.rows};
  const bool large = scale * std::min(cell.x, cell.y) >= 1.0 || scale == 0.0;
  const auto repeats = [&](double size) {
    return large ? std::size_t{1} : static_cast<std::size_t>(std::max(1.0, scale * size));
  };
  const std::size_t wide = repeats(cell.x), high = repeats(cell.y), row = static_cast<std::size_t>(cells.columns);
  const std::size_t columns = wide * row, rows = high * static_cast<std::size_t>(cells.rows);
  cell = {cell.x / static_cast<double>(wide), cell.y / static_cast<double>(high)};
  const Surface image(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(columns), static_cast<int>(rows)),
                      &cairo_surface_destroy);
  if (cairo_surface_status(image.get()) != CAIRO_STATUS_SUCCESS) return;
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(image.get()));
  for (std::size_t j = 0; j < rows; ++j) {
    auto* to_row = reinterpret_cast<std::uint32_t*>(cairo_image_surface_get_data(image.get()) + j * stride);
    for (std::size_t i = 0; i < columns; ++i) to_row[i] = cells.colors[j / high * row + i / wide];
  }
  cairo_surface_mark_dirty(image.get());
  cairo_save(to);
  cairo_translate(to, cells.from.x, cells.from.y);
  cairo_scale(to, cell.x, cell.y);
  cairo_set_source_surface(to, image.get(), 0.0, 0.0);
  cairo_pattern_set_filter(cairo_get_source(to), large ? CAIRO_FILTER_NEAREST : CAIRO_FILTER_GOOD);
  cairo_pattern_set_extend(cairo_get_source(to), CAIRO_EXTEND_PAD);
  cairo_rectangle(to, 0.0, 0.0, static_cast<double>(columns), static_cast<double>(rows));
  cairo_fill(to);
  cairo_restore(to);
}

/// Returns false if a shape could not be painted.
bool paint(cairo_t* to, const Drawing& drawing, double scale) {
  cairo_set_line_cap(to, CAIRO_LINE_CAP_ROUND);
  cairo_set_line_join(to, CAIRO_LINE_JOIN_ROUND);
  set_color(to, drawing.background);
  cairo_paint(to);
  for (const Shape& shape : drawing.shapes) std::visit(Painter{to, scale}, shape);
  return cairo_status(to) == CAIRO_STATUS_SUCCESS;
}

bool pixels(const Drawing& drawing, double scale, std::vector<std::uint8_t>& rgb) {
  const auto side = [&](int length) { return static_cast<int>(std::ceil(length * scale - 1e-6)); };
  const int width = side(drawing.width), height = side(drawing.height);
  const Surface page(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height), &cairo_surface_destroy);
  const Context to(cairo_create(page.get()), &cairo_destroy);
  cairo_scale(to.get(), scale, scale);
  if (!paint(to.get(), drawing, scale)) return false;
  cairo_surface_flush(page.get());
  rgb.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::uint8_t* out = rgb.data();
  for (int j = 0; j < height; ++j) {
    const auto* row = reinterpret_cast<const std::uint32_t*>(cairo_image_surface_get_data(page.get()) +
                                                             static_cast<std::ptrdiff_t>(j) *
                                                                 cairo_image_surface_get_stride(page.get()));
    for (int i = 0; i < width; ++i)
      for (const int shift : {16, 8, 0}) *out++ = static_cast<std::uint8_t>(row[i] >> shift);
  }
  return true;
}

cairo_status_t append(void* to, const unsigned char* bytes, unsigned count) {
  static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

bool pdf(const Drawing& drawing, double scale, std::string& bytes) {
  const double points = scale * kPoints / kPixelsPerInch;  // per layout pixel
  const Surface page(
      cairo_pdf_surface_create_for_stream(append, &bytes, drawing.width * points, drawing.height * points),
      &cairo_surface_destroy);
  // No date, so that equal figures are equal files.
  cairo_pdf_surface_set_metadata(page.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  {
    const Context to(cairo_create(page.get()), &cairo_destroy);
    cairo_scale(to.get(), points, points);
    if (!paint(to.get(), drawing, 0.0)) return false;
    cairo_show_page(to.get());
  }
  cairo_surface_finish(page.get());
  return cairo_surface_status(page.get()) == CAIRO_STATUS_SUCCESS;
}

}  // namespace
}  // namespace sf::viz

extern "C" {
extern const sf::viz::DrawingBackend sensorfarm_cairo;
const sf::viz::DrawingBackend sensorfarm_cairo{sf::viz::text_width, sf::viz::pixels, sf::viz::pdf};
}
