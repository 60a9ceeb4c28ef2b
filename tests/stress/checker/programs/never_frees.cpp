// finds: nothing
#include <atomic>
#include <thread>

struct Node {
  int value;
  Node* next;
};
std::atomic<Node*> top{nullptr};

void push(int value) {
  Node* const node = new Node{value, top.load()};
  while (!top.compare_exchange_strong(node->next, node)) {
  }
}

bool pop() {
  Node* node = top.load();
  while (node != nullptr && !top.compare_exchange_strong(node, node->next)) {
  }
  return node != nullptr;  // and is not freed, for another may look at it
}

int main() {
  std::thread a([] { push(1); });
  std::thread b([] { pop(); });
  a.join();
  b.join();
  return 0;
}
