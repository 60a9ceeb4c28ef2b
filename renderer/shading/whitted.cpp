#include "renderer/shading/whitted.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/shading/whitted.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "renderer/shading/surfaces-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace irt::HWY_NAMESPACE {

HWY_INLINE Truths<lanes> any_above_zero(const Lanes3& colour) {
  const Lanes zero(0.0f);
  return either(either(colour.x > zero, colour.y > zero), colour.z > zero);
}

/// Contributions to pixels, gathered until there are enough for the frame buffer.
class Gathered {
 public:
  explicit Gathered(FrameBuffer& frame) : frame_(frame) {}
  ~Gathered() {
    frame_.add(static_cast<std::uint32_t>(count_), pixel_, channel_[0], channel_[1], channel_[2]);
  }
  Gathered(const Gathered&) = delete;
  Gathered& operator=(const Gathered&) = delete;

  HWY_INLINE void add(const Truths<lanes>& which, const Indices<lanes>& pixels,
                      const Lanes3& colour) {
    put(colour.x, which, channel_[0] + count_);
    put(colour.y, which, channel_[1] + count_);
    put(colour.z, which, channel_[2] + count_);
    count_ += put(pixels, which, pixel_ + count_);
  }

 private:
  FrameBuffer& frame_;
  std::size_t count_ = 0;  // of another type than the pixels, so that it can stay in a register
  std::uint32_t pixel_[surface_chunk + lanes];
  float channel_[3][surface_chunk + lanes];
};

/// Where rays of one kind go: a task that is made when the first one comes.
class Secondary {
 public:
  Secondary(const Task& parent, TaskSink& tasks, TaskKind kind, std::uint32_t depth,
            SecondaryRays how)
      : parent_(parent), tasks_(tasks), kind_(kind), depth_(depth), how_(how) {}

  /// Adds the rays of `which`, children of the rays from `first` on.
  HWY_INLINE void add(const Truths<lanes>& which, std::uint32_t first, const LineOf<Lanes>& line,
                      const Lanes3& weight, const Indices<lanes>& pixels) {
    if (how_ != SecondaryRays::thesis && !any(which)) return;
    if (task_ == nullptr) {
      if (!any(which)) return;
      task_ = &tasks_.add(kind_, depth_);
      task_->sample = parent_.sample;
      task_->rays.singly = how_ == SecondaryRays::single;
      if (how_ == SecondaryRays::thesis) fill_with_none();
    }
    Rays& rays = task_->rays;
    if (how_ == SecondaryRays::thesis) {
      const Lanes zero(0.0f);
      const Lanes end = select(which, line.end, Lanes(-1.0f));
      store(rays, first, {line.origin, line.direction, end},
            {select(which, weight.x, zero), select(which, weight.y, zero),
             select(which, weight.z, zero)},
            pixels);
      return;
    }
    const std::uint32_t at = rays.size;
    put(line.origin.x, which, &rays.origin_x[at]);
    put(line.origin.y, which, &rays.origin_y[at]);
    put(line.origin.z, which, &rays.origin_z[at]);
    put(line.direction.x, which, &rays.direction_x[at]);
    put(line.direction.y, which, &rays.direction_y[at]);
    put(line.direction.z, which, &rays.direction_z[at]);
    put(line.end, which, &rays.t_max[at]);
    put(weight.x, which, &rays.weight_r[at]);
    put(weight.y, which, &rays.weight_g[at]);
    put(weight.z, which, &rays.weight_b[at]);
    rays.size += put(pixels, which, &rays.pixel[at]);
  }

 private:
  /// As many lanes as the parent has, none with a ray.
  void fill_with_none() {
    Rays& rays = task_->rays;
    rays.size = parent_.rays.size;
    const Lanes zero(0.0f), one(1.0f);
    for (std::uint32_t first = 0; first < rays.size; first += lanes) {
      store(rays, first, {{zero, zero, zero}, {one, one, one}, Lanes(-1.0f)}, {zero, zero, zero},
            Indices<lanes>(0u));
    }
  }
  static HWY_INLINE void store(Rays& rays, std::uint32_t at, const LineOf<Lanes>& line,
                               const Lanes3& weight, const Indices<lanes>& pixels) {
    line.origin.x.store(&rays.origin_x[at]);
    line.origin.y.store(&rays.origin_y[at]);
    line.origin.z.store(&rays.origin_z[at]);
    line.direction.x.store(&rays.direction_x[at]);
    line.direction.y.store(&rays.direction_y[at]);
    line.direction.z.store(&rays.direction_z[at]);
    line.end.store(&rays.t_max[at]);
    weight.x.store(&rays.weight_r[at]);
    weight.y.store(&rays.weight_g[at]);
    weight.z.store(&rays.weight_b[at]);
    pixels.store(&rays.pixel[at]);
  }

  const Task& parent_;
  TaskSink& tasks_;
  TaskKind kind_;
  std::uint32_t depth_;
  SecondaryRays how_;
  Task* task_ = nullptr;
};

void shade_hits(const Scene& scene, FrameBuffer& frame, const ShaderOptions& options,
                const Task& task, const Hits& hits, TaskSink& tasks) {
  const Rays& rays = task.rays;
  std::vector<Secondary> shadow(
      scene.lights.size(), Secondary(task, tasks, TaskKind::shadow, task.depth, options.secondary));
  Secondary specular(task, tasks, TaskKind::specular, task.depth + 1, options.secondary);
  const Lanes zero(0.0f);
  const Lanes3 black{zero, zero, zero};
  SurfaceChunk surfaces;
  for (std::uint32_t chunk = 0; chunk < rays.size; chunk += surface_chunk) {
    const std::uint32_t count = std::min(surface_chunk, rays.size - chunk);
    surfaces.find(scene, rays, hits, chunk, count);
    Gathered contributions(frame);
    for (std::uint32_t i = 0; i < count; i += lanes) {
      const std::uint32_t lane = chunk + i;
      const std::uint32_t left = std::min<std::uint32_t>(count - i, lanes);
      const Truths<lanes> is_ray =
          both(truths<lanes>((1u << left) - 1), Lanes::load(&rays.t_max[lane]) >= zero);
      const Indices<lanes> pixels = Indices<lanes>::load(&rays.pixel[lane]);
      const Lanes3 weight{Lanes::load(&rays.weight_r[lane]), Lanes::load(&rays.weight_g[lane]),
                          Lanes::load(&rays.weight_b[lane])};
      const Lanes3 matt = weight * surfaces.diffuse(i);
      const Truths<lanes> is_surface = both(is_ray, surfaces.is_surface(i));
      const Truths<lanes> is_hit = surfaces.is_hit(i);
      // A hit without a normal is black.
      contributions.add(is_ray, pixels,
                        select(is_hit, select(is_surface, matt * Lanes(Whitted::ambient), black),
                               weight * broadcast<Lanes>(Whitted::background)));
      if (!any(is_surface)) continue;

      const Lanes3 point = surfaces.point(i), normal = surfaces.normal(i);
      for (std::size_t k = 0; k < shadow.size(); ++k) {
        const Lanes3 light = broadcast<Lanes>(scene.lights[k].position);
        const Lanes3 to_light = light - point;
        // NaN: the light lies on the surface.
        const Lanes cosine = dot(normal, to_light) / square_root(dot(to_light, to_light));
        const Lanes3 brings = matt * broadcast<Lanes>(scene.lights[k].intensity) * cosine;
        const Truths<lanes> lit = both(is_surface, both(cosine > zero, any_above_zero(brings)));
        const Lanes3 end = surfaces.lifted(i, light);
        shadow[k].add(lit, lane, {light, end - light, Lanes(1.0f)}, brings, pixels);
      }

      if (task.depth == options.max_depth) continue;
      const Lanes3 mirrored = weight * surfaces.specular(i);
      const Lanes3 origin{Lanes::load(&rays.origin_x[lane]), Lanes::load(&rays.origin_y[lane]),
                          Lanes::load(&rays.origin_z[lane])};
      const Lanes3 along{Lanes::load(&rays.direction_x[lane]), Lanes::load(&rays.direction_y[lane]),
                         Lanes::load(&rays.direction_z[lane])};
      specular.add(both(is_surface, any_above_zero(mirrored)), lane,
                   {surfaces.lifted(i, origin), along - normal * (Lanes(2.0f) * dot(along, normal)),
                    Lanes(std::numeric_limits<float>::infinity())},
                   mirrored, pixels);
    }
  }
}

void add_light(FrameBuffer& frame, const Rays& rays, const std::uint8_t* occluded) {
  const Lanes zero(0.0f);
  for (std::uint32_t chunk = 0; chunk < rays.size; chunk += surface_chunk) {
    const std::uint32_t end = std::min(rays.size, chunk + surface_chunk);
    Gathered contributions(frame);
    for (std::uint32_t lane = chunk; lane < end; lane += lanes) {
      const std::uint32_t left = std::min<std::uint32_t>(end - lane, lanes);
      alignas(16) std::uint8_t last[lanes] = {};
      if (left < lanes) std::copy_n(occluded + lane, left, last);
      const Truths<lanes> is_dark = load_bytes<lanes>(left < lanes ? last : occluded + lane);
      const Truths<lanes> is_ray =
          both(truths<lanes>((1u << left) - 1), Lanes::load(&rays.t_max[lane]) >= zero);
      contributions.add(is_ray, Indices<lanes>::load(&rays.pixel[lane]),
                        {select(is_dark, zero, Lanes::load(&rays.weight_r[lane])),
                         select(is_dark, zero, Lanes::load(&rays.weight_g[lane])),
                         select(is_dark, zero, Lanes::load(&rays.weight_b[lane]))});
    }
  }
}

}  // namespace irt::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace irt {

HWY_EXPORT(shade_hits);
HWY_EXPORT(add_light);

void Whitted::on_hits(const Task& task, const Hits& hits, TaskSink& tasks) const {
  HWY_DYNAMIC_DISPATCH(shade_hits)(scene_, frame_, options_, task, hits, tasks);
}

void Whitted::on_occlusion(const Task& task, std::span<const std::uint8_t> occluded,
                           TaskSink& /*tasks*/) const {
  HWY_DYNAMIC_DISPATCH(add_light)(frame_, task.rays, occluded.data());
}

}  // namespace irt
#endif  // HWY_ONCE
