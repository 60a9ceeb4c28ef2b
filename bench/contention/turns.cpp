#include "bench/contention/turns.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "bench/contention/child.hpp"
#include "bench/contention/shuffle.hpp"

namespace irt::contention {
namespace {

class Round {
 public:
  Round(std::span<const Job> jobs, const std::function<void(std::size_t, const Sample&)>& done,
        const std::atomic<bool>& cancel)
      : jobs_(jobs), done_(done), cancel_(cancel), children_(jobs.size()) {}

  void start(const std::filesystem::path& program) {
    for (std::size_t i = 0; i < jobs_.size() && !cancel_; ++i) {
      children_[i] = std::make_unique<MeasuringChild>(program, jobs_[i]);
      if (children_[i]->ready(cancel_)) {
        hold(i);
      } else {
        finish(i);
      }
    }
  }

  void turn(std::size_t i) {
    if (!children_[i] || cancel_) return;
    let_go(i);
    if (children_[i]->take_turn(cancel_)) {
      hold(i);
    } else {
      finish(i);
    }
  }

  void finish_all() {
    for (std::size_t i = 0; i < children_.size() && !cancel_; ++i) {
      if (!children_[i]) continue;
      let_go(i);
      finish(i);
    }
  }

 private:
  // One that is alone has nobody to make way for.
  void hold(std::size_t i) {
    if (jobs_.size() > 1) children_[i]->hold();
  }
  void let_go(std::size_t i) {
    if (jobs_.size() > 1) children_[i]->let_go();
  }

  void finish(std::size_t i) {
    const Sample sample = children_[i]->finish(cancel_);
    children_[i].reset();
    if (!cancel_) done_(i, sample);
  }

  std::span<const Job> jobs_;
  const std::function<void(std::size_t, const Sample&)>& done_;
  const std::atomic<bool>& cancel_;
  std::vector<std::unique_ptr<MeasuringChild>> children_;  // none where it has ended
};

}  // namespace

Turn turn_of(unsigned threads, unsigned processors) {
  if (threads <= processors) return {};
  const unsigned each = (threads + processors - 1) / processors;
  return {.seconds = 0.02 * each, .settling_seconds = 0.005 * each};
}

unsigned turns_in(double seconds, const Turn& turn) {
  return static_cast<unsigned>(std::max(1L, std::lround(seconds / turn.seconds)));
}

void measure_in_turns(const std::filesystem::path& program, std::span<const Job> jobs,
                      std::uint64_t seed,
                      const std::function<void(std::size_t, const Sample&)>& done,
                      const std::atomic<bool>& cancel) {
  Round round(jobs, done, cancel);
  round.start(program);
  std::vector<std::size_t> order(jobs.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  SplitMix random(seed);
  for (unsigned lap = 0; lap < jobs.front().turns; ++lap) {
    if (lap % 2 == 0) {
      shuffle(std::span(order), random);
    } else {
      std::ranges::reverse(order);
    }
    for (const std::size_t i : order) round.turn(i);
  }
  round.finish_all();
}

}  // namespace irt::contention
