#include "viz/svg.h"

#include <fmt/format.h>

#include "base/png.h"

namespace sf::viz {
namespace {

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[word >> (18 - 6 * k) & 63u];
  }
  return text;
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&' || c == '<' || c == '>')
      out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : "&gt;";
    else
      out += c;
  }
  return out;
}

/// `fill="#rrggbb"`, with an opacity if the colour is not opaque.
std::string paint(const char* what, std::uint32_t color) {
  std::string text = fmt::format(" {}=\"#{:06x}\"", what, color & 0xFFFFFFu);
  if (color >> 24 != 0xFF) text += fmt::format(" {}-opacity=\"{:.3g}\"", what, (color >> 24) / 255.0);
  return text;
}

/// Rounds to hundredths of a layout pixel, 1.4 micrometres.
std::string number(double value) {
  std::string text = fmt::format("{:.2f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string path_data(const Paths& paths, bool closed) {
  std::string text;
  for (const auto& path : paths) {
    char command = 'M';
    for (const glm::dvec2& p : path) {
      text += fmt::format("{}{} {}", command, number(p.x), number(p.y));
      command = 'L';
    }
    if (path.size() == 1) text += "h0";
    if (closed) text += 'Z';
  }
  return text;
}

struct SvgWriter {
  std::string out;
  int clips = 0;

  void operator()(const Clip& clip) {
    const PixelBox& b = clip.box;
    if (clips > 0) out += "</g>\n";
    ++clips;
    out += fmt::format("<clipPath id=\"c{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n", clips,
                       b.x_min, b.y_min, std::max(b.x_max - b.x_min, 0), std::max(b.y_max - b.y_min, 0));
    out += fmt::format("<g clip-path=\"url(#c{})\">\n", clips);
  }
  void operator()(const Stroke& s) {
    out += fmt::format("<path d=\"{}\"{} stroke-width=\"{}\"", path_data(s.paths, false), paint("stroke", s.color),
                       number(s.width));
    if (!s.dash.empty()) out += fmt::format(" stroke-dasharray=\"{:g}\"", fmt::join(s.dash, " "));
    out += "/>\n";
  }
  void operator()(const Fill& f) {
    out += fmt::format("<path d=\"{}\"{} stroke=\"none\"/>\n", path_data(f.paths, true), paint("fill", f.color));
  }
  void operator()(const Lettering& t) {
    out += fmt::format("<text x=\"{0}\" y=\"{1}\" font-size=\"{2}\"{3}", number(t.at.x), number(t.at.y), t.size,
                       paint("fill", t.color));
    if (t.bold) out += " font-weight=\"bold\"";
    if (t.upwards) out += fmt::format(" transform=\"rotate(-90 {} {})\"", number(t.at.x), number(t.at.y));
    if (t.halo >> 24)
      out += fmt::format("{} stroke-width=\"{}\" paint-order=\"stroke\"", paint("stroke", t.halo), kHaloWidth);
    out += ">" + escaped(t.text) + "</text>\n";
  }
  void operator()(const CellImage& cells) {
    std::vector<std::uint8_t> rgb;
    for (const std::uint32_t color : cells.colors)
      for (const int shift : {16, 8, 0}) rgb.push_back(static_cast<std::uint8_t>(color >> shift));
    out += fmt::format(
        "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" "
        "style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/>\n",
        number(cells.from.x), number(cells.from.y), number(cells.to.x - cells.from.x),
        number(cells.to.y - cells.from.y), base64(base::encode_png(rgb, cells.columns, cells.rows)));
  }
};

}  // namespace

std::string to_svg(const Drawing& drawing, double scale) {
  SvgWriter writer;
  writer.out = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{2:.2f}mm\" height=\"{3:.2f}mm\" viewBox=\"0 0 {0} {1}\" "
      "fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" font-family=\"'DejaVu Sans', sans-serif\" "
      "xml:space=\"preserve\">\n<rect width=\"{0}\" height=\"{1}\"{4}/>\n",
      drawing.width, drawing.height, scale * drawing.width / kPixelsPerMillimetre,
      scale * drawing.height / kPixelsPerMillimetre, paint("fill", drawing.background));
  for (const Shape& shape : drawing.shapes) std::visit(writer, shape);
  return writer.out + (writer.clips > 0 ? "</g>\n</svg>\n" : "</svg>\n");
}

}  // namespace sf::viz
