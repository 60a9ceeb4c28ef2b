// Whether the seq_cst operations can still be put in one order, asked of random graphs, against the
// standard's words taken one by one.

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "stress/checker/coherence.hpp"

namespace irt::checker {
namespace {

/// [atomics.order] of C++20, paragraphs 3 and 4, over all pairs of operations.
class ByDefinition {
 public:
  explicit ByDefinition(const Graph& graph) : graph_(graph) {
    for (EventId id = 0; id < graph.size(); ++id)
      if (graph.event(id).order == Order::seq_cst && graph.event(id).kind != EventKind::initial)
        nodes_.push_back(id);
    for (std::uint32_t l = 0; l < graph.locations(); ++l) add_accesses(l);
  }

  [[nodiscard]] bool order_exists() const {
    const std::size_t count = nodes_.size();
    std::vector<std::vector<bool>> before(count, std::vector<bool>(count));
    for (std::size_t a = 0; a < count; ++a)
      for (std::size_t b = 0; b < count; ++b)
        before[a][b] = a != b && (strongly_happens_before(nodes_[a], nodes_[b]) ||
                                  coherence_ordered_before(nodes_[a], nodes_[b]));
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t a = 0; a < count; ++a)
        for (std::size_t b = 0; b < count; ++b)
          if (before[a][k] && before[k][b]) before[a][b] = true;
    for (std::size_t a = 0; a < count; ++a)
      if (before[a][a]) return false;
    return true;
  }

 private:
  struct Access {
    EventId id;
    std::uint32_t location;
    std::size_t position;  ///< store, its reads, next store, ...
  };

  void add_accesses(std::uint32_t l) {
    const Location& location = graph_.location(l);
    for (std::size_t place = 0; place < location.stores.size(); ++place)
      accesses_.push_back({location.stores[place], l, 2 * place});
    for (const EventId read : location.reads)
      if (!graph_.event(read).writes)
        accesses_.push_back({read, l, 2 * place_of(graph_, graph_.event(read).from) + 1});
  }

  [[nodiscard]] bool strongly_happens_before(EventId a, EventId b) const {
    const Event& first = graph_.event(a);
    const Event& second = graph_.event(b);
    if (first.thread == second.thread) return first.index < second.index;
    return second.before.count[first.thread] > first.index;
  }

  /// Whether `node` is `access`, or a fence that happens before it (or after it).
  [[nodiscard]] bool stands_before(EventId node, EventId access) const {
    const Event& event = graph_.event(access);
    return node == access ||
           (graph_.event(node).kind == EventKind::fence && event.kind != EventKind::initial &&
            happens_before(graph_.event(node), event.after));
  }
  [[nodiscard]] bool stands_behind(EventId node, EventId access) const {
    return node == access || (graph_.event(node).kind == EventKind::fence &&
                              happens_before(graph_.event(access), graph_.event(node).after));
  }

  [[nodiscard]] bool coherence_ordered_before(EventId a, EventId b) const {
    for (const Access& x : accesses_)
      for (const Access& y : accesses_)
        if (x.location == y.location && x.position < y.position && stands_before(a, x.id) &&
            stands_behind(b, y.id))
          return true;
    return false;
  }

  const Graph& graph_;
  std::vector<EventId> nodes_;
  std::vector<Access> accesses_;
};

/// Adds one random event after another, each of those that the model allows, and asks of each
/// other place whether it may be there.
class Grower {
 public:
  explicit Grower(unsigned seed) : random_(seed), threads_(2 + below(3)), graph_(threads_) {
    for (unsigned l = 0; l < locations; ++l) graph_.add_location(64 * (l + 1), 8, 0);
  }

  void grow() {
    const unsigned thread = below(threads_);
    const unsigned location = below(locations);
    static constexpr std::array orders{Order::relaxed, Order::acq_rel, Order::seq_cst,
                                       Order::seq_cst};
    const Order order = orders[below(orders.size())];
    switch (below(6)) {
      case 0:
        if (below(40) == 0) return graph_.reset_location(location, 0), void();
        graph_.finish_fence(graph_.begin(EventKind::fence, thread, order, nullptr));
        return;
      case 1:
        return modify(thread, location, order);
      case 2:
      case 3:
        return store(thread, location, order);
      default:
        return load(thread, location, order);
    }
  }

  unsigned asked = 0;
  unsigned refused = 0;

 private:
  static constexpr unsigned locations = 2;

  unsigned below(std::size_t n) { return static_cast<unsigned>(random_() % n); }

  /// Asks of each of `places` and completes the event at one of those allowed.
  template <class Finish>
  void choose(const std::vector<std::size_t>& places, EventKind kind, unsigned thread,
              std::uint32_t location, Order order, Finish finish) {
    std::vector<std::size_t> allowed;
    for (const std::size_t place : places) {
      Event& event = graph_.begin(kind, thread, order, nullptr);
      const bool answer = graph_.allows(event, location, place);
      Graph with = graph_;
      finish(with, with.begin(kind, thread, order, nullptr), place);
      const bool right = ByDefinition(with).order_exists();
      ASSERT_EQ(answer, right) << "event " << graph_.size();
      ++asked;
      if (answer)
        allowed.push_back(place);
      else
        ++refused;
    }
    ASSERT_FALSE(allowed.empty());
    finish(graph_, graph_.begin(kind, thread, order, nullptr), allowed[below(allowed.size())]);
  }

  void load(unsigned thread, std::uint32_t location, Order order) {
    std::vector<std::size_t> places;
    for (std::size_t p = lowest_readable(graph_, thread, location);
         p < graph_.location(location).stores.size(); ++p)
      places.push_back(p);
    choose(places, EventKind::load, thread, location, order,
           [&](Graph& g, Event& e, std::size_t p) { g.finish_load(e, location, p); });
  }

  void modify(unsigned thread, std::uint32_t location, Order order) {
    std::vector<std::size_t> places;
    for (std::size_t p = lowest_readable(graph_, thread, location);
         p < graph_.location(location).stores.size(); ++p)
      if (free_to_modify(graph_, location, p)) places.push_back(p);
    choose(places, EventKind::modify, thread, location, order,
           [&](Graph& g, Event& e, std::size_t p) { g.finish_modify(e, location, p, 1); });
  }

  void store(unsigned thread, std::uint32_t location, Order order) {
    std::vector<std::size_t> places;
    for (std::size_t p = lowest_readable(graph_, thread, location) + 1;
         p <= graph_.location(location).stores.size(); ++p)
      if (free_to_place(graph_, location, p)) places.push_back(p);
    choose(places, EventKind::store, thread, location, order,
           [&](Graph& g, Event& e, std::size_t p) { g.finish_store(e, location, p, 1); });
  }

  std::mt19937 random_;
  unsigned threads_;
  Graph graph_;
};

TEST(SeqCstOrder, is_that_of_the_definition_after_each_event) {
  unsigned asked = 0;
  unsigned refused = 0;
  for (unsigned seed = 1; seed <= 1'500; ++seed) {
    Grower grower(seed);
    for (int i = 0; i < 24 && !testing::Test::HasFatalFailure(); ++i) grower.grow();
    ASSERT_FALSE(testing::Test::HasFatalFailure()) << "seed " << seed;
    asked += grower.asked;
    refused += grower.refused;
  }
  EXPECT_GT(asked, 30'000U);
  EXPECT_GT(refused, 500U) << "nothing to tell apart";
}

}  // namespace
}  // namespace irt::checker
