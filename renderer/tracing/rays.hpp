/// Rays and hits, many at a time: the unit of work that moves between engine, hierarchy and shader.
///
/// Structure of arrays, so that one layout serves single rays and SIMD packets of any width: packet
/// `p` of width W is the lanes [p*W, (p+1)*W). Arrays are 64-byte aligned and padded to a multiple
/// of 16 lanes and by 16 more, so that 16 may be written behind the last; lanes past `size` are
/// never read as results.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <memory_resource>
#include <new>
#include <span>

#include "renderer/scene/vec3.hpp"

namespace irt {

/// A fixed-size array on a 64-byte boundary, padded with zeroed lanes: at least 16.
template <class T>
class LaneArray {
 public:
  /// `memory` outlives the array.
  explicit LaneArray(std::size_t lanes,
                     std::pmr::memory_resource& memory = *std::pmr::new_delete_resource())
      : data_(static_cast<T*>(memory.allocate(bytes(lanes), alignment)), {&memory, bytes(lanes)}) {
    std::uninitialized_value_construct_n(data_.get(), bytes(lanes) / sizeof(T));
  }

  T& operator[](std::size_t lane) { return data_[lane]; }
  const T& operator[](std::size_t lane) const { return data_[lane]; }
  T* data() { return data_.get(); }
  [[nodiscard]] const T* data() const { return data_.get(); }

 private:
  static constexpr std::size_t alignment = 64;
  static constexpr std::size_t bytes(std::size_t lanes) {
    return (lanes + 31) / 16 * 16 * sizeof(T);
  }
  struct Delete {
    std::pmr::memory_resource* memory;
    std::size_t bytes;
    void operator()(T* data) const { memory->deallocate(data, bytes, alignment); }
  };
  std::unique_ptr<T[], Delete> data_;
};

/// One ray. It meets a triangle at origin + t * direction where 0 < t < t_max.
struct Ray {
  Vec3 origin;
  Vec3 direction;  ///< any length but zero
  float t_max = std::numeric_limits<float>::infinity();
};

/// Up to `capacity` rays with what each contributes to the frame.
struct Rays {
  /// `memory` outlives the rays.
  explicit Rays(std::uint32_t lanes,
                std::pmr::memory_resource& memory = *std::pmr::new_delete_resource())
      : capacity(lanes),
        origin_x(lanes, memory),
        origin_y(lanes, memory),
        origin_z(lanes, memory),
        direction_x(lanes, memory),
        direction_y(lanes, memory),
        direction_z(lanes, memory),
        t_max(lanes, memory),
        weight_r(lanes, memory),
        weight_g(lanes, memory),
        weight_b(lanes, memory),
        pixel(lanes, memory) {}

  std::uint32_t size = 0;
  std::uint32_t capacity;
  bool singly = false;  ///< to be traced ray by ray, whatever the width of packets
  LaneArray<float> origin_x, origin_y, origin_z;
  LaneArray<float> direction_x, direction_y, direction_z;
  LaneArray<float> t_max;
  /// Product of the cosines and BRDFs on the path so far, per channel (thesis 3.1).
  LaneArray<float> weight_r, weight_g, weight_b;
  LaneArray<std::uint32_t> pixel;  ///< index into the frame buffer

  [[nodiscard]] Ray ray(std::uint32_t lane) const {
    return {{origin_x[lane], origin_y[lane], origin_z[lane]},
            {direction_x[lane], direction_y[lane], direction_z[lane]},
            t_max[lane]};
  }
  [[nodiscard]] Vec3 weight(std::uint32_t lane) const {
    return {weight_r[lane], weight_g[lane], weight_b[lane]};
  }

  /// Appends a ray; `size < capacity` is the caller's to ensure.
  void add(const Ray& ray, Vec3 weight, std::uint32_t at_pixel) {
    const std::uint32_t lane = size++;
    origin_x[lane] = ray.origin.x;
    origin_y[lane] = ray.origin.y;
    origin_z[lane] = ray.origin.z;
    direction_x[lane] = ray.direction.x;
    direction_y[lane] = ray.direction.y;
    direction_z[lane] = ray.direction.z;
    t_max[lane] = ray.t_max;
    weight_r[lane] = weight.x;
    weight_g[lane] = weight.y;
    weight_b[lane] = weight.z;
    pixel[lane] = at_pixel;
  }
};

/// The value of `Hits::triangle` for a ray that meets nothing.
inline constexpr std::uint32_t no_triangle = 0xffff'ffffu;

/// The first triangle that each ray meets.
struct Hits {
  explicit Hits(std::uint32_t capacity)
      : t(capacity), u(capacity), v(capacity), triangle(capacity) {}

  LaneArray<float> t;     ///< ray parameter; undefined without a hit
  LaneArray<float> u, v;  ///< barycentric weights of the second and third corner
  LaneArray<std::uint32_t> triangle;
};

/// One hit, as the scalar kernels pass it.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  float u = 0, v = 0;
  std::uint32_t triangle = no_triangle;
};

}  // namespace irt
