/// Of executions that differ only in which of several equal threads does what, one.
///
/// Threads of one *role* run the same program, so that an execution graph with two of them
/// exchanged is one as well (exchange.hpp makes sure of that). The exhaustive search then needs one
/// graph of each orbit. This is what tells it which, in the manner of Kokologiannakis, Marmanis and
/// Vafeiadis 2024, "SPORE: Combining Symmetry and Partial Order Reduction", though not by their
/// rules.
///
/// *Alike.* Two threads of a role, i below j, are alike as long as their events are the same: loads
/// of the same store, whatever is at blocks that each allocated itself, fences, equal choices.
/// Event number k of both is where they are still alike if the k - 1 before it are the same.
///
/// *The lower one first.* Where they are still alike, event k of i is made before event k of j.
/// This is a dependency like program order and reads-from (`past`): TruSt takes nothing back on
/// which what it keeps depends, so that no thread is ever ahead of a lower one that it is alike to.
/// A subset of events that is closed under what they depend on keeps its dependencies, and a
/// revisit changes the last event of a thread only, on which nothing that is kept depends. So
/// TruSt's arguments hold with this dependency as with its own two.
///
/// *The lower one earlier.* Where two that were alike differ at one and the same location, or in a
/// choice, event k of j must not come before that of i in coherence order (the choice: must not be
/// the larger). If it does, the graph is *forbidden*, unless what j reads there depends on event k
/// of i: then the exchange could not be made in this order. TruSt asks two things of what it
/// takes for consistent. A part of such a graph that is closed under dependencies is not forbidden:
/// all that is asked is in the part. And what is added in the dullest way is not forbidden: i is
/// there when j is added, and j's event comes after all there is.
///
/// *Each orbit has one* that is not forbidden. Take any graph and an order of its events that
/// agrees with program order and reads-from, those who are alike and read the same making their
/// events at once; number those of a role by who comes first where they differ. Nothing depends on
/// itself. If now j is forbidden against i, then all on which i's event k depends, j's included but
/// for what follows from i's, can be made first, then j's event k, then i's, then the rest as
/// before. Among those who parted there the order becomes smaller, lexicographically by coherence,
/// and elsewhere it stays; so this ends.
///
/// What is not said to be ordered is not: other locations, as of slots by worker, and what one has
/// in a block of its own while the other is a guest there.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "stress/checker/graph.hpp"

namespace irt::checker {

class Heap;

class Symmetry {
 public:
  /// By thread, its role; a thread whose role no other one has is equal to none. Empty: none is.
  explicit Symmetry(std::vector<unsigned> roles);

  /// The next execution begins.
  void begin();
  [[nodiscard]] bool any() const { return any_; }

  /// What the event number `index` of `thread` depends on because of lower threads.
  [[nodiscard]] Clock past(const Graph& graph, unsigned thread, std::size_t index) const;
  /// `event` is part of the graph now.
  void added(const Graph& graph, const Heap& heap, const Event& event);
  /// Whether threads that should be alike are not: one was ahead of a lower one. Then nothing here
  /// holds.
  [[nodiscard]] bool broken() const { return broken_; }

  /// Whether the event number `index` of `thread`, at `location`, may not come where `place` says.
  /// `place(store)` is a store's number in modification order, `at` that of the store read or the
  /// one that a store is put after; `source` is what the store read depends on, null if none is.
  template <class Place>
  [[nodiscard]] bool forbids(const Graph& graph, const Heap& heap, unsigned thread,
                             std::size_t index, std::uint32_t location, std::size_t at,
                             const Clock* source, Place place) const;
  [[nodiscard]] bool forbids_option(const Graph& graph, unsigned thread, std::size_t index,
                                    std::uint32_t option) const;

 private:
  /// Event number `index` of `lower`, if `thread` is still alike there; else null.
  [[nodiscard]] const Event* rival(const Graph& graph, unsigned lower, unsigned thread,
                                   std::size_t index) const;

  std::vector<unsigned> roles_;
  bool any_ = false;
  bool broken_ = false;
  /// How many events of the lower and the higher thread are the same, from the first on.
  std::array<std::array<std::uint16_t, max_threads>, max_threads> same_{};
};

/// Whether a location is in a block of `a` or `b`, so that it is not the same to both.
bool is_own(const Graph& graph, const Heap& heap, std::uint32_t location, unsigned a, unsigned b);

template <class Place>
bool Symmetry::forbids(const Graph& graph, const Heap& heap, unsigned thread, std::size_t index,
                       std::uint32_t location, std::size_t at, const Clock* source,
                       Place place) const {
  if (!any_) return false;
  for (unsigned lower = 0; lower < thread; ++lower) {
    const Event* event = rival(graph, lower, thread, index);
    if (event == nullptr || !(event->reads || event->writes) || event->location != location ||
        is_own(graph, heap, location, lower, thread))
      continue;
    if (source != nullptr && source->count[lower] >= index) continue;
    const std::optional<std::size_t> theirs =
        place(event->writes ? graph.id_of(*event) : event->from);
    if (theirs && *theirs > at) return true;
  }
  return false;
}

}  // namespace irt::checker
