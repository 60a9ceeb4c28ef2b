// finds: nothing
#include <atomic>
#include <cstdlib>
#include <thread>

struct Node {
  std::atomic<int> value;
};
std::atomic<Node*> published;

int main() {
  std::thread reader([] {
    if (Node* node = published.load(std::memory_order_acquire))
      node->value.store(2, std::memory_order_relaxed);
  });
  auto* node = static_cast<Node*>(std::malloc(sizeof(Node)));
  node->value.store(1, std::memory_order_relaxed);
  published.store(node, std::memory_order_release);
  reader.join();
  std::free(node);
  return 0;
}
