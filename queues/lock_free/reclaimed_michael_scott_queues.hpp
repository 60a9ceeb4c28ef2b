/// LFREE with other reclaimers than hazard pointers: what they cost is the difference between
/// these.
///
/// When to use: each says itself, in queues/reclamation/. When not: a thread may stand still inside
/// an operation, and memory is finite: then only hazard pointers (`lfree`, `lfree-cached`) and
/// hazard eras (`lfree-eras`) bound what is held back.
///
/// Ordering: FIFO by happens-before. Progress: lock-free, apart from the allocator. Memory: one
/// node per task, from the allocator, and what the reclaimer holds back. Unbounded.
///
/// How it works: see michael_scott_queue.hpp.
#pragma once

#include <string_view>

#include "queues/lock_free/michael_scott_queue.hpp"
#include "queues/reclamation/epochs.hpp"
#include "queues/reclamation/hazard_eras.hpp"
#include "queues/reclamation/hazard_pointers.hpp"
#include "queues/reclamation/hyaline.hpp"
#include "queues/reclamation/node_cache.hpp"
#include "queues/reclamation/quiescent_states.hpp"
#include "queues/work_queue.hpp"

namespace irt {

constexpr Claims reclaimed_michael_scott_claims(Reclamation reclamation) {
  return {.ordering = Ordering::fifo_happens_before,
          .push = Progress::lock_free,
          .pop = Progress::lock_free,
          .reclamation = reclamation,
          .elements = {.large = true}};
}

template <class Node>
using PlainEpochs = Epochs<Node>;

/// One barrier for each operation, and none for a node.
template <class T>
class EpochMichaelScottQueue : public MichaelScottList<T, PlainEpochs> {
 public:
  static constexpr std::string_view summary = "LFREE, nodes freed by epochs (DEBRA)";
  static constexpr Claims claims = reclaimed_michael_scott_claims(Reclamation::epochs);
  using MichaelScottList<T, PlainEpochs>::MichaelScottList;
};

template <class Node>
using PlainQuiescentStates = QuiescentStates<Node>;

/// No barrier, while pops find something. A worker that neither calls nor leaves, and whose last
/// pop did not answer *empty*, keeps all others from freeing.
template <class T>
class QuiescentMichaelScottQueue : public MichaelScottList<T, PlainQuiescentStates> {
 public:
  static constexpr std::string_view summary = "LFREE, nodes freed by quiescent states (QSBR)";
  static constexpr Claims claims = reclaimed_michael_scott_claims(Reclamation::quiescent_states);
  using MichaelScottList<T, PlainQuiescentStates>::MichaelScottList;
};

template <class Node>
using TwoHazardEras = HazardEras<Node, 2>;

/// A barrier when the era has changed.
template <class T>
class EraMichaelScottQueue : public MichaelScottList<T, TwoHazardEras> {
 public:
  static constexpr std::string_view summary = "LFREE, nodes freed by hazard eras";
  static constexpr Claims claims = reclaimed_michael_scott_claims(Reclamation::hazard_eras);
  using MichaelScottList<T, TwoHazardEras>::MichaelScottList;
};

template <class Node>
using PlainHyaline = Hyaline<Node>;

/// Two barriers for each operation, and none for a node; nodes go when the last reader does.
template <class T>
class HyalineMichaelScottQueue : public MichaelScottList<T, PlainHyaline> {
 public:
  static constexpr std::string_view summary = "LFREE, nodes freed by their last reader (Hyaline-1)";
  static constexpr Claims claims = reclaimed_michael_scott_claims(Reclamation::last_reader);
  using MichaelScottList<T, PlainHyaline>::MichaelScottList;
};

template <class Node>
using CachedHazardPointers = HazardPointers<Node, 2, NodeCache>;

/// Spares the allocator, and keeps tools that watch it from seeing a node that is freed too early;
/// for them there is `lfree`.
template <class T>
class CachedMichaelScottQueue : public MichaelScottList<T, CachedHazardPointers> {
 public:
  static constexpr std::string_view summary = "LFREE, a cache of nodes for each worker";
  static constexpr Claims claims = reclaimed_michael_scott_claims(Reclamation::hazard_pointers);
  using MichaelScottList<T, CachedHazardPointers>::MichaelScottList;
};

}  // namespace irt
