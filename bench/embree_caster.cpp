#include "bench/embree_caster.h"

#include <embree3/rtcore.h>

#include <algorithm>

#include "base/error.h"
#include "base/reading.h"

namespace sf::bench {

namespace {

constexpr std::size_t kMostPacket = 16;
alignas(64) constexpr int kAllValid[kMostPacket] = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};

void intersect(RTCScene scene, RTCIntersectContext& context, RTCRayHit8& packet) {
  rtcIntersect8(kAllValid, scene, &context, &packet);
}
void intersect(RTCScene scene, RTCIntersectContext& context, RTCRayHit16& packet) {
  rtcIntersect16(kAllValid, scene, &context, &packet);
}

class EmbreeCaster final : public Caster {
 public:
  EmbreeCaster(const Scans& scans, const EmbreeUse& use);
  ~EmbreeCaster() override;

  std::string name() const override {
    return (use_.packet == 1 ? "embree, single rays" : "embree, " + std::to_string(use_.packet) + "-ray packets") +
           (use_.robust ? ", robust" : "");
  }
  void poison() override { results_.poison(); }
  void cast(std::size_t round) override {
    thread_pool_.parallel_for(scans_.robots(), kRobotsPerPiece, [&](std::size_t first, std::size_t last, unsigned) {
      for (std::size_t i = first; i < last; ++i) cast_robot(i, scans_.X_WS(round, i));
    });
  }
  std::size_t unwritten() const override { return results_.unwritten(); }
  double range(std::size_t robot, std::size_t beam) const override { return results_.range(robot, beam); }
  std::uint64_t hash() const override { return results_.hash(); }

 private:
  void add_walls(RTCGeometry geometry);
  void cast_robot(std::size_t robot, const base::Pose& X_WS) {
    if (use_.packet == 16) return cast_packets<RTCRayHit16, 16>(robot, X_WS);
    if (use_.packet == 8) return cast_packets<RTCRayHit8, 8>(robot, X_WS);
    cast_single(robot, X_WS);
  }
  template <class Packet, std::size_t width>
  void cast_packets(std::size_t robot, const base::Pose& X_WS);
  void cast_single(std::size_t robot, const base::Pose& X_WS);
  std::uint32_t model_of(unsigned primitive) const {
    return primitive == RTC_INVALID_GEOMETRY_ID ? base::kNoHit : models_[primitive / 2];
  }

  const Scans& scans_;
  EmbreeUse use_;
  Results<float> results_;
  RTCDevice device_;
  RTCScene scene_;
  std::vector<std::uint32_t> models_;     ///< by wall
  std::vector<float> beams_x_, beams_y_;  ///< padded to whole packets with the last beam
  base::ThreadPool thread_pool_;
};

EmbreeCaster::EmbreeCaster(const Scans& scans, const EmbreeUse& use)
    : scans_(scans), use_(use), results_(scans), device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  add_walls(geometry);
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  rtcSetSceneFlags(scene_, use.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  rtcCommitScene(scene_);
  SF_CHECK(rtcGetDeviceError(device_) == RTC_ERROR_NONE, "Embree refused the scene");

  for (const glm::dvec2& beam : scans.beams) {
    beams_x_.push_back(static_cast<float>(beam.x));
    beams_y_.push_back(static_cast<float>(beam.y));
  }
  const std::size_t padded = (beams_x_.size() + use.packet - 1) / use.packet * use.packet;
  beams_x_.resize(padded, beams_x_.back());
  beams_y_.resize(padded, beams_y_.back());
}

EmbreeCaster::~EmbreeCaster() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

/// Uses two triangles per wall: faster than one upright quad, or than one triangle whose section is the wall.
void EmbreeCaster::add_walls(RTCGeometry geometry) {
  const double z = scans_.world.movers[0].X_WM.z + scans_.laser.X_MS.z;
  std::vector<world::Segment> seen;
  for (const world::Segment& s : scans_.world.walls)
    if (s.seen_by_laser && s.z_min <= z && z < s.z_max) seen.push_back(s);
  auto* const vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 4 * seen.size()));
  auto* const triangles = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), 2 * seen.size()));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const glm::dvec2 corners[4] = {seen[i].a, seen[i].b, seen[i].b, seen[i].a};
    for (std::size_t k = 0; k < 4; ++k) {
      float* const v = vertices + 3 * (4 * i + k);
      v[0] = static_cast<float>(corners[k].x);
      v[1] = static_cast<float>(corners[k].y);
      v[2] = k < 2 ? -0.5f : 1.0f;
    }
    constexpr unsigned kCorners[6] = {0, 1, 2, 0, 2, 3};
    for (std::size_t k = 0; k < 6; ++k) triangles[6 * i + k] = static_cast<unsigned>(4 * i) + kCorners[k];
    models_.push_back(seen[i].model);
  }
}

template <class Packet, std::size_t width>
void EmbreeCaster::cast_packets(std::size_t robot, const base::Pose& X_WS) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  const auto c = static_cast<float>(std::cos(X_WS.yaw));
  const auto s = static_cast<float>(std::sin(X_WS.yaw));
  const auto x = static_cast<float>(X_WS.x);
  const auto y = static_cast<float>(X_WS.y);
  const auto range_max = static_cast<float>(scans_.laser.range_max);
  float* const ranges = results_.ranges(robot);
  std::uint32_t* const hits = results_.hits(robot);
  Packet packet{};
  for (std::size_t first = 0; first < beams_x_.size(); first += width) {
    for (std::size_t k = 0; k < width; ++k) {
      packet.ray.org_x[k] = x;
      packet.ray.org_y[k] = y;
      packet.ray.dir_x[k] = c * beams_x_[first + k] - s * beams_y_[first + k];
      packet.ray.dir_y[k] = s * beams_x_[first + k] + c * beams_y_[first + k];
      packet.ray.tfar[k] = range_max;
      packet.ray.mask[k] = 0xFFFFFFFFu;
      packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.primID[k] = RTC_INVALID_GEOMETRY_ID;
    }
    intersect(scene_, context, packet);
    const std::size_t count = std::min(width, scans_.beams.size() - first);
    for (std::size_t k = 0; k < count; ++k) {
      ranges[first + k] = packet.ray.tfar[k];
      hits[first + k] = model_of(packet.hit.primID[k]);
    }
  }
}

void EmbreeCaster::cast_single(std::size_t robot, const base::Pose& X_WS) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  const auto c = static_cast<float>(std::cos(X_WS.yaw));
  const auto s = static_cast<float>(std::sin(X_WS.yaw));
  float* const ranges = results_.ranges(robot);
  std::uint32_t* const hits = results_.hits(robot);
  RTCRayHit one{};
  for (std::size_t i = 0; i < scans_.beams.size(); ++i) {
    one.ray.org_x = static_cast<float>(X_WS.x);
    one.ray.org_y = static_cast<float>(X_WS.y);
    one.ray.dir_x = c * beams_x_[i] - s * beams_y_[i];
    one.ray.dir_y = s * beams_x_[i] + c * beams_y_[i];
    one.ray.tfar = static_cast<float>(scans_.laser.range_max);
    one.ray.mask = 0xFFFFFFFFu;
    one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    one.hit.primID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &one);
    ranges[i] = one.ray.tfar;
    hits[i] = model_of(one.hit.primID);
  }
}

}  // namespace

std::unique_ptr<Caster> make_embree_caster(const Scans& scans, const EmbreeUse& use) {
  return std::make_unique<EmbreeCaster>(scans, use);
}

}  // namespace sf::bench
