#pragma once
// Cases of the self-test and their results. Each case compares the farm with a known result at a limit of its range.

#include <cmath>
#include <concepts>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sf::selftest {

/// Type of reference results: more than 64 bits if the machine supports it (x86: 64-bit significand).
using Real = long double;

/// Result of a case.
struct Outcome {
  std::uint64_t checks = 0;
  std::uint64_t failed = 0;
  double error = 0.0;              ///< in the case's unit, of the check that is closest to its allowed error
  double allowed = 0.0;            ///< allowed error of that check; 0: bitwise equality
  std::string failure;             ///< description of the first failed check
  std::vector<std::string> notes;  ///< additional measurements
  double seconds = 0.0;            ///< [s] duration

  /// Returns whether the case passed. A case without checks does not pass.
  bool passed() const { return checks > 0 && failed == 0; }
};

/// Collects the checks of a case. Not thread-safe.
class Checks {
 public:
  /// @param stop polled at each check, which throws base::Interrupted once it returns true; empty: never
  explicit Checks(std::function<bool()> stop = {}) : stop_(std::move(stop)) {}

  /// Checks |got - exact| <= allowed. @param what and @param index identify the check in messages
  void near(double got, Real exact, double allowed, std::string_view what, std::uint64_t index = 0);
  /// Checks that the values are bitwise equal, or both NaN.
  void same(double got, double expected, std::string_view what, std::uint64_t index = 0);
  /// Checks that two integers are equal.
  template <std::integral A, std::integral B>
  void equal(A got, B expected, std::string_view what, std::uint64_t index = 0) {
    holds(std::cmp_equal(got, expected),
          std::string(what)
              .append(": ")
              .append(std::to_string(got))
              .append(", expected ")
              .append(std::to_string(expected)),
          index);
  }
  void holds(bool it, std::string_view what, std::uint64_t index = 0);
  /// Checks that `call` throws base::InputError with a message that contains `word`.
  void refused(const std::function<void()>& call, std::string_view word, std::string_view what);
  void note(std::string text);

  const Outcome& outcome() const { return outcome_; }

 private:
  void count(bool good, double error, double allowed, const std::function<std::string()>& failure);

  std::function<bool()> stop_;
  Outcome outcome_;
  double nearest_ = -1.0;  ///< largest error divided by its allowed error
};

class Fixture;

struct Case {
  std::string_view group;
  std::string_view name;  ///< unique: words with dashes
  std::string_view unit;  ///< of its errors; empty: all checks are exact
  std::string_view why;   ///< expected result and reason for the allowed error
  void (*run)(Fixture& fixture, Checks& checks);
};

}  // namespace sf::selftest
