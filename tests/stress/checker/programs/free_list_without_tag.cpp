// finds with -DWRONG: failure
// pmodels/argobots#178: a node leaves the free list and comes back between another thread's look
// at it and its exchange of the head, which then installs a successor that is in use. Right: the
// head carries a tag that every exchange raises
#include <array>
#include <atomic>
#include <cassert>
#include <thread>

struct FreeList {
  static constexpr unsigned none = 3;
  static constexpr unsigned tag = 4;
  std::array<std::atomic<unsigned>, none> next{1, 2, none};
  std::atomic<unsigned> head{0};

  static unsigned index(unsigned tagged) { return tagged % tag; }
#if defined(WRONG)
  static unsigned retagged(unsigned, unsigned node) {
    return node;
  }
#else
  static unsigned retagged(unsigned tagged, unsigned node) {
    return tagged - index(tagged) + tag + node;
  }
#endif

  unsigned take() {
    unsigned first = head.load();
    while (index(first) != none) {
      const unsigned second = next[index(first)].load();
      if (head.compare_exchange_strong(first, retagged(first, second))) break;
    }
    return index(first);
  }

  void give(unsigned node) {
    unsigned first = head.load();
    do {
      next[node].store(index(first));
    } while (!head.compare_exchange_strong(first, retagged(first, node)));
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
