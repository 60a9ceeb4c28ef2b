// Structures with reclaimers that do not suit them: none of these may compile, and the compiler
// says why. CASE chooses one; tests/queues/CMakeLists.txt has the sentence that each must end with.
#include "queues/lock_free/counted_michael_scott_queue.hpp"
#include "queues/lock_free/michael_scott_queue.hpp"
#include "queues/reclamation/epochs.hpp"
#include "queues/reclamation/hazard_eras.hpp"
#include "queues/reclamation/hazard_pointers.hpp"
#include "queues/reclamation/tagged_free_list.hpp"

namespace irt {

// How the cases are written is right, where the two fit.
#define SOUND 0
// A pop has two nodes in hand.
#define ONE_POINTER 1
#define ONE_ERA 2
// A walk along the links, as through a list that others cut meanwhile.
#define WALK_WITH_POINTERS 3
#define WALK_WITH_ERAS 4
// A node becomes another one while it is read.
#define FREE_LIST 5
// And what is read of it is no word.
#define LARGE_IN_FREE_LIST 6
// There is no third hazard pointer.
#define THIRD_POINTER 7

struct Node {
  std::atomic<Node*> next{nullptr};
};

template <class N>
using OnePointer = HazardPointers<N, 1>;
template <class N>
using OneEra = HazardEras<N, 1>;
template <class N>
using PlainEpochs = Epochs<N>;
constexpr Needs walk{.nodes = 1, .follows_retired = true};

#if CASE == SOUND
MichaelScottList<int, PlainEpochs> list(1, 1);
static_assert(suits<Epochs<Node>::offers, walk>());
#elif CASE == ONE_POINTER
MichaelScottList<int, OnePointer> list(1, 1);
#elif CASE == ONE_ERA
MichaelScottList<int, OneEra> list(1, 1);
#elif CASE == WALK_WITH_POINTERS
static_assert(suits<OnePointer<Node>::offers, walk>());
#elif CASE == WALK_WITH_ERAS
static_assert(suits<OneEra<Node>::offers, walk>());
#elif CASE == FREE_LIST
MichaelScottList<int, TaggedFreeList> list(1, 1);
#elif CASE == LARGE_IN_FREE_LIST
CountedMichaelScottQueue<LargeElement> list(1, 1);
#elif CASE == THIRD_POINTER
Node* third(HazardPointers<Node, 2>& nodes, const std::atomic<Node*>& source) {
  return nodes.guard(0).protect<2>(source);
}
#endif

}  // namespace irt
