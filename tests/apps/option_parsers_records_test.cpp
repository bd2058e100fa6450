// Parsers of arguments at and just beyond their limits, and short texts of reports, compared with a golden record.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>

#include "apps/options/command_line.h"
#include "apps/options/option_parsers.h"
#include "apps/processes/slurm.h"
#include "apps/reports/text.h"
#include "tests/apps/golden.h"

namespace sf::apps {

namespace {

/// "NAME 'text' -> value", one per line. @param show formats the parsed value
template <class Read, class Show>
std::string table(const char* name, Read read, Show show, const std::vector<std::string>& texts) {
  std::string rows;
  for (const std::string& text : texts) {
    const auto value = read(text);
    rows += fmt::format("{} '{}' -> {}\n", name, text, value ? show(*value) : "none");
  }
  return rows;
}

std::string answers(const char* name, const Validator& validator, const std::vector<std::string>& texts) {
  std::string rows;
  for (const std::string& text : texts) rows += fmt::format("{} '{}' -> '{}'\n", name, text, validator(text));
  return rows;
}

std::string places() {
  const auto pose = [](const base::Pose& X) { return fmt::format("{:g} {:g} {:g} {:.9g}", X.x, X.y, X.z, X.yaw); };
  const auto line = [](const viz::Line& l) {
    return fmt::format("{:g} {:g} to {:g} {:g}", l.a.x, l.a.y, l.b.x, l.b.y);
  };
  const auto extent = [](const world::Extent& e) {
    return fmt::format("{:g} {:g} {:g} {:g}", e.x_min, e.y_min, e.x_max, e.y_max);
  };
  const auto size = [](const glm::dvec2& s) { return fmt::format("{:g} by {:g}", s.x, s.y); };
  return table("pose", read_pose, pose,
               {"1,2,90", "1,2", "1,2,3,4", "1e7,-1e7,0", "1.0000001e7,0,0", "0,1.0000001e7,0", "a,b,c"}) +
         table("line", read_line, line, {"0,0,1,2", "1,2,1,2", "1,2,1,3", "1,2,3,2", "0,0,1"}) +
         table("extent", read_extent, extent, {"0,1,2,3", "0,1,0,3", "2,1,0,3", "0,3,2,3", "0,4,2,3", "0,1,2"}) +
         table("size", read_size, size,
               {"50", "49.9", "1000", "1001", "50x30", "50x29.9", "50x1000", "50x1001", "170x120", "x", "85x", "a"});
}

std::string numbers() {
  const auto ports = [](const std::vector<std::uint16_t>& p) {
    return fmt::format("{} from {} to {}", p.size(), p.front(), p.back());
  };
  const auto quantity = [](const Quantity& q) { return fmt::format("{:.9g} {}", q.value, q.is_tesla ? "T" : "m"); };
  const auto rate = [](double hertz) { return fmt::format("{:g}", hertz); };
  const auto share = [](const Share& s) { return fmt::format("{} of {}", s.index, s.count); };
  const auto setting = [](const auto& s) { return fmt::format("[{}] [{}]", s.first, s.second); };
  return table("ports", read_ports, ports,
               {"1", "0", "65535", "65536", "10-10", "10-9", "1-1024", "1-1025", "1000-2023", "5-", "-5", "01",
                "1-2-3"}) +
         table("quantity", read_quantity, quantity,
               {"1m",  "2cm", "3mm", "4um", "4\u00b5m", "5nm", "1T", "2mT",  "3uT", "3\u00b5T",
                "4nT", "5G",  "6mG", "0m",  "-1m",      "1",   "m",  "infm", "1 m", "1km"}) +
         table("rate", read_rate, rate, {"10", "10Hz", "0", "-1", "10hz", "10 Hz", "inf", "0.5Hz", ""}) +
         table("share", read_share, share, {"1/1", "2/8", "8/8", "9/8", "0/8", "8", "a/8", "1/b", "1/"}) +
         table("setting", read_setting, setting, {"a=b", "a=", "=b", "a", "a=b=c"});
}

std::string validators() {
  return answers("whole 2 to 10", whole(2, 10), {"1", "2", "10", "11", "-3", "05", "2.0", "", "0x3"}) +
         answers("number -1 to 2.5", number(-1.0, 2.5),
                 {"-1", "-1.01", "2.5", "2.51", "nan", "inf", "", "1a", "1e-3"}) +
         answers("one_of", one_of({"max", "inf", "none"}), {"max", "inf", "none", "Max", ""}) +
         answers("one_of one", one_of({"max"}), {"max", "min"}) + answers("not_empty", not_empty("a name"), {"", "x"}) +
         answers("picture", picture(), {"", "a.png", "a.SVG", "a.pdf", "a.jpg", "a", "b/c.d/e"});
}

std::string words() {
  std::string rows;
  for (const std::string word : {"--jsn", "--json", "json", "--zzzzzz", "--repot"})
    rows += fmt::format("suggest {} -> {}\n", word, suggest_option(word, {"json", "report", "seed"}));
  rows += shell_quoted("it's $here") + "\n" + row("name", 5) + row("", "more");
  return rows;
}

std::string batch_script() {
  return batch_script_text(BatchScript{.name = "grid",
                                       .tasks = {0, 1, 2, 5, 7, 8},
                                       .shares = 9,
                                       .cpus = 3,
                                       .log = "out/%a.log",
                                       .directives = {"--time=1:00:00"},
                                       .program = "/opt/sensor farm",
                                       .arguments = {"sweep", "a b.toml"}});
}

}  // namespace

TEST(OptionParserRecords, MatchTheirRecord) {
  expect_golden("option_parsers", places() + numbers() + validators() + words() + batch_script());
}

/// True if a value of "COMMAND --OPTION" is accepted. The value is checked before the missing arguments.
static bool takes(const std::string& option, const std::string& value) {
  const std::size_t space = option.find(' ');
  const std::string command = option.substr(0, space), name = option.substr(space + 1), word = name + "=" + value;
  const char* const words[] = {"sensorfarm", command.c_str(), word.c_str()};
  testing::internal::CaptureStderr();
  parse_command_line(3, words);
  const std::string err = testing::internal::GetCapturedStderr();
  EXPECT_EQ(err.find("was not expected"), std::string::npos) << err;
  return err.find(name + ": expected ") == std::string::npos;
}

/// The smallest and largest values of options, and the next ones beyond.
TEST(OptionLimits, AreEnforced) {
  struct Range {
    const char *below, *first, *last, *above;
  };
  const std::pair<Range, std::vector<std::string>> limits[] = {
      {{"-1000001", "-1e6", "1e6", "1000001"}, {"export --height", "field --height"}},
      {{"0.0009", "0.001", "1e6", "1000001"}, {"export --every"}},
      {{"-0.1", "0", "1e9", "1.001e9"},
       {"view --time", "run --duration", "serve --forget", "serve --radio", "robot --stop-after", "light --time",
        "listen --duration", "plot --from", "plot --to"}},
      {{"0.09", "0.1", "10000", "10001"}, {"check --rate", "serve --rate"}},
      {{"49.9", "50", "1200", "1200.1"}, {"field --dpi"}},
      {{"-1", "0", "65535", "65536"}, {"sense --sensor", "serve --port", "start --robot"}},
      {{"0.0009", "0.001", "1e9", "1.001e9"}, {"run --checkpoint", "run --balance", "sweep --timeout"}},
      {{"-0.1", "0", "1e6", "1000001"}, {"run --speed", "serve --lockstep-timeout"}},
      {{"-1", "0", "256", "257"}, {"run --threads"}},
      {{"0", "1", "65535", "65536"},
       {"run --robots", "run --laser-port", "run --ports-per-robot", "serve --spat", "robot --port", "robot --cameras",
        "robot --tag", "robot --spat", "light --port", "vps --robots"}},
      {{"-1", "0", "18446744073709551615", "18446744073709551616"}, {"run --seed", "verify --sample"}},
      {{"-1", "0", "232", "233"}, {"run --ros2"}},
      {{"0.009", "0.01", "1e6", "1000001"}, {"serve --stale-after"}},
      {{"-0.1", "0", "10", "10.01"}, {"serve --link-delay"}},
      {{"0", "1", "64", "65"}, {"serve --hypotheses"}},
      {{"0", "1", "65536", "65537"}, {"serve --wait-for"}},
      {{"-0.1", "0", "3600", "3600.1"}, {"robot --delay", "robot --jitter"}},
      {{"-0.1", "0", "1", "1.001"}, {"robot --loss", "robot --duplicate", "robot --corrupt"}},
      {{"0.09", "0.1", "1000", "1000.1"}, {"robot --rate"}},
      {{"0.09", "0.1", "100", "100.1"}, {"light --rate"}},
      {{"-89.1", "-89", "89", "89.1"}, {"light --latitude"}},
      {{"-180", "-179.9", "179.9", "180"}, {"light --longitude"}},
      {{"0.09", "0.1", "1e6", "1000001"}, {"listen --silence"}},
      {{"-1", "0", "1000000000000", "1000000000001"}, {"dump --count"}},
      {{"0", "1", "1000", "1001"}, {"experiment --trials", "vps --rendered"}},
      {{"0", "1", "1024", "1025"}, {"test --jobs", "sweep --jobs"}},
      {{"0", "1", "100000", "100001"}, {"sweep --tasks"}},
      {{"-0.1", "0", "100", "100.1"}, {"vps --speed"}},
      {{"-1", "0", "100", "101"}, {"vps --occluders"}},
      {{"-1", "0", "1000000000", "1000000001"}, {"vps --images"}},
      {{"0", "1", "1000000", "1000001"}, {"vps --every"}},
      {{"2", "3", "100", "101"}, {"calibrate --columns", "calibrate --rows"}},
      {{"0.00009", "0.0001", "10", "10.01"}, {"calibrate --square", "calibrate --marker"}}};
  for (const auto& [range, options] : limits)
    for (const std::string& option : options) {
      EXPECT_TRUE(takes(option, range.first) && takes(option, range.last)) << option;
      EXPECT_FALSE(takes(option, range.below)) << option << "=" << range.below;
      EXPECT_FALSE(takes(option, range.above)) << option << "=" << range.above;
    }
}

/// Up to ten names in full, and units of quantities at their limits.
TEST(Texts, ListsAndUnitsAtTheirLimits) {
  std::vector<std::string_view> names(10, "a");
  EXPECT_EQ(list_names({}), "none");
  EXPECT_EQ(list_names(names), "a, a, a, a, a, a, a, a, a, a");
  names.push_back("b");
  EXPECT_EQ(list_names(names), "a, a, a, a, a, a, a, a, a, a, ... (11 in all)");
  EXPECT_EQ(join_or({"a"}) + "; " + join_or({"a", "b"}) + "; " + join_or({"a", "b", "c"}), "a; a or b; a, b or c");
  EXPECT_EQ(counted(0, "job") + counted(1, "job") + counted(2, "job"), "0 jobs1 job2 jobs");
  for (const auto& [value, text] : {std::pair{0.0, "0"},
                                    {0.99e-12, "< 1 pm"},
                                    {1e-12, "1 pm"},
                                    {999.4e-12, "999 pm"},
                                    {999.6e-12, "1 nm"},
                                    {1e-9, "1 nm"},
                                    {999.6e-9, "1 um"},
                                    {0.9994, "999 mm"},
                                    {0.9996, "1 m"},
                                    {1.0, "1 m"},
                                    {1234.0, "1.23e+03 m"},
                                    {std::numeric_limits<double>::infinity(), "-"}})
    EXPECT_EQ(quantity_text(value, "m"), text) << value;
}

/// A printed bound is never smaller than the bound.
TEST(Texts, BoundsAreRoundedUp) {
  for (double bound = 1e-15; bound < 1e6; bound *= 1.00173) {
    const double shown = std::stod(rounded_up(bound));
    ASSERT_GE(shown, bound);
    ASSERT_LE(shown, 1.0101 * bound) << "three digits";
  }
  EXPECT_EQ(rounded_up(1.05), "1.05") << "three digits are enough";
  EXPECT_EQ(rounded_up(9.991), "10") << "a digit more";
  EXPECT_EQ(bound_text(1.0501e-9, "m"), "1.06 nm");
  EXPECT_EQ(bound_text(0.0, "m"), "0");
  EXPECT_EQ(bound_text(std::numeric_limits<double>::infinity(), "m"), "-");
}

}  // namespace sf::apps
