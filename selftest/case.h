#pragma once
// One question to the farm at an end of its range, and what came of it.

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

/// More than 64 bits, where the machine has them: x86's 64-bit significand.
using Real = long double;

/// What came of a case.
struct Outcome {
  std::uint64_t checks = 0;
  std::uint64_t failed = 0;
  double error = 0.0;              ///< in the case's unit, of the check that came nearest to what it is allowed
  double allowed = 0.0;            ///< what that check was allowed; 0: the same to the bit
  std::string failure;             ///< the first check that failed
  std::vector<std::string> notes;  ///< what else was measured
  double seconds = 0.0;            ///< [s] it took

  /// A case that checked nothing has proved nothing.
  bool passed() const { return checks > 0 && failed == 0; }
};

/// What a case tells its checks to. One thread.
class Checks {
 public:
  /// |got - exact| <= allowed. @param what and @param index name the check where it fails
  void near(double got, Real exact, double allowed, std::string_view what, std::uint64_t index = 0);
  /// Equal to the bit, or neither a number.
  void same(double got, double expected, std::string_view what, std::uint64_t index = 0);
  /// Equal whole numbers.
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
  /// `call` is refused as a user's mistake, in words that hold `word`.
  void refused(const std::function<void()>& call, std::string_view word, std::string_view what);
  void note(std::string text);

  const Outcome& outcome() const { return outcome_; }

 private:
  void count(bool good, double error, double allowed, const std::function<std::string()>& failure);

  Outcome outcome_;
  double nearest_ = -1.0;  ///< largest error as a share of what was allowed
};

class Fixture;

struct Case {
  std::string_view group;
  std::string_view name;  ///< unique: words with dashes
  std::string_view unit;  ///< of its errors; empty: nothing in it is near, it is right or wrong
  std::string_view why;   ///< the answer, and the reason for what is allowed
  void (*run)(Fixture& fixture, Checks& checks);
};

}  // namespace sf::selftest
