#include "bench/spatial_embree.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <glm/common.hpp>
#include <string>

namespace sf::bench {

namespace {

std::string embree_options() {
  const char* const isa = std::getenv("LIDAR_ISA");
  return std::string("threads=1") + (isa != nullptr ? std::string(",isa=") + isa : "");
}

/// A scene, shared by the casters that use it.
class EmbreeScene {
 public:
  /// @param triangles split faces of four corners
  EmbreeScene(const scene::Mesh& mesh, bool triangles, bool robust)
      : device_(rtcNewDevice(embree_options().c_str())), scene_(rtcNewScene(device_)) {
    glm::dvec3 low(HUGE_VAL), high(-HUGE_VAL);
    for (const glm::dvec3& v : mesh.vertices) low = glm::min(low, v), high = glm::max(high, v);
    centre_ = 0.5 * (low + high);
    const RTCGeometry geometry =
        rtcNewGeometry(device_, triangles ? RTC_GEOMETRY_TYPE_TRIANGLE : RTC_GEOMETRY_TYPE_QUAD);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.vertices.size()));
    for (const glm::dvec3& v : mesh.vertices)
      for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>((v - centre_)[axis]);
    std::vector<std::uint32_t> corners;
    for (const scene::Face& face : mesh.faces) {
      corners.insert(corners.end(), face.begin(), face.begin() + (triangles ? 3 : 4));
      if (triangles && scene::corners_of(face) == 4) corners.insert(corners.end(), {face[0], face[2], face[3]});
    }
    const std::size_t each = triangles ? 3 : 4;
    void* faces =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, triangles ? RTC_FORMAT_UINT3 : RTC_FORMAT_UINT4,
                                each * sizeof(std::uint32_t), corners.size() / each);
    std::memcpy(faces, corners.data(), corners.size() * sizeof(std::uint32_t));
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneFlags(scene_, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcCommitScene(scene_);
  }
  ~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  RTCScene scene() const { return scene_; }
  glm::dvec3 centre() const { return centre_; }

 private:
  RTCDevice device_;
  RTCScene scene_;
  glm::dvec3 centre_{};
};

alignas(64) constexpr int kAll[16] = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
void intersect(RTCScene scene, RTCIntersectContext& context, RTCRayHit8& rays) {
  rtcIntersect8(kAll, scene, &context, &rays);
}
void intersect(RTCScene scene, RTCIntersectContext& context, RTCRayHit16& rays) {
  rtcIntersect16(kAll, scene, &context, &rays);
}

class EmbreeBeams : public SpatialCaster {
 public:
  EmbreeBeams(std::shared_ptr<EmbreeScene> scene, const std::vector<glm::dvec3>& beams, double range_max, int packet,
              std::string name)
      : scene_(std::move(scene)),
        beams_(beams.size()),
        range_(static_cast<float>(range_max)),
        packet_(packet),
        name_(std::move(name)),
        labels_(beams.size()) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const glm::dvec3& beam : beams) directions_[axis].push_back(static_cast<float>(beam[axis]));
      directions_[axis].resize((beams.size() + 15) / 16 * 16, directions_[axis].back());
    }
  }
  std::string name() const override { return name_; }
  std::span<const std::uint32_t> labels() const override { return labels_; }
  void cast(const base::RigidTransform& X_WS, std::span<double> ranges) override {
    if (packet_ == 16) return cast_packets<RTCRayHit16, 16>(X_WS, ranges);
    cast_packets<RTCRayHit8, 8>(X_WS, ranges);
  }

 private:
  struct View {
    float R[3][3];
    float p[3];
  };
  View view_of(const base::RigidTransform& X_WS) const {
    View view;
    const glm::dvec3 p = X_WS.p - scene_->centre();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) view.R[row][column] = static_cast<float>(X_WS.R[column][row]);
      view.p[row] = static_cast<float>(p[row]);
    }
    return view;
  }
  float along(const View& view, int row, std::size_t beam) const {
    return view.R[row][0] * directions_[0][beam] + view.R[row][1] * directions_[1][beam] +
           view.R[row][2] * directions_[2][beam];
  }

  template <class Packet, std::size_t width>
  void cast_packets(const base::RigidTransform& X_WS, std::span<double> ranges) {
    const View view = view_of(X_WS);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    alignas(64) Packet rays;
    for (std::size_t first = 0; first < beams_; first += width) {
      for (std::size_t i = 0; i < width; ++i) {
        rays.ray.org_x[i] = view.p[0], rays.ray.org_y[i] = view.p[1], rays.ray.org_z[i] = view.p[2];
        rays.ray.dir_x[i] = along(view, 0, first + i), rays.ray.dir_y[i] = along(view, 1, first + i);
        rays.ray.dir_z[i] = along(view, 2, first + i);
        rays.ray.tnear[i] = 0.0f, rays.ray.tfar[i] = range_, rays.ray.time[i] = 0.0f;
        rays.ray.mask[i] = ~0u, rays.ray.flags[i] = 0, rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      }
      intersect(scene_->scene(), context, rays);
      for (std::size_t i = 0; i < width && first + i < beams_; ++i)
        ranges[first + i] = static_cast<double>(rays.ray.tfar[i]), labels_[first + i] = rays.hit.geomID[i];
    }
  }

  std::shared_ptr<EmbreeScene> scene_;
  std::size_t beams_;
  float range_;
  int packet_;
  std::string name_;
  std::vector<float> directions_[3];  ///< padded to whole packets
  std::vector<std::uint32_t> labels_;
};

}  // namespace

std::vector<std::unique_ptr<SpatialCaster>> embree_casters(const scene::Mesh& mesh,
                                                           const std::vector<glm::dvec3>& beams, double range_max) {
  std::vector<std::unique_ptr<SpatialCaster>> casters;
  for (const bool triangles : {false, true})
    for (const bool robust : {false, true}) {
      const auto scene = std::make_shared<EmbreeScene>(mesh, triangles, robust);
      for (const int packet : {8, 16})
        casters.push_back(std::make_unique<EmbreeBeams>(
            scene, beams, range_max, packet,
            fmt::format("embree {}{}{}", packet, triangles ? " triangles" : "", robust ? " robust" : "")));
    }
  return casters;
}

}  // namespace sf::bench
