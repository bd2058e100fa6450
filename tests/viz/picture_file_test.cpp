#include "viz/picture_file.h"

#include <gtest/gtest.h>

#include <regex>

#include "base/error.h"
#include "tests/golden.h"
#include "tests/refusal.h"
#include "tests/viz/png.h"
#include "viz/canvas.h"
#include "viz/svg.h"

namespace sf::viz {
namespace {

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// One shape of each kind.
Canvas one_of_each() {
  Canvas canvas(200, 100, kWhite);
  canvas.clip({10, 10, 190, 90});
  canvas.line({0, 50}, {200, 50}, 2.0, 0x80FF0000u);
  canvas.disc({50, 50}, 10.0, 0xFF00FF00u);
  TextStyle style;
  style.halo = kWhite;
  canvas.text({100, 50}, "Robot <&> 7", style);
  style.bold = style.upwards = true;
  canvas.text({20, 50}, "y [m]", style);
  const std::uint32_t cells[] = {0xFF112233u, 0xFF445566u};
  canvas.image({150, 20}, {170, 30}, {2, 1, cells});
  return canvas;
}

/// Checks that tags are closed in order.
bool is_well_formed(const std::string& xml) {
  std::vector<std::string> open;
  const std::regex tag("<(/?)([A-Za-z]+)([^<>]*?)(/?)>");
  for (std::sregex_iterator it(xml.begin(), xml.end(), tag), end; it != end; ++it) {
    const std::string name = (*it)[2];
    if ((*it)[1] == "/") {
      if (open.empty() || open.back() != name) return false;
      open.pop_back();
    } else if ((*it)[4] != "/") {
      open.push_back(name);
    }
  }
  return open.empty();
}

TEST(Svg, EveryShapeIsAnElement) {
  const std::string svg = to_svg(one_of_each().drawing());
  EXPECT_TRUE(is_well_formed(svg)) << svg;
  EXPECT_EQ(occurrences(svg, "<path"), 2u) << "line and disc";
  EXPECT_EQ(occurrences(svg, "<image"), 1u);
  EXPECT_EQ(occurrences(svg, "<clipPath"), 2u) << "the whole picture, and ours";
  EXPECT_NE(svg.find("stroke=\"#ff0000\" stroke-opacity=\"0.502\""), std::string::npos) << "half transparent red";
  EXPECT_NE(svg.find("fill=\"#00ff00\" stroke=\"none\""), std::string::npos) << "opaque green";
  EXPECT_NE(svg.find("width=\"28.22mm\" height=\"14.11mm\" viewBox=\"0 0 200 100\""), std::string::npos);
}

TEST(Svg, TextsAreTexts) {
  const std::string svg = to_svg(one_of_each().drawing());
  const std::regex text("<text ([^>]*)>([^<]*)</text>");
  std::vector<std::smatch> found{std::sregex_iterator(svg.begin(), svg.end(), text), std::sregex_iterator()};
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0][2], "Robot &lt;&amp;&gt; 7") << "with its special characters";
  EXPECT_NE(found[0].str(1).find("paint-order=\"stroke\""), std::string::npos) << "its halo is below it";
  EXPECT_EQ(found[1][2], "y [m]");
  EXPECT_NE(found[1].str(1).find("rotate(-90"), std::string::npos);
  EXPECT_NE(found[1].str(1).find("bold"), std::string::npos);
}

TEST(Svg, ImagesArePngFiles) {
  const std::string svg = to_svg(one_of_each().drawing());
  EXPECT_NE(svg.find("href=\"data:image/png;base64,iVBORw0KGgo"), std::string::npos) << "the signature of PNG";
}

TEST(Svg, ADrawingWithoutShapesIsAPage) { EXPECT_TRUE(is_well_formed(to_svg({10, 10, kWhite, {}}))); }

TEST(PictureFile, TheSuffixDeterminesTheFormat) {
  EXPECT_EQ(format_of("a.png"), PictureFormat::png);
  EXPECT_EQ(format_of("a.b/c"), PictureFormat::png);  // suffixes of folder names are ignored
  EXPECT_EQ(format_of("a.SVG"), PictureFormat::svg);
  EXPECT_EQ(format_of("a.png.pdf"), PictureFormat::pdf);
  EXPECT_EQ(format_of("a.eps"), std::nullopt);
}

TEST(PictureFile, PdfHasItsFontsAndNoDate) {
  const std::string path = scenes::own_file("x.pdf");
  save_picture(one_of_each().drawing(), path);
  const std::string pdf = golden::read(path);
  EXPECT_TRUE(pdf.starts_with("%PDF-"));
  EXPECT_EQ(occurrences(pdf, "/FontFile"), 2u) << "regular and bold, embedded";
  EXPECT_GE(occurrences(pdf, "/ToUnicode"), 2u) << "so that texts can be searched";
  EXPECT_NE(pdf.find("/MediaBox [ 0 0 80 40 ]"), std::string::npos) << "200 x 100 px of 1/180 inch";
  save_picture(one_of_each().drawing(), path);
  EXPECT_TRUE(golden::read(path) == pdf) << "the same figure, the same bytes";
}

TEST(PictureFile, DotsPerInchScaleThePixelsAlone) {
  const std::string path = scenes::own_file("x.png");
  const auto painted = [&](double dpi) {
    save_picture(one_of_each().drawing(), path, {.dpi = dpi});
    return scenes::read_png(path);
  };
  const scenes::Picture half = painted(90.0), whole = painted(180.0), fine = painted(540.0);
  EXPECT_EQ(half.width, 100);
  EXPECT_EQ(whole.width, 200);
  EXPECT_EQ(fine.width, 600);
  EXPECT_EQ(fine.height, 300);
  constexpr std::uint32_t kGreen = 0xFF00FF00u;
  EXPECT_NEAR(fine.count(kGreen), 9 * whole.count(kGreen), 0.15 * fine.count(kGreen));
  EXPECT_NE(golden::read(path).find("pHYs"), std::string::npos) << "the size on paper is in the file";
}

TEST(PictureFile, LimitsAreEnforced) {
  const std::string path = scenes::own_file("x.png");
  expect_in("more than 32768 along a side",
            refusal_of([&] { save_picture(Canvas(16384, 1, kWhite).drawing(), path, {.dpi = 361.0}); }));
  for (const char* name : {"/nowhere/x.svg", "/nowhere/x.pdf", "/nowhere/x.png"})
    EXPECT_THROW(save_picture(one_of_each().drawing(), name), base::InputError) << name;
}

}  // namespace
}  // namespace sf::viz
