// Means of angular rate and specific force against finite differences of the trajectory in 50 digits: the trajectory is
// made of the poses at the ticks and the screw motions between them, by matrices.

#include "sensors/inertial_motion.h"

#include <gtest/gtest.h>

#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <functional>
#include <glm/geometric.hpp>

#include "base/tilted_pose.h"
#include "robots/kinematics.h"

namespace sf::sensors {
namespace {

using Digits = boost::multiprecision::cpp_bin_float_50;
using Vector = std::array<Digits, 3>;
using Matrix = std::array<Vector, 3>;  // rows

Vector operator*(const Digits& s, const Vector& v) { return {s * v[0], s * v[1], s * v[2]}; }
Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vector operator-(const Vector& a, const Vector& b) { return a + Digits(-1) * b; }
Digits dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector operator*(const Matrix& m, const Vector& v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }
Matrix transposed(const Matrix& m) {
  Matrix t;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) t[i][k] = m[k][i];
  return t;
}
Matrix operator*(const Matrix& a, const Matrix& b) {
  const Matrix columns = transposed(b);
  Matrix product;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector column = a * columns[k];
    for (std::size_t i = 0; i < 3; ++i) product[i][k] = column[i];
  }
  return product;
}
Matrix skew(const Vector& w) { return {Vector{0, -w[2], w[1]}, Vector{w[2], 0, -w[0]}, Vector{-w[1], w[0], 0}}; }
Matrix identity() { return {Vector{1, 0, 0}, Vector{0, 1, 0}, Vector{0, 0, 1}}; }
Matrix sum(const Matrix& a, const Digits& s, const Matrix& b) {
  return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
}

struct Placed {
  Matrix R;
  Vector p;
};

Matrix rotation(double roll, double pitch, double yaw) {
  const auto about = [](std::size_t axis, double angle) {
    const Digits s = sin(Digits(angle)), c = cos(Digits(angle));
    Matrix m = identity();
    const std::size_t i = (axis + 1) % 3, k = (axis + 2) % 3;
    m[i][i] = m[k][k] = c, m[i][k] = -s, m[k][i] = s;
    return m;
  };
  return about(2, yaw) * about(1, pitch) * about(0, roll);
}
Placed placed(const base::Report& r) {
  return {rotation(r.tilt.roll, r.tilt.pitch, r.X_WM.yaw), {r.X_WM.x, r.X_WM.y, r.X_WM.z}};
}

/// Returns the pose after a part of the screw motion: exp(part log(X)), by Rodrigues' formula.
Placed screw(const Placed& from, const Placed& to, const Digits& part) {
  const Matrix R = transposed(from.R) * to.R;
  const Vector p = transposed(from.R) * (to.p - from.p);
  const Vector twice{R[2][1] - R[1][2], R[0][2] - R[2][0], R[1][0] - R[0][1]};
  const Digits sine = sqrt(dot(twice, twice)) / 2, angle = atan2(sine, (R[0][0] + R[1][1] + R[2][2] - 1) / 2);
  const Matrix W = skew((angle / (2 * sine)) * twice), WW = W * W;
  // V(1) u = p with V(s) = s 1 + (1 - cos s a) / a^2 W + (s a - sin s a) / a^3 W^2.
  const Digits a = angle, inverse = 1 / (a * a) - (1 + cos(a)) / (2 * a * sin(a));
  const Vector u = sum(sum(identity(), Digits(-0.5), W), inverse, WW) * p;
  const Digits t = part * a;
  const Matrix turned = sum(sum(identity(), sin(t) / a, W), (1 - cos(t)) / (a * a), WW);
  const Matrix V =
      sum(sum(Matrix{part * identity()[0], part * identity()[1], part * identity()[2]}, (1 - cos(t)) / (a * a), W),
          (t - sin(t)) / (a * a * a), WW);
  return {from.R * turned, from.p + from.R * (V * u)};
}

constexpr std::int64_t kTick = 100'000'000;  // [ns]
constexpr double kGravity = 9.81;

/// Poses of ticks, far from the origin: tilted, then level, with a turn in place, then tilted again.
std::vector<base::Report> ticks() {
  const double poses[][6] = {{300.0, -200.0, 1.0, 0.1, -0.2, 3.0},  {300.1, -200.1, 1.05, 0.2, -0.1, -3.1},
                             {300.3, -200.0, 1.0, -0.3, 0.3, -2.8}, {300.3, -200.2, 0.9, 0.0, 0.0, -2.9},
                             {300.2, -200.3, 0.9, 0.0, 0.0, -2.7},  {300.2, -200.3, 0.9, 0.0, 0.0, -2.6},
                             {300.4, -200.5, 1.0, 0.3, 0.1, -2.5}};
  std::vector<base::Report> reports;
  for (const auto& p : poses) {
    base::Report r;
    r.time = static_cast<std::int64_t>(reports.size()) * kTick;
    r.X_WM = {p[0], p[1], p[2], p[5]};
    r.tilt = {p[3], p[4]};
    reports.push_back(r);
  }
  return reports;
}

class Trajectory {
 public:
  explicit Trajectory(const base::RigidTransform& X_MS) {
    for (const base::Report& r : ticks()) ticks_.push_back(placed(r));
    for (std::size_t i = 0; i < 3; ++i) {
      p_MS_[i] = X_MS.p[static_cast<int>(i)];
      for (std::size_t k = 0; k < 3; ++k) R_MS_[i][k] = X_MS.R[static_cast<int>(k)][static_cast<int>(i)];
    }
  }
  /// Returns the sensor's pose [ticks] on the motion between two ticks, also beyond its ends.
  Placed at(std::size_t segment, const Digits& time) const {
    const Placed X = screw(ticks_[segment], ticks_[segment + 1], time - segment);
    return {X.R * R_MS_, X.p + X.R * p_MS_};
  }
  Vector velocity(std::size_t segment, const Digits& time) const {  // [m/tick]
    return (1 / (2 * h)) * (at(segment, time + h).p - at(segment, time - h).p);
  }
  Vector rate(std::size_t segment, const Digits& time) const {  // [rad/tick]
    const Matrix turn = transposed(at(segment, time - h).R) * at(segment, time + h).R;
    return (1 / (4 * h)) * Vector{turn[2][1] - turn[1][2], turn[0][2] - turn[2][0], turn[1][0] - turn[0][1]};
  }
  Vector force(std::size_t segment, const Digits& time) const {
    const Placed now = at(segment, time);
    const Vector change = at(segment, time + h).p - Digits(2) * now.p + at(segment, time - h).p;
    return transposed(now.R) * ((100 / (h * h)) * change + Vector{0, 0, kGravity});
  }
  Vector jump(std::size_t segment) const {  // [m/s] at its start
    Vector change = velocity(segment, segment);
    if (segment > 0) change = change - velocity(segment - 1, segment);
    return transposed(at(segment, segment).R) * (Digits(10) * change);
  }

 private:
  const Digits h{"1e-10"};  // [ticks]
  std::vector<Placed> ticks_;
  Matrix R_MS_;
  Vector p_MS_;
};

glm::dvec3 to_double(const Vector& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

/// Integrates a function over part of a segment.
Vector integral(const std::function<Vector(const Digits&)>& f, const Digits& from, const Digits& to) {
  Vector sum;
  for (std::size_t axis = 0; axis < 3; ++axis)
    sum[axis] =
        boost::math::quadrature::gauss<Digits, 7>::integrate([&](const Digits& t) { return f(t)[axis]; }, from, to);
  return sum;
}

TEST(InertialMotion, MeansAreThoseOfFiniteDifferences) {
  const base::RigidTransform X_MS{base::rotation_of(0.4, -1.1, 2.0), {0.3, -0.2, 0.5}};
  const Trajectory trajectory(X_MS);
  const std::vector<base::Report> states = ticks();
  constexpr std::int64_t kDuration = 150'000'000;
  InertialMotion motion(X_MS, kDuration, 10.0, kGravity);
  // At ticks; between them; just behind one; and means that begin at a tick.
  for (std::int64_t now = 10'000'000, done = -1; now <= 590'000'000; now += 40'000'000) {
    const auto tick = now / kTick;
    while (done < tick) motion.add(states[static_cast<std::size_t>(++done)]);
    const base::Report& last = states[static_cast<std::size_t>(tick)];
    const InertialMeans found = motion.mean(
        now == last.time ? last : robots::interpolate(last, states[static_cast<std::size_t>(tick) + 1], now));

    Vector turned{}, gained{};
    const std::int64_t begin = now - kDuration;
    if (begin < 0) gained = (Digits(-begin) / 1e9) * (transposed(trajectory.at(0, 0).R) * Vector{0, 0, kGravity});
    for (std::size_t k = 0; k < 6; ++k) {
      const std::int64_t start = static_cast<std::int64_t>(k) * kTick;
      const std::int64_t from = std::max(begin, start), to = std::min(now, start + kTick);
      if (from >= to) continue;
      if (start >= begin) gained = gained + trajectory.jump(k);
      const Digits a = Digits(from) / kTick, b = Digits(to) / kTick;
      turned = turned + integral([&](const Digits& t) { return trajectory.rate(k, t); }, a, b);
      gained = gained + Digits(0.1L) * integral([&](const Digits& t) { return trajectory.force(k, t); }, a, b);
    }
    const Digits seconds = Digits(kDuration) / 1e9;
    EXPECT_LT(glm::distance(found.rate, to_double((1 / seconds) * turned)), 1e-11) << now;
    EXPECT_LT(glm::distance(found.force, to_double((1 / seconds) * gained)), 1e-9) << now;
  }
}

}  // namespace
}  // namespace sf::sensors
