#include <algorithm>
#include <cmath>

#include "tests/sensors/brute_force.h"

namespace sf::oracle {

using Wide = long double;

namespace {

constexpr std::uint32_t kNothing = 0xFFFFFFFFu;

/// A segment on the line of a beam, in the beam's frame.
struct Crossing {
  Meeting meeting;
  Wide aside_a = 0.0L;  ///< [m] lateral distance of its ends, positive on the left of the beam
  Wide aside_b = 0.0L;
  glm::dvec2 a, b;
  bool strict = false;     ///< hit in real arithmetic
  bool firm = false;       ///< hit by more than kEitherWay
  bool uncertain = false;  ///< contact with the sensor depends on rounding
};

/// Returns false when the segment is farther than kEitherWay from the beam's line.
bool meet(const world::Segment& s, glm::dvec2 origin, Wide dx, Wide dy, Crossing& out) {
  const Wide wx = static_cast<Wide>(s.a.x) - origin.x;
  const Wide wy = static_cast<Wide>(s.a.y) - origin.y;
  const Wide ex = static_cast<Wide>(s.b.x) - s.a.x;
  const Wide ey = static_cast<Wide>(s.b.y) - s.a.y;
  out.aside_a = dx * wy - dy * wx;
  out.aside_b = out.aside_a + (dx * ey - dy * ex);
  const Wide below = ex * dy - ey * dx;
  if (below == 0.0L) return false;
  out.strict = (out.aside_a >= 0.0L && out.aside_b <= 0.0L) || (out.aside_a <= 0.0L && out.aside_b >= 0.0L);
  const Wide least = std::min(std::fabs(out.aside_a), std::fabs(out.aside_b));
  out.firm = out.strict && least > kEitherWay;
  if (!out.strict && least > kEitherWay) return false;

  Wide t = (ex * wy - ey * wx) / below;
  out.uncertain = std::fabs(std::fabs(t) - kTouch) < 1e-11L;
  if (t < -kTouch - 1e-11L) return false;
  if (t <= kTouch && below < 0.0L && !out.uncertain) return false;
  t = std::max(t, 0.0L);
  const Wide sine = std::fabs(below) / std::hypot(ex, ey);
  out.meeting = {t, s.model, static_cast<double>(sine), static_cast<double>(std::hypot(wx, wy))};
  out.a = s.a;
  out.b = s.b;
  return true;
}

/// Returns true when two crossings share an end near the beam, and their other ends lie on both sides of it.
bool closes(const Crossing& p, const Crossing& q) {
  const auto same = [](glm::dvec2 v, glm::dvec2 w) { return v.x == w.x && v.y == w.y; };
  const auto apart = [](Wide shared, Wide other_p, Wide other_q) {
    if (std::fabs(shared) > kEitherWay) return false;
    return std::min(other_p, other_q) < -kEitherWay && std::max(other_p, other_q) > kEitherWay;
  };
  return (same(p.a, q.a) && apart(p.aside_a, p.aside_b, q.aside_b)) ||
         (same(p.a, q.b) && apart(p.aside_a, p.aside_b, q.aside_a)) ||
         (same(p.b, q.a) && apart(p.aside_b, p.aside_a, q.aside_b)) ||
         (same(p.b, q.b) && apart(p.aside_b, p.aside_a, q.aside_a));
}

/// Returns the range beyond which nothing is visible.
Wide firm_range(const std::vector<Crossing>& crossings, Wide range_max) {
  Wide firm = range_max;
  for (const Crossing& c : crossings)
    if (c.firm && !c.uncertain) firm = std::min(firm, c.meeting.range);
  for (const Crossing& p : crossings) {
    if (p.firm || p.uncertain) continue;
    for (const Crossing& q : crossings)
      if (&p != &q && !q.firm && !q.uncertain && closes(p, q))
        firm = std::min(firm, std::max(p.meeting.range, q.meeting.range));
  }
  return firm;
}

}  // namespace

double rounding(const Meeting& meeting) {
  const double sine = std::max(meeting.sine, 1e-16);
  return 1e-12 + 1e-15 * (static_cast<double>(meeting.range) + meeting.arm) / sine;
}

Truth judge(std::span<const world::Segment> surfaces, glm::dvec2 origin, Wide direction, double range_max) {
  const Wide dx = std::cos(direction);
  const Wide dy = std::sin(direction);
  std::vector<Crossing> crossings;
  for (const world::Segment& s : surfaces) {
    Crossing crossing;
    if (meet(s, origin, dx, dy, crossing)) crossings.push_back(crossing);
  }
  const Wide firm = firm_range(crossings, range_max);

  Truth truth;
  truth.first = {range_max, kNothing, 1.0, 0.0};
  if (firm >= range_max - 1e-9) truth.right.push_back(truth.first);
  for (const Crossing& c : crossings) {
    const Wide slack = rounding(c.meeting);
    if (c.strict && !c.uncertain && c.meeting.range < truth.first.range) truth.first = c.meeting;
    if (c.meeting.range <= firm + slack && c.meeting.range < range_max + slack) truth.right.push_back(c.meeting);
  }
  // Crossings within rounding of the firm answer are also valid.
  truth.right.push_back(truth.first);
  for (const Meeting& m : truth.right)
    truth.ambiguous = truth.ambiguous || std::fabs(m.range - truth.first.range) > 1e-5L;
  return truth;
}

}  // namespace sf::oracle
