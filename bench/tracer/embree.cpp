#include <array>
#include <chrono>
#include <cstring>
#include <embree3/rtcore.h>

#include "bench/tracer/contestant.hpp"

namespace irt::tracer {
namespace {

/// A scene of one mesh, committed.
class EmbreeScene {
 public:
  EmbreeScene(const Mesh& mesh, RTCBuildQuality quality, unsigned threads)
      : device_(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())),
        scene_(rtcNewScene(device_)) {
    rtcSetSceneBuildQuality(scene_, quality);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, quality);
    void* const vertices = rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), mesh.vertices.size());
    std::memcpy(vertices, mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3));
    void* const indices =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                sizeof(TriangleIndices), mesh.triangles.size());
    std::memcpy(indices, mesh.triangles.data(), mesh.triangles.size() * sizeof(TriangleIndices));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    const auto start = std::chrono::steady_clock::now();
    rtcCommitScene(scene_);
    commit_ms_ =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;
  ~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  [[nodiscard]] RTCScene handle() const { return scene_; }
  /// How long the hierarchy took; copying the mesh is not in it.
  [[nodiscard]] double commit_ms() const { return commit_ms_; }

 private:
  RTCDevice device_;
  RTCScene scene_;
  double commit_ms_ = 0;
};

RTCIntersectContext context(bool coherent) {
  RTCIntersectContext result;
  rtcInitIntersectContext(&result);
  result.flags =
      coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return result;
}

/// Embree's packets of N rays and the functions that trace them.
template <int N>
struct PacketOf;
template <>
struct PacketOf<4> {
  using RayHit = RTCRayHit4;
  static constexpr auto intersect = rtcIntersect4;
  static constexpr auto occluded = rtcOccluded4;
};
template <>
struct PacketOf<8> {
  using RayHit = RTCRayHit8;
  static constexpr auto intersect = rtcIntersect8;
  static constexpr auto occluded = rtcOccluded8;
};
template <>
struct PacketOf<16> {
  using RayHit = RTCRayHit16;
  static constexpr auto intersect = rtcIntersect16;
  static constexpr auto occluded = rtcOccluded16;
};

/// Copies N lanes; the arrays of a batch are padded, so a whole packet may always be read.
template <int N, class To, class From>
void copy_lanes(To& to, const LaneArray<From>& from, std::uint32_t first) {
  static_assert(sizeof(to[0]) == sizeof(From));
  std::memcpy(to, from.data() + first, N * sizeof(From));
}

template <int N>
void load(const Rays& rays, std::uint32_t first, typename PacketOf<N>::RayHit& packet, int* valid) {
  copy_lanes<N>(packet.ray.org_x, rays.origin_x, first);
  copy_lanes<N>(packet.ray.org_y, rays.origin_y, first);
  copy_lanes<N>(packet.ray.org_z, rays.origin_z, first);
  copy_lanes<N>(packet.ray.dir_x, rays.direction_x, first);
  copy_lanes<N>(packet.ray.dir_y, rays.direction_y, first);
  copy_lanes<N>(packet.ray.dir_z, rays.direction_z, first);
  copy_lanes<N>(packet.ray.tfar, rays.t_max, first);
  for (int i = 0; i < N; ++i) {
    packet.ray.tnear[i] = 0;
    packet.ray.time[i] = 0;
    packet.ray.mask[i] = ~0u;
    packet.ray.id[i] = 0;
    packet.ray.flags[i] = 0;
    packet.hit.primID[i] = packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    valid[i] = first + static_cast<std::uint32_t>(i) < rays.size ? -1 : 0;
  }
}

template <int N>
void closest(RTCScene scene, bool coherent, const Rays& rays, Hits& hits) {
  RTCIntersectContext how = context(coherent);
  for (std::uint32_t first = 0; first < rays.size; first += N) {
    alignas(64) typename PacketOf<N>::RayHit packet;
    alignas(64) int valid[N];
    load<N>(rays, first, packet, valid);
    PacketOf<N>::intersect(valid, scene, &how, &packet);
    std::memcpy(hits.t.data() + first, packet.ray.tfar, sizeof packet.ray.tfar);
    std::memcpy(hits.u.data() + first, packet.hit.u, sizeof packet.hit.u);
    std::memcpy(hits.v.data() + first, packet.hit.v, sizeof packet.hit.v);
    std::memcpy(hits.triangle.data() + first, packet.hit.primID, sizeof packet.hit.primID);
  }
}

template <int N>
void any(RTCScene scene, bool coherent, const Rays& rays, std::span<std::uint8_t> occluded) {
  RTCIntersectContext how = context(coherent);
  for (std::uint32_t first = 0; first < rays.size; first += N) {
    alignas(64) typename PacketOf<N>::RayHit packet;
    alignas(64) int valid[N];
    load<N>(rays, first, packet, valid);
    PacketOf<N>::occluded(valid, scene, &how, &packet.ray);
    for (std::uint32_t i = first; i < std::min(rays.size, first + N); ++i) {
      occluded[i] = packet.ray.tfar[i - first] < 0;
    }
  }
}

RTCRayHit load_one(const Rays& rays, std::uint32_t lane) {
  RTCRayHit one{};
  one.ray.org_x = rays.origin_x[lane];
  one.ray.org_y = rays.origin_y[lane];
  one.ray.org_z = rays.origin_z[lane];
  one.ray.dir_x = rays.direction_x[lane];
  one.ray.dir_y = rays.direction_y[lane];
  one.ray.dir_z = rays.direction_z[lane];
  one.ray.tfar = rays.t_max[lane];
  one.ray.mask = ~0u;
  one.hit.primID = one.hit.geomID = one.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return one;
}

void store_one(const RTCRayHit& one, Hits& hits, std::uint32_t lane) {
  hits.t[lane] = one.ray.tfar;
  hits.u[lane] = one.hit.u;
  hits.v[lane] = one.hit.v;
  hits.triangle[lane] = one.hit.primID;
}

void closest_singly(RTCScene scene, bool coherent, const Rays& rays, Hits& hits) {
  RTCIntersectContext how = context(coherent);
  for (std::uint32_t lane = 0; lane < rays.size; ++lane) {
    RTCRayHit one = load_one(rays, lane);
    rtcIntersect1(scene, &how, &one);
    store_one(one, hits, lane);
  }
}

void any_singly(RTCScene scene, bool coherent, const Rays& rays, std::span<std::uint8_t> occluded) {
  RTCIntersectContext how = context(coherent);
  for (std::uint32_t lane = 0; lane < rays.size; ++lane) {
    RTCRayHit one = load_one(rays, lane);
    rtcOccluded1(scene, &how, &one.ray);
    occluded[lane] = one.ray.tfar < 0;
  }
}

/// As Embree's stream of single rays, a whole batch at once.
std::vector<RTCRayHit>& stream_of(const Rays& rays) {
  thread_local std::vector<RTCRayHit> stream;
  stream.resize(rays.size);
  for (std::uint32_t lane = 0; lane < rays.size; ++lane) stream[lane] = load_one(rays, lane);
  return stream;
}

void closest_stream(RTCScene scene, bool coherent, const Rays& rays, Hits& hits) {
  RTCIntersectContext how = context(coherent);
  std::vector<RTCRayHit>& stream = stream_of(rays);
  rtcIntersect1M(scene, &how, stream.data(), rays.size, sizeof(RTCRayHit));
  for (std::uint32_t lane = 0; lane < rays.size; ++lane) store_one(stream[lane], hits, lane);
}

void any_stream(RTCScene scene, bool coherent, const Rays& rays, std::span<std::uint8_t> occluded) {
  RTCIntersectContext how = context(coherent);
  std::vector<RTCRayHit>& stream = stream_of(rays);
  rtcOccluded1M(scene, &how, &stream.data()->ray, rays.size, sizeof(RTCRayHit));
  for (std::uint32_t lane = 0; lane < rays.size; ++lane) {
    occluded[lane] = stream[lane].ray.tfar < 0;
  }
}

struct Way {
  std::string_view name;
  RTCBuildQuality quality;
  bool coherent;
  void (*closest)(RTCScene, bool, const Rays&, Hits&);
  void (*any)(RTCScene, bool, const Rays&, std::span<std::uint8_t>);
};
constexpr RTCBuildQuality medium = RTC_BUILD_QUALITY_MEDIUM, high = RTC_BUILD_QUALITY_HIGH;
constexpr std::array ways{
    Way{"embree 1", medium, false, closest_singly, any_singly},
    Way{"embree 4", medium, true, closest<4>, any<4>},
    Way{"embree 8", medium, true, closest<8>, any<8>},
    Way{"embree 16", medium, true, closest<16>, any<16>},
    Way{"embree stream", medium, true, closest_stream, any_stream},
    Way{"embree 4 incoherent", medium, false, closest<4>, any<4>},
    Way{"embree 8 incoherent", medium, false, closest<8>, any<8>},
    Way{"embree 16 incoherent", medium, false, closest<16>, any<16>},
    Way{"embree stream incoherent", medium, false, closest_stream, any_stream},
    Way{"embree 1 high", high, false, closest_singly, any_singly},
    Way{"embree 16 high", high, true, closest<16>, any<16>},
};

/// One way through a scene of Embree's, behind this project's face.
class Embree final : public Accelerator {
 public:
  Embree(const Way& way, std::shared_ptr<const EmbreeScene> scene)
      : way_(way), scene_(std::move(scene)) {}

  void closest_hit(const Rays& rays, Hits& hits, TraceProfile* /*profile*/) const override {
    way_.closest(scene_->handle(), way_.coherent, rays, hits);
  }
  void any_hit(const Rays& rays, std::span<std::uint8_t> occluded,
               TraceProfile* /*profile*/) const override {
    way_.any(scene_->handle(), way_.coherent, rays, occluded);
  }
  /// Embree does not say; nobody asks.
  [[nodiscard]] std::size_t memory_bytes() const override { return 0; }

 private:
  const Way& way_;
  std::shared_ptr<const EmbreeScene> scene_;
};

}  // namespace

Contestants embree_contestants(const Mesh& mesh, std::span<const std::string> wanted) {
  Contestants contestants;
  for (const RTCBuildQuality quality : {medium, high}) {
    std::shared_ptr<const EmbreeScene> scene;
    for (const Way& way : ways) {
      if (way.quality != quality || !is_wanted(way.name, wanted)) continue;
      if (!scene) scene = std::make_shared<EmbreeScene>(mesh, quality, 1);
      contestants.push_back(
          {std::string(way.name), false, false, std::make_unique<Embree>(way, scene)});
    }
  }
  return contestants;
}

std::vector<std::string> embree_names() {
  std::vector<std::string> names;
  names.reserve(std::size(ways));
  for (const Way& way : ways) names.emplace_back(way.name);
  return names;
}

void flush_denormals() {
#if defined(__x86_64__)
  constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x0040;  // of MXCSR
  __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | flush_to_zero | denormals_are_zero);
#endif
}

std::vector<TimedBuild> time_embree_builds(const Mesh& mesh, unsigned threads) {
  return {{"embree medium", EmbreeScene(mesh, medium, threads).commit_ms(), 0},
          {"embree high", EmbreeScene(mesh, high, threads).commit_ms(), 0}};
}

}  // namespace irt::tracer
