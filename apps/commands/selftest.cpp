// `selftest`: tests the farm at the limits of its range on this machine.

#include <fmt/format.h>

#include <algorithm>

#include "apps/commands/commands.h"
#include "apps/options/open_device.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/thread_pool.h"
#include "selftest/suite.h"

namespace sf::apps {

namespace {

using selftest::Case;
using selftest::Outcome;

std::vector<const Case*> chosen(const std::vector<std::string>& names) {
  std::vector<const Case*> some;
  for (const Case& c : selftest::cases()) {
    const bool asked =
        std::any_of(names.begin(), names.end(), [&](const auto& n) { return n == c.name || n == c.group; });
    if (names.empty() || asked) some.push_back(&c);
  }
  if (std::count(names.begin(), names.end(), selftest::failing_case().name) > 0)
    some.push_back(&selftest::failing_case());
  return some;
}

int list_cases() {
  for (const Case& c : selftest::cases()) print(fmt::format("{:<9} {:<27} {}\n", c.group, c.name, c.why));
  return 0;
}

std::string error_of(const Case& c, const Outcome& o) {
  if (c.unit.empty()) return "pass or fail";
  if (o.allowed == 0.0 && o.error == 0.0) return "0: bitwise equal";
  return fmt::format("{:.2g} of {:.2g} {}", o.error, o.allowed, c.unit);
}

std::string line_of(const Case& c, const Outcome& o) {
  std::string text = fmt::format("{:<9} {:<27} {:>8}  {:<30} {}\n", c.group, c.name, o.checks, error_of(c, o),
                                 o.passed() ? "ok" : "FAILED");
  if (!o.passed()) text += fmt::format("{:10}{} of {} checks failed; first: {}\n", "", o.failed, o.checks, o.failure);
  for (const std::string& note : o.notes) text += fmt::format("{:10}{}\n", "", note);
  return text;
}

}  // namespace

std::size_t SelfTestReport::passed() const {
  return static_cast<std::size_t>(
      std::count_if(cases.begin(), cases.end(), [](const auto& c) { return c.second.passed(); }));
}

std::string self_test_text(const SelfTestReport& test) {
  std::string text = fmt::format("{:<9} {:<27} {:>8}  {}\n", "group", "case", "checks", "closest call: error of limit");
  std::uint64_t checks = 0;
  for (const auto& [c, o] : test.cases) {
    text += line_of(*c, o);
    checks += o.checks;
  }
  const std::string rest =
      test.interrupted() ? fmt::format("; interrupted, {} not run", test.asked - test.cases.size()) : "";
  return text + fmt::format("{} of {} passed on {}: {} checks in {:.1f} s{}\n", test.passed(),
                            counted(test.cases.size(), "case"), test.device.name, checks, test.seconds, rest);
}

int selftest(const SelfTestOptions& options) {
  if (options.list) return list_cases();
  gpu::Device device = open_device(options);
  selftest::Fixture fixture(device, [] { return stop_requested().load(); });
  const std::vector<const Case*> some = chosen(options.cases);
  SelfTestReport test{.device = device.info(), .asked = some.size()};
  install_stop_handlers();
  {
    Progress progress("selftest");
    for (std::size_t i = 0; i < some.size() && !stop_requested(); ++i) {
      progress.show(static_cast<double>(i) / static_cast<double>(some.size()), std::string(some[i]->name));
      try {
        test.cases.emplace_back(some[i], selftest::run(*some[i], fixture));
      } catch (const base::Interrupted&) {
        break;
      }
      test.seconds += test.cases.back().second.seconds;
    }
  }
  print(options.json ? self_test_json(test) : self_test_text(test));
  return test.sound() ? 0 : test.passed() == test.cases.size() && test.interrupted() ? interrupted_code() : 1;
}

}  // namespace sf::apps
