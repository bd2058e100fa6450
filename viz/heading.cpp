#include "viz/heading.h"

#include "viz/legend.h"

namespace sf::viz {
namespace {

// [px]
constexpr double kMargin = 26.0;
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

/// `text` shortened until it is at most `width` [px] wide.
std::string fitted(std::string text, const TextStyle& style, double width) {
  if (text_size(text, style).x <= width) return text;
  while (!text.empty() && text_size(text + "...", style).x > width) text.pop_back();
  return text + "...";
}

std::vector<std::string> wrapped(const std::string& text, const TextStyle& style, double width) {
  std::vector<std::string> lines;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find(' ', from), text.size());
    const std::string word = text.substr(from, to - from);
    if (!lines.empty() && text_size(lines.back() + " " + word, style).x <= width)
      lines.back() += " " + word;
    else
      lines.push_back(fitted(word, style, width));
    from = to + 1;
  }
  return lines;
}

}  // namespace

Heading make_heading(const std::string& title, const std::string& subtitle, double width, const Page& page) {
  Heading heading;
  if (page.title) heading = {wrapped(title, title_style(), width), wrapped(subtitle, subtitle_style(), width), 0.0};
  heading.height = kMargin + kTitleLine * static_cast<double>(heading.title.size()) +
                   kSubtitleLine * static_cast<double>(heading.subtitle.size());
  if (!heading.title.empty() || !heading.subtitle.empty()) heading.height += 12.0;
  return heading;
}

void draw_heading(Canvas& canvas, double left, const Heading& heading) {
  double y = kMargin;
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
