/// A second application of the engine, beside images: which particles of a moving cloud run into
/// the scene (thesis 3.1 names collision detection).
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/engine/application.hpp"
#include "renderer/scene/scene.hpp"

namespace irt {

struct Particle {
  Vec3 position;
  Vec3 velocity;  ///< distance that it flies in one frame, if nothing is in the way
};

/// What became of a particle in the last frame.
struct Contacts {
  std::uint32_t count = 0;             ///< collisions with the scene
  std::uint32_t first = 0xffff'ffffu;  ///< first triangle hit, `no_triangle` for none
  float time = 1;                      ///< of the first collision, in [0, 1) of the frame
  friend bool operator==(const Contacts&, const Contacts&) = default;
};

/// Sweeps every particle along its way. It bounces like a mirror ray and flies on for the rest of
/// the frame, until `max_contacts`. The result does not depend on queue or threads: a particle is
/// in one task at a time.
class CollisionQuery final : public Application {
 public:
  /// `mesh` outlives the query. `rays_per_task` is at most the engine's.
  CollisionQuery(const Mesh& mesh, std::vector<Particle> particles, std::uint32_t rays_per_task,
                 std::uint32_t max_contacts = 4)
      : mesh_(mesh),
        particles_(std::move(particles)),
        contacts_(particles_.size()),
        rays_per_task_(rays_per_task),
        max_contacts_(max_contacts) {}

  void start_frame(TaskSink& tasks) override;
  void on_hits(const Task& task, const Hits& hits, TaskSink& tasks) override;
  void on_occlusion(const Task&, std::span<const std::uint8_t>, TaskSink&) override {}

  /// Per particle, of the last frame.
  [[nodiscard]] const std::vector<Contacts>& contacts() const { return contacts_; }

  /// All collisions of the last frame.
  [[nodiscard]] std::uint64_t total() const;

 private:
  const Mesh& mesh_;
  std::vector<Particle> particles_;
  std::vector<Contacts> contacts_;
  std::uint32_t rays_per_task_, max_contacts_;
};

/// `count` particles spread evenly over the bounding box of `mesh`, flying up to a quarter of its
/// diagonal, the same for the same `seed` on every machine.
std::vector<Particle> particle_cloud(const Mesh& mesh, std::uint32_t count, std::uint64_t seed);

}  // namespace irt
