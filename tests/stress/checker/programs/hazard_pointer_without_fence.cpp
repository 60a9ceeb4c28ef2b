// finds with -DWRONG: use after free
// kcenon/thread_system#600 (pull 602): a reader announces its pointer by a release store, which
// the second look at the head may overtake, so that the scan misses it. Right: a fence keeps the
// second look at the head behind the announcement
#include <atomic>
#include <thread>

struct Node {
  int value;
};

struct Stack {
  std::atomic<Node*> head{new Node{1}};
  std::atomic<Node*> hazard{nullptr};

  Node* protect() {
    Node* seen = head.load(std::memory_order_acquire);
    while (true) {
      hazard.store(seen, std::memory_order_release);
#if !defined(WRONG)
      std::atomic_thread_fence(std::memory_order_seq_cst);
#endif
      Node* const again = head.load(std::memory_order_acquire);
      if (again == seen) return seen;
      seen = again;
    }
  }

  void unprotect() {
    hazard.store(nullptr, std::memory_order_release);
  }

  Node* replace_and_scan(Node* fresh) {
    Node* const old = head.exchange(fresh, std::memory_order_acq_rel);
    std::atomic_thread_fence(std::memory_order_seq_cst);
    if (hazard.load(std::memory_order_acquire) == old) return old;
    delete old;
    return nullptr;
  }
};

int main() {
  Stack stack;
  int seen = 0;
  std::thread reader([&] {
    seen = stack.protect()->value;
    stack.unprotect();
  });
  Node* const still_retired = stack.replace_and_scan(new Node{2});
  reader.join();
  delete still_retired;
  delete stack.head.load();
  if (seen != 1 && seen != 2) return 1;
  return 0;
}
