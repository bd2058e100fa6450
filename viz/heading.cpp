#include "viz/heading.h"

#include <string_view>

#include "viz/legend.h"

namespace sf::viz {
namespace {

// [px]
constexpr double kTitleLine = 36.0;
constexpr double kSubtitleLine = 26.0;

TextStyle title_style() {
  TextStyle style;
  style.size = 28;
  style.bold = true;
  return style;
}

TextStyle subtitle_style() {
  TextStyle style = small_text();
  style.size = 19;
  style.color = theme::kLabel;
  return style;
}

}  // namespace

std::string fitted_text(std::string text, const TextStyle& style, double width) {
  if (text_size(text, style).x <= width) return text;
  while (!text.empty() && text_size(text + "...", style).x > width) {
    while (text.size() > 1 && (static_cast<unsigned char>(text.back()) & 0xC0) == 0x80) text.pop_back();
    text.pop_back();
  }
  return text + "...";
}

std::string fitted_name(const std::string& name, const TextStyle& style, double width) {
  constexpr std::size_t kShortWord = 4;
  std::size_t end = name.rfind(' ');
  if (end == std::string::npos || name.size() - end > kShortWord + 1) return fitted_text(name, style, width);
  if (constexpr std::string_view kSensor = " sensor"; name.substr(0, end).ends_with(kSensor)) end -= kSensor.size();
  if (text_size(name, style).x <= width) return name;
  const std::string last = name.substr(end);
  return fitted_text(name.substr(0, end), style, width - text_size(last, style).x) + last;
}

std::vector<std::string> wrapped_text(const std::string& text, const TextStyle& style, double width) {
  std::vector<std::string> lines;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find(' ', from), text.size());
    const std::string word = text.substr(from, to - from);
    if (!lines.empty() && text_size(lines.back() + " " + word, style).x <= width)
      lines.back() += " " + word;
    else
      lines.push_back(fitted_text(word, style, width));
    from = to + 1;
  }
  return lines;
}

Heading make_heading(const std::string& title, const std::string& subtitle, double width, const Page& page) {
  Heading heading;
  if (page.title)
    heading = {wrapped_text(title, title_style(), width), wrapped_text(subtitle, subtitle_style(), width)};
  heading.edge = page_edge(page);
  heading.height = heading.edge + kTitleLine * static_cast<double>(heading.title.size()) +
                   kSubtitleLine * static_cast<double>(heading.subtitle.size());
  if (!heading.title.empty() || !heading.subtitle.empty()) heading.height += 12.0;
  return heading;
}

void draw_heading(Canvas& canvas, double left, const Heading& heading) {
  double y = heading.edge;
  for (const std::string& line : heading.title) {
    canvas.text({left, y + 0.45 * kTitleLine}, line, title_style());
    y += kTitleLine;
  }
  for (const std::string& line : heading.subtitle) {
    canvas.text({left, y + 0.57 * kSubtitleLine}, line, subtitle_style());
    y += kSubtitleLine;
  }
}

}  // namespace sf::viz
