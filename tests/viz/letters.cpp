#include "tests/viz/letters.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/golden.h"
#include "viz/canvas.h"

namespace sf::scenes {
namespace {

std::string attribute(const std::string& line, const std::string& name) {
  const std::size_t at = line.find(" " + name + "=\"");
  if (at == std::string::npos) return "";
  const std::size_t from = at + name.size() + 3;
  return line.substr(from, line.find('"', from) - from);
}

std::string unescaped(std::string text) {
  for (const auto& [code, letter] : {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&amp;", "&"}})
    for (std::size_t at = text.find(code); at != std::string::npos; at = text.find(code, at + 1))
      text.replace(at, std::string(code).size(), letter);
  return text;
}

bool touch(const LetterBox& a, const LetterBox& b) {
  return a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y;
}

}  // namespace

std::vector<LetterBox> letters_of(const std::string& svg) {
  std::vector<LetterBox> letters;
  for (const std::string& line : golden::lines_of(svg)) {
    if (line.rfind("<text ", 0) != 0 || line.find("paint-order") != std::string::npos) continue;
    LetterBox box;
    const std::size_t from = line.find('>') + 1;
    box.text = unescaped(line.substr(from, line.rfind("</text>") - from));
    box.size = std::atof(attribute(line, "font-size").c_str());
    viz::TextStyle style;
    style.size = static_cast<int>(box.size);
    style.bold = !attribute(line, "font-weight").empty();
    const glm::dvec2 at{std::atof(attribute(line, "x").c_str()), std::atof(attribute(line, "y").c_str())};
    const double wide = viz::text_size(box.text, style).x, up = 0.72 * box.size, down = 0.18 * box.size;
    const bool upright = !attribute(line, "transform").empty();
    box.low = upright ? at - glm::dvec2{up, wide} : at - glm::dvec2{0.0, up};
    box.high = upright ? at + glm::dvec2{down, 0.0} : at + glm::dvec2{wide, down};
    letters.push_back(box);
  }
  return letters;
}

void expect_legible(const std::string& svg, const std::string& what) {
  const std::string page = attribute(svg.substr(svg.find("<svg")), "viewBox");  // "0 0 W H"
  char* end = nullptr;
  const double width = std::strtod(page.c_str() + 4, &end), height = std::strtod(end, nullptr);
  const std::vector<LetterBox> letters = letters_of(svg);
  EXPECT_FALSE(letters.empty()) << what;
  for (std::size_t i = 0; i < letters.size(); ++i) {
    const LetterBox& a = letters[i];
    EXPECT_TRUE(a.low.x >= 0.0 && a.low.y >= 0.0 && a.high.x <= width && a.high.y <= height)
        << what << ": '" << a.text << "' leaves the picture of " << width << " x " << height << " at " << a.low.x
        << ", " << a.low.y << " to " << a.high.x << ", " << a.high.y;
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_FALSE(touch(a, letters[k])) << what << ": '" << a.text << "' over '" << letters[k].text << "' at "
                                         << a.low.x << ", " << a.low.y;
  }
}

}  // namespace sf::scenes
