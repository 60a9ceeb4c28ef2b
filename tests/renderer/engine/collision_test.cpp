#include "renderer/engine/collision.hpp"

#include <gtest/gtest.h>

#include "renderer/engine/engine.hpp"
#include "renderer/scene/scenes.hpp"
#include "renderer/tracing/surface.hpp"
#include "tests/renderer/engine/brute_force.hpp"
#include "tests/renderer/engine/test_queues.hpp"

namespace irt {
namespace {

// A closed box of twelve triangles with a slanted wall across it.
Mesh box() {
  Mesh mesh;
  for (unsigned i = 0; i < 8; ++i) {
    mesh.vertices.push_back({i & 1u ? 1.0f : -1.0f, i & 2u ? 1.0f : -1.0f, i & 4u ? 1.0f : -1.0f});
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1}, {2, 3, 7},
                    {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}, {0, 1, 6}};
  mesh.material.assign(mesh.triangles.size(), 0);
  return mesh;
}

// The same physics, one particle after the other, without engine or tasks.
std::vector<Contacts> one_by_one(const Mesh& mesh, const std::vector<Particle>& particles,
                                 std::uint32_t max_contacts) {
  const BruteForce scene(mesh);
  std::vector<Contacts> all;
  for (const Particle& particle : particles) {
    Contacts contacts;
    Ray ray{particle.position, particle.velocity, 1};
    while (contacts.count < max_contacts) {
      const Hit hit = scene.trace(ray);
      if (hit.triangle == no_triangle) break;
      if (contacts.count++ == 0) {
        contacts.first = hit.triangle;
        contacts.time = hit.t;
      }
      const Surface surface = *surface_at(mesh, hit.triangle, hit.u, hit.v, ray.direction);
      ray = {surface.lifted(ray.origin), reflect(ray.direction, surface.normal) * (1 - hit.t), 1};
    }
    all.push_back(contacts);
  }
  return all;
}

TEST(Collision, AgreesWithOneByOneForEveryQueueAndThreadCount) {
  const Mesh mesh = box();
  const auto particles = particle_cloud(mesh, 5'000, 1);
  const auto expected = one_by_one(mesh, particles, 4);
  std::uint64_t total = 0;
  for (const Contacts& contacts : expected) total += contacts.count;
  ASSERT_GT(total, 500u);

  const BruteForce accelerator(mesh);
  for (const QueueEntry& queue : {plain_queue, queue_entry<OwnQueues>("own")}) {
    for (const unsigned threads : {1u, 2u, 7u}) {
      CollisionQuery query(mesh, particles, 64);
      auto engine = make_engine({.threads = threads, .rays_per_task = 64}, queue, accelerator);
      for (int frame = 0; frame < 2; ++frame) {
        engine->run(query);
        EXPECT_EQ(query.total(), total);
        for (std::size_t i = 0; i < particles.size(); ++i) {
          ASSERT_EQ(query.contacts()[i].count, expected[i].count);
          ASSERT_EQ(query.contacts()[i].first, expected[i].first);
          ASSERT_NEAR(query.contacts()[i].time, expected[i].time, 1e-6);
        }
      }
    }
  }
}

TEST(Collision, NothingLeavesAClosedBox) {
  // A particle that slipped through a wall after a bounce would fly on without contacts.
  Mesh mesh = box();
  mesh.triangles.pop_back();
  std::vector<Particle> particles = particle_cloud(mesh, 3'000, 2);
  for (Particle& particle : particles) {
    particle.position = particle.position * 0.99f;
    particle.velocity = normalize(particle.velocity) * 100.0f;  // far more than 16 crossings
  }
  const BruteForce accelerator(mesh);
  CollisionQuery query(mesh, particles, 256, 16);
  make_engine({}, plain_queue, accelerator)->run(query);
  for (const Contacts& contacts : query.contacts()) ASSERT_EQ(contacts.count, 16u);
}

TEST(Collision, TheSceneOfThePictureServesAsWell) {
  // The same cloud through the default structure and through every triangle.
  const Scene scene = built_in_scenes().front().make();
  const auto particles = particle_cloud(scene.mesh, 400, 3);
  const auto fast = accelerators().front().build(scene.mesh, {});
  const BruteForce every_triangle(scene.mesh);
  CollisionQuery query(scene.mesh, particles, 32);
  make_engine({.threads = 3, .rays_per_task = 32}, plain_queue, *fast)->run(query);
  EXPECT_GT(query.total(), 20u);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Hit hit = every_triangle.trace({particles[i].position, particles[i].velocity, 1});
    EXPECT_EQ(query.contacts()[i].first, hit.triangle);
    if (hit.triangle == no_triangle) continue;
    EXPECT_NEAR(query.contacts()[i].time, hit.t, 1e-5);
  }
}

}  // namespace
}  // namespace irt
