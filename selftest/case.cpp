#include "selftest/case.h"

#include <fmt/format.h>

#include <bit>

#include "base/error.h"
#include "base/thread_pool.h"

namespace sf::selftest {

namespace {

constexpr std::size_t kMaxNotes = 12;

std::string named(std::string_view what, std::uint64_t index) { return fmt::format("{} [{}]", what, index); }

}  // namespace

void Checks::count(bool good, double error, double allowed, const std::function<std::string()>& failure) {
  if (stop_ && stop_()) throw base::Interrupted();
  ++outcome_.checks;
  constexpr double kBeyond = std::numeric_limits<double>::infinity();
  const double share = error == 0.0 ? 0.0 : allowed > 0.0 ? error / allowed : kBeyond;
  if (!(share <= nearest_)) {
    nearest_ = std::isnan(share) ? kBeyond : share;
    outcome_.error = std::isnan(error) ? kBeyond : error;
    outcome_.allowed = allowed;
  }
  if (good) return;
  if (outcome_.failed++ == 0) outcome_.failure = failure();
}

void Checks::near(double got, Real exact, double allowed, std::string_view what, std::uint64_t index) {
  const auto error = static_cast<double>(std::fabs(static_cast<Real>(got) - exact));
  count(error <= allowed, error, allowed, [&] {
    return fmt::format("{}: {:.17g}, expected {:.17g} within {:.3g}", named(what, index), got,
                       static_cast<double>(exact), allowed);
  });
}

void Checks::same(double got, double expected, std::string_view what, std::uint64_t index) {
  const bool good = std::bit_cast<std::uint64_t>(got) == std::bit_cast<std::uint64_t>(expected) ||
                    (std::isnan(got) && std::isnan(expected));
  count(good, good ? 0.0 : std::fabs(got - expected), 0.0,
        [&] { return fmt::format("{}: {:.17g}, expected {:.17g}", named(what, index), got, expected); });
}

void Checks::holds(bool it, std::string_view what, std::uint64_t index) {
  if (stop_ && stop_()) throw base::Interrupted();
  ++outcome_.checks;
  if (it) return;
  if (outcome_.failed++ == 0) outcome_.failure = named(what, index);
}

void Checks::refused(const std::function<void()>& call, std::string_view word, std::string_view what) {
  std::string said;
  try {
    call();
    said = "was accepted";
  } catch (const base::InputError& error) {
    said = error.what();
  } catch (const base::DeviceError& error) {
    said = error.what();
  }
  holds(said.find(word) != std::string::npos && said != "was accepted",
        fmt::format("{}: expected a rejection that names '{}', got: {}", what, word, said));
}

void Checks::note(std::string text) {
  if (outcome_.notes.size() < kMaxNotes) outcome_.notes.push_back(std::move(text));
}

}  // namespace sf::selftest
