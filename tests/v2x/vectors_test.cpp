// Frames written by other encoders, with their decodings by other decoders.
//
// vectors/asn1c.txt: random frames that Debian's asn1c 0.9.28 decoded from UPER, encoded again to the same bytes and
// wrote as XML (XER), from a module with the components of J2735-2016 without its extensions. Each frame is one line of
// hexadecimal digits, followed by a line of XML. Together they contain every component and enumeration name.

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>

#include "v2x/text_forms.h"
#include "v2x/xml.h"

namespace sf::v2x {

namespace {

std::vector<std::string> lines_of(const std::string& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line.substr(0, line.find('\r')));
  return lines;
}

/// Removes blanks. Hexadecimal digits may have either case.
std::string condensed(const std::string& xml) {
  std::string text;
  for (const char c : xml)
    if (!std::isspace(static_cast<unsigned char>(c)))
      text += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

Frame decoded(const base::Bytes& bytes) {
  Frame frame;
  const DecodeResult result = decode(bytes, frame);
  EXPECT_TRUE(result.ok()) << result.error;
  if (result.ok()) frame.padding.assign(bytes.begin() + static_cast<std::ptrdiff_t>(result.size), bytes.end());
  return frame;
}

void expect_same_bytes(const base::Bytes& bytes) {
  base::Bytes again;
  encode(decoded(bytes), again);
  EXPECT_EQ(hex_text(again), hex_text(bytes));
}

const std::string kReal = SF_SOURCE_DIR "/../shared/data/spat/";

/// Returns the message frame of a decoder's output.
std::string real_xml(const std::string& name) {
  std::stringstream text;
  for (const std::string& line : lines_of(kReal + name)) text << line << "\n";
  const std::string all = text.str(), end = "</MessageFrame>\n";
  const std::size_t first = all.find("<MessageFrame>");
  return all.substr(first, all.find(end) + end.size() - first);
}

}  // namespace

TEST(Vectors, FramesOfAnotherEncoder) {
  const auto lines = lines_of(SF_SOURCE_DIR "/tests/v2x/vectors/asn1c.txt");
  ASSERT_EQ(lines.size(), 60u);
  for (std::size_t i = 0; i < lines.size(); i += 2) {
    const auto bytes = read_hex(lines[i]);
    ASSERT_TRUE(bytes);
    expect_same_bytes(*bytes);
    const std::string xml = condensed(xml_of(decoded(*bytes)));
    const std::string other = condensed(lines[i + 1]);
    EXPECT_NE(xml.find("<VALUE>" + other + "</VALUE>"), std::string::npos) << lines[i] << "\n" << xml;
  }
}

TEST(Vectors, RealFramesEncodeToTheSameBytes) {
  const std::vector<std::string> files{"real_spat_frames.hex", "SpatReceiverTest_ValidSPAT.txt",
                                       "MapReceiverTest_ValidMAP.txt"};
  for (const std::string& file : files) {
    const auto lines = lines_of(kReal + file);
    if (lines.empty()) GTEST_SKIP() << kReal + file << " is not on this machine";
    for (const std::string& line : lines) {
      const auto bytes = read_hex(line);
      ASSERT_TRUE(bytes) << file;
      expect_same_bytes(*bytes);
    }
  }
}

TEST(Vectors, RealFramesDecodeToTheirXml) {
  for (const auto& [file, xml] :
       std::vector<std::pair<std::string, std::string>>{{"SpatReceiverTest_ValidSPAT.txt", "decoder-output-spat.xml"},
                                                        {"MapReceiverTest_ValidMAP.txt", "decoder-output-map.xml"}}) {
    const auto lines = lines_of(kReal + file);
    if (lines.empty()) GTEST_SKIP() << kReal + file << " is not on this machine";
    // A log's timestamp appears within one value of the MAP's decoding.
    const std::regex logged("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9:.]+Z ");
    const std::string expected = std::regex_replace(real_xml(xml), logged, "");
    EXPECT_EQ("      " + xml_of(decoded(*read_hex(lines[0])), 3).substr(6), "      " + expected);
  }
}

TEST(Xml, ControlCharactersAndMarkupAreEscaped) {
  Frame frame;
  Spat& spat = std::get<Spat>(frame.message);
  spat.name = "a<b>&\n";
  spat.intersections.resize(1);
  EXPECT_NE(xml_of(frame).find("<name>a&lt;b&gt;&amp;<lf/></name>"), std::string::npos);
}

TEST(TextForms, HexadecimalDigits) {
  EXPECT_EQ(read_hex("0aFf"), (base::Bytes{0x0A, 0xFF}));
  EXPECT_EQ(read_hex(""), base::Bytes{});
  for (const char* wrong : {"0", "0g", "-1", "0x00", " 0"}) EXPECT_FALSE(read_hex(wrong)) << wrong;
}

TEST(TextForms, RowsByName) {
  constexpr std::array<std::string_view, 2> names{"one", "two"};
  EXPECT_EQ(read_row(names, false, "two"), 1);
  EXPECT_EQ(row_text(names, 2), "extension-0");
  EXPECT_EQ(read_row(names, true, "extension-63"), 65);
  EXPECT_FALSE(read_row(names, true, "extension-64"));  // beyond normally small numbers
  EXPECT_FALSE(read_row(names, true, "extension-"));
  EXPECT_FALSE(read_row(names, true, "extension-1x"));
  EXPECT_FALSE(read_row(names, false, "extension-0"));
}

}  // namespace sf::v2x
