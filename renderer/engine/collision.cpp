#include "renderer/engine/collision.hpp"

#include "queues/split_mix.hpp"
#include "renderer/tracing/surface.hpp"

namespace irt {

void CollisionQuery::start_frame(TaskSink& tasks) {
  contacts_.assign(contacts_.size(), Contacts{});
  Task* task = nullptr;
  for (std::uint32_t i = 0; i < particles_.size(); ++i) {
    if (task == nullptr || task->rays.size == rays_per_task_) {
      task = &tasks.add(TaskKind::primary, 0);
    }
    // The weight carries the share of the frame that is left, here all of it.
    task->rays.add({particles_[i].position, particles_[i].velocity, 1}, {1, 0, 0}, i);
  }
}

void CollisionQuery::on_hits(const Task& task, const Hits& hits, TaskSink& tasks) {
  Task* next = nullptr;
  for (std::uint32_t lane = 0; lane < task.rays.size; ++lane) {
    if (hits.triangle[lane] == no_triangle) continue;
    const Ray ray = task.rays.ray(lane);
    const std::uint32_t particle = task.rays.pixel[lane];
    const float left = task.rays.weight_r[lane];
    // A particle is in one task at a time and the queue orders that task after the one before, so
    // this is not a race.
    Contacts& contacts = contacts_[particle];
    if (contacts.count++ == 0) {
      contacts.first = hits.triangle[lane];
      contacts.time = 1 - left * (1 - hits.t[lane]);
    }
    if (contacts.count == max_contacts_) continue;
    const auto surface =
        surface_at(mesh_, hits.triangle[lane], hits.u[lane], hits.v[lane], ray.direction);
    if (!surface) continue;
    if (next == nullptr) next = &tasks.add(TaskKind::specular, task.depth + 1);
    const float rest = 1 - hits.t[lane];
    next->rays.add({surface->lifted(ray.origin), reflect(ray.direction, surface->normal) * rest, 1},
                   {left * rest, 0, 0}, particle);
  }
}

std::uint64_t CollisionQuery::total() const {
  std::uint64_t total = 0;
  for (const Contacts& contacts : contacts_) total += contacts.count;
  return total;
}

std::vector<Particle> particle_cloud(const Mesh& mesh, std::uint32_t count, std::uint64_t seed) {
  Vec3 low = mesh.vertices.front(), high = low;
  for (const Vec3 vertex : mesh.vertices) {
    low = min(low, vertex);
    high = max(high, vertex);
  }
  SplitMix random(seed);
  const Vec3 size = high - low;
  const float reach = 0.25f * length(size);
  std::vector<Particle> particles(count);
  for (Particle& particle : particles) {
    for (int axis = 0; axis < 3; ++axis) {
      particle.position[axis] = low[axis] + size[axis] * random.uniform();
      particle.velocity[axis] = reach * (2 * random.uniform() - 1);
    }
  }
  return particles;
}

}  // namespace irt
