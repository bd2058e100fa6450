#include "robots/estimation/object_tracks.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::estimation {

namespace {

using Matrix2 = Eigen::Matrix2d;
using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

constexpr double kWallTime = 5.0;             // [s] for which a wall is known
constexpr double kWallSigmas = 3.0;           // of an echo's distance from a wall
constexpr double kWallDepth = 0.05;           // [m] walls are uneven
constexpr double kSame = 2.0;                 // squared normalised distance of two tracks of one object
constexpr double kMoves = 6.0, kRests = 3.0;  // squared normalised speeds: 5 and 22 % of objects at rest
constexpr double kSlowestObject = 0.03;       // [m/s]
constexpr double kTentative = 0.5;            // share of `keep` for tracks that are not confirmed
constexpr double kFades = 5.0;                // [s] in which errors that repeat change

double track_seconds(std::int64_t time) { return 1e-9 * static_cast<double>(time); }

Matrix2 matrix_of(const Spread& s) {
  Matrix2 m;
  m << s[0], s[1], s[1], s[2];
  return m;
}

Matrix4 read(const std::array<double, 16>& from) { return Eigen::Map<const Matrix4>(from.data()); }
void write(const Matrix4& from, std::array<double, 16>& to) {
  Eigen::Map<Matrix4>(to.data()) = 0.5 * (from + from.transpose());
}

void predict_track(ObjectTrack& track, std::int64_t time, double agility) {
  if (time <= track.time) return;
  const double t = track_seconds(time - track.time), q = agility * agility;
  Matrix4 F = Matrix4::Identity(), Q = Matrix4::Zero();
  F(0, 2) = F(1, 3) = t;
  for (const int i : {0, 1}) {
    Q(i, i) = q * t * t * t / 3.0;
    Q(i, i + 2) = Q(i + 2, i) = q * t * t / 2.0;
    Q(i + 2, i + 2) = q * t;
  }
  Q.topLeftCorner<2, 2>() += 2.0 * t / kFades * matrix_of(track.repeated);
  track.p += t * track.v;
  write(F * read(track.own) * F.transpose() + Q, track.own);
  track.time = time;
}

using Vector4 = Eigen::Vector4d;
Vector4 row_of(const RadialSpeed& radial) { return {0.0, 0.0, radial.along.x, radial.along.y}; }
/// [m/s] Measured less expected.
double surplus(const ObjectTrack& track, const RadialSpeed& radial) {
  return radial.speed - glm::dot(radial.along, track.v);
}

void correct_speed(ObjectTrack& track, const RadialSpeed& radial) {
  const Matrix4 P = read(track.own);
  const Vector4 h = row_of(radial), Ph = P * h, K = Ph / (h.dot(Ph) + radial.variance);
  const Vector4 change = surplus(track, radial) * K;
  track.p += glm::dvec2{change[0], change[1]}, track.v += glm::dvec2{change[2], change[3]};
  write(P - K * Ph.transpose(), track.own);
}

void correct_track(ObjectTrack& track, const Observation& observation) {
  const Matrix2 repeated = matrix_of(observation.repeated);
  const Matrix4 P = read(track.own);
  const Matrix2 R = matrix_of(observation.own) + repeated;
  const glm::dvec2 innovation = observation.p + observation.to_middle - track.p;
  const Eigen::Matrix<double, 4, 2> K = P.leftCols<2>() * (P.topLeftCorner<2, 2>() + R).inverse();
  const Eigen::Vector4d change = K * Eigen::Vector2d(innovation.x, innovation.y);
  track.p += glm::dvec2{change[0], change[1]}, track.v += glm::dvec2{change[2], change[3]};
  Matrix4 rest = Matrix4::Identity();
  rest.leftCols<2>() -= K;
  write(rest * P * rest.transpose() + K * R * K.transpose(), track.own);
  // Errors that repeat are averaged with weights that sum up to 1, at worst as if they were the same.
  const double share = std::clamp(0.5 * (K(0, 0) + K(1, 1)), 0.0, 1.0);
  for (std::size_t k = 0; k < 3; ++k) track.repeated[k] += share * (observation.repeated[k] - track.repeated[k]);
  if (observation.radial) correct_speed(track, *observation.radial);
}

/// Returns the squared normalised distance, that of a measured speed included, and the logarithm of the determinant of
/// its covariance.
std::array<double, 2> distance_of(const ObjectTrack& track, const Observation& observation) {
  const Matrix2 S = matrix_of({track.covariance(0, 0), track.covariance(0, 1), track.covariance(1, 1)}) +
                    matrix_of(observation.own) + matrix_of(observation.repeated);
  const glm::dvec2 away = observation.p + observation.to_middle - track.p;
  const Eigen::Vector2d d(away.x, away.y);
  std::array<double, 2> distance{d.dot(S.inverse() * d), base::log(S.determinant())};
  if (observation.radial) {
    const Vector4 h = row_of(*observation.radial);
    const double variance = h.dot(read(track.own) * h) + observation.radial->variance;
    const double off = surplus(track, *observation.radial);
    distance[0] += off * off / variance, distance[1] += base::log(variance);
  }
  return distance;
}

void decide_motion(ObjectTrack& track) {
  Matrix2 V;
  V << track.covariance(2, 2), track.covariance(2, 3), track.covariance(3, 2), track.covariance(3, 3);
  const Eigen::Vector2d v(track.v.x, track.v.y);
  const double squared = v.dot(V.inverse() * v);
  track.moving = squared > (track.moving ? kRests : kMoves) && v.norm() > kSlowestObject;
}

bool may_be_one(const ObjectTrack& track, const Observation& observation) {
  return track.corner == observation.corner && (track.tag == 0 || observation.tag == 0 || track.tag == observation.tag);
}

}  // namespace

void ObjectTracks::add_walls(std::int64_t time, std::span<const SeenWall> walls) {
  while (!walls_.empty() && track_seconds(time - walls_.front().time) > kWallTime) walls_.pop_front();
  for (const SeenWall& wall : walls) walls_.push_back({time, wall});
  while (walls_.size() > kMostWalls) walls_.pop_front();
}

bool ObjectTracks::on_wall(std::int64_t time, const Observation& observation) const {
  if (observation.corner || observation.tag != 0) return false;
  const auto variance = [&](glm::dvec2 u) {
    const Spread& s = observation.own;
    return u.x * u.x * s[0] + 2.0 * u.x * u.y * s[1] + u.y * u.y * s[2];
  };
  return std::ranges::any_of(walls_, [&](const TimedWall& seen) {
    if (std::abs(track_seconds(time - seen.time)) > kWallTime) return false;
    const SeenWall& wall = seen.wall;
    const glm::dvec2 d = observation.p - wall.middle, n{-wall.along.y, wall.along.x};
    const double sigma = std::sqrt(variance(n) + wall.across + kWallDepth * kWallDepth);
    return std::abs(glm::dot(d, n)) < kWallSigmas * sigma &&
           std::abs(glm::dot(d, wall.along)) < wall.half_length + std::sqrt(variance(wall.along));
  });
}

void ObjectTracks::assign(std::span<const Observation> observations) {
  pairs_.clear();
  used_.assign(observations.size(), 0), explained_.assign(observations.size(), 0), updated_.assign(tracks_.size(), 0);
  for (std::size_t t = 0; t < tracks_.size(); ++t)
    for (std::size_t i = 0; i < observations.size(); ++i) {
      if (!may_be_one(tracks_[t], observations[i])) continue;
      const auto [squared, determinant] = distance_of(tracks_[t], observations[i]);
      if (!(squared < options_.gate)) continue;
      explained_[i] = 1;
      const bool same = observations[i].tag != 0 && tracks_[t].tag == observations[i].tag;
      pairs_.push_back({!same, squared + determinant, t, i});
    }
  std::ranges::sort(pairs_, {}, &Pair::key);
  for (const Pair& pair : pairs_) {
    if (used_[pair.observation] != 0 || updated_[pair.track] != 0) continue;
    used_[pair.observation] = updated_[pair.track] = 1;
    ObjectTrack& track = tracks_[pair.track];
    correct_track(track, observations[pair.observation]);
    decide_motion(track);
    if (observations[pair.observation].tag != 0) track.tag = observations[pair.observation].tag;
    ++track.hits;
  }
}

void ObjectTracks::add(std::int64_t time, std::span<const Observation> observations) {
  for (ObjectTrack& track : tracks_) predict_track(track, time, options_.agility);
  assign(observations);
  for (std::size_t t = 0; t < updated_.size(); ++t)
    if (updated_[t] != 0) tracks_[t].seen = std::max(tracks_[t].seen, time);
  for (std::size_t i = 0; i < observations.size(); ++i)
    if (used_[i] == 0 && explained_[i] == 0 && !on_wall(time, observations[i])) start(time, observations[i]);
}

void ObjectTracks::start(std::int64_t time, const Observation& observation) {
  if (tracks_.size() >= kMostTracks) {
    ++left_out_;
    return;
  }
  ObjectTrack track{.identity = next_identity_++,
                    .time = time,
                    .p = observation.p + observation.to_middle,
                    .seen = time,
                    .hits = 1,
                    .corner = observation.corner,
                    .tag = observation.tag};
  Matrix4 own = Matrix4::Zero();
  own.topLeftCorner<2, 2>() = matrix_of(observation.own) + matrix_of(observation.repeated);
  own(2, 2) = own(3, 3) = options_.speed * options_.speed;
  write(own, track.own), track.repeated = observation.repeated;
  if (observation.radial) correct_speed(track, *observation.radial);
  tracks_.push_back(track);
}

void ObjectTracks::end_old(std::int64_t time) {
  std::erase_if(tracks_, [&](const ObjectTrack& track) {
    return track_seconds(time - track.seen) > options_.keep * (track.hits < kConfirmed ? kTentative : 1.0);
  });
  // Of two tracks of one object the later one ends.
  for (std::size_t a = 0; a < tracks_.size(); ++a)
    for (std::size_t b = tracks_.size(); b-- > a + 1;) {
      const ObjectTrack& other = tracks_[b];
      Observation as{.p = other.p, .corner = other.corner, .tag = other.tag};
      as.own = {other.covariance(0, 0), other.covariance(0, 1), other.covariance(1, 1)};
      if (!may_be_one(tracks_[a], as) || tracks_[a].time != other.time || !(distance_of(tracks_[a], as)[0] < kSame))
        continue;
      if (tracks_[a].tag == 0) tracks_[a].tag = other.tag;
      tracks_[a].hits = std::max(tracks_[a].hits, other.hits);
      tracks_[a].seen = std::max(tracks_[a].seen, other.seen);
      tracks_.erase(tracks_.begin() + static_cast<std::ptrdiff_t>(b));
    }
}

std::vector<ObjectTrack> ObjectTracks::at(std::int64_t time) const {
  std::vector<ObjectTrack> objects;
  for (const ObjectTrack& track : tracks_) {
    if (track.hits < kConfirmed) continue;
    predict_track(objects.emplace_back(track), time, options_.agility);
  }
  return objects;
}

}  // namespace sf::estimation
