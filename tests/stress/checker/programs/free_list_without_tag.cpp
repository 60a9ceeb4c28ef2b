// finds: failure
// pmodels/argobots#178: a node leaves the free list and comes back between another thread's look
// at it and its exchange of the head, which then installs a successor that is in use
#include <array>
#include <atomic>
#include <cassert>
#include <thread>

struct FreeList {
  static constexpr unsigned none = 3;
  std::array<std::atomic<unsigned>, none> next{1, 2, none};
  std::atomic<unsigned> head{0};

  unsigned take() {
    unsigned first = head.load();
    while (first != none) {
      const unsigned second = next[first].load();
      if (head.compare_exchange_strong(first, second)) break;
    }
    return first;
  }

  void give(unsigned node) {
    unsigned first = head.load();
    do {
      next[node].store(first);
    } while (!head.compare_exchange_strong(first, node));
  }
};

int main() {
  FreeList list;
  unsigned kept = FreeList::none;
  std::thread other([&] {
    const unsigned returned = list.take();
    kept = list.take();
    list.give(returned);
  });
  const unsigned mine = list.take();
  other.join();
  assert(mine != kept);
  const unsigned next = list.take();
  assert(next != kept && next != mine);
  return 0;
}
