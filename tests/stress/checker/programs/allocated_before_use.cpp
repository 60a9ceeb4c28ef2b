// finds with -DWRONG: data race
// all accesses to the node are atomic, but nothing makes its allocation happen before them
#include <atomic>
#include <cstdlib>
#include <thread>

struct Node {
  std::atomic<int> value;
};
std::atomic<Node*> published;

#if defined(WRONG)
constexpr auto reads = std::memory_order_relaxed;
constexpr auto publishes = std::memory_order_relaxed;
#else
constexpr auto reads = std::memory_order_acquire;
constexpr auto publishes = std::memory_order_release;
#endif

int main() {
  std::thread reader([] {
    if (Node* node = published.load(reads)) node->value.store(2, std::memory_order_relaxed);
  });
  auto* node = static_cast<Node*>(std::malloc(sizeof(Node)));
  node->value.store(1, std::memory_order_relaxed);
  published.store(node, publishes);
  reader.join();
  std::free(node);
  return 0;
}
