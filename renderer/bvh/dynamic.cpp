#include "renderer/bvh/dynamic.hpp"

#include <algorithm>
#include <chrono>

namespace irt {
namespace {

constexpr UpdateEntry entries[] = {
    {"auto", "refit, and rebuild when what refitted trees cost adds up to it", Update::by_cost},
    {"refit", "new boxes in the tree of the first frame", Update::refit},
    {"rebuild", "a new tree for every frame", Update::rebuild},
};

template <class Work>
double seconds_of(Work work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

std::span<const UpdateEntry> updates() {
  return entries;
}

DynamicAccelerator::DynamicAccelerator(const AcceleratorEntry& entry, const Mesh& mesh,
                                       const AcceleratorOptions& options, Update update,
                                       Executor& executor)
    : entry_(entry), mesh_(mesh), options_(options), update_(update) {
  rebuild(executor);
}

void DynamicAccelerator::rebuild(Executor& executor) {
  rebuild_s_ = seconds_of([&] {
    AcceleratorOptions options = options_;
    options.executor = &executor;
    current_ = entry_.build(mesh_, options);
  });
  cost_when_built_ = current_->sah_cost();
  lost_s_ = 0;
}

bool DynamicAccelerator::update(Executor& executor, double render_s) {
  if (update_ != Update::rebuild && !(update_ == Update::by_cost && rebuilding_pays(render_s))) {
    bool done = false;
    refit_s_ = seconds_of([&] { done = current_->refit(mesh_, executor); });
    if (done) return false;
  }
  rebuild(executor);
  return true;
}

bool DynamicAccelerator::rebuilding_pays(double render_s) {
  const double cost = current_->sah_cost();
  if (cost > cost_when_built_) lost_s_ += render_s * (1 - cost_when_built_ / cost);
  // A refit that was interrupted may have taken longer than a rebuild. A tree that loses nothing is
  // refitted all the same, which measures the refit anew.
  return lost_s_ > std::max(0.0, rebuild_s_ - refit_s_);
}

}  // namespace irt
