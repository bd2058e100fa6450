#include "scenarios/junit.h"

#include <gtest/gtest.h>

#include <map>

namespace sf::scenarios {
namespace {

/// A parser for a subset of XML that checks well-formedness: elements by path with their attributes.
class Xml {
 public:
  explicit Xml(const std::string& text) : text_(text) { read(); }
  bool fine() const { return fine_ && open_.empty(); }
  int count(const std::string& name) const {
    const auto found = counts_.find(name);
    return found == counts_.end() ? 0 : found->second;
  }
  /// Returns the values of an attribute in order, unescaped.
  std::vector<std::string> values(const std::string& element, const std::string& attribute) const {
    std::vector<std::string> found;
    for (const auto& [e, a, v] : attributes_)
      if (e == element && a == attribute) found.push_back(v);
    return found;
  }

 private:
  void read() {
    std::size_t at = 0;
    while (fine_ && (at = text_.find('<', at)) != std::string::npos) {
      const std::size_t end = text_.find('>', at);
      if (end == std::string::npos) fine_ = false;
      if (fine_) tag(text_.substr(at + 1, end - at - 1));
      at = end;
    }
  }
  void tag(std::string body) {
    if (body.empty()) return void(fine_ = false);
    if (body.front() == '?') return;
    if (body.front() == '/') {
      fine_ = !open_.empty() && open_.back() == body.substr(1);
      if (fine_) open_.pop_back();
      return;
    }
    const bool closed = body.back() == '/';
    if (closed) body.pop_back();
    const std::size_t space = body.find(' ');
    const std::string name = body.substr(0, space);
    ++counts_[name];
    if (!closed) open_.push_back(name);
    if (space != std::string::npos) read_attributes(name, body.substr(space));
  }
  void read_attributes(const std::string& element, const std::string& body) {
    std::size_t at = 0;
    while ((at = body.find_first_not_of(' ', at)) != std::string::npos) {
      const std::size_t is = body.find("=\"", at);
      const std::size_t end = is == std::string::npos ? is : body.find('"', is + 2);
      if (end == std::string::npos) return void(fine_ = false);
      attributes_.push_back({element, body.substr(at, is - at), plain(body.substr(is + 2, end - is - 2))});
      at = end + 1;
    }
  }
  std::string plain(const std::string& text) {
    static const std::map<std::string, char> kNames{
        {"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}};
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '<') fine_ = false;
      if (text[i] != '&') {
        out += text[i];
        continue;
      }
      const std::size_t end = text.find(';', i);
      const auto found = end == std::string::npos ? kNames.end() : kNames.find(text.substr(i + 1, end - i - 1));
      if (found == kNames.end()) return fine_ = false, out;
      out += found->second;
      i = end;
    }
    return out;
  }

  std::string text_;
  bool fine_ = true;
  std::vector<std::string> open_;
  std::map<std::string, int> counts_;
  std::vector<std::tuple<std::string, std::string, std::string>> attributes_;
};

TEST(Junit, HasASuitePerScenarioAndACasePerExpectation) {
  const std::vector<ScenarioResult> results{
      {.name = "one", .file = "a/one.toml", .outcomes = {{"done", "done", "done", true, 3}}, .wall = 1.5},
      {.name = "two",
       .file = "two.toml",
       .outcomes = {{"contacts", "<= 0", "2", false, 7}, {"done", "done", "done", true, 8}}}};
  const std::string text = junit_of(results);
  const Xml xml(text);
  ASSERT_TRUE(xml.fine()) << text;
  EXPECT_EQ(xml.count("testsuites"), 1);
  EXPECT_EQ(xml.count("testsuite"), 2);
  EXPECT_EQ(xml.count("testcase"), 3);
  EXPECT_EQ(xml.values("testsuite", "tests"), (std::vector<std::string>{"1", "2"}));
  EXPECT_EQ(xml.values("testsuite", "failures"), (std::vector<std::string>{"0", "1"}));
  EXPECT_EQ(xml.values("failure", "message"), (std::vector<std::string>{"expected <= 0, got 2"}));
  EXPECT_NE(text.find("two.toml:7"), std::string::npos);
}

TEST(Junit, ReservedCharactersAreEscaped) {
  const std::string bad = "a<b> & \"c\" 'd'";
  const std::vector<ScenarioResult> results{{.name = bad, .file = bad, .outcomes = {{bad, bad, bad, false, 1}}}};
  const std::string text = junit_of(results);
  const Xml xml(text);
  ASSERT_TRUE(xml.fine()) << text;
  EXPECT_EQ(xml.values("testsuite", "name"), std::vector<std::string>{bad});
  EXPECT_EQ(xml.values("testcase", "name"), std::vector<std::string>{bad});
}

TEST(Junit, NoExpectationsAreASkippedCase) {
  const std::vector<ScenarioResult> results{{.name = "idle", .file = "a&b.toml"}};
  const std::string text = junit_of(results);
  const Xml xml(text);
  ASSERT_TRUE(xml.fine()) << text;
  EXPECT_EQ(xml.values("testsuite", "skipped"), std::vector<std::string>{"1"});
  EXPECT_EQ(xml.values("testsuite", "tests"), std::vector<std::string>{"1"});
  EXPECT_EQ(xml.values("skipped", "message"), std::vector<std::string>{"a&b.toml has no [expect]"});
  EXPECT_EQ(xml.count("failure"), 0);
}

/// XML 1.0 forbids them even if escaped.
TEST(Junit, ControlCharactersAreRemoved) { EXPECT_EQ(escaped(std::string("a\x01\x1b\tb\n", 6)), "a\tb"); }

/// The parser above detects errors.
TEST(Junit, TheParserRejectsMalformedXml) {
  EXPECT_FALSE(Xml("<a><b></a></b>").fine());
  EXPECT_FALSE(Xml("<a x=\"&bad;\"/>").fine());
  EXPECT_FALSE(Xml("<a>").fine());
  EXPECT_TRUE(Xml("<a x=\"1\"><b/></a>").fine());
}

}  // namespace
}  // namespace sf::scenarios
